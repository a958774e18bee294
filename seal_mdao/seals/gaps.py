"""Largest gap between contacts at the end of a load path, and measures whose points do not include
it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.contact.friction import OPEN
from seal_mdao.measures.gap import Gap, open_at
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.seals.profiles import contact_positions, contacts, self_contacts

NEGLIGIBLE = 1e-3
"""Gap that is as good as closed, mm: a penalty leaves as much."""


class OpenGap(NamedTuple):
    """The largest gap between the first and the last contact with a profile.

    Attributes
    ----------
    profile : str
    size : float
        mm; 0 where nothing opens.
    point : int
        Contact point; -1 where nothing opens.
    place : tuple of float
        Where that is in the undeformed section, mm; empty where nothing opens.
    """

    profile: str
    size: float
    point: int
    place: tuple


def open_between(result, profile: str, step: int = -1) -> np.ndarray:
    """Find the points between the first and the last contact with a profile that touch nothing
    after a nominal step.

    Returns
    -------
    ndarray of int
        Indices of contact points.
    """
    own = result.path.at_nominal(profile)[step]
    # open between closed ones along the edge
    points = open_at(result.term(profile), own.branch)
    others = [
        response.x[response.branch != OPEN]
        for term in (*contacts(result.seal), *self_contacts(result.seal))
        if term.label != profile
        for response in (result.path.at_nominal(term.label)[step],)
    ]
    touching = np.concatenate([np.empty((0, 2)), *others])
    if not points.size or not len(touching):
        return points
    # points of other contacts may lie between those of this one: half of the distance of neighbours
    size = len(own.x)
    beside = [own.x[(points + k) % size] - own.x[points] for k in (-1, 1)]
    near = 0.5 * np.min([np.hypot(*d.T) for d in beside], axis=0)
    nearest = np.linalg.norm(own.x[points][:, None] - touching, axis=2).min(axis=1)
    return points[nearest > near]


def largest_gap(result, profile: str) -> OpenGap:
    """Find the largest gap of all contact points of a profile after the last converged step."""
    response = result.path.at_nominal(profile)[-1]
    points = open_at(result.term(profile), response.state)
    if not points.size:
        return OpenGap(profile, 0.0, -1, ())
    point = int(points[response.gap[points].argmax()])
    place = contact_positions(result, profile)[point]
    return OpenGap(profile, float(response.gap[point]), point, tuple(place.tolist()))


def largest_gaps(result) -> dict[str, float]:
    """Compute the largest gap of every profile by its name, mm."""
    labels = [contact.label for contact in contacts(result.seal)]
    return {label: largest_gap(result, label).size for label in labels}


def unmeasured_gaps(result, measures: Sequence[Measure]) -> tuple[str, ...]:
    """Report measures of gaps whose points do not include the largest gap, one line each.

    Parameters
    ----------
    result : SealResult
        Of a completed path.
    measures : sequence of Measure
        With their places.
    """
    found = (_unmeasured(result, measure) for measure in measures)
    return tuple(text for text in found if text)


def gaps_unmeasured_by(result, name: str) -> tuple[str, ...]:
    """As ``unmeasured_gaps`` for the measure ``name`` of the seal; empty for a name that is not a
    measure, such as that of an aggregate."""
    try:
        measures = result.measures((name,))
    except ValueError:
        return ()
    return unmeasured_gaps(result, measures)


def _unmeasured(result, measure) -> str:
    base = measure.base if isinstance(measure, Derived) else measure
    if not isinstance(base, Gap):
        return ""
    points, largest = base.points, largest_gap(result, base.profile)
    if largest.size <= NEGLIGIBLE or largest.point in points:
        return ""
    gap = result.response(base.profile).gap[np.array(points, int)]
    return (
        f"the largest gap to {base.profile!r}, {largest.size:.3g} mm at "
        f"{values.place(largest.place)} of the undeformed section, lies outside of the points at "
        f"which {measure.name} is evaluated, where it is at most {gap.max(initial=0.0):.3g} mm: "
        "the gap region has moved away from these points; minimise the integral of the squared gap "
        "instead of the sum at points (gap_square_integral, --gap-integral)"
    )

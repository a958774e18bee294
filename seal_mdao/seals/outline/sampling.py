"""Points along the boundary of a section: sampled at a spacing, doubled, or located where given."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.segments import pair

FINE = 16
"""Evaluations of a variable spacing per expected side."""
MATCH = 1e-6
"""Largest distance of a point that is located on the boundary from it, mm."""
LOOK = 32
"""Points per side of a segment in the first search for the nearest one."""
STEPS = 12
"""Gauss-Newton steps from there; quadratic convergence for points on the curve."""


class Boundary(NamedTuple):
    """Points along a contour, in order; the last one is joined to the first.

    Attributes
    ----------
    points : ndarray, shape (k, 2)
        mm.
    edge : ndarray of str, shape (k,)
        Edge of the side from each point to the next.
    segment : ndarray of int, shape (k,)
        Index of the segment of this side.
    corner : ndarray of bool, shape (k,)
        Whether a segment begins at the point.
    arc_length : ndarray, shape (k,)
        From the beginning of the contour, mm.
    length : float
        Of the complete contour, mm.
    tangent : ndarray, shape (k, 2, 2)
        Unit tangents just before and just after each point; they differ at corners alone.
    """

    points: np.ndarray
    edge: np.ndarray
    segment: np.ndarray
    corner: np.ndarray
    arc_length: np.ndarray
    length: float
    tangent: np.ndarray


def sampled(
    outline, spacing: float | Callable[[np.ndarray], np.ndarray], limits: dict | None = None
) -> list[Boundary]:
    """Sample points along every contour, outer contour first; ends of segments always are points.

    Parameters
    ----------
    outline : Outline
    spacing : float or callable
        Largest distance along the boundary, mm; or a function that gives it at points (k, 2).
    limits : dict, optional
        Largest distances along edges by their names, mm, where ``spacing`` gives more.

    Raises
    ------
    ValueError
        For a spacing that is not positive.
    """

    def of(edge):
        """Spacing along an edge."""
        if not limits or edge not in limits:
            return spacing
        least = limits[edge]
        return (
            (lambda x: np.minimum(spacing(x), least)) if callable(spacing) else min(spacing, least)
        )

    found = []
    for contour in outline.contours:
        fractions = [_fractions(segment, of(segment.edge))[:-1] for segment in contour.segments]
        number = np.repeat(np.arange(len(fractions)), [s.size for s in fractions])
        found.append(boundary_at(contour.segments, number, np.concatenate(fractions)))
    return found


def boundary_at(segments, number: np.ndarray, fraction: np.ndarray) -> Boundary:
    """Describe points of a contour by their segments (k,) and fractions of these (k,), below 1."""
    lengths = np.array([segment.length for segment in segments])
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    points, after = np.empty((2, number.size, 2))
    for i, segment in enumerate(segments):
        here = number == i
        points[here] = segment.points(fraction[here])
        after[here] = segment.tangents(fraction[here])
    # at a corner the tangent before is that of the end of the segment before
    before, corner = after.copy(), fraction == 0.0
    last = np.array([segment.tangents([1.0])[0] for segment in segments])
    before[corner] = last[number[corner] - 1]
    return Boundary(
        points, np.array([segment.edge for segment in segments])[number], number, corner,
        starts[number] + fraction * lengths[number], float(starts[-1]),
        np.stack([before, after], axis=1),
    )  # fmt: skip


def _fractions(segment, spacing) -> np.ndarray:
    """Compute fractions of a segment's length for its points, both ends included."""
    if not callable(spacing):
        _require_positive(np.array([float(spacing)]))
        # constant spacing h: ceil(L / h) equal sides, but no side turns by more than 45 degrees
        count = int(np.ceil(segment.length / spacing - 1e-9))
        return np.linspace(0.0, 1.0, max(count, segment.sides) + 1)
    fine = np.linspace(0.0, 1.0, FINE * segment.sides + 1)
    # refine the evaluation to the smallest spacing found in a first pass
    least = float(_at(spacing, segment, fine).min())
    fine = np.linspace(0.0, 1.0, FINE * max(segment.sides, int(segment.length / least)) + 1)
    rate = segment.length / _at(spacing, segment, fine)
    # sides up to s: n(s) = int_0^s L / h ds by the trapezoidal rule; points at equal steps of n
    sides = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(fine))])
    count = max(int(np.ceil(sides[-1] - 1e-9)), segment.sides)
    found = np.interp(np.linspace(0.0, sides[-1], count + 1), sides, fine)
    found[0], found[-1] = 0.0, 1.0
    return found


def _at(spacing, segment, s) -> np.ndarray:
    values = np.broadcast_to(np.asarray(spacing(segment.points(s)), float), s.shape)
    _require_positive(values)
    return values


def _require_positive(values) -> None:
    wrong = np.flatnonzero(~(np.isfinite(values) & (values > 0.0)))
    if wrong.size:
        raise ValueError(f"the particle spacing must be a positive number, got {values[wrong[0]]}")


def doubled(outline, boundaries) -> list:
    """Insert a point on the curve in the middle (arc length) of every side of the boundary.

    Parameters
    ----------
    outline : Outline
    boundaries : sequence of Boundary
        As ``sampled(outline, 2 * spacing)`` gives them; for ``cloud.graded``

            def sample(at):
                return doubled(outline, sampled(outline, lambda x: 2.0 * at(x)))
    """
    return [
        _doubled(contour.segments, boundary)
        for contour, boundary in zip(outline.contours, boundaries, strict=True)
    ]


def _doubled(segments, boundary):
    lengths = np.array([segment.length for segment in segments])
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    # middle of each side in arc length; the last side ends where the contour begins
    arc, number = boundary.arc_length, boundary.segment
    middle = 0.5 * (arc + np.append(arc[1:], boundary.length))
    inner = boundary_at(segments, number, (middle - starts[number]) / lengths[number])
    return boundary._replace(
        points=_between(boundary.points, inner.points),
        edge=np.repeat(boundary.edge, 2),
        segment=np.repeat(number, 2),
        corner=_between(boundary.corner, inner.corner),
        arc_length=_between(arc, middle),
        tangent=_between(boundary.tangent, inner.tangent),
    )


def _between(values, others):
    # interleave: values at even indices, others at odd ones
    return np.stack([values, others], axis=1).reshape(2 * len(values), *values.shape[1:])


def located(contour, points: np.ndarray) -> tuple[Boundary, np.ndarray]:
    """Locate the points of a loop on a contour; return its ``Boundary`` and the order of the points.

    Parameters
    ----------
    contour : Contour
    points : ndarray, shape (k, 2)
        In order along the contour, starting anywhere; ends of segments must be among them.

    Raises
    ------
    GeometryError
        For a point that is not on the contour, points in another order, an end of a segment where no
        point is.
    """
    segments = contour.segments
    number, fraction, away = _nearest(segments, points)
    worst = int(away.argmax())
    if not away[worst] <= MATCH:
        raise GeometryError(
            f"the particle at {pair(points[worst])} is {away[worst]:.3g} mm away from the edge "
            f"{segments[number[worst]].edge!r}, on which it must lie; use a mesh (cloud) of this "
            "section"
        )
    lengths = np.array([segment.length for segment in segments])
    number, fraction = _from_beginnings(number, fraction, lengths)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    arc = starts[number] + fraction * lengths[number]
    order = np.roll(np.arange(len(points)), -int(arc.argmin()))
    # sorted from the beginning the arc length must increase strictly: once around, no repetition
    if not (np.diff(arc[order]) > 0.0).all():
        raise GeometryError(
            f"the particles along the contour with the edge {segments[0].edge!r} do not surround "
            "it exactly once; use a mesh (cloud) of this section"
        )
    missing = np.setdiff1d(np.arange(len(segments)), number[fraction == 0.0])
    if missing.size:
        raise GeometryError(
            f"no particle is at {pair(segments[missing[0]].start)}, where a segment of the edge "
            f"{segments[missing[0]].edge!r} begins; use a mesh (cloud) of this section"
        )
    return boundary_at(segments, number[order], fraction[order])._replace(
        points=points[order]
    ), order


def _nearest(segments, points):
    """Find segment, fraction of its length and distance of the nearest point for every point."""
    found = [_on(segment, points) for segment in segments]
    fractions, away = (np.array([one[i] for one in found]) for i in (0, 1))
    number, every = away.argmin(axis=0), np.arange(len(points))
    return number, fractions[number, every], away[number, every]


def _on(segment, points):
    # start at the nearest of many points of the segment
    first = np.linspace(0.0, 1.0, LOOK * segment.sides + 1)
    candidates = segment.points(first)
    fraction = first[np.hypot(*np.moveaxis(points[:, None] - candidates, -1, 0)).argmin(axis=1)]
    for _ in range(STEPS):
        # s <- s + (p - x(s)) . t(s) / L, clipped to the segment
        along = ((points - segment.points(fraction)) * segment.tangents(fraction)).sum(axis=1)
        fraction = np.clip(fraction + along / segment.length, 0.0, 1.0)
    return fraction, np.hypot(*(points - segment.points(fraction)).T)


def _from_beginnings(number, fraction, lengths):
    """Assign points at the end of a segment to the beginning of the next one."""
    fraction = np.where(fraction * lengths[number] <= MATCH, 0.0, fraction)
    ends = (1.0 - fraction) * lengths[number] <= MATCH
    return np.where(ends, (number + 1) % len(lengths), number), np.where(ends, 0.0, fraction)

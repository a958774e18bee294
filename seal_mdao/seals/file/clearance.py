"""Gap between the section of a seal file and its profiles at the start of the path."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from seal_mdao.contact.kinematics import closest_point
from seal_mdao.errors import SealFileError
from seal_mdao.geometry.pose import in_frame
from seal_mdao.seals.file.profile_table import motion_of, rigid_profile_of
from seal_mdao.seals.outline.segments import pair

ROUNDING = 1e-9
"""Penetration at the start that is rounding, over the size of the section."""
TYPED = 1e-6
"""Distance from the section at the start, over its size, that is rounding of the coordinates in a file:
the profile is meant to touch."""
NEAR = 1e-3
"""Largest distance at the start of a profile that supports a body, over the size of the section: designs
may recede so far from profiles that touch the nominal seal."""
LOOK = 1e-4
"""Sagitta of the chords at whose ends gaps are evaluated, over the size of the section."""


class Nearest(NamedTuple):
    """Smallest distance of a section from a profile at the start: gap (mm), point, edge."""

    gap: float
    place: np.ndarray
    edge: str


def gap_at_start(profile):
    """Return the gap of a point to a profile at the start, as a function of x and y."""
    # g_n of the closest point, in the frame of the profile at the start of the path
    curve, pose = rigid_profile_of(profile).curve, motion_of(profile, 1).pose(0.0)
    return lambda x, y: closest_point(curve, *in_frame(pose, x, y))[2]


def nearest_at_start(profile, outline) -> Nearest:
    """Find the point of the edges that may touch a profile where their gap at the start is least."""
    gap, sagitta = gap_at_start(profile), LOOK * outline.size
    found = (nearest_of(segment, gap, sagitta) for segment in _segments(profile, outline))
    return min(found, key=lambda own: own.gap)


def nearest_free_edges(where: str, profile, file) -> tuple[str, ...]:
    """Return the free edges that follow one another around the one nearest to a profile at the start.

    Raises
    ------
    SealFileError
        When no edge is free.
    """
    runs = [
        run
        for contour in file.section.outline.contours
        for run in _free_runs(contour.edge_names, file.supports)
    ]
    if not runs:
        raise SealFileError(
            f"{where}: the profile has no edge that it may touch, because all edges of the section "
            "are in [fixed], [[symmetry]], [[moved]] or glued; leave one edge free, or name it in "
            "the list contact"
        )
    gap, sagitta = gap_at_start(profile), LOOK * file.section.outline.size

    def away(run):
        segments = (s for name in run for s in file.section.outline.edge(name))
        return min(nearest_of(segment, gap, sagitta).gap for segment in segments)

    return min(runs, key=away)


def _free_runs(names, supports) -> list[tuple[str, ...]]:
    """Divide the edges of a closed contour into runs of neighbours without a support."""
    held = [i for i, name in enumerate(names) if name in supports]
    if not held:
        return [tuple(names)]
    # begin behind a supported edge, and end a run at every other one
    found = [()]
    for name in (*names[held[0] + 1 :], *names[: held[0]]):
        found = [*found, ()] if name in supports else [*found[:-1], (*found[-1], name)]
    return [run for run in found if run]


def check_start(where: str, profile, outline) -> float:
    """Return the least gap of a profile at the start, mm, which must not be negative beyond its
    ``interference``.

    Raises
    ------
    SealFileError
        When the profile, at the place ``where`` in the file, begins within the section.
    """
    # g < 0: the section begins inside the rigid body
    least, place, edge = nearest_at_start(profile, outline)
    if least < -TYPED * outline.size - profile.interference:
        gap, sagitta = gap_at_start(profile), LOOK * outline.size
        # points along all edges that may touch
        every = [s.points(s.chords(sagitta)) for s in _segments(profile, outline)]
        # all of the section on the wrong side: the curve has the wrong direction
        inside = all(gap(*x) < 0.0 for x in np.concatenate(every))
        turned = "; is its direction reversed?" if inside else ""
        touching = None if inside else _touching_start(profile, place, least, outline)
        raise SealFileError(
            f"{where}: start = {pair(profile.start)} puts the edge {edge!r} {-least:.3g} mm "
            f"inside the rigid body at {pair(np.round(place, 6) + 0.0)}; start it farther away"
            + ("" if touching is None else f", such as start = {touching}, where it touches")
            + ", give its interference"
            + " or remove that edge from the list contact" * (len(profile.contact) > 1)
            + f" (the rigid body lies on the left of the curve's direction{turned})"
        )
    return least


def cleared(profile, outline):
    """Return the profile with a start position at which it does not overlap the section.

    A profile that touches in the drawing would begin within the section or outside of it by chance. One
    with an interference is left as it is (``seals.clear_start``).
    """
    clear = ROUNDING * outline.size
    least, place, _ = nearest_at_start(profile, outline)
    if abs(least) > TYPED * outline.size:
        return profile
    typed = 0.0 if abs(least) <= clear else least
    return _moved_off(profile, place, 2.0 * clear - typed, outline.size)


def _touching_start(profile, place, least: float, outline) -> list | None:
    """Find a start, with few digits, at which a profile touches that begins ``-least`` mm inside at a
    point; None if it is then inside at another one."""
    exact = _moved_off(profile, place, -least, outline.size).start
    for digits in range(3, 10):
        start = np.round(exact, digits) + 0.0
        moved = replace(profile, start=tuple(start.tolist()))
        if abs(nearest_at_start(moved, outline).gap) <= TYPED * outline.size:
            return start.tolist()
    return None


def _moved_off(profile, place, distance: float, size: float):
    """Return the profile with a start that is ``distance`` (mm) farther off a point."""
    gap, h, (x, y) = gap_at_start(profile), 1e-3 * size, place
    # the profile moves against the gradient of its gap g, by central differences
    away = np.array([gap(x + h, y) - gap(x - h, y), gap(x, y + h) - gap(x, y - h)]) / (2.0 * h)
    start = np.array(profile.start) - distance * away
    return replace(profile, start=tuple(start.tolist()))


def rests_along_a_segment(profile, outline) -> bool:
    """Whether a profile touches or nearly touches a complete segment of its edges at the start, not only
    a point."""
    gap, s = gap_at_start(profile), np.linspace(0.0, 1.0, 5)
    segments = [own for contour in outline.contours for own in contour.segments]
    return any(
        max(abs(gap(*x)) for x in own.points(s)) <= NEAR * outline.size
        for own in segments
        if own.edge in profile.contact
    )


def _segments(profile, outline) -> list:
    return [segment for name in profile.contact for segment in outline.edge(name)]


def nearest_of(segment, gap, sagitta) -> Nearest:
    """Find the nearest point of a segment: by chords first, then between the ends beside the best."""

    def at(fraction):
        return gap(*segment.points([fraction])[0])

    # g at the ends of chords, then its minimum by Brent's method between the neighbours of the least
    fractions = segment.chords(sagitta)
    k = int(np.argmin([at(s) for s in fractions]))
    beside = fractions[max(k - 1, 0)], fractions[min(k + 1, len(fractions) - 1)]
    between = scipy.optimize.minimize_scalar(
        at, bounds=beside, method="bounded", options={"xatol": 1e-10}
    ).x
    best = min(fractions[k], between, key=at)
    return Nearest(at(best), segment.points([best])[0], segment.edge)

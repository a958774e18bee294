"""Chains of segments: joined head to tail in one point, and closed loops of loose segments."""

from collections import defaultdict
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.arcs import Circle
from seal_mdao.seals.outline.segments import Line, Segment, pair
from seal_mdao.seals.outline.sizes import USUAL

SHORTEST = 10.0
"""Least length of a segment, over the distance within which ends are joined."""

MOST_SEGMENTS = 20_000
"""Of a contour, and of a drawing: each becomes a particle at least."""

ROUNDING = 1e-9
"""Distance of ends that are equal up to rounding, mm; ends farther apart are moved together."""

FOLDED = np.radians(1.0)
"""Least angle between neighbouring segments."""


def checked_chain(segments, join: float, closed: bool) -> tuple:
    """Check that segments form a chain, and move ends that are up to ``join`` (mm) apart together.

    Every joint then is one point for particles, drawings and lines between materials. Lines keep their
    directions, so that edges stay in planes of symmetry. A closed chain ends where it begins.

    Raises
    ------
    GeometryError
        For segments that are not joined, too short, or fold back on each other.
    """
    if not isinstance(segments, tuple | list) or not segments:
        raise GeometryError(
            f"a contour of the section needs at least one segment, got {segments!r}"
        )
    check_count(len(segments))
    # every segment by itself, then every joint
    for number, segment in enumerate(segments, 1):
        _check_segment(number, segment, join, alone=len(segments) == 1)
        _check_length(number, segment, join, segments)
    following = [*pairwise(enumerate(segments, 1))]
    if closed:
        following.append(((len(segments), segments[-1]), (1, segments[0])))
    for (i, one), (j, other) in following:
        where = f"segment {i} (edge {one.edge!r}) and segment {j} (edge {other.edge!r})"
        gap = float(np.hypot(*(other.start - one.end)))
        if gap > join:
            is_last = closed and j == 1
            # a single edge, such as a polyline that is a complete contour
            remedy = (
                "; a line or spline that is a complete contour repeats its first point at its end"
            )
            raise GeometryError(
                ("the contour is open: " if is_last else "")
                + f"segment {i} (edge {one.edge!r}) ends at {pair(one.end)}, but the next segment "
                f"{j} (edge {other.edge!r}) begins at {pair(other.start)}, {gap:.3g} mm away"
                + (remedy if is_last and one.edge == other.edge else "")
            )
        # angle between the segments at the joint: atan2(|t x b|, t . b) of tangent and reversed tangent
        ahead, back = one.tangents([1.0])[0], -other.tangents([0.0])[0]
        angle = np.arctan2(abs(ahead[0] * back[1] - ahead[1] * back[0]), ahead @ back)
        if angle < FOLDED:
            raise GeometryError(
                f"{where} overlap or form a cusp at {pair(one.end)}, where the boundary reverses its "
                "direction; remove one of the two segments, or round the cusp with an arc"
            )
    return _joined(tuple(segments), join, closed)


def check_count(count: int) -> None:
    """Raise GeometryError for more segments than ``MOST_SEGMENTS``."""
    if count > MOST_SEGMENTS:
        raise GeometryError(
            f"{count} segments (lines, arcs, splines) are more than the limit of {MOST_SEGMENTS}; "
            "draw the section with fewer and longer segments, or ignore layers that are not the "
            "boundary of the section"
        )


def _joined(segments: tuple, join: float, closed: bool) -> tuple:
    """Move ends that are farther apart than rounding to one point."""
    ends = [[segment.start, segment.end] for segment in segments]
    # joint i lies between segments i and i + 1, for a closed chain also between last and first
    last = len(segments) if closed else len(segments) - 1
    moved = set()
    for i in range(last):
        j = (i + 1) % len(segments)
        if np.hypot(*(segments[j].start - segments[i].end)) > ROUNDING:
            ends[i][1] = ends[j][0] = _joint(segments[i], segments[j], join)
            moved |= {i, j}
    return tuple(
        segment.between(*(end.tolist() for end in ends[i])) if i in moved else segment
        for i, segment in enumerate(segments)
    )


def _joint(one: Segment, other: Segment, join: float) -> np.ndarray:
    """Choose the joint of two segments whose ends are no farther apart than ``join``."""
    # a line and a curve: the end of the line; two curves: the start of the second
    if not isinstance(other, Line):
        return one.end if isinstance(one, Line) else other.start
    if not isinstance(one, Line):
        return other.start
    # two lines: their intersection, if that is within ``join``
    # one.end + s t, other.start + r u:  s = ((other.start - one.end) x u) / (t x u)
    t, u, gap = one.tangents([1.0])[0], other.tangents([0.0])[0], other.start - one.end
    turn = t[0] * u[1] - t[1] * u[0]
    if abs(gap[0] * u[1] - gap[1] * u[0]) >= join * abs(turn):
        return other.start
    found = one.end + (gap[0] * u[1] - gap[1] * u[0]) / turn * t
    # horizontal and vertical lines keep their constant coordinate bit for bit
    across = np.array([u[0] == 0.0, u[1] == 0.0])
    along = np.array([t[0] == 0.0, t[1] == 0.0])
    found = np.where(across, other.start, found)
    return np.where(along, one.end, found)


def _check_segment(number, segment, join, alone) -> None:
    """Refuse what is no segment, has no edge, or is a circle among others."""
    if not isinstance(segment, Segment):
        raise GeometryError(
            f"segment {number} of the boundary must be a line, arc, circle or spline, got "
            f"{segment!r}"
        )
    where = f"segment {number} (edge {segment.edge!r})"
    if not isinstance(segment.edge, str) or not segment.edge:
        raise GeometryError(
            f"segment {number} of the boundary needs the name of its edge, got {segment.edge!r}"
        )
    if isinstance(segment, Circle) and not alone:
        raise GeometryError(
            f"{where} is a circle, which must be the only segment of a contour; use arcs to "
            "connect other segments"
        )


def _check_length(number, segment, join, segments) -> None:
    """Refuse a segment that is too short; in a tiny chain the unit of length may be wrong."""
    if segment.length >= SHORTEST * join:
        return
    # extent of the chain by the ends and middles of its segments
    points = np.concatenate([own.points([0.0, 0.5, 1.0]) for own in segments])
    size = float(np.ptp(points, axis=0).max())
    unit = (
        f"; the complete contour is only {size:.3g} mm in size; lengths must be in mm (are these "
        "in metres?)"
        if size < USUAL[0]
        else ""
    )
    raise GeometryError(
        f"segment {number} (edge {segment.edge!r}) at {pair(segment.start)} is only "
        f"{segment.length:.3g} mm long; leave out this segment or make it longer than "
        f"{SHORTEST * join:g} mm{unit}"
    )


def loops(segments, names, join: float) -> list[tuple]:
    """Chain segments head to tail into closed loops; ends up to ``join`` (mm) apart are joined.

    Raises
    ------
    GeometryError
        For an end that meets no other end, or several, with the ``names`` of the segments.
    """
    # ends 2 i and 2 i + 1 are start and end of segment i
    ends = np.array([end for segment in segments for end in (segment.start, segment.end)])
    node = joined_ends(ends, join)
    at = defaultdict(list)
    for number, joint in enumerate(node):
        at[joint].append(number)
    _check_nodes(ends, at, names)
    found, left = [], set(range(len(segments)))
    while left:
        here = min(left)  # the order of the file
        first, forward, chain = node[2 * here], True, []
        while here in left:
            left.remove(here)
            chain.append(segments[here] if forward else segments[here].reversed())
            last = 2 * here + int(forward)
            if node[last] == first:
                break
            # every node has two ends: leave it by the other one, forward if that is a start
            following = next(end for end in at[node[last]] if end != last)
            here, forward = following // 2, following % 2 == 0
        found.append(tuple(chain))
    return found


def joined_ends(ends, join: float) -> np.ndarray:
    """Number ends (2 n, 2) so that those up to ``join`` (mm) apart have equal numbers."""
    pairs = cKDTree(ends).query_pairs(join, output_type="ndarray")
    ones = np.ones(len(pairs))
    graph = coo_array((ones, (pairs[:, 0], pairs[:, 1])), shape=(len(ends), len(ends)))
    return connected_components(graph, directed=False)[1]


def _check_nodes(ends, at, names) -> None:
    """Refuse joints of other than two ends."""
    for numbers in at.values():
        if len(numbers) > 2:
            which = " and ".join(dict.fromkeys(names[number // 2] for number in numbers))
            raise GeometryError(
                f"{len(numbers)} ends meet at {pair(ends[numbers[0]])}: {which}; exactly two ends "
                "of segments must meet in a closed contour (is a segment drawn twice?)"
            )
    # an end that meets no other, and the nearest one of these
    loose = [numbers[0] for numbers in at.values() if len(numbers) == 1]
    if loose:
        first = loose[0]
        nearest, others = "", [number for number in loose if number != first]
        if others:
            away = np.hypot(*(ends[others] - ends[first]).T)
            other = others[int(away.argmin())]
            nearest = (
                f"; the nearest open end is that of {names[other // 2]} at {pair(ends[other])}, "
                f"{away.min():.3g} mm away"
            )
        raise GeometryError(
            f"the contour is open: {names[first // 2]} ends at {pair(ends[first])} and no segment "
            f"begins there{nearest}"
        )

"""Chains of segments: joined head to tail, none too short, none folding back."""

from itertools import pairwise

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.arcs import Circle
from seal_mdao.seals.outline.segments import Segment, pair

SHORTEST = 10.0
"""Least length of a segment, over the distance within which ends are joined."""

FOLDED = np.radians(1.0)
"""Least angle between neighbouring segments."""


def checked_chain(segments, join: float, closed: bool) -> tuple:
    """The segments, if they make a chain.

    Parameters
    ----------
    segments : sequence of Segment
    join : float
        Largest distance of the ends of neighbours, mm.
    closed : bool
        Whether the last one leads to the first.

    Raises
    ------
    GeometryError
    """
    if not isinstance(segments, tuple | list) or not segments:
        raise GeometryError(f"a contour needs at least one segment, got {segments!r}")
    for number, segment in enumerate(segments, 1):
        _check_segment(number, segment, join, alone=len(segments) == 1)
    following = [*pairwise(enumerate(segments, 1))]
    if closed:
        following.append(((len(segments), segments[-1]), (1, segments[0])))
    for (i, one), (j, other) in following:
        where = f"segment {i} (edge {one.edge!r}) and segment {j} (edge {other.edge!r})"
        gap = float(np.hypot(*(other.start - one.end)))
        if gap > join:
            is_last = closed and j == 1
            raise GeometryError(
                ("the contour is open: " if is_last else "")
                + f"segment {i} (edge {one.edge!r}) ends at {pair(one.end)} but segment {j} (edge "
                f"{other.edge!r}) begins at {pair(other.start)}, {gap:.3g} mm away"
            )
        ahead, back = one.tangents([1.0])[0], -other.tangents([0.0])[0]
        angle = np.arctan2(abs(ahead[0] * back[1] - ahead[1] * back[0]), ahead @ back)
        if angle < FOLDED:
            raise GeometryError(f"{where} fold back on each other at {pair(one.end)}")
    return tuple(segments)


def _check_segment(number, segment, join, alone) -> None:
    if not isinstance(segment, Segment):
        raise GeometryError(f"segment {number} must be a line, arc, circle or spline: {segment!r}")
    where = f"segment {number} (edge {segment.edge!r})"
    if not isinstance(segment.edge, str) or not segment.edge:
        raise GeometryError(f"segment {number} needs the name of its edge, got {segment.edge!r}")
    if segment.length < SHORTEST * join:
        raise GeometryError(
            f"{where} at {pair(segment.start)} is only {segment.length:.3g} mm long; leave it out or "
            f"make it longer than {SHORTEST * join:g} mm"
        )
    if isinstance(segment, Circle) and not alone:
        raise GeometryError(f"{where} is a circle; a circle is a contour of its own")

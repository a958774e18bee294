"""Parting lines of a drawing: chains of segments across the section, between regions."""

from collections import defaultdict

import numpy as np
import shapely

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.chain import ROUNDING, joined_ends
from seal_mdao.seals.outline.contours import JOIN, Contour, Outline
from seal_mdao.seals.outline.segments import pair

FOLLOWED = 0.01
"""Largest distance of the straight sides of a parting line from its arcs and splines, mm."""


def parted(outline: Outline, segments, names) -> tuple[Outline, tuple]:
    """Chain loose segments to parting lines from boundary to boundary.

    Ends closer than 1e-3 mm to the boundary are moved onto it. Where no segments of the boundary meet
    there, the segment is divided, so that a particle is at the end of the line.

    Parameters
    ----------
    outline : Outline
    segments : sequence of Segment
        In any order and direction.
    names : sequence of str
        Of the entities that they come from, for messages.

    Returns
    -------
    outline : Outline
        With segments divided at the ends of the lines.
    lines : tuple of ndarray, shape (k, 2)
        mm.

    Raises
    ------
    GeometryError
        For a line that is closed, branches, does not end on the boundary, or leaves the section.
    """
    lines = []
    for chain, which in _chains(segments, names):
        line = _polyline(chain)
        # both ends onto the boundary, which they may divide
        for end in (0, -1):
            outline, line[end] = _attached(outline, line[end], which)
        _check_inside(outline, line, which)
        lines.append(line)
    return outline, tuple(lines)


def _chains(segments, names) -> list[tuple]:
    """Chain segments head to tail, from one open end to another, with the name of the first one."""
    ends = np.array([end for segment in segments for end in (segment.start, segment.end)])
    node, at = joined_ends(ends, JOIN), defaultdict(list)
    for number, joint in enumerate(node):
        at[joint].append(number)
    for numbers in at.values():
        if len(numbers) > 2:
            which = " and ".join(dict.fromkeys(names[number // 2] for number in numbers))
            raise GeometryError(
                f"{len(numbers)} ends of parting lines meet at {pair(ends[numbers[0]])}: {which}; a "
                "parting line leads from one point of the boundary to another without branches"
            )
    found, left = [], set(range(len(segments)))
    # open ends in the order of the file
    for first in (numbers[0] for numbers in at.values() if len(numbers) == 1):
        end, chain, which = first, [], names[first // 2]
        while end is not None and end // 2 in left:
            here, forward = end // 2, end % 2 == 0
            left.remove(here)
            chain.append(segments[here] if forward else segments[here].reversed())
            # the other end of the segment, and the segment that continues from there
            far = 2 * here + int(forward)
            end = next((other for other in at[node[far]] if other != far), None)
        if chain:
            found.append((chain, which))
    if left:
        raise GeometryError(
            f"{names[min(left)]} is part of a closed parting line; a region within another one is not "
            "possible: lead the line from one point of the boundary to another"
        )
    return found


def _polyline(chain) -> np.ndarray:
    """Follow a chain of segments by straight sides, their corners (k, 2)."""
    parts = [
        segment.points(segment.chords(FOLLOWED) if segment.turning else [0.0, 1.0])
        for segment in chain
    ]
    # the first point of every segment but the first is the last one of that before
    return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])


def _attached(outline: Outline, point, which) -> tuple[Outline, np.ndarray]:
    """Find the joint of the boundary at a point; a segment is divided where there is none."""
    joints = np.array([segment.start for c in outline.contours for segment in c.segments])
    away = np.hypot(*(joints - point).T)
    if away.min() <= JOIN:
        # equal up to rounding: bit for bit
        return outline, joints[away.argmin()]
    # the nearest segment of all contours
    places = [
        (*segment.nearest(point)[::-1], i, j)
        for i, contour in enumerate(outline.contours)
        for j, segment in enumerate(contour.segments)
    ]
    distance, s, i, j = min(places)
    if distance > JOIN:
        raise GeometryError(
            f"{which}: the parting line ends at {pair(point)}, {distance:.3g} mm away from the "
            "boundary; let it end there"
        )
    contours = list(outline.contours)
    segments = contours[i].segments
    parts = segments[j].divided(s)
    contours[i] = Contour((*segments[:j], *parts, *segments[j + 1 :]))
    return outline.redrawn(contours), parts[0].end


def _check_inside(outline: Outline, line, which) -> None:
    """Refuse a line that leaves the section between its ends."""
    # boundaries are followed within FOLLOWED, so is the line
    shape = outline.shape(FOLLOWED).buffer(2.0 * FOLLOWED)
    outside = shapely.LineString(line).difference(shape)
    if outside.length > ROUNDING:
        raise GeometryError(
            f"{which}: the parting line leaves the section near "
            f"{pair(outside.representative_point().coords[0])}; let it end at the boundary and begin "
            "again behind the hole"
        )

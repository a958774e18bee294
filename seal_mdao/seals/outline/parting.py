"""Parting lines of a drawing, between regions: chains of segments across the section, or closed ones."""

from collections import defaultdict
from itertools import combinations

import numpy as np
import shapely

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.chain import joined_ends
from seal_mdao.seals.outline.contours import JOIN, Contour, Outline
from seal_mdao.seals.outline.segments import pair

FOLLOWED = 0.01
"""Largest distance of the straight sides of a parting line from its arcs and splines, mm."""

COINCIDENT = 0.1
"""Length along which two parting lines may be closer to each other than ``JOIN``, mm."""

FINE = 1e-6
"""Largest distance of the straight sides of the boundary, which trim a parting line, from it, mm."""


def parted(outline: Outline, segments, names) -> tuple[Outline, tuple]:
    """Chain loose segments to parting lines, closed or from boundary to boundary, and trim them
    (``trimmed``).

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
        For a line that branches, is open and does not end on the boundary, does not run through the
        section, or crosses another one.
    """
    lines = []
    for chain, which in _chains(segments, names):
        try:
            outline, parts = trimmed(outline, _polyline(chain))
        except GeometryError as error:
            raise GeometryError(f"{which}: the parting line {error}") from None
        lines += parts
    check_uncrossed(lines)
    return outline, tuple(lines)


def trimmed(outline: Outline, line) -> tuple[Outline, list]:
    """Remove the parts of a parting line that run through holes, outside of the section, or along its
    boundary.

    Ends closer than 1e-3 mm to the boundary are moved onto it. Where no segments of the boundary meet
    at an end of a part, the segment is divided, so that a particle is there. A closed line, around an
    insert, stays as it is.

    Parameters
    ----------
    outline : Outline
    line : array_like, shape (k, 2)
        From boundary to boundary, or back to its first point, mm.

    Returns
    -------
    outline : Outline
        With segments divided at the ends of the parts.
    parts : list of ndarray, shape (k, 2)
        In order along the line, mm.

    Raises
    ------
    GeometryError
        For a line that crosses itself, does not end on the boundary, touches it elsewhere, or does not
        run through the section, for a closed line that is not inside the section, or a crossing too
        close to the end of a segment. The message lacks its subject.
    """
    line = np.array(line, float)
    if not shapely.LineString(line).is_simple:
        raise GeometryError(
            f"from {pair(line[0])} to {pair(line[-1])} between two materials crosses itself"
        )
    if len(line) > 3 and np.hypot(*(line[-1] - line[0])) <= JOIN:
        return outline, [_closed(line, outline.shape(FINE))]
    # both ends onto the boundary, which they may divide
    for end in (0, -1):
        outline, line[end] = _attached(outline, line[end], "ends")
    curve, section = shapely.LineString(line), outline.shape(FINE)
    if curve.intersection(section.buffer(-JOIN)).length <= JOIN:
        raise GeometryError(
            f"from {pair(line[0])} to {pair(line[-1])} between two materials does not run through "
            "the section"
        )
    along = curve.intersection(section.boundary).length > JOIN
    if not along and curve.difference(section.buffer(JOIN)).is_empty:
        _require_clear(line, section)
        return outline, [line]
    inside = curve.intersection(section).difference(section.boundary)
    inside = shapely.line_merge(inside, directed=True)
    parts = [part for part in shapely.get_parts(inside) if part.length > JOIN]
    # in order along the line; every end is an end of the line or a crossing with a contour
    parts = [_distinct(shapely.get_coordinates(part)) for part in parts]
    parts.sort(key=lambda part: curve.project(shapely.Point(part.mean(axis=0))))
    for part in parts:
        for end in (0, -1):
            own = next((e for e in line[[0, -1]] if np.hypot(*(e - part[end])) <= JOIN), None)
            if own is not None:
                part[end] = own
                continue
            outline, part[end] = _attached(outline, part[end], "crosses")
        _require_clear(part, section)
    return outline, parts


def _closed(line: np.ndarray, section) -> np.ndarray:
    """Return a closed line (k, 2) whose last point is its first one.

    Raises
    ------
    GeometryError
        For a line that encloses no area, touches the boundary or leaves the section.
    """
    line = np.vstack([line[:-1], line[0]])
    if shapely.Polygon(line).buffer(-JOIN).is_empty:
        raise GeometryError(f"from {pair(line[0])} back to this point encloses no area")
    outside = shapely.LineString(line).difference(section.buffer(-JOIN))
    if not outside.is_empty:
        at = outside.representative_point().coords[0]
        raise GeometryError(
            f"is closed, but touches or leaves the section at {pair(at)}; let a closed line run inside "
            "the section only, or let the line lead from one point of the boundary to another"
        )
    return line


def _require_clear(part: np.ndarray, section) -> None:
    """Raise GeometryError for a part (k, 2) that touches the boundary between its ends."""
    curve = shapely.LineString(part)
    for near in shapely.get_parts(section.boundary.intersection(curve.buffer(JOIN))):
        at = near.representative_point()
        # the boundary on both sides of an end is near the part, too
        if all(near.distance(shapely.Point(end)) > JOIN for end in part[[0, -1]]):
            raise GeometryError(
                f"touches the boundary at {pair(at.coords[0])} without crossing it; let it end there, "
                "or pass this point at a distance"
            )


def _distinct(part: np.ndarray) -> np.ndarray:
    """Leave out points (k, 2) of a line that are closer than 1e-3 mm to the next one."""
    return part[np.append(np.hypot(*np.diff(part, axis=0).T) > JOIN, True)]


def check_uncrossed(lines) -> None:
    """Raise GeometryError for two parting lines (k, 2) that cross between their ends or coincide."""
    for (i, one), (j, other) in combinations(enumerate(map(shapely.LineString, lines), 1), 2):
        common = other.intersection(one.buffer(JOIN))
        if common.length > COINCIDENT:
            at = common.representative_point().coords[0]
            raise GeometryError(
                f"the lines {i} and {j} between materials (parting lines) coincide near {pair(at)}; "
                "give a line between two regions once, with one of them"
            )
        if one.crosses(other):
            at = one.intersection(other).representative_point().coords[0]
            raise GeometryError(
                f"the lines {i} and {j} between materials (parting lines) cross at {pair(at)}; "
                "every line must lead from one point of the boundary to another without crossing "
                "other lines"
            )


def _chains(segments, names) -> list[tuple]:
    """Chain segments head to tail, from one open end to another or back to the first one, with the name
    of the first one."""
    ends = np.array([end for segment in segments for end in (segment.start, segment.end)])
    node, at = joined_ends(ends, JOIN), defaultdict(list)
    for number, joint in enumerate(node):
        at[joint].append(number)
    for numbers in at.values():
        if len(numbers) > 2:
            which = " and ".join(dict.fromkeys(names[number // 2] for number in numbers))
            raise GeometryError(
                f"{len(numbers)} ends of parting lines meet at {pair(ends[numbers[0]])}: {which}; "
                "a parting line must be closed, or connect two points of the boundary without branches"
            )
    found, left = [], set(range(len(segments)))
    # open ends in the order of the file, then what is left: closed chains
    opened = [numbers[0] for numbers in at.values() if len(numbers) == 1]
    for first in (*opened, *range(0, 2 * len(segments), 2)):
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
    return found


def _polyline(chain) -> np.ndarray:
    """Follow a chain of segments by straight sides, their corners (k, 2)."""
    parts = [
        segment.points(segment.chords(FOLLOWED) if segment.turning else [0.0, 1.0])
        for segment in chain
    ]
    # the first point of every segment but the first is the last one of that before
    return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])


def _attached(outline: Outline, point, verb: str) -> tuple[Outline, np.ndarray]:
    """Find the joint of the boundary at a point; divide a segment where there is none.

    ``verb`` says in messages what the line does there.
    """
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
        inside = outline.shape(FINE).contains(shapely.Point(point))
        where, cure = "outside of", "shorten it to the boundary"
        if inside:
            where, cure = "inside", "extend it to the boundary, or close it around an insert"
        raise GeometryError(
            f"{verb} at {pair(point)} {where} the section, {distance:.3g} mm away from its boundary; "
            f"{cure}"
        )
    contours = list(outline.contours)
    segments = contours[i].segments
    parts = segments[j].divided(s)
    try:
        contours[i] = Contour((*segments[:j], *parts, *segments[j + 1 :]))
    except GeometryError:
        # the only reason: a part is shorter than a segment may be
        raise GeometryError(
            f"{verb} at {pair(point)} on {outline.titles[i]}, {away.min():.3g} mm away from "
            f"{pair(joints[away.argmin()])}, where segments of the boundary meet; let the line lead "
            "there, or farther away"
        ) from None
    return outline.redrawn(contours), parts[0].end

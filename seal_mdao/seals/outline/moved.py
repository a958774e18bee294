"""Section of a design: moved segments are replaced by splines through their points."""

import numpy as np
import scipy

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.arcs import Arc, Circle, circle_through
from seal_mdao.seals.outline.contours import Contour, Outline
from seal_mdao.seals.outline.sampling import Boundary
from seal_mdao.seals.outline.segments import Line
from seal_mdao.seals.outline.spline import Spline

SMOOTH = 1e-3
"""Largest turn of the tangent, radians, over which one spline continues into the next segment: joints
with gaps in a drawing turn by some 1e-4."""

EXACT = 1e-9
"""Largest distance of moved points from a line or arc that they still form, over its size."""


def shifted_outline(outline: Outline, boundaries: list[Boundary], points) -> Outline:
    """Build the section whose boundary passes through moved points.

    Segments without moved points are unchanged, lines that stay straight and arcs that stay arcs remain
    such. The others become cubic splines through their points, with the nominal arc length as
    parameter: one spline over segments of an edge that join smoothly, a corner where there was one.

    Parameters
    ----------
    outline : Outline
        Nominal section.
    boundaries : list of Boundary
        Its sampled points.
    points : sequence of ndarray, shape (k, 2)
        Their positions in the design, mm.

    Raises
    ------
    GeometryError
        For a boundary that crosses itself.
    """
    contours = [
        _moved(contour, boundary, np.asarray(own, float))
        for contour, boundary, own in zip(outline.contours, boundaries, points, strict=True)
    ]
    return outline.redrawn(contours)


def _moved(contour, boundary, points) -> Contour:
    segments, corners = contour.segments, np.flatnonzero(boundary.corner)
    has_moved = (points != boundary.points).any(axis=1)
    ends = np.append(corners[1:], len(points))
    # the first point of the next segment is the last one of this
    changed = [
        bool(has_moved[a:b].any() or has_moved[b % len(points)])
        for a, b in zip(corners, ends, strict=True)
    ]
    if not any(changed):
        return contour
    # the contour returns to its first point
    arc = np.append(boundary.arc_length, boundary.length)
    closed = np.vstack([points, points[:1]])
    # the same kind of segment through the moved points, None where it takes a spline
    kept = [
        _same_kind(segment, closed[a : b + 1]) if has_changed else segment
        for segment, a, b, has_changed in zip(segments, corners, ends, changed, strict=True)
    ]
    found = []
    for first, last in _runs(segments, [own is None for own in kept]):
        if kept[first] is not None:
            found.append(kept[first])
            continue
        here = slice(corners[first], ends[last] + 1)
        through, parameter = tuple(map(tuple, closed[here].tolist())), tuple(arc[here].tolist())
        # a closed spline with a corner at its joint must not be periodic: it gets end slopes
        kinked = through[0] == through[-1] and _turn(segments[last], segments[first]) >= SMOOTH
        slopes = _end_slopes(through, parameter) if kinked else None
        found.append(Spline(through, segments[first].edge, parameter, slopes))
    return Contour(tuple(found))


def _same_kind(segment, points):
    """Make the line, arc or circle through moved points (k, 2); None if they lie on none."""
    if isinstance(segment, Line) and len(points) > 2:
        along, to = points[-1] - points[0], points - points[0]
        # distance from the chord |t x d| / |t|
        away = np.abs(along[0] * to[:, 1] - along[1] * to[:, 0]).max() / np.hypot(*along)
        if away <= EXACT * np.hypot(*along):
            return Line(tuple(points[0].tolist()), tuple(points[-1].tolist()), segment.edge)
    if isinstance(segment, Circle) and len(points) > 4:
        centre, _, _ = circle_through(points[:-1])
        radius = points[0, 0] - centre[0]
        # a circle begins at its rightmost point
        if radius > 0.0 and abs(points[0, 1] - centre[1]) <= EXACT * radius:
            circle = Circle(tuple(centre.tolist()), float(radius), segment.edge, segment.clockwise)
            return circle if _is_on(circle, points) else None
    if isinstance(segment, Arc) and len(points) > 3:
        middle = len(points) // 2
        try:
            arc = Arc.through(points[0], points[middle], points[-1], segment.edge)
        except GeometryError:
            return None
        return arc if _is_on(arc, points) else None
    return None


def _is_on(round_, points) -> bool:
    """Return whether points lie on the circle of an arc."""
    away = np.abs(np.hypot(*(points - round_.centre).T) - round_.radius)
    return bool(away.max() <= EXACT * round_.radius)


def _runs(segments, changed) -> list[tuple[int, int]]:
    """List the first and last segment of every segment of the new contour."""
    runs = []
    for i, segment in enumerate(segments):
        # a spline continues into the next moved segment of its edge without a corner
        continues = (
            i > 0 and changed[i] and changed[i - 1] and segments[i - 1].edge == segment.edge
            and _turn(segments[i - 1], segment) < SMOOTH
        )  # fmt: skip
        if continues:
            runs[-1] = (runs[-1][0], i)
        else:
            runs.append((i, i))
    return runs


def _turn(one, other) -> float:
    a, b = one.tangents([1.0])[0], other.tangents([0.0])[0]
    return float(np.hypot(*(a - b)))


def _end_slopes(through, parameter) -> tuple:
    """Compute end slopes of a not-a-knot spline whose ends coincide without a smooth joint."""
    curve = scipy.interpolate.CubicSpline(parameter, np.array(through))
    return tuple(map(tuple, curve([parameter[0], parameter[-1]], 1).tolist()))

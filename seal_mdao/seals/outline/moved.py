"""Section of a design: moved segments are replaced by splines through their points."""

import numpy as np
import scipy

from seal_mdao.seals.outline.contours import Contour, Outline
from seal_mdao.seals.outline.sampling import Boundary
from seal_mdao.seals.outline.spline import Spline

SMOOTH = 1e-3
"""Largest turn of the tangent, radians, over which one spline continues into the next segment: joints
with gaps in a drawing turn by some 1e-4."""


def shifted_outline(outline: Outline, boundaries: list[Boundary], points) -> Outline:
    """Build the section whose boundary passes through moved points.

    Segments without moved points are unchanged. The others become cubic splines through their points,
    with the nominal arc length as parameter: one spline over segments of an edge that join smoothly,
    a corner where there was one.

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
    found = []
    for first, last in _runs(segments, changed):
        if not changed[first]:
            found.append(segments[first])
            continue
        here = slice(corners[first], ends[last] + 1)
        through, parameter = tuple(map(tuple, closed[here].tolist())), tuple(arc[here].tolist())
        # a closed spline with a corner at its joint must not be periodic: it gets end slopes
        kinked = through[0] == through[-1] and _turn(segments[last], segments[first]) >= SMOOTH
        slopes = _end_slopes(through, parameter) if kinked else None
        found.append(Spline(through, segments[first].edge, parameter, slopes))
    return Contour(tuple(found))


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

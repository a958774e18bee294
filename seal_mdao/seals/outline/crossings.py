"""Checks of contours: touching, crossing, and nesting of holes and bodies."""

import numpy as np
import shapely

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.segments import pair


def check_apart(contours, titles, distance: float) -> None:
    """Raise GeometryError for sides closer than ``distance`` (mm) that are not neighbours.

    ``contours`` are those of ``Outline.labelled``, ``titles`` their names in messages.
    """
    # flat lists of the sides of all contours; before: index of the preceding side of the loop
    starts, ends, contour, names, before = [], [], [], [], []
    for number, (points, segment, edges) in enumerate(contours):
        first = sum(map(len, starts))
        starts.append(points)
        ends.append(np.roll(points, -1, axis=0))
        contour += [number] * len(points)
        names += [edges[i] for i in segment]
        before.append(first + np.roll(np.arange(len(points)), 1))
    before = np.concatenate(before)
    sides = shapely.linestrings(np.stack([np.concatenate(starts), np.concatenate(ends)], axis=1))
    # pairs of sides closer than ``distance``; each pair once, neighbours left out
    one, other = shapely.STRtree(sides).query(sides, predicate="dwithin", distance=distance)
    close = (one < other) & (before[other] != one) & (before[one] != other)
    close = np.flatnonzero(close & ~_only_around_a_corner(sides, one, other, before, distance))
    if close.size == 0:
        return
    crosses = shapely.crosses(sides[one[close]], sides[other[close]])
    # a crossing is reported rather than a contact
    worst = close[np.argmax(crosses)]
    a, b = one[worst], other[worst]
    kind = "crosses" if crosses.any() else "touches"
    what = f"{titles[contour[b]]}, edge {names[b]!r},"
    if contour[a] == contour[b]:
        what = f"itself (edge {names[b]!r})"
    at = shapely.get_coordinates(shapely.shortest_line(sides[a], sides[b]))[0]
    raise GeometryError(
        f"{titles[contour[a]]}, edge {names[a]!r}, {kind} {what} at {pair(at)}; separate the two "
        "parts of the boundary"
    )


def _only_around_a_corner(sides, one, other, before, distance):
    """Return whether two sides are close only because a short side lies between them."""
    length = shapely.length(sides)
    between = np.where(before[before[other]] == one, before[other], before[one])
    next_but_one = (before[before[other]] == one) | (before[before[one]] == other)
    apart = shapely.distance(sides[one], sides[other])
    return next_but_one & (apart > 0.0) & (length[between] < 4.0 * distance)


def check_nested(contours, titles, n_holes: int) -> None:
    """Raise GeometryError for holes outside the material of bodies, and bodies inside it.

    Contours must not cross; they and ``titles`` are those of ``check_apart``: an outer contour, the
    holes, outer contours of further bodies.
    """
    holes, several = range(1, 1 + n_holes), len(contours) > 1 + n_holes
    for i, around in enumerate(nearest_around([points for points, _, _ in contours])):
        where = f"{titles[i]} (edge {contours[i][2][0]!r}, at {pair(contours[i][0][0])})"
        if i in holes and around is None:
            raise GeometryError(
                f"{where} lies outside of {'every body' if several else 'the outer contour'}; move "
                "this hole inside"
            )
        # contours alternate inwards: body, hole, body in the hole, ...
        if around is not None and (i in holes) == (around in holes):
            raise GeometryError(
                f"{where} lies inside of {titles[around]}; move or remove one of these contours"
            )


def nearest_around(loops) -> list:
    """Find the index of the smallest loop (k, 2) around each of the closed loops; None without one."""
    rings = np.array([shapely.polygons(points) for points in loops])
    # a loop contains another one if it contains a point inside it, and is larger
    size, found = shapely.area(rings), []
    for own, point in zip(size, shapely.point_on_surface(rings), strict=True):
        around = np.flatnonzero(shapely.contains(rings, point) & (size > own))
        found.append(int(around[size[around].argmin()]) if around.size else None)
    return found


def check_simple(points, closed: bool) -> None:
    """Raise GeometryError for a polyline (k, 2), closed or not, that crosses itself."""
    points = np.vstack([points[:-1], points[:1]]) if closed else points
    line = shapely.linestrings(points)
    if not shapely.is_simple(line):
        # divided at all intersections, parts have common ends there
        parts = shapely.get_parts(shapely.node(line))
        ends = shapely.get_coordinates([shapely.boundary(part) for part in parts])
        distinct, counts = np.unique(ends, axis=0, return_counts=True)
        at = distinct[counts > 1][0] if (counts > 1).any() else points[0]
        raise GeometryError(f"the curve crosses or touches itself at {pair(at)}")

"""Triangles inside closed loops, by Netgen's advancing front (extra ``mesh``)."""

from importlib import import_module

import numpy as np

from seal_mdao.errors import GeometryError

UNBOUNDED = 1e6
"""Largest size asked for along the loops, which are not to be divided further, mm."""

GRADINGS = (0.3, 0.6, 1.2, 2.4)
"""How fast triangles may grow, gentle first: the mesher divides sides that grow faster."""


def _netgen():
    try:
        return import_module("netgen.geom2d")
    except ImportError as error:
        raise ImportError(
            "clouds of particles need netgen-mesher, which is not installed: "
            "pip install seal_mdao[mesh]"
        ) from error


def triangulate(loops, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles between closed loops of given points.

    Parameters
    ----------
    loops : sequence of ndarray, shape (k, 2)
        Points in order, the material on the left.
    size : float
        Largest wanted side, mm; where a loop has shorter sides the triangles follow.

    Returns
    -------
    points : ndarray, shape (n, 2)
        Those of the loops first, in order; the same bits for the same input.
    triangles : ndarray of int, shape (m, 3)
        Counter-clockwise.

    Raises
    ------
    GeometryError
        For loops that cannot be filled.
    ImportError
        Without netgen-mesher.
    """
    geometry = _netgen().SplineGeometry()
    sides, count = [], 0
    for loop in loops:
        numbers = [geometry.AppendPoint(*map(float, x), maxh=UNBOUNDED) for x in loop]
        ends = list(zip(numbers, numbers[1:] + numbers[:1], strict=True))
        for a, b in ends:
            geometry.Append(["line", a, b], leftdomain=1, rightdomain=0, maxh=UNBOUNDED)
        around = count + np.arange(len(loop))
        sides.append(np.column_stack([around, np.roll(around, -1)]))
        count += len(loop)
    given, sides = np.concatenate(loops), np.concatenate(sides)
    for grading in GRADINGS:
        points, triangles = _generated(geometry, size, grading)
        if not (lost := _lost(points, triangles, given, sides)):
            return points, triangles
    x, y = points[min(lost)[0]]
    raise GeometryError(
        f"the mesher divides the boundary near ({x:.4g}, {y:.4g}): its sides there are much longer "
        "than those beside them; let the spacing change more slowly"
    )


def _generated(geometry, size, grading):
    try:
        mesh = geometry.GenerateMesh(maxh=float(size), grading=grading)
    except Exception as error:  # whatever the library throws
        raise GeometryError(f"the section cannot be filled with triangles: {error}") from error
    points = np.array([tuple(point.p)[:2] for point in mesh.Points()])
    triangles = np.array([[v.nr - 1 for v in cell.vertices] for cell in mesh.Elements2D()], int)
    return points, triangles


def _lost(points, triangles, given, sides) -> set:
    """Sides at which the boundary of the triangles and the loops differ."""
    if len(points) < len(given) or not np.array_equal(points[: len(given)], given):
        raise GeometryError("the mesher has moved points of the boundary")
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    known = set(map(tuple, ends.tolist()))
    found = {end for end in known if end[::-1] not in known}
    return set(map(tuple, sides.tolist())) ^ found

"""Triangulation of closed loops by Netgen's advancing front (extra ``mesh``)."""

from importlib import import_module
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from seal_mdao.errors import GeometryError
from seal_mdao.user_cache import read_stored, store, stored_file

UNBOUNDED = 1e6
"""Mesh size along the loops in units of the mesher: large, so that it does not divide their sides."""

ON_LOOP = 1e-3
"""Largest distance of the end of a cut from a point of a loop, mm."""

GRADINGS = (0.3, 0.6, 1.2, 2.4)
"""Values of the grading (growth of triangles), tried in this order: the mesher divides sides of the
boundary whose length changes faster."""


def _netgen():
    try:
        return import_module("netgen.geom2d")
    except ImportError as error:
        message = (
            "filling a section with particles (key spacing) needs the Python package "
            "netgen-mesher, which is not installed: pip install "
        )
        raise ImportError(message + "seal_mdao[mesh]") from error


class Triangles(NamedTuple):
    """Triangulation, bitwise equal for the same input.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Those of the loops first, in order, then those between the ends of cuts.
    triangles : ndarray of int, shape (m, 3)
        Counter-clockwise.
    parts : ndarray of int, shape (m,)
        Index of the part, into which the cuts divide the section, of every triangle.
    """

    points: np.ndarray
    triangles: np.ndarray
    parts: np.ndarray


def triangulate(loops, size: float, cuts=()) -> Triangles:
    """Triangulate the section between closed loops of given points, divided by cuts.

    The triangles are stored for the same loops of later runs (``user_cache``): importing the mesher and
    meshing takes up to a tenth of the time of a short analysis.

    Parameters
    ----------
    loops : sequence of ndarray, shape (k, 2)
        Points in order, the material on the left.
    size : float
        Largest side, mm; smaller next to shorter sides of loops.
    cuts : sequence of ndarray, shape (k, 2)
        Straight sides through the inside from one point of a loop to another, or closed (the last point
        is the first one): sides of triangles lie on them.

    Raises
    ------
    GeometryError
        For loops that cannot be filled.
    ImportError
        Without netgen-mesher.
    """
    given = [[np.asarray(line, float).tolist() for line in lines] for lines in (loops, cuts)]
    path = stored_file("triangles", [*given, float(size)])
    found = read_stored(path)
    if found is not None:
        return Triangles(
            np.array(found["points"]),
            np.array(found["triangles"], int),
            np.array(found["parts"], int),
        )
    made = _triangulated(loops, size, cuts)
    store(path, {name: own.tolist() for name, own in made._asdict().items()})
    return made


def _triangulated(loops, size, cuts) -> Triangles:
    """As ``triangulate``, by Netgen, in a unit of length with which ``size`` is between 1 and 2.

    Tolerances of Netgen are absolute. The unit is a power of two, so that scaling is free of rounding.
    """
    unit = 2.0 ** np.floor(np.log2(size))
    loops, cuts = ([np.asarray(line, float) / unit for line in lines] for lines in (loops, cuts))
    made = _unit_triangulated(loops, size / unit, cuts, unit)
    return made._replace(points=unit * made.points)


def _unit_triangulated(loops, size, cuts, unit) -> Triangles:
    """As ``triangulate``, in units of ``unit`` mm."""
    geometry = _netgen().SplineGeometry()
    sides, count, every = [], 0, []
    for loop in loops:
        # one domain (1) on the left of every side, nothing (0) on the right
        numbers = [geometry.AppendPoint(*map(float, x), maxh=UNBOUNDED) for x in loop]
        ends = list(zip(numbers, numbers[1:] + numbers[:1], strict=True))
        for a, b in ends:
            geometry.Append(["line", a, b], leftdomain=1, rightdomain=0, maxh=UNBOUNDED)
        around = count + np.arange(len(loop))
        sides.append(np.column_stack([around, np.roll(around, -1)]))
        count += len(loop)
        every += numbers
    given, sides = np.concatenate(loops), np.concatenate(sides)
    for cut in cuts:
        _append_cut(geometry, cut, given, every, size, ON_LOOP / unit)
    # accept the first grading with which the sides of the boundary are those given
    for grading in GRADINGS:
        points, triangles, divided = _generated(geometry, size, grading, len(sides))
        if not (lost := _lost(points, triangles, given, sides)):
            return Triangles(points, triangles, _parts(triangles, divided))
    x, y = unit * points[min(lost)[0]]
    raise GeometryError(
        f"the particle spacing on the boundary near ({x:.4g}, {y:.4g}) is much larger than that of "
        "neighbouring edges; choose spacings of edges that differ less (edge_spacing)"
    )


def _append_cut(geometry, cut, given, every, size, tolerance):
    """Add a cut between points of the loops, or a closed one; the mesher divides its sides."""
    # a closed cut has at least three sides; Netgen crashes on others
    if len(cut) > 3 and np.array_equal(cut[0], cut[-1]):
        numbers = [geometry.AppendPoint(*map(float, x), maxh=UNBOUNDED) for x in cut[:-1]]
        numbers.append(numbers[0])
    else:
        first, last = _joined(cut, given, every, tolerance)
        between = [geometry.AppendPoint(*map(float, x), maxh=UNBOUNDED) for x in cut[1:-1]]
        numbers = [first, *between, last]
    for a, b in pairwise(numbers):
        geometry.Append(["line", a, b], leftdomain=1, rightdomain=1, maxh=float(size))


def _joined(cut, given, every, tolerance) -> list:
    """Find the points of the loops at both ends of a cut.

    Raises
    ------
    GeometryError
        For a cut that does not connect two of them.
    """
    away = [np.hypot(*(given - end).T) for end in (cut[0], cut[-1])]
    ends = [every[int(a.argmin())] for a in away]
    if max(a.min() for a in away) > tolerance or ends[0] == ends[1]:
        raise GeometryError(
            "a line between two materials (cut) must connect two different points of the boundary"
        )
    return ends


def _generated(geometry, size, grading, n_sides):
    try:
        mesh = geometry.GenerateMesh(maxh=float(size), grading=grading)
    except Exception as error:  # whatever the library throws
        raise GeometryError(
            f"the section cannot be filled with triangles ({error}); simplify the boundary or "
            "change the spacing"
        ) from error
    # numbers of Netgen start from 1; boundary indices beyond ``n_sides`` belong to cuts
    points = np.array([tuple(point.p)[:2] for point in mesh.Points()])
    triangles = np.array([[v.nr - 1 for v in cell.vertices] for cell in mesh.Elements2D()], int)
    divided = [[v.nr - 1 for v in e.vertices] for e in mesh.Elements1D() if e.index > n_sides]
    return points, triangles, {frozenset(side) for side in divided}


def _parts(triangles, divided) -> np.ndarray:
    """Number the parts of the section: adjacent triangles share one unless a cut lies between."""
    # the triangles on both sides of every side
    owners = {}
    for number, (a, b, c) in enumerate(triangles.tolist()):
        for side in ((a, b), (b, c), (c, a)):
            owners.setdefault(frozenset(side), []).append(number)
    joined = [o for side, o in owners.items() if len(o) == 2 and side not in divided]
    pairs = np.array(joined, int).reshape(-1, 2)
    n = len(triangles)
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(n, n))
    return connected_components(graph, directed=False)[1].astype(int)


def _lost(points, triangles, given, sides) -> set:
    """Find the sides at which the boundary of the triangles and the loops differ."""
    if len(points) < len(given) or not np.array_equal(points[: len(given)], given):
        raise GeometryError(
            "the triangles do not fill the section exactly, because Netgen has moved points of its "
            "boundary; use a slightly smaller or larger spacing"
        )
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    known = set(map(tuple, ends.tolist()))
    # a directed side without its opposite is on the boundary
    found = {end for end in known if end[::-1] not in known}
    return set(map(tuple, sides.tolist())) ^ found

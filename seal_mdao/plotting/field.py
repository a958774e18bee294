"""The meshless fields between the particles: deformed position and stress on a fine grid."""

from dataclasses import dataclass

import numpy as np
from matplotlib.tri import Triangulation

from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.rkpm.tables import PointTable, build_table
from seal_mdao.seals.result import SealResult
from seal_mdao.structure.particle_stress import deformation_gradients
from seal_mdao.terms.point_assembly import interpolate

WANTED = 8000
"""Points that a picture of a whole section needs, about."""
FINEST = 6
"""Most intervals into which a side of a background cell is divided."""


@dataclass(frozen=True, eq=False)
class FineGrid:
    """Points between the particles with the shape functions of one design.

    Attributes
    ----------
    table : PointTable
        Points, bilinear in the corners of the background cells, and their shape functions.
    region : ndarray of int, shape (k,)
        Number of the material of every point; between two materials points lie twice.
    quads : ndarray of int, shape (q, 4)
        Corners of the pieces of the cells, counter-clockwise undeformed; some meet in a triangle.
    triangles : ndarray of int, shape (m, 3)
        Between neighbouring points, counter-clockwise undeformed.
    loops : tuple of ndarray of int
        Points along the boundary, the body on the left; the first is not repeated.
    """

    table: PointTable
    region: np.ndarray
    quads: np.ndarray
    triangles: np.ndarray
    loops: tuple

    @property
    def points(self) -> PointSet:
        return self.table.points


def fine_grid(result: SealResult, divisions: int | None = None) -> FineGrid:
    """Shape functions of a result's design on a grid finer than its particles.

    Parameters
    ----------
    result : SealResult
    divisions : int, optional
        Intervals into which the sides of cells are divided; chosen by the number of cells when left
        out.
    """
    disc, cells = result.path.discretization, result.seal.body.cells
    if divisions is None:
        divisions = int(np.clip(np.sqrt(WANTED / len(cells)), 1, FINEST))
    region = _cell_regions(result)
    points, of_cell, of_point = _refined(cells, region, divisions)
    quads = _quads(of_cell)
    return FineGrid(
        build_table(disc.cloud, points, disc.transformation), of_point,
        quads, _triangles(quads), boundary_loops(cells, of_cell),
    )  # fmt: skip


def _cell_regions(result) -> np.ndarray:
    """Number of the material of every cell."""
    body = result.term("structure").definition
    return body.per_cell(range(len(body.regions)), len(result.seal.body.cells), int)


def _refined(cells, region, n: int):
    """Points of all cells: the set, the points (m, n + 1, n + 1) of every cell, their regions."""
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    shares = np.stack([(n - i) * (n - j), i * (n - j), i * j, (n - i) * j], axis=-1)
    shape = (len(cells), (n + 1) ** 2, 4)
    anchors = np.broadcast_to(cells[:, None, :], shape)
    order = np.argsort(anchors, axis=-1)
    anchors = np.take_along_axis(anchors, order, -1)
    shares = np.take_along_axis(np.broadcast_to(shares.reshape(1, -1, 4), shape), order, -1).copy()
    for k in range(1, 4):  # the repeated corner of a triangle
        same = anchors[..., k] == anchors[..., k - 1]
        shares[..., k] += np.where(same, shares[..., k - 1], 0)
        shares[..., k - 1][same] = 0
    # what has no share does not tell points apart: those of neighbouring cells are the same
    heaviest = np.take_along_axis(anchors, shares.argmax(axis=-1)[..., None], -1)
    anchors = np.where(shares > 0, anchors, heaviest)
    rows = np.concatenate([anchors, shares], axis=-1)
    order = np.argsort(anchors * (n * n + 1) + shares, axis=-1)
    rows = np.concatenate([np.take_along_axis(part, order, -1) for part in (anchors, shares)], -1)
    rows = np.concatenate([np.broadcast_to(region[:, None, None], (*shape[:2], 1)), rows], -1)
    found, place = np.unique(rows.reshape(-1, 9), axis=0, return_inverse=True)
    points = PointSet(np.ascontiguousarray(found[:, 1:5]), found[:, 5:] / n**2, 1)
    return points, place.reshape(len(cells), n + 1, n + 1), found[:, 0]


def _quads(of_cell) -> np.ndarray:
    a, b = of_cell[:, :-1, :-1].ravel(), of_cell[:, 1:, :-1].ravel()
    c, d = of_cell[:, 1:, 1:].ravel(), of_cell[:, :-1, 1:].ravel()
    return np.column_stack([a, b, c, d])


def _triangles(quads) -> np.ndarray:
    a, b, c, d = quads.T
    found = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    different = (found != np.roll(found, 1, axis=1)).all(axis=1)
    return found[different]


def boundary_loops(cells: np.ndarray, of_cell: np.ndarray) -> tuple:
    """Points along every closed boundary of cells (m, 4), from the points (m, n + 1, n + 1) of all."""
    along = [of_cell[:, :, 0], of_cell[:, -1, :], of_cell[:, ::-1, -1], of_cell[:, 0, ::-1]]
    sides = {}
    for k in range(4):
        for a, b, points in zip(cells[:, k], cells[:, (k + 1) % 4], along[k], strict=True):
            if a != b and sides.pop((b, a), None) is None:
                sides[a, b] = points[:-1]
    following = {a: (b, points) for (a, b), points in sides.items()}
    loops = []
    while following:
        start, (at, points) = following.popitem()
        parts = [points]
        while at != start:
            at, points = following.pop(at)
            parts.append(points)
        loops.append(np.concatenate(parts))
    return tuple(loops)


def undeformed(result: SealResult, fine) -> np.ndarray:
    """Undeformed coordinates of the fine grid, shape (k, 2), mm."""
    return fine.points.at(result.particles)


def deformed(result: SealResult, fine, step: int = -1) -> np.ndarray:
    """Deformed coordinates of the fine grid after a nominal step, shape (k, 2), mm."""
    u = np.empty((len(fine.points.anchors), 2))
    interpolate(fine.table.table, result.path.nominal_steps[step].d, u)
    return undeformed(result, fine) + u


def von_mises(result: SealResult, fine, step: int = -1) -> np.ndarray:
    """Von Mises stress on the fine grid after a nominal step, shape (k,), kPa.

    Beyond the limit of its law, which quadrature points do not pass but others may, a material has none:
    there it is the highest of all others.
    """
    f = deformation_gradients(fine.table.table, result.path.nominal_steps[step].d)
    square, jacobian, stress = (f[:, :4] ** 2).sum(axis=1), 1.0 + f[:, 4], np.empty(len(f))
    for number, region in enumerate(result.term("structure").definition.regions):
        at = fine.region == number
        stress[at] = region.material.von_mises(square[at], jacobian[at])[0]
    return np.nan_to_num(stress, nan=np.nanmax(stress))


def triangulation(coordinates: np.ndarray, fine: FineGrid) -> Triangulation:
    """Triangulation of the fine grid at the given coordinates (k, 2)."""
    return Triangulation(*coordinates.T, fine.triangles)

"""Meshless fields between the particles: deformed positions and stress on a fine grid."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.rkpm.tables import PointTable, build_table
from seal_mdao.seals.result import SealResult
from seal_mdao.structure.particle_stress import deformation_gradients
from seal_mdao.structure.relaxed_stress import relaxed_stress
from seal_mdao.structure.second_stress import point_state
from seal_mdao.structure.softened_stress import softened_stress
from seal_mdao.terms.point_assembly import interpolate

WANTED = 8000
"""Approximate number of points for a figure of the complete section."""
FINEST = 6
"""Largest number of intervals of a side of a background cell."""


@dataclass(frozen=True, eq=False)
class FineGrid:
    """Points between the particles with the shape functions of one design.

    Attributes
    ----------
    result : SealResult
    table : PointTable
        Points, bilinear in the corners of the background cells, and their raw shape functions.
    region : ndarray of int, shape (k,)
        Number of the material of every point; between two materials points lie twice.
    quads : ndarray of int, shape (q, 4)
        Corners of the pieces of the cells, counter-clockwise undeformed; some meet in a triangle.
    triangles : ndarray of int, shape (m, 3)
        Between neighbouring points, counter-clockwise undeformed.
    loops : tuple of ndarray of int
        Points along the boundary, the body on the left; the first is not repeated.
    """

    result: SealResult
    table: PointTable
    region: np.ndarray
    quads: np.ndarray
    triangles: np.ndarray
    loops: tuple

    @property
    def points(self) -> PointSet:
        return self.table.points

    def undeformed(self) -> np.ndarray:
        """Compute undeformed coordinates, shape (k, 2), mm."""
        return self.points.at(self.result.particles)

    def deformed(self, step: int = -1) -> np.ndarray:
        """Compute deformed coordinates after a nominal step, shape (k, 2), mm."""
        # x = X + sum_I Phi_I(X) c_I
        u = np.empty((len(self.points.anchors), 2))
        d = self.result.path.nominal_steps[step].d
        interpolate(self.table.raw, self._coefficients(d), u)
        return self.undeformed() + u

    def _coefficients(self, d: np.ndarray) -> np.ndarray:
        """Compute the coefficients c of the raw shape functions, (n, 2), mm."""
        # Phi T d = Phi (T d): to transform the coefficients is faster than to transform the table
        return self.result.path.discretization.transformation.coefficients(d)

    def _gradients(self, d: np.ndarray) -> np.ndarray:
        """Compute F, J - 1 and h of a body of revolution at the points, shape (k, 5 or 6)."""
        return deformation_gradients(self.table.raw, self._coefficients(d))

    def von_mises(self, step: int = -1) -> np.ndarray:
        """Compute the von Mises stress after a nominal step, shape (k,), kPa.

        Points between quadrature points may exceed the limit of a material law, where it gives no
        stress; they get the highest stress of all other points.
        """
        term, path = self.result.term("structure"), self.result.path
        now, stress = path.nominal_steps[step], np.empty(len(self.region))
        f = self._gradients(now.d)
        # |F|^2 = F_ij F_ij and J of every point, h of a body of revolution, then the law of its region
        state = point_state(f)
        for number, region in enumerate(term.definition.regions):
            at = self.region == number
            if region.prony is None and region.softening is None:
                stress[at] = term.von_mises(region, [own[at] for own in state], now.fraction)[0]
                continue
            # of rubber that relaxes or softens through all steps so far
            steps = path.steps[: path.steps.index(now) + 1]
            history = np.array([self._gradients(own.d)[at] for own in steps])
            fractions = [own.fraction for own in steps]
            evaluate = softened_stress if region.prony is None else relaxed_stress
            stress[at] = evaluate(term, region, history, fractions)
        return np.nan_to_num(stress, nan=np.nanmax(stress))


def fine_grid(result: SealResult, divisions: int | None = None) -> FineGrid:
    """Evaluate the shape functions of a result's design on a grid finer than its particles.

    Parameters
    ----------
    result : SealResult
    divisions : int, optional
        Intervals of the sides of cells; by default chosen by the number of cells.
    """
    disc, cells = result.path.discretization, result.seal.body.cells
    if divisions is None:
        divisions = int(np.clip(np.sqrt(WANTED / len(cells)), 1, FINEST))
    body = result.term("structure").definition
    region = body.per_cell(range(len(body.regions)), len(cells), int)
    points, of_cell, of_point = _refined(cells, region, divisions)
    points = points._replace(hooped=disc.body.axisymmetric)
    quads, table = _quads(of_cell), build_table(disc.cloud, points)
    loops = boundary_loops(cells, of_cell)
    return FineGrid(result, table, of_point, quads, _triangles(quads), loops)


def _refined(cells, region, n: int):
    """Divide all cells: point set, indices (m, n + 1, n + 1) of the points of every cell, regions."""
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    # bilinear weights times n^2, integers so that equal points of two cells compare exactly:
    # N = [(1 - a)(1 - b), a (1 - b), a b, (1 - a) b],  a = i / n, b = j / n
    weights = np.stack([(n - i) * (n - j), i * (n - j), i * j, (n - i) * j], axis=-1)
    shape = (len(cells), (n + 1) ** 2, 4)
    anchors = np.broadcast_to(cells[:, None, :], shape)
    order = np.argsort(anchors, axis=-1)
    anchors = np.take_along_axis(anchors, order, -1)
    weights = np.take_along_axis(
        np.broadcast_to(weights.reshape(1, -1, 4), shape), order, -1
    ).copy()
    for k in range(1, 4):  # the repeated corner of a triangle gets the sum
        same = anchors[..., k] == anchors[..., k - 1]
        weights[..., k] += np.where(same, weights[..., k - 1], 0)
        weights[..., k - 1][same] = 0
    # anchors of zero weight are replaced, so that points on a side common to two cells are equal
    heaviest = np.take_along_axis(anchors, weights.argmax(axis=-1)[..., None], -1)
    anchors = np.where(weights > 0, anchors, heaviest)
    # anchors sorted, with their weights, give one key a point; the region makes interfaces double
    order = np.argsort(anchors * (n * n + 1) + weights, axis=-1)
    rows = np.concatenate([np.take_along_axis(part, order, -1) for part in (anchors, weights)], -1)
    rows = np.concatenate([np.broadcast_to(region[:, None, None], (*shape[:2], 1)), rows], -1)
    found, index = np.unique(rows.reshape(-1, 9), axis=0, return_inverse=True)
    # shape functions of a point are those of its material
    points = PointSet(
        np.ascontiguousarray(found[:, 1:5]), found[:, 5:] / n**2, 1, parts=found[:, 0]
    )
    return points, index.reshape(len(cells), n + 1, n + 1), found[:, 0]


def _quads(of_cell) -> np.ndarray:
    """Corners of the pieces of all cells, counter-clockwise."""
    low, high = slice(None, -1), slice(1, None)
    corners = (low, low), (high, low), (high, high), (low, high)
    return np.column_stack([of_cell[:, i, j].ravel() for i, j in corners])


def _triangles(quads) -> np.ndarray:
    """Two triangles for each quadrilateral, one where two of its corners are the same."""
    found = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return found[(found != np.roll(found, 1, axis=1)).all(axis=1)]


def cell_loops(body) -> tuple:
    """Trace the closed boundaries of a body through its particles."""
    # two points along a side of a cell: its corners
    return boundary_loops(body.cells, body.cells[:, [[0, 3], [1, 2]]])


def boundary_loops(cells: np.ndarray, of_cell: np.ndarray) -> tuple:
    """Trace closed boundaries of cells (m, 4) as loops of their points (m, n + 1, n + 1)."""
    along = [of_cell[:, :, 0], of_cell[:, -1, :], of_cell[:, ::-1, -1], of_cell[:, 0, ::-1]]
    sides = {}
    for k in range(4):
        for a, b, points in zip(cells[:, k], cells[:, (k + 1) % 4], along[k], strict=True):
            # a side met in the opposite direction before is inside and cancels
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

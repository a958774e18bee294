"""Variationally consistent integration: gradients whose cell mean obeys the divergence theorem.

Gauss quadrature does not integrate the rational shape functions exactly, and a Galerkin method that
ignores this fails the linear patch test. Each cell's gradients are shifted by one constant per
neighbour so that their weighted mean equals the boundary integral (Chen, Hillman and Rueter 2013,
in the symmetric form of an assumed gradient):

    grad~_q = grad_q + (1 / V_c) ( sum_e Phi_e n_e - sum_q w_q grad_q )

Constants and linear fields are reproduced as before. Cell edges carry two Gauss points; edges of
the essential boundary their two end points, where the admissible test functions vanish. Cells of a
column share the points of the edges between them.

In a body of revolution all integrals carry the circumference c = 2 pi R (``axisymmetry``), and the
divergence of the radial component has the hoop row Phi / R,

    sum_q c w (grad~_j + delta_j1 Phi / R) = sum_e c Phi_e n_ej,

which one constant shift per neighbour and cell satisfies again.

The rows of ``cell_areas``, which are made from values at the edge points and corners, follow those of
the Gauss points of a column.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.rkpm.axisymmetry import (
    CIRCUMFERENCE,
    add_circumference_seeds,
    add_radius_seeds,
    edge_circumferences,
)
from seal_mdao.rkpm.cell_areas import (
    AROUND,
    PLANE,
    AreaFactors,
    add_area_row_seeds,
    area_factors,
    area_rows,
)
from seal_mdao.rkpm.cells import CellMap, add_weight_seeds
from seal_mdao.rkpm.cells import weight_rates as rates_of_weights
from seal_mdao.rkpm.scatter import scatter_add
from seal_mdao.rkpm.shape_functions import Cloud, PointSet, ShapeTable, grad_rows
from seal_mdao.rkpm.tables import PointTable, raw_tables, runs
from seal_mdao.rkpm.transformed import TableRates, TableTransform, entry_starts

EDGE_POINTS = 8


class EdgeRule(NamedTuple):
    """Integration rule of the cell boundaries.

    Attributes
    ----------
    ends : ndarray of int, shape (n_cells, 8, 2)
        Particles at the ends of the edge of every edge point, counter-clockwise.
    weights : ndarray, shape (n_cells, 8, 2)
        Linear weights of the edge point between them, which sum to 1.
    radial : ndarray, shape (n_cells, 8, 2)
        Weights of the radii of these particles in c, with which the rule integrates products of two
        linear functions of an edge exactly: those of the point at Gauss points, (2/3, 1/3) at ends.
    distinct : ndarray of int, shape (n_columns, s)
        The points of every column of cells, by their index among the 12 points of all cells: edge points
        and corners.
    point_of : ndarray of int, shape (n_cells, 12)
        Index of every point of a cell among those of its column.
    """

    ends: np.ndarray
    weights: np.ndarray
    radial: np.ndarray
    distinct: np.ndarray
    point_of: np.ndarray


def edge_rule(cells: np.ndarray, constrained: np.ndarray, column: int = 1) -> EdgeRule:
    """Build the rule of the cell boundaries: two points on each of the four edges of every cell.

    Parameters
    ----------
    cells : ndarray of int, shape (n_cells, 4)
    constrained : ndarray of int
        Particles with imposed components; an outer edge between two of them is essential boundary.
    column : int
        Cells in succession that share the points between them.
    """
    ends = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2)
    _, which, count = np.unique(
        np.sort(ends, axis=2).reshape(-1, 2), axis=0, return_inverse=True, return_counts=True
    )
    # an edge of one cell only lies on the boundary of the body
    outer = (count[which.ravel()] == 1).reshape(ends.shape[:2])
    essential = outer & np.isin(ends, constrained).all(axis=2)
    # Gauss points s = (1 -+ 1 / sqrt(3)) / 2 on [0, 1], weight 1/2 each; end points where essential
    g = 0.5 - 0.5 / np.sqrt(3.0)
    gauss = np.array([[1.0 - g, g], [g, 1.0 - g]])
    ends, shape = np.repeat(ends, 2, axis=1), (len(cells), EDGE_POINTS, 2)
    weights = np.where(essential[..., None, None], np.eye(2), gauss).reshape(shape)
    # int R N_a ds / (L/2) = 2/3 R_a + 1/3 R_b of the linear function N_a of an end
    lumped = (np.eye(2) + 1.0) / 3.0
    radial = np.where(essential[..., None, None], lumped, gauss).reshape(shape)
    return EdgeRule(ends, weights, radial, *_distinct_points(ends, weights, column))


def _with_corners(ends, weights) -> tuple[np.ndarray, np.ndarray]:
    """Append the corners of the cells to their edge points: ends and weights (n_cells, 12, 2)."""
    corners = np.repeat(ends[:, ::2, :1], 2, axis=2)
    on_corners = np.broadcast_to([1.0, 0.0], corners.shape)
    return np.concatenate([ends, corners], axis=1), np.concatenate([weights, on_corners], axis=1)


def _distinct_points(ends, weights, column: int) -> tuple[np.ndarray, np.ndarray]:
    """Number the distinct points of every column: ``distinct`` and ``point_of`` of ``EdgeRule``.

    Two points are one where both lie on the same edge, nearer to the same end, or in the same corner.
    Columns with fewer points than others repeat their first."""
    ends, weights = _with_corners(ends, weights)
    of_cell = ends.shape[1]
    # key of a point: column, nearer end, farther end
    n_columns = len(ends) // column
    order = np.argsort(-weights, axis=2, kind="stable")
    key = np.empty((n_columns, column * of_cell, 3), int)
    key[..., 0] = np.arange(n_columns)[:, None]
    key[..., 1:] = np.take_along_axis(ends, order, axis=2).reshape(n_columns, -1, 2)
    _, first, which = np.unique(key.reshape(-1, 3), axis=0, return_index=True, return_inverse=True)
    # numbered in order of first appearance, counted from the first point of the column
    seen = np.sort(first)
    of_column = seen // (column * of_cell)
    before = np.searchsorted(of_column, np.arange(n_columns))
    point_of = np.arange(seen.size) - before[of_column]
    distinct = np.tile(seen[before, None], point_of.max() + 1)
    distinct[of_column, point_of] = seen
    return distinct, point_of[np.searchsorted(seen, first[which.ravel()])].reshape(ends.shape[:2])


def edge_normals(rule: EdgeRule, vectors: np.ndarray) -> np.ndarray:
    """Compute outward normal times weight at every edge point, shape (..., n_cells, 8, 2).

    Linear in ``vectors`` (..., n, 2): the particles give the normals, a velocity their rates.
    """
    # n w = 1/2 (dy, -dx) of the edge, counter-clockwise: outward, half the length for each point
    edge = vectors[..., rule.ends[..., 1], :] - vectors[..., rule.ends[..., 0], :]
    return 0.5 * np.stack([edge[..., 1], -edge[..., 0]], axis=-1)


def add_normal_seeds(rule: EdgeRule, normal_bar: np.ndarray, x_bar: np.ndarray) -> None:
    """Apply the transpose of ``edge_normals``: seeds (n_cells, 8, 2, M) added to ``x_bar`` (n, 2, M)."""
    # dx_bar = -1/2 n_y_bar, dy_bar = 1/2 n_x_bar; + at the second end, - at the first
    pull = 0.5 * np.stack([-normal_bar[..., 1, :], normal_bar[..., 0, :]], axis=-2)
    scatter_add(x_bar, rule.ends[..., 1], pull)
    scatter_add(x_bar, rule.ends[..., 0], -pull)


def circumferences(gauss: PointTable, shape) -> np.ndarray:
    """Compute c = 2 pi R of the Gauss points, ``shape`` (n_cells, q), m; 1 in plane strain."""
    if not gauss.points.hooped:
        return np.ones(shape)
    return CIRCUMFERENCE * gauss.coordinates[:, 0].reshape(shape)


def around_normals(rule: EdgeRule, gauss: PointTable) -> np.ndarray:
    """Compute outward normals times c w at the edge points, shape (n_cells, 8, 2)."""
    particles = gauss.cloud.particles
    normals = edge_normals(rule, particles)
    if not gauss.points.hooped:
        return normals
    return edge_circumferences(rule.ends, rule.radial, particles)[..., None] * normals


def integration_points(mapping: CellMap, rule: EdgeRule, axisymmetric: bool = False) -> tuple:
    """Collect Gauss points, and edge points with corners; those of a column of cells form a group."""
    n_cells, q = len(mapping.cells), mapping.n_points
    anchors = np.broadcast_to(mapping.cells[:, None], (n_cells, q, 4)).reshape(-1, 4)
    weights = np.broadcast_to(mapping.values, (n_cells, q, 4)).reshape(-1, 4)
    n_columns, n_distinct = rule.distinct.shape
    gauss = PointSet(anchors, weights, q * (n_cells // n_columns), False, hooped=axisymmetric)
    points = _with_corners(rule.ends, rule.weights)
    ends, between = (own.reshape(-1, 2)[rule.distinct.ravel()] for own in points)
    return gauss, PointSet(ends, between, n_distinct, sloped=False)


@dataclass(frozen=True)
class CellTable:
    """Shape functions at the quadrature points of the background cells, one group per column.

    Attributes
    ----------
    mapping : CellMap
    rule : EdgeRule
    weights : ndarray, shape (n_cells, q)
        Quadrature weights of the section, area unit.
    gauss : PointTable
        Gradients at the Gauss points of the shape functions of Eq. (13), in a body of revolution with
        the row Phi / R.
    edges : PointTable
        Values at the edge points and corners; the groups share the neighbour lists of the Gauss points.
    raw : ShapeTable
        Consistent gradients at the Gauss points of a column, with that row, then its rows of
        ``cell_areas``, two or three as of as many points.
    table : ShapeTable
        After the essential transformation; what the analysis uses.
    transform : TableTransform
        From ``raw`` to ``table``.
    """

    mapping: CellMap
    rule: EdgeRule
    weights: np.ndarray
    gauss: PointTable
    edges: PointTable
    raw: ShapeTable
    table: ShapeTable
    transform: TableTransform

    @property
    def axisymmetric(self) -> bool:
        """Whether the body is one of revolution."""
        return self.gauss.points.hooped

    @cached_property
    def circumferences(self) -> np.ndarray:
        """c = 2 pi R of the Gauss points, shape (n_cells, q), m; 1 in plane strain."""
        return circumferences(self.gauss, self.weights.shape)

    @cached_property
    def cell_weights(self) -> np.ndarray:
        """Quadrature weights c w of the body, shape (n_cells, q)."""
        return self.weights * self.circumferences

    @property
    def column_weights(self) -> np.ndarray:
        """Those weights by columns, shape (n_columns, cells of a column * q)."""
        return self.cell_weights.reshape(self.raw.n_groups, self.gauss.raw.group_size)

    @property
    def area_factors(self) -> AreaFactors:
        """Factors of the rows of areas."""
        return area_factors(self.cell_weights, self.weights)

    @property
    def normals(self) -> np.ndarray:
        """Outward normals times c w at the edge points, shape (n_cells, 8, 2)."""
        return around_normals(self.rule, self.gauss)

    def weight_rates(self, velocity) -> np.ndarray:
        """Differentiate the weights c w along design velocities V (P, n, 2), shape (P, n_cells, q)."""
        rates = rates_of_weights(self.mapping, self.gauss.cloud.particles, velocity)
        if not self.axisymmetric:
            return rates
        # (c w)' = c w' + 2 pi R' w
        moved = self.gauss.points.rates(self.gauss.cloud.particles, velocity)[:, 0]
        around = CIRCUMFERENCE * moved.T.reshape(rates.shape)
        return self.circumferences * rates + around * self.weights

    def add_weight_seeds(self, weight_bar, x_bar) -> None:
        """Transpose of ``weight_rates``: seeds (n_cells, q, M) added to ``x_bar`` (n, 2, M)."""
        particles = self.gauss.cloud.particles
        if self.axisymmetric:
            on_radius = CIRCUMFERENCE * (weight_bar * self.weights[..., None])
            on_radius = on_radius.reshape(-1, weight_bar.shape[2])
            add_radius_seeds(self.gauss.points, particles, on_radius, x_bar)
            weight_bar = weight_bar * self.circumferences[..., None]
        add_weight_seeds(self.mapping, particles, weight_bar, x_bar)

    def _normal_rates(self, velocity) -> np.ndarray:
        """Rates of ``normals``, shape (P, n_cells, 8, 2)."""
        # the edge normals are linear in the particles: their rates are the normals of the velocities
        rates = edge_normals(self.rule, velocity)
        if not self.axisymmetric:
            return rates
        # (c n)' = c n' + c' n, c being linear in the particles too
        particles = self.gauss.cloud.particles
        around, grown = (
            edge_circumferences(self.rule.ends, self.rule.radial, own)[..., None]
            for own in (particles, velocity)
        )
        return around * rates + grown * edge_normals(self.rule, particles)

    def _add_normal_seeds(self, normal_bar, x_bar) -> None:
        """Transpose of ``_normal_rates``: seeds (n_cells, 8, 2, M) added to ``x_bar`` (n, 2, M)."""
        if self.axisymmetric:
            ends, radial, particles = self.rule.ends, self.rule.radial, self.gauss.cloud.particles
            # c_bar = n . (c n)_bar
            plain = edge_normals(self.rule, particles)
            on_around = np.einsum("cejm,cej->cem", normal_bar, plain)
            add_circumference_seeds(ends, radial, on_around, x_bar)
            around = edge_circumferences(ends, radial, particles)
            normal_bar = normal_bar * around[..., None, None]
        add_normal_seeds(self.rule, normal_bar, x_bar)

    def rates(self, velocity, weight_rates, matrix_rate) -> TableRates:
        """Differentiate the table along design velocities V (P, n, 2).

        Parameters
        ----------
        weight_rates : ndarray, shape (P, n_cells, q)
            Of ``weight_rates``.
        matrix_rate : ndarray, shape (c, u, P)
            T' of ``essential.transformation_rates``.
        """
        raw, at_gauss = self.raw, self.gauss.raw_rates(velocity, self.transform)
        at_edges = self.edges.raw_rates(velocity, like=at_gauss)
        active = at_gauss.start[:, 0]
        starts = np.column_stack([active, entry_starts(np.diff(active), raw)])
        grad = np.empty(grad_rows(raw) * starts[-1, 1])
        rates = TableRates(starts, at_gauss.active, np.empty(0), grad)
        normals = self.normals, self._normal_rates(velocity)
        weights, points = (self.cell_weights, weight_rates), self.rule.point_of
        _correct_rates(raw, self.edges.raw, points, at_gauss, at_edges, weights, normals, rates)
        factors, particles = self.area_factors, self.gauss.cloud.particles
        # those of the section
        normals = edge_normals(self.rule, particles), edge_normals(self.rule, velocity)
        factor_rates = np.zeros((len(velocity), *factors.values.shape))
        if self.axisymmetric:
            areas = rates_of_weights(self.mapping, particles, velocity).sum(axis=2)
            factor_rates = factors.rates(weight_rates.sum(axis=2), areas)
        factors = factors.values, factor_rates
        _fill_area_rates(raw, self.edges.raw, points, at_edges, weights, normals, factors, rates)
        return self.transform.rates(rates, matrix_rate)

    def pull_back(self, grad_bar, weight_bar, x_bar) -> np.ndarray:
        """Apply the transpose of ``rates``: seeds (grad.size, M) back to the particles.

        ``weight_bar`` (n_cells, q, M) and ``x_bar`` (n, 2, M) are added to; returns the seeds on T.
        """
        m, raw, gauss, edges, transform = (
            grad_bar.shape[1], self.raw, self.gauss, self.edges, self.transform
        )  # fmt: skip
        matrix_bar = np.zeros((*transform.transformation.matrix.shape, m))
        normals, per_point = self.normals, grad_rows(raw)
        factors, particles = self.area_factors, gauss.cloud.particles
        # those of the section
        area_normals = edge_normals(self.rule, particles)
        normal_bar, area_normal_bar, gauss_bar, edge_bar, factor_bar = (
            np.zeros((*of.shape, m))
            for of in (normals, normals, gauss.coordinates, edges.coordinates, factors.values)
        )
        # run by run, so that the coefficients of the derivatives stay in the cache
        nothing = np.empty((0, m))
        for columns in runs(raw, ~transform.touched) + runs(raw, transform.touched):
            ends = list(columns)
            # Phi~ = Phi T: seeds on the raw gradients and on T
            seeds = grad_bar[slice(*(per_point * raw.group_size * self.table.start[ends]))]
            seeds = transform.pull_back(columns, raw.grad, per_point, seeds, matrix_bar)
            # consistent gradients -> gradients at Gauss points, values at edge points, weights, normals
            n = np.diff(raw.start[ends])[0]
            on_rows = np.empty((per_point * n * gauss.raw.group_size, m))
            on_values = np.zeros((n * edges.raw.group_size, m))
            if self.axisymmetric:
                # those on the gradients grow by those on their means
                seeds = seeds.copy()
            _add_area_seeds(
                raw, edges.raw, self.rule.point_of, self.cell_weights, area_normals, factors.values,
                columns, seeds, on_values, weight_bar, area_normal_bar, factor_bar,
            )  # fmt: skip
            _correct_seeds(
                raw, edges.raw, self.rule.point_of, self.cell_weights, normals, columns, seeds,
                on_rows, on_values, weight_bar, normal_bar,
            )  # fmt: skip
            # -> particles and points
            gauss.add_raw_seeds(columns, nothing, on_rows, x_bar, gauss_bar)
            edges.add_raw_seeds(columns, on_values, nothing, x_bar, edge_bar)
        # normals and points move with the particles
        self._add_normal_seeds(normal_bar, x_bar)
        if self.axisymmetric:
            add_normal_seeds(self.rule, area_normal_bar, x_bar)
            # of V = sum_q c w and A = sum_q w
            volume_bar, area_bar = factors.seeds(factor_bar)
            weight_bar += volume_bar[:, None]
            on_weights = np.repeat(area_bar[:, None], self.weights.shape[1], axis=1)
            add_weight_seeds(self.mapping, particles, on_weights, x_bar)
        gauss.points.add_seeds(particles, gauss_bar, x_bar)
        edges.points.add_seeds(edges.cloud.particles, edge_bar, x_bar)
        return matrix_bar


@inlined
def _of_cell(start, cell, n_cells):
    """Locate the rows of a cell: its column, its number in the column, the number of neighbours n."""
    cells = n_cells // (start.size - 1)
    column = cell // cells
    return column, cell - cells * column, start[column + 1] - start[column]


@inlined
def _gauss_rows(values, before, rows, number, q_count, width):
    """View the rows of the Gauss points of a cell, shape (q, rows, width), in those of its column, which
    begin at the entry ``before``. ``width``: neighbours, times parameters or measures."""
    at = before + rows * number * q_count * width
    return values[at : at + rows * q_count * width].reshape(q_count, rows, width)


@inlined
def _area_rows(values, before, rows, number, cells, q_count, width):
    """View the rows of areas of a cell, shape (pairs, rows, width), which follow those of the Gauss
    points of all ``cells`` of its column."""
    pairs = AROUND if rows == 3 else PLANE
    at = before + rows * (q_count * cells + pairs * number) * width
    return values[at : at + rows * pairs * width].reshape(pairs, rows, width)


@internal
def _fill_values(edges, start, column, points, n, out):
    """Fill ``out`` (12, n) with the values at the ``points`` (12,) of a cell of a column."""
    for e in range(points.size):
        at = start[column] * edges.group_size + points[e] * n
        for i in range(n):
            out[e, i] = edges.phi[at + i]


@compiled
def _correct(gauss, edges, point_of, weights, normals, raw):
    """Fill the rows of ``raw`` with those of ``gauss``, gradients made consistent."""
    (n_cells, q_count), start, rows = weights.shape, raw.start, grad_rows(raw)
    for cell in range(n_cells):
        column, number, n = _of_cell(start, cell, n_cells)
        s0 = start[column]
        grad = _gauss_rows(gauss.grad, rows * s0 * gauss.group_size, rows, number, q_count, n)
        out = _gauss_rows(raw.grad, rows * s0 * raw.group_size, rows, number, q_count, n)
        on_edges, volume = s0 * edges.group_size, 0.0
        for q in range(q_count):
            # V_c = sum_q w_q
            volume += weights[cell, q]
        # components counted by a shape: numba splits a loop over a constant 2 into two
        for j in range(normals.shape[2]):
            for i in range(n):
                # s_Ij = (1/V_c) ( sum_e Phi_I(x_e) n_ej - sum_q w_q Phi_I,j(x_q) )
                shift = 0.0
                for q in range(q_count):
                    shift -= weights[cell, q] * grad[q, j, i]
                if rows == 3 and j == 0:
                    for q in range(q_count):
                        # the radial divergence has the hoop row, - w_q Phi_I / R
                        shift -= weights[cell, q] * grad[q, 2, i]
                for e in range(normals.shape[1]):
                    shift += edges.phi[on_edges + point_of[cell, e] * n + i] * normals[cell, e, j]
                shift /= volume
                for q in range(q_count):
                    # Phi~_I,j(x_q) = Phi_I,j(x_q) + s_Ij
                    out[q, j, i] = grad[q, j, i] + shift
        for q in range(q_count if rows == 3 else 0):
            for i in range(n):
                out[q, 2, i] = grad[q, 2, i]


@compiled
def _correct_rates(raw, edges, point_of, d_gauss, d_edges, weights, normals, rates):
    """Differentiate the consistent gradients of ``raw``, given the rates of Phi_I,j, ``d_gauss``, and
    pairs of weights and of normals with their rates."""
    (weights, weight_rates), (normals, normal_rates) = weights, normals
    (n_cells, q_count), rows, start = weights.shape, grad_rows(raw), raw.start
    for cell in range(n_cells):
        column, number, n = _of_cell(start, cell, n_cells)
        which = d_gauss.active[d_gauss.start[column, 0] : d_gauss.start[column + 1, 0]]
        count = which.size
        if count == 0:
            continue
        before, size = rows * start[column] * raw.group_size, n * count
        grad = _gauss_rows(raw.grad, before, rows, number, q_count, n)
        # where the entries of a column begin is counted in all of its points
        before = rows * d_gauss.start[column, 1]
        d_grad = _gauss_rows(d_gauss.grad, before, rows, number, q_count, size)
        d_grad = d_grad.reshape(q_count, rows, n, count)
        out = _gauss_rows(rates.grad, rows * rates.start[column, 1], rows, number, q_count, size)
        out = out.reshape(q_count, rows, n, count)
        # V_c s_Ij' = sum_e (Phi_I n_ej)' - sum_q (w_q' Phi~_I,j + w_q Phi_I,j'):
        # the term -V_c' s_Ij of the quotient is contained in w_q' Phi~_I,j = w_q' (Phi_I,j + s_Ij)
        volume, d_shift = weights[cell].sum(), np.zeros((2, n, count))
        for q in range(q_count):
            for j in range(2):
                for i in range(n):
                    for p in range(count):
                        dw = weight_rates[which[p], cell, q]
                        # - w_q' Phi~_I,j - w_q Phi_I,j'
                        d_shift[j, i, p] -= (
                            dw * grad[q, j, i] + weights[cell, q] * d_grad[q, j, i, p]
                        )
            for i in range(n if rows == 3 else 0):
                for p in range(count):
                    # and of the hoop row: - w_q' Phi_I / R - w_q (Phi_I / R)'
                    dw = weight_rates[which[p], cell, q]
                    d_shift[0, i, p] -= dw * grad[q, 2, i] + weights[cell, q] * d_grad[q, 2, i, p]
        for e in range(normals.shape[1]):
            at = point_of[cell, e] * n
            phi = edges.phi[start[column] * edges.group_size + at :][:n]
            d_phi = d_edges.phi[d_edges.start[column, 1] + at * count :][: n * count]
            for j in range(2):
                for i in range(n):
                    for p in range(count):
                        dn = normal_rates[which[p], cell, e, j]
                        # + Phi_I' n_ej + Phi_I n_ej'
                        d_shift[j, i, p] += d_phi[i * count + p] * normals[cell, e, j] + phi[i] * dn
        for q in range(q_count):
            for j in range(2):
                for i in range(n):
                    for p in range(count):
                        # Phi~_I,j' = Phi_I,j' + s_Ij'
                        out[q, j, i, p] = d_grad[q, j, i, p] + d_shift[j, i, p] / volume
            for i in range(n if rows == 3 else 0):
                for p in range(count):
                    out[q, 2, i, p] = d_grad[q, 2, i, p]


@compiled
def _correct_seeds(
    raw,
    edges,
    point_of,
    weights,
    normals,
    columns,
    seeds,
    gauss_bar,
    edge_bar,
    weight_bar,
    normal_bar,
):
    """Apply the transpose of ``_correct_rates`` to the ``columns`` (first, last): seeds (rows, M) on
    the consistent gradients to those on the gradients at the Gauss points and, added, on the values
    at the edge points, and to those on the weights and normals of all cells."""
    (first, last), cells, rows = columns, len(weights) // (raw.start.size - 1), grad_rows(raw)
    (q_count, e_count), count = (weights.shape[1], normals.shape[1]), seeds.shape[1]
    on_weights, on_normals = np.empty((q_count, count)), np.empty((2, e_count, count))
    flat, flat_gauss = seeds.reshape(seeds.size), gauss_bar.reshape(gauss_bar.size)
    for cell in range(cells * first, cells * last):
        column, number, n = _of_cell(raw.start, cell, len(weights))
        before = rows * raw.start[column] * raw.group_size
        grad = _gauss_rows(raw.grad, before, rows, number, q_count, n).reshape(q_count, rows * n)
        # seeds hold the rows of these columns only; side by side: rows, neighbours, measures
        at = rows * (raw.start[column] - raw.start[first]) * count
        seed = _gauss_rows(flat, at * raw.group_size, rows, number, q_count, n * count)
        on_gauss = _gauss_rows(flat_gauss, at * q_count * cells, rows, number, q_count, n * count)
        seed, on_gauss = (
            seed.reshape(q_count, rows * n * count), on_gauss.reshape(q_count, rows * n * count)
        )  # fmt: skip
        volume, shift_bar = weights[cell].sum(), np.zeros(2 * n * count)
        for q in range(q_count):
            for a in range(shift_bar.size):
                # s_bar_Ij / V_c, with s_bar_Ij = sum_q Phi~_bar_q,Ij
                shift_bar[a] += seed[q, a] / volume
        for q in range(q_count):
            for a in range(shift_bar.size):
                # Phi_bar_q,Ij = Phi~_bar_q,Ij - w_q s_bar_Ij / V_c
                on_gauss[q, a] = seed[q, a] - weights[cell, q] * shift_bar[a]
            for a in range(shift_bar.size, seed.shape[1]):
                # hoop row: hoop_bar_q,I = hoop~_bar_q,I - w_q s_bar_I1 / V_c
                on_gauss[q, a] = seed[q, a] - weights[cell, q] * shift_bar[a - 2 * n * count]
        by_x, by_y = shift_bar[: n * count], shift_bar[n * count :]
        phi = np.empty((e_count, n))
        _fill_values(edges, raw.start, column, point_of[cell, :e_count], n, phi)
        for e in range(e_count):
            at = (raw.start[column] - raw.start[first]) * edges.group_size + point_of[cell, e] * n
            # Phi_bar_I(x_e) += sum_j s_bar_Ij n_ej / V_c
            on_edge = edge_bar[at : at + n].reshape(n * count)
            for a in range(by_x.size):
                on_edge[a] += by_x[a] * normals[cell, e, 0] + by_y[a] * normals[cell, e, 1]
        # w_bar_q = -sum_Ij Phi~_q,I,j s_bar_Ij / V_c,   n_bar_ej = sum_I Phi_I(x_e) s_bar_Ij / V_c
        if rows == 3:
            # the hoop row is shifted with the first component
            on_rows = np.empty((3 * n, count))
            on_rows[: 2 * n] = shift_bar.reshape(2 * n, count)
            on_rows[2 * n :] = on_rows[:n]
            np.dot(grad, on_rows, on_weights)
        else:
            np.dot(grad, shift_bar.reshape(2 * n, count), on_weights)
        np.dot(phi, by_x.reshape(n, count), on_normals[0])
        np.dot(phi, by_y.reshape(n, count), on_normals[1])
        for q in range(q_count):
            for p in range(count):
                weight_bar[cell, q, p] -= on_weights[q, p]
        for e in range(e_count):
            for j in range(2):
                for p in range(count):
                    normal_bar[cell, e, j, p] = on_normals[j, e, p]


@compiled
def fill_areas(raw, edges, point_of, weights, normals, factors):
    """Fill the rows of areas of ``raw``, whose gradients are known: (V/A) a_I and b_I, and in a body of
    revolution those of Gbar and M; zero in place of a hoop row.

    ``weights`` (n_cells, q) are c w, ``normals`` (n_cells, 8, 2) those of the section.
    """
    (n_cells, q_count), rows = weights.shape, grad_rows(raw)
    cells = n_cells // (raw.start.size - 1)
    for cell in range(n_cells):
        column, number, n = _of_cell(raw.start, cell, n_cells)
        before, factor = rows * raw.start[column] * raw.group_size, factors[cell]
        values, own = np.empty((point_of.shape[1], n)), np.empty((PLANE, 2, n))
        _fill_values(edges, raw.start, column, point_of[cell], n, values)
        area_rows(values, own)
        out = _area_rows(raw.grad, before, rows, number, cells, q_count, n)
        out[:] = 0.0
        for t in range(PLANE):
            for i in range(n):
                out[t, 0, i], out[t, 1, i] = factor[0] * own[t, 0, i], own[t, 1, i]
        if rows == 3:
            grad = _gauss_rows(raw.grad, before, rows, number, q_count, n)
            for i in range(n):
                # - (V/A) sum_e Phi_e n_e1, (1/A) sum_e Phi_e n_e2
                for e in range(normals.shape[1]):
                    out[PLANE, 0, i] -= factor[0] * values[e, i] * normals[cell, e, 0]
                    out[PLANE, 1, i] += factor[1] * values[e, i] * normals[cell, e, 1]
                # sum_q c w Phi_I,1, (1/V) sum_q c w Phi_I,2
                for q in range(q_count):
                    out[PLANE + 1, 0, i] += weights[cell, q] * grad[q, 0, i]
                    out[PLANE + 1, 1, i] += factor[2] * weights[cell, q] * grad[q, 1, i]


@compiled
def _fill_area_rates(raw, edges, point_of, d_edges, weights, normals, factors, rates):
    """Fill the rates of the rows of areas in ``rates``, which has those of the gradients; ``weights``,
    ``normals`` and ``factors`` are pairs of values and rates."""
    (weights, weight_rates), (normals, normal_rates) = weights, normals
    factors, factor_rates = factors
    (n_cells, q_count), rows = weights.shape, grad_rows(raw)
    cells = n_cells // (raw.start.size - 1)
    for cell in range(n_cells):
        column, number, n = _of_cell(raw.start, cell, n_cells)
        which = rates.active[rates.start[column, 0] : rates.start[column + 1, 0]]
        count, factor = which.size, factors[cell]
        if count == 0:
            continue
        value_rates = np.empty((point_of.shape[1], n * count))
        for e in range(point_of.shape[1]):
            at = d_edges.start[column, 1] + point_of[cell, e] * n * count
            value_rates[e] = d_edges.phi[at : at + n * count]
        own = np.empty((PLANE, 2, n * count))
        area_rows(value_rates, own)
        before = rows * raw.start[column] * raw.group_size
        area = _area_rows(raw.grad, before, rows, number, cells, q_count, n)
        at = rows * rates.start[column, 1]
        out = _area_rows(rates.grad, at, rows, number, cells, q_count, n * count)
        out[:] = 0.0
        for t in range(PLANE):
            for i in range(n):
                for p in range(count):
                    # ((V/A) a_I)' = (V/A) a_I' + (V/A)' a_I
                    grown = factor_rates[which[p], cell, 0] / factor[0] * area[t, 0, i]
                    k = i * count + p
                    out[t, 0, k], out[t, 1, k] = factor[0] * own[t, 0, k] + grown, own[t, 1, k]
        if rows == 2:
            continue
        values = np.empty((point_of.shape[1], n))
        _fill_values(edges, raw.start, column, point_of[cell], n, values)
        grad = _gauss_rows(raw.grad, before, rows, number, q_count, n)
        d_grad = _gauss_rows(rates.grad, at, rows, number, q_count, n * count)
        for i in range(n):
            for p in range(count):
                k, rate = i * count + p, factor_rates[which[p], cell]
                # factors'
                out[PLANE, 0, k] += rate[0] / factor[0] * area[PLANE, 0, i]
                out[PLANE, 1, k] += rate[1] / factor[1] * area[PLANE, 1, i]
                out[PLANE + 1, 1, k] += rate[2] / factor[2] * area[PLANE + 1, 1, i]
                for e in range(normals.shape[1]):
                    # (Phi_e n_e)'
                    for j in range(2):
                        moved = value_rates[e, k] * normals[cell, e, j]
                        moved += values[e, i] * normal_rates[which[p], cell, e, j]
                        out[PLANE, j, k] += moved * (-factor[0] if j == 0 else factor[1])
                for q in range(q_count):
                    # (c w Phi_I,j)'
                    for j in range(2):
                        moved = weight_rates[which[p], cell, q] * grad[q, j, i]
                        moved += weights[cell, q] * d_grad[q, j, k]
                        out[PLANE + 1, j, k] += moved * (1.0 if j == 0 else factor[2])


@compiled
def _add_area_seeds(
    raw, edges, point_of, weights, normals, factors, columns, seeds, edge_bar, weight_bar, normal_bar,
    factor_bar,
):  # fmt: skip
    """Apply the transpose of ``_fill_area_rates`` to the ``columns`` (first, last): seeds (rows, M) on
    all rows, added to those on the gradients among them, on the values at the points, and on weights,
    normals and factors."""
    (first, last), count, rows = columns, seeds.shape[1], grad_rows(raw)
    (n_cells, q_count), flat = weights.shape, seeds.reshape(seeds.size)
    cells = n_cells // (raw.start.size - 1)
    for cell in range(cells * first, cells * last):
        column, number, n = _of_cell(raw.start, cell, n_cells)
        at, factor = raw.start[column] - raw.start[first], factors[cell]
        before, on_rows = (
            rows * raw.start[column] * raw.group_size, rows * at * count * raw.group_size
        )  # fmt: skip
        area = _area_rows(raw.grad, before, rows, number, cells, q_count, n)
        seed = _area_rows(flat, on_rows, rows, number, cells, q_count, n * count)
        own, value_bar = np.empty((PLANE, 2, n * count)), np.zeros((point_of.shape[1], n * count))
        for t in range(PLANE):
            for i in range(n):
                for m in range(count):
                    k = i * count + m
                    own[t, 0, k], own[t, 1, k] = factor[0] * seed[t, 0, k], seed[t, 1, k]
                    factor_bar[cell, 0, m] += seed[t, 0, k] * area[t, 0, i] / factor[0]
        add_area_row_seeds(own, value_bar)
        if rows == 3:
            values = np.empty((point_of.shape[1], n))
            _fill_values(edges, raw.start, column, point_of[cell], n, values)
            grad = _gauss_rows(raw.grad, before, rows, number, q_count, n)
            on_grad = _gauss_rows(flat, on_rows, rows, number, q_count, n * count)
            for i in range(n):
                for m in range(count):
                    k = i * count + m
                    # factors
                    factor_bar[cell, 0, m] += seed[PLANE, 0, k] * area[PLANE, 0, i] / factor[0]
                    factor_bar[cell, 1, m] += seed[PLANE, 1, k] * area[PLANE, 1, i] / factor[1]
                    on_means = seed[PLANE + 1, 1, k] * area[PLANE + 1, 1, i]
                    factor_bar[cell, 2, m] += on_means / factor[2]
                    for j in range(2):
                        on_sum = seed[PLANE, j, k] * (-factor[0] if j == 0 else factor[1])
                        for e in range(normals.shape[1]):
                            # Phi_e n_e
                            value_bar[e, k] += on_sum * normals[cell, e, j]
                            normal_bar[cell, e, j, m] += on_sum * values[e, i]
                        on_sum = seed[PLANE + 1, j, k] * (1.0 if j == 0 else factor[2])
                        for q in range(q_count):
                            # c w Phi_I,j
                            on_grad[q, j, k] += on_sum * weights[cell, q]
                            weight_bar[cell, q, m] += on_sum * grad[q, j, i]
        for e in range(point_of.shape[1]):
            row = at * edges.group_size + point_of[cell, e] * n
            for i in range(n):
                for m in range(count):
                    edge_bar[row + i, m] += value_bar[e, i * count + m]


def build_cell_table(
    cloud: Cloud,
    mapping: CellMap,
    rule: EdgeRule,
    weights: np.ndarray,
    transformation,
    axisymmetric: bool = False,
    parts: np.ndarray | None = None,
) -> CellTable:
    """Build the consistent shape functions at the quadrature points, with essential conditions.

    Parameters
    ----------
    weights : ndarray, shape (n_cells, q)
        Of the section.
    axisymmetric : bool
        Whether the section is turned about the axis x = 0.
    parts : ndarray of int, shape (n_cells,), optional
        Part of every cell.
    """
    gauss, edges = integration_points(mapping, rule, axisymmetric)
    if parts is not None:
        gauss = gauss._replace(parts=np.repeat(parts, mapping.n_points))
    gauss, edges = raw_tables(cloud, gauss, edges)
    around, normals = weights * circumferences(gauss, weights.shape), around_normals(rule, gauss)
    # the Gauss points of a column, then the pairs of rows of each of its cells
    pairs = AROUND if axisymmetric else PLANE
    size = gauss.raw.group_size + pairs * (len(rule.point_of) // gauss.raw.n_groups)
    grad = np.empty(grad_rows(gauss.raw) * gauss.raw.neighbours.size * size)
    raw = gauss.raw._replace(grad=grad, group_size=size)
    _correct(gauss.raw, edges.raw, rule.point_of, around, normals, raw)
    fill_areas(
        raw, edges.raw, rule.point_of, around, edge_normals(rule, cloud.particles),
        area_factors(around, weights).values,
    )  # fmt: skip
    transform = TableTransform(raw, transformation)
    return CellTable(mapping, rule, weights, gauss, edges, raw, transform.table, transform)

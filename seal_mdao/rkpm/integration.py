"""Variationally consistent integration: gradients whose cell mean obeys the divergence theorem.

Gauss quadrature does not integrate the rational shape functions exactly, and a Galerkin method that
ignores this fails the linear patch test. Each cell's gradients are shifted by one constant per
neighbour so that their weighted mean equals the boundary integral (Chen, Hillman and Rueter 2013,
in the symmetric form of an assumed gradient):

    grad~_q = grad_q + (1 / V_c) ( sum_e Phi_e n_e - sum_q w_q grad_q )

Constants and linear fields are reproduced as before. Cell edges carry two Gauss points; edges of
the essential boundary their two end points, where the admissible test functions vanish.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, inlined
from seal_mdao.rkpm.cells import CellMap
from seal_mdao.rkpm.scatter import scatter_add
from seal_mdao.rkpm.shape_functions import Cloud, PointSet, ShapeTable
from seal_mdao.rkpm.tables import PointTable, raw_rates, raw_seeds, raw_table
from seal_mdao.rkpm.transformed import (
    TableRates,
    entry_starts,
    transform_table,
    transformed_rates,
    untransformed_seeds,
)

EDGE_POINTS = 8


class EdgeRule(NamedTuple):
    """Integration of the cell boundaries.

    Attributes
    ----------
    ends : ndarray of int, shape (n_cells, 8, 2)
        Particles at the ends of the edge of every edge point, counter-clockwise.
    weights : ndarray, shape (n_cells, 8, 2)
        Place of the edge point between them.
    """

    ends: np.ndarray
    weights: np.ndarray


def edge_rule(cells: np.ndarray, constrained: np.ndarray) -> EdgeRule:
    """Two points on each of the four edges of every cell.

    Parameters
    ----------
    cells : ndarray of int, shape (n_cells, 4)
    constrained : ndarray of int
        Particles with imposed components; an outer edge between two of them is essential boundary.
    """
    ends = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2)
    _, which, count = np.unique(
        np.sort(ends, axis=2).reshape(-1, 2), axis=0, return_inverse=True, return_counts=True
    )
    outer = (count[which.ravel()] == 1).reshape(ends.shape[:2])
    essential = outer & np.isin(ends, constrained).all(axis=2)
    g = 0.5 - 0.5 / np.sqrt(3.0)
    gauss = np.array([[1.0 - g, g], [g, 1.0 - g]])
    weights = np.where(essential[..., None, None], np.eye(2), gauss)
    n = len(cells)
    return EdgeRule(np.repeat(ends, 2, axis=1), weights.reshape(n, EDGE_POINTS, 2))


def edge_normals(rule: EdgeRule, vectors: np.ndarray) -> np.ndarray:
    """Outward normal times weight at every edge point, (..., n_cells, 8, 2).

    Linear in ``vectors`` (..., n, 2): the particles give the normals, a velocity their rates.
    """
    edge = vectors[..., rule.ends[..., 1], :] - vectors[..., rule.ends[..., 0], :]
    return 0.5 * np.stack([edge[..., 1], -edge[..., 0]], axis=-1)


def add_normal_seeds(rule: EdgeRule, normal_bar: np.ndarray, x_bar: np.ndarray) -> None:
    """Transpose of ``edge_normals``: seeds (n_cells, 8, 2, M) added to ``x_bar`` (n, 2, M)."""
    pull = 0.5 * np.stack([-normal_bar[..., 1, :], normal_bar[..., 0, :]], axis=-2)
    scatter_add(x_bar, rule.ends[..., 1], pull)
    scatter_add(x_bar, rule.ends[..., 0], -pull)


def integration_points(mapping: CellMap, rule: EdgeRule, column: int = 1) -> PointSet:
    """Gauss points followed by edge points of every cell; ``column`` cells in succession are a group.

    Of the edge points only the values are used.
    """
    n_cells, q = len(mapping.cells), mapping.n_points
    anchors = np.empty((n_cells, q + EDGE_POINTS, 4), int)
    weights = np.zeros((n_cells, q + EDGE_POINTS, 4))
    anchors[:, :q], weights[:, :q] = mapping.cells[:, None], mapping.values
    anchors[:, q:] = np.tile(rule.ends, (1, 1, 2))
    weights[:, q:, :2] = rule.weights
    sloped = np.tile(np.arange(q + EDGE_POINTS) < q, column)
    return PointSet(anchors.reshape(-1, 4), weights.reshape(-1, 4), sloped.size, sloped)


@dataclass(frozen=True)
class CellTable:
    """Shape functions at the quadrature points of the background cells, a group for a column of them.

    Attributes
    ----------
    rule : EdgeRule
    weights : ndarray, shape (n_cells, q)
        Quadrature weights.
    full : PointTable
        Gauss and edge points, as Eq. (13) gives them.
    raw : ShapeTable
        Gauss points with consistent gradients.
    table : ShapeTable
        After the essential transformation; what the analysis uses.
    """

    rule: EdgeRule
    weights: np.ndarray
    full: PointTable
    raw: ShapeTable
    table: ShapeTable

    @property
    def column_weights(self) -> np.ndarray:
        """The weights by columns, shape (n_columns, cells of a column * q)."""
        return self.weights.reshape(self.raw.n_groups, self.raw.group_size)


@inlined
def _place(table, cell, n_cells):
    """Column of a cell, its number of neighbours, and the rows (point, neighbour) before the cell, in
    its column and in all, were there one point in a cell."""
    cells = n_cells // (table.start.size - 1)
    column = cell // cells
    n = table.start[column + 1] - table.start[column]
    before = (cell - cells * column) * n
    return column, n, before, cells * table.start[column] + before


@inlined
def _cell_correction(grad, phi, weights, normals, n, out):
    """The shift (2, n) of one cell's gradients, which begin ``grad`` and ``phi`` (flat, as in a table);
    returns the cell's volume."""
    volume, edges = 0.0, weights.size * n
    for q in range(weights.size):
        volume += weights[q]
    # the components from a shape: where numba knows of two it makes two loops of this one
    for j in range(normals.shape[1]):
        for i in range(n):
            shift = 0.0
            for q in range(weights.size):
                shift -= weights[q] * grad[(2 * q + j) * n + i]
            for e in range(normals.shape[0]):
                shift += phi[edges + e * n + i] * normals[e, j]
            out[j, i] = shift / volume
    return volume


@compiled
def _correct(full, weights, normals, phi, grad):
    n_cells, q_count = weights.shape
    points = q_count + normals.shape[1]
    for cell in range(n_cells):
        _, n, _, s0 = _place(full, cell, n_cells)
        old_phi, old, shift = (
            full.phi[s0 * points :],
            full.grad[2 * s0 * points :],
            np.empty((2, n)),
        )
        _cell_correction(old, old_phi, weights[cell], normals[cell], n, shift)
        for q in range(q_count):
            for j in range(normals.shape[2]):
                at = (2 * q + j) * n
                for i in range(n):
                    grad[2 * s0 * q_count + at + i] = old[at + i] + shift[j, i]
        for i in range(q_count * n):
            phi[s0 * q_count + i] = old_phi[i]


@compiled
def _correct_rates(full, full_rates, weights, normals, weight_rates, normal_rates, rates):
    n_cells, q_count = weights.shape
    points = q_count + normals.shape[1]
    for cell in range(n_cells):
        column, n, before, s0 = _place(full, cell, n_cells)
        which = rates.active[rates.start[column, 0] : rates.start[column + 1, 0]]
        count = which.size
        if count == 0:
            continue
        phi = full.phi[s0 * points : (s0 + n) * points].reshape(points, n)
        grad = full.grad[2 * s0 * points : 2 * (s0 + n) * points].reshape(points, 2, n)
        at, size = full_rates.start[column, 1] + before * points * count, n * points * count
        d_phi = full_rates.phi[at : at + size].reshape(points, n, count)
        d_grad = full_rates.grad[2 * at : 2 * (at + size)].reshape(points, 2, n, count)
        at, size = rates.start[column, 1] + before * q_count * count, n * q_count * count
        new_phi = rates.phi[at : at + size].reshape(q_count, n, count)
        new_grad = rates.grad[2 * at : 2 * (at + size)].reshape(q_count, 2, n, count)
        shift = np.empty((2, n))
        volume = _cell_correction(
            full.grad[2 * s0 * points :], full.phi[s0 * points :], weights[cell], normals[cell], n,
            shift,
        )  # fmt: skip
        d_shift = np.zeros((2, n, count))
        for p in range(count):
            for q in range(q_count):
                dw = weight_rates[which[p], cell, q]
                for j in range(2):
                    for i in range(n):
                        d_shift[j, i, p] -= (
                            dw * (grad[q, j, i] + shift[j, i])
                            + weights[cell, q] * d_grad[q, j, i, p]
                        )
            for e in range(normals.shape[1]):
                for j in range(2):
                    dn = normal_rates[which[p], cell, e, j]
                    for i in range(n):
                        d_shift[j, i, p] += (
                            d_phi[q_count + e, i, p] * normals[cell, e, j]
                            + phi[q_count + e, i] * dn
                        )
        for q in range(q_count):
            for i in range(n):
                for p in range(count):
                    new_phi[q, i, p] = d_phi[q, i, p]
            for j in range(2):
                for i in range(n):
                    for p in range(count):
                        new_grad[q, j, i, p] = d_grad[q, j, i, p] + d_shift[j, i, p] / volume


@compiled
def _correct_seeds(
    full, weights, normals, phi_bar, grad_bar, full_phi_bar, full_grad_bar, weight_bar, normal_bar
):
    n_cells, q_count = weights.shape
    points, count = q_count + normals.shape[1], phi_bar.shape[1]
    for cell in range(n_cells):
        _, n, _, s0 = _place(full, cell, n_cells)
        phi = full.phi[s0 * points : (s0 + n) * points].reshape(points, n)
        grad = full.grad[2 * s0 * points : 2 * (s0 + n) * points].reshape(points, 2, n)
        shift, shift_bar = np.empty((2, n)), np.zeros((2, n, count))
        volume = _cell_correction(
            full.grad[2 * s0 * points :], full.phi[s0 * points :], weights[cell], normals[cell], n,
            shift,
        )  # fmt: skip
        here, full_here = (
            slice(s0 * q_count, (s0 + n) * q_count),
            slice(s0 * points, (s0 + n) * points),
        )
        phi_seed, out_phi = phi_bar[here], full_phi_bar[full_here]
        seed = grad_bar[2 * here.start : 2 * here.stop].reshape(q_count, 2, n, count)
        out = full_grad_bar[2 * full_here.start : 2 * full_here.stop].reshape(points, 2, n, count)
        for q in range(q_count):
            for j in range(2):
                for i in range(n):
                    for m in range(count):
                        shift_bar[j, i, m] += seed[q, j, i, m] / volume
        for i in range(q_count * n):
            for m in range(count):
                out_phi[i, m] = phi_seed[i, m]
        for q in range(q_count):
            w = weights[cell, q]
            for j in range(2):
                for i in range(n):
                    slope = grad[q, j, i] + shift[j, i]
                    for m in range(count):
                        out[q, j, i, m] = seed[q, j, i, m] - w * shift_bar[j, i, m]
                        weight_bar[cell, q, m] -= slope * shift_bar[j, i, m]
        for e in range(normals.shape[1]):
            for j in range(2):
                for i in range(n):
                    normal, value = normals[cell, e, j], phi[q_count + e, i]
                    for m in range(count):
                        out_phi[(q_count + e) * n + i, m] += shift_bar[j, i, m] * normal
                        normal_bar[cell, e, j, m] += shift_bar[j, i, m] * value


def build_cell_table(
    cloud: Cloud, mapping: CellMap, rule: EdgeRule, column: int, weights: np.ndarray, transformation
) -> CellTable:
    """Consistent shape functions at the quadrature points, transformed for essential conditions.

    Parameters
    ----------
    column : int
        Cells in succession that share a list of neighbours.
    weights : ndarray, shape (n_cells, q)
    """
    points = integration_points(mapping, rule, column)
    coordinates, full = raw_table(cloud, points)
    q = column * weights.shape[1]
    phi, grad = np.empty(full.neighbours.size * q), np.empty(2 * full.neighbours.size * q)
    _correct(full, weights, edge_normals(rule, cloud.particles), phi, grad)
    raw = ShapeTable(full.start, full.neighbours, phi, grad, q)
    table = transform_table(raw, transformation)
    return CellTable(rule, weights, PointTable(points, coordinates, full, full), raw, table)


def cell_table_rates(cloud, cells: CellTable, velocity, weight_rates, transformation, matrix_rate):
    """Rates of the cells' table along design velocities (P, n, 2).

    Parameters
    ----------
    weight_rates : ndarray, shape (P, n_cells, q)
    matrix_rate : ndarray, shape (c, u, P)
        T' of ``essential.transformation_rates``.
    """
    full_rates = raw_rates(cloud, cells.full, velocity, transformation)
    starts = full_rates.start.copy()
    starts[:, 1] = entry_starts(np.diff(starts[:, 0]), cells.raw)
    rates = TableRates(
        starts, full_rates.active, np.empty(starts[-1, 1]), np.empty(2 * starts[-1, 1])
    )
    _correct_rates(
        cells.full.raw, full_rates, cells.weights, edge_normals(cells.rule, cloud.particles),
        weight_rates, edge_normals(cells.rule, velocity), rates,
    )  # fmt: skip
    return transformed_rates(cells.raw, cells.table, rates, transformation, matrix_rate)


def cell_table_seeds(cloud, cells: CellTable, grad_bar, weight_bar, x_bar, transformation):
    """Pull seeds on the cells' gradients (grad.size, M) back to the particles.

    ``weight_bar`` (n_cells, q, M) and ``x_bar`` (n, 2, M) are added to; returns the seeds on T.
    """
    m = grad_bar.shape[1]
    phi_bar = np.zeros((cells.table.phi.size, m))
    phi_bar, grad_bar, matrix_bar = untransformed_seeds(
        cells.raw, cells.table, phi_bar, grad_bar, transformation
    )
    full = cells.full.raw
    full_phi, full_grad = np.zeros((full.phi.size, m)), np.zeros((full.grad.size, m))
    normals = edge_normals(cells.rule, cloud.particles)
    normal_bar = np.zeros((*normals.shape, m))
    _correct_seeds(
        full, cells.weights, normals, phi_bar, grad_bar, full_phi, full_grad, weight_bar, normal_bar
    )
    add_normal_seeds(cells.rule, normal_bar, x_bar)
    raw_seeds(cloud, cells.full, full_phi, full_grad, x_bar)
    return matrix_bar

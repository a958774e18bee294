"""Quadratically consistent integration: what the quadratic basis needs to show its rates.

The analysis shifts the gradients of every cell by a constant, which integrates constant stresses
exactly and leaves an error of first order in the stress otherwise: enough for the linear basis. A
quadratic basis needs one moment more (Duan, Li, Belytschko and others, Int. J. Numer. Meth. Engng
92 (2012) 399; Chen, Hillman and Rueter, ibid. 95 (2013) 387): gradients corrected by a linear field,

    sum_q w_q m_q grad~_q = sum_e m_e Phi_e n_e - sum_q w_q Phi_q grad m_q,     m = 1, x, y.

In a body of revolution w and n carry the circumference, and the radial component has the hoop row,

    sum_q w_q m_q (grad~_1 + Phi / R)_q = sum_e m_e Phi_e n_e1 - sum_q w_q Phi_q m_q,1.

Equilibrium sigma_h = sigma_11 + R sigma_11,1 + R b_1 then holds at every point, so that the hoop row
itself needs no correction (``docs/theory/axisymmetry.md``).
"""

from dataclasses import replace

import numpy as np

from seal_mdao.equilibrium.discretization import Body, Discretization, discretize
from seal_mdao.equilibrium.tangent_layout import equation_numbers, tangent_layout
from seal_mdao.rkpm.cell_areas import area_factors
from seal_mdao.rkpm.consistent_gradients import (
    CellTable,
    EdgeRule,
    around_normals,
    circumferences,
    edge_normals,
    fill_areas,
    integration_points,
)
from seal_mdao.rkpm.shape_functions import PointSet, ShapeTable, grad_rows
from seal_mdao.rkpm.tables import build_table, raw_tables
from seal_mdao.rkpm.transformed import TableTransform


def _edge_rule(cells: np.ndarray, n_edge: int, column: int) -> tuple[EdgeRule, np.ndarray]:
    """Gauss points on the edges of every cell, and their weights on an edge of length 2."""
    g, w = np.polynomial.legendre.leggauss(n_edge)
    ends = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).repeat(n_edge, axis=1)
    shares = np.tile(0.5 * np.column_stack([1 - g, 1 + g]), (len(cells), 4, 1))
    number = np.arange(ends[..., 0].size).reshape(-1, column * 4 * n_edge)
    place = (number % number.shape[1]).reshape(ends.shape[:2])
    return EdgeRule(ends, shares, shares, number, place), np.tile(w, 4)


def _corrected(weights, normals, x, x_edge, phi, phi_edge, grad):
    """Gradients of one cell, as ``grad``, with the three moments of the divergence theorem.

    Parameters
    ----------
    weights : ndarray, shape (q,)
    normals : ndarray, shape (e, 2)
        Outward normal times weight at the edge points.
    x, x_edge : ndarray, shapes (q, 2), (e, 2)
    phi, phi_edge, grad : ndarray, shapes (q, n), (e, n), (q, 2, n)
        In a body of revolution the gradients have the row Phi / R as their third one.
    """
    centre, size = x.mean(axis=0), np.sqrt(weights.sum())
    m, m_edge = (np.column_stack([np.ones(len(at)), (at - centre) / size]) for at in (x, x_edge))
    slope = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]) / size
    lack = np.einsum("el,en,ej->ljn", m_edge, phi_edge, normals)
    lack -= np.einsum("q,qn,lj->ljn", weights, phi, slope)
    lack -= np.einsum("q,ql,qjn->ljn", weights, m, grad[:, :2])
    # the hoop row is part of the radial divergence
    lack[:, 0] -= np.einsum("q,ql,qjn->ln", weights, m, grad[:, 2:])
    gram = np.einsum("q,ql,qk->lk", weights, m, m)
    share = np.linalg.solve(gram, lack.reshape(3, -1)).reshape(lack.shape)
    new = grad.copy()
    new[:, :2] += np.einsum("ql,ljn->qjn", m, share)
    return new


def _of_cell(table: ShapeTable, values, components: int, cell: int, column: int) -> np.ndarray:
    """Rows (point and component, neighbour) of one cell of flat ``values``."""
    group, place = divmod(cell, column)
    size = components * table.group_size
    rows = values[table.start[group] * size : table.start[group + 1] * size]
    return rows.reshape(column, size // column, -1)[place]


def _with_areas(gauss: ShapeTable, edges: ShapeTable, grad, weights, disc) -> ShapeTable:
    """The rows of all cells, ``grad``, and those of areas behind those of each column."""
    rule, size, column = disc.body.edge_rule, disc.cells.raw.group_size, disc.body.pressure.cells
    full = np.zeros(grad_rows(gauss) * gauss.neighbours.size * size)
    for g in range(gauss.n_groups):
        own = np.concatenate(grad[g * column : (g + 1) * column])
        first = grad_rows(gauss) * size * gauss.start[g]
        full[first : first + own.size] = own
    raw = gauss._replace(phi=np.empty(0), grad=full, group_size=size)
    factors = area_factors(weights, disc.weights).values
    normals = edge_normals(rule, disc.particles)
    fill_areas(raw, edges, rule.point_of, weights, normals, factors)
    return raw


def discretize_quadratic(body: Body, particles, terms=(), n_edge: int = 3) -> Discretization:
    """As ``discretize``, with quadratically consistent gradients at the quadrature points."""
    disc = discretize(body, particles)
    column = body.pressure.cells
    rule, reference = _edge_rule(body.cells, n_edge, column)
    # with the points of the rows of areas
    points, of_areas = integration_points(body.cell_map, body.edge_rule, body.axisymmetric)
    ends, shares = (own.reshape(-1, 2) for own in (rule.ends, rule.weights))
    on_edges = PointSet(ends, shares, column * 4 * n_edge, sloped=False)
    gauss, edges, of_areas = raw_tables(
        disc.cloud, points._replace(valued=True), on_edges, of_areas
    )
    weights = disc.weights * circumferences(gauss, disc.weights.shape)
    normals, grad = reference[:, None] * around_normals(rule, gauss), []
    for cell in range(len(body.cells)):
        places = [own.coordinates.reshape(len(body.cells), -1, 2)[cell] for own in (gauss, edges)]
        phi, phi_edge = (_of_cell(own.raw, own.raw.phi, 1, cell, column) for own in (gauss, edges))
        slope = _of_cell(gauss.raw, gauss.raw.grad, grad_rows(gauss.raw), cell, column)
        slope = slope.reshape(len(phi), grad_rows(gauss.raw), -1)
        new = _corrected(weights[cell], normals[cell], *places, phi, phi_edge, slope)
        grad.append(new.ravel())
    raw = _with_areas(gauss.raw, of_areas.raw, grad, weights, disc)
    transform = TableTransform(raw, disc.transformation)
    cells = CellTable(
        body.cell_map, rule, disc.weights, gauss, edges, raw, transform.table, transform
    )
    where = [term.point_set() for term in terms]
    tables = [p and build_table(disc.cloud, p, disc.transformation) for p in where]
    couples = tuple(term.couples for term in terms)
    every = [
        cells.raw,
        *(table.raw for table, own in zip(tables, couples, strict=True) if table and own),
    ]
    equations = equation_numbers(body.fixed, every, disc.transformation)
    layout = tangent_layout(equations, every, disc.transformation)
    return replace(disc, cells=cells, tables=tuple(tables), couples=couples, layout=layout)

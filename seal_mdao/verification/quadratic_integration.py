"""Quadratically consistent integration: what the quadratic basis needs to show its rates.

The analysis shifts the gradients of every cell by a constant, which integrates constant stresses
exactly and leaves an error of first order in the stress otherwise: enough for the linear basis. A
quadratic basis needs one moment more (Duan, Li, Belytschko and others, Int. J. Numer. Meth. Engng
92 (2012) 399; Chen, Hillman and Rueter, ibid. 95 (2013) 387): gradients corrected by a linear field,

    sum_q w_q m_q grad~_q = sum_e m_e Phi_e n_e - sum_q w_q Phi_q grad m_q,     m = 1, x, y.
"""

from dataclasses import replace

import numpy as np

from seal_mdao.analysis.body import Body, Discretization, discretize
from seal_mdao.analysis.equations import equation_numbers, tangent_layout
from seal_mdao.rkpm.integration import CellTable
from seal_mdao.rkpm.shape_functions import PointSet, ShapeTable
from seal_mdao.rkpm.tables import PointTable, build_table, raw_table, transform_table


def _points(body: Body, n_edge: int) -> tuple[PointSet, np.ndarray, np.ndarray]:
    """Gauss points followed by edge points of every cell, edge ends and reference weights."""
    g, w = np.polynomial.legendre.leggauss(n_edge)
    mapping, m = body.cell_map, len(body.cells)
    q = mapping.n_points
    ends = np.stack([body.cells, np.roll(body.cells, -1, axis=1)], axis=2).repeat(n_edge, axis=1)
    size = q + ends.shape[1]
    anchors, weights = np.empty((m, size, 4), int), np.zeros((m, size, 4))
    anchors[:, :q], weights[:, :q] = mapping.cells[:, None], mapping.values
    anchors[:, q:] = np.tile(ends, (1, 1, 2))
    weights[:, q:, :2] = np.tile(0.5 * np.column_stack([1 - g, 1 + g]), (4, 1))
    group = body.pressure.cells * size
    return PointSet(anchors.reshape(-1, 4), weights.reshape(-1, 4), group), ends, np.tile(w, 4)


def _corrected(weights, normals, x, phi, grad):
    """Gradients (q, 2, n) of one cell with the three moments of the divergence theorem.

    Parameters
    ----------
    weights : ndarray, shape (q,)
    normals : ndarray, shape (e, 2)
        Outward normal times weight at the edge points.
    x : ndarray, shape (q + e, 2)
    phi, grad : ndarray, shapes (q + e, n), (q + e, 2, n)
        Gauss points first.
    """
    q, size = len(weights), np.sqrt(weights.sum())
    m = np.column_stack([np.ones(len(x)), (x - x[:q].mean(axis=0)) / size])
    slope = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]) / size
    lack = np.einsum("el,en,ej->ljn", m[q:], phi[q:], normals)
    lack -= np.einsum("q,qn,lj->ljn", weights, phi[:q], slope)
    lack -= np.einsum("q,ql,qjn->ljn", weights, m[:q], grad[:q])
    gram = np.einsum("q,ql,qk->lk", weights, m[:q], m[:q])
    share = np.linalg.solve(gram, lack.reshape(3, -1)).reshape(lack.shape)
    return grad[:q] + np.einsum("ql,ljn->qjn", m[:q], share)


def discretize_quadratic(body: Body, particles, terms=(), n_edge: int = 3) -> Discretization:
    """As ``discretize``, with quadratically consistent gradients at the quadrature points."""
    disc = discretize(body, particles)
    points, ends, reference = _points(body, n_edge)
    x, full = raw_table(disc.cloud, points)
    column = body.pressure.cells
    q, size = disc.weights.shape[1], points.group_size // column
    edge = disc.particles[ends[..., 1]] - disc.particles[ends[..., 0]]
    normals = 0.5 * reference[:, None] * np.stack([edge[..., 1], -edge[..., 0]], axis=-1)
    phi, grad = [], []
    for cell in range(len(body.cells)):
        group, place = divmod(cell, column)
        rows = slice(full.start[group] * column * size, full.start[group + 1] * column * size)
        here = full.phi[rows].reshape(column, size, -1)[place]
        slope = full.grad[2 * rows.start : 2 * rows.stop].reshape(column, size, 2, -1)[place]
        places = x[cell * size : (cell + 1) * size]
        phi.append(here[:q].ravel())
        grad.append(_corrected(disc.weights[cell], normals[cell], places, here, slope).ravel())
    raw = ShapeTable(
        full.start, full.neighbours, np.concatenate(phi), np.concatenate(grad), column * q
    )
    cells = CellTable(
        body.edge_rule, disc.weights, PointTable(points, x, full, full), raw,
        transform_table(raw, disc.transformation),
    )  # fmt: skip
    where = [term.point_set() for term in terms]
    tables = [p and build_table(disc.cloud, p, disc.transformation) for p in where]
    couples = tuple(term.couples for term in terms)
    every = [
        cells.raw,
        *(table.raw for table, own in zip(tables, couples, strict=True) if table and own),
    ]
    equations = equation_numbers(body.fixed, every, disc.transformation)
    layout = tangent_layout(equations, every, disc.transformation, body.solver)
    return replace(disc, cells=cells, tables=tuple(tables), couples=couples, layout=layout)

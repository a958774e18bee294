"""Fields of a solved body: values at arbitrary points, deformation gradients, stresses, errors."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from seal_mdao.analysis.body import Discretization
from seal_mdao.materials.mooney_rivlin import MooneyRivlin, cofactor
from seal_mdao.rkpm.cells import cell_map, quadrature_points, quadrature_weights
from seal_mdao.rkpm.shape_functions import PointSet, ShapeTable
from seal_mdao.rkpm.tables import build_table


class Operators(NamedTuple):
    """Shape functions of all points of a table as sparse matrices (points, particles).

    Attributes
    ----------
    value, by_x, by_y : csr_array
    """

    value: csr_array
    by_x: csr_array
    by_y: csr_array

    def gradient(self, d: np.ndarray) -> np.ndarray:
        """du_i / dX_j of coefficients ``d`` (n, 2), shape (points, 2, 2)."""
        return np.stack([self.by_x @ d, self.by_y @ d], axis=-1)


def operators(table: ShapeTable, n_particles: int) -> Operators:
    """The flat table (group, point, component, neighbour) as sparse matrices."""
    q, counts = table.group_size, np.diff(table.start)
    rows = np.repeat(np.arange(table.n_groups * q), np.repeat(counts, q))
    group = rows // q
    begin = np.repeat(table.start[:-1], q) * q + np.tile(np.arange(q), len(counts)) * np.repeat(
        counts, q
    )
    local = np.arange(rows.size) - begin[rows]
    columns = table.neighbours[table.start[group] + local]
    slope = 2 * begin[rows] + local
    shape = (table.n_groups * q, n_particles)
    values = (table.phi, table.grad[slope], table.grad[slope + counts[group]])
    return Operators(*(csr_array((v, (rows, columns)), shape=shape) for v in values))


def domain_rule(disc: Discretization, n_gauss: int) -> tuple[PointSet, np.ndarray]:
    """Gauss points of all cells and their weights, whatever the body itself integrates with."""
    mapping = cell_map(disc.body.cells, n_gauss)
    return quadrature_points(mapping), quadrature_weights(mapping, disc.particles).ravel()


def operators_at(disc: Discretization, points: PointSet) -> Operators:
    """Shape functions with their own (uncorrected) gradients at any points."""
    table = build_table(disc.cloud, points, disc.transformation).table
    return operators(table, disc.body.n_particles)


def deformation_gradients(disc: Discretization, d: np.ndarray) -> np.ndarray:
    """F at the quadrature points of the analysis, shape (n_cells, q, 2, 2)."""
    gradient = operators(disc.cells.table, disc.body.n_particles).gradient(d)
    return (np.eye(2) + gradient).reshape(*disc.weights.shape, 2, 2)


def cell_pressures(disc: Discretization, material: MooneyRivlin, d: np.ndarray) -> np.ndarray:
    """Projected volumetric stress K (J_c - 1) of every cell, tension positive, shape (n_cells,)."""
    h = deformation_gradients(disc, d) - np.eye(2)
    change = h[..., 0, 0] + h[..., 1, 1] + np.linalg.det(h)
    w = disc.weights
    return material.bulk_modulus * (w * change).sum(axis=1) / w.sum(axis=1)


def piola_stresses(disc: Discretization, material: MooneyRivlin, d: np.ndarray) -> np.ndarray:
    """First Piola-Kirchhoff stress that the analysis integrates, shape (n_cells, q, 2, 2)."""
    F = deformation_gradients(disc, d)
    pressure = cell_pressures(disc, material, d)
    return material.stress(F) + pressure[:, None, None, None] * cofactor(F)


def cauchy_stresses(disc: Discretization, material: MooneyRivlin, d: np.ndarray) -> np.ndarray:
    """Cauchy stress P F^T / J at the quadrature points, shape (n_cells, q, 2, 2)."""
    F = deformation_gradients(disc, d)
    P = piola_stresses(disc, material, d)
    return P @ np.swapaxes(F, -1, -2) / np.linalg.det(F)[..., None, None]

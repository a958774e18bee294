"""Strain energy as a result of measures: its derivatives at a converged step.

E = sum_q w W + sum_h K/2 V_h s_h^2,    s_h of ``deformation``,    e = J - 1 + c

dE/dd   = internal force
dE/dw   = W + K sum_h (s_h (N_h e - n_h det(F - 1)) - N_h s_h^2 / 2)
dE/dB_j = w P_ij d_i,                 P with the projected pressure K sum_h N_h s_h
dE/da   = p_c cof G d                 of the rows of areas, p_c = K sum_h n_h s_h
dE/dB_h = w P_h d_1                   of the hoop row of a body of revolution
dE/dc   = sum_q w dW/dc,              dE/dK = sum_h V_h s_h^2 / 2
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled
from seal_mdao.rkpm.shape_functions import grad_rows
from seal_mdao.structure.deformation import determinants, plane_jacobian
from seal_mdao.structure.internal_force import W_H, piola_stress, without_quadratic


@dataclass(frozen=True, eq=False)
class BodySeeds:
    """Seeds of M measures on the strain energy and the internal forces.

    Attributes
    ----------
    energy : ndarray, shape (M,)
    force : ndarray, shape (M, n, 2)
        In the internal forces on all components, prescribed ones included.
    """

    energy: np.ndarray
    force: np.ndarray

    @property
    def used(self) -> np.ndarray:
        """Measures with seeds that are not zero, shape (M,)."""
        return (self.energy != 0.0) | self.force.any(axis=(1, 2))

    def put(self, rows, other: "BodySeeds") -> None:
        """Set the ``rows`` of measures to ``other``."""
        self.energy[rows], self.force[rows] = other.energy, other.force

    def times(self, rates) -> np.ndarray:
        """The rates of the measures, (M, P), from those of the body."""
        out = np.outer(self.energy, rates.energy()) if self.energy.any() else 0.0
        return out + rates.force(self.force)


class EnergyGradient(NamedTuple):
    """Derivatives of the strain energy at one step.

    Attributes
    ----------
    nodal : ndarray, shape (n, 2)
        On displacement coefficients, imposed ones included.
    grad : ndarray
        On B at the quadrature points and on the rows of areas, in the order of the cells' table.
    weights : ndarray, shape (n_cells, q)
        On the quadrature weights.
    constants : ndarray, shape (C,)
        On the material parameters.
    """

    nodal: np.ndarray
    grad: np.ndarray
    weights: np.ndarray
    constants: np.ndarray


def energy_gradient(term, step) -> EnergyGradient:
    """Derivatives of the strain energy of a ``StructuralTerm`` at a converged step."""
    table, weights, d = term.cells.table, term.cells.column_weights, step.d
    deformation = term.deformation_of(d[None], [step.fraction])
    bulk = term.bulk_at([step.fraction])[0]
    pressure, squares = term.pressure(deformation)[0], term.squared_volume_strain(deformation)
    of_cells = term.cell_pressure(deformation)[0]
    # dE/dw = W + K sum_h (s_h (N_h e - n_h det(F - 1)) - N_h s_h^2 / 2)
    change = deformation.f[0, ..., 4] + deformation.offset[0, :, None]
    on_weights = term.density(deformation) + pressure * change
    on_weights -= 0.5 * bulk[:, None] * squares
    on_weights -= of_cells * determinants(deformation.f[0, ..., :4] - (1.0, 0.0, 0.0, 1.0))
    grad = np.empty(table.grad.size)
    # dE/dB = w P d, point by point
    w = term.energy_derivatives(deformation)[:, 0]
    _fill_gradient(
        table, weights, deformation.f[0], deformation.areas[0], w, pressure, of_cells, d, grad
    )
    on_weights = on_weights.reshape(term.cells.weights.shape)
    constants = term.energy_by_constants(deformation)
    # dE/dd is the internal force
    return EnergyGradient(term.forces(d, step.fraction, None), grad, on_weights, constants)


@compiled
def _fill_gradient(table, weights, f, areas, w, pressure, of_cells, d, out):
    """``out``: w P_ij d_i for every neighbour and j, with p and p_c at the quadrature points."""
    q_count, rows, points = weights.shape[1], grad_rows(table), table.group_size
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        own = out[rows * s0 * points : rows * (s0 + n) * points].reshape(points, rows, n)
        own[q_count:] = 0.0
        for t in range(points - q_count):
            g, p = areas[column, t], of_cells[column, t * q_count // (points - q_count)]
            for a in range(n):
                near = table.neighbours[s0 + a]
                # dE/da = p_c cof G d
                own[q_count + t, 0, a] = p * (g[3] * d[near, 0] - g[1] * d[near, 1])
                own[q_count + t, 1, a] = p * (g[0] * d[near, 1] - g[2] * d[near, 0])
        for q in range(q_count):
            # P = 2 W_T F + (W_J + p) cof F - p_c (cof F - 1)
            w_j, own_f = w[1, column, q] + pressure[column, q], f[column, q]
            p = piola_stress(own_f, w[0, column, q], w_j)
            p = without_quadratic(p, own_f, of_cells[column, q])
            for j in range(2):
                # dE/dB_Ij = w P_ij d_Ii
                x, y = weights[column, q] * p[j], weights[column, q] * p[2 + j]
                for a in range(n):
                    near = table.neighbours[s0 + a]
                    own[q, j, a] = x * d[near, 0] + y * d[near, 1]
            if rows == 3:
                # dE/dB_Ih = w P_h d_I1,  P_h = W_h + (W_J + p) det F
                p_h = w[W_H, column, q] + w_j * plane_jacobian(f[column, q])
                for a in range(n):
                    near = table.neighbours[s0 + a]
                    own[q, 2, a] = weights[column, q] * p_h * d[near, 0]


@compiled
def add_gradient_rates(table, rates, gradient, out):
    """Add the sum of ``gradient`` times B' over all columns to ``out`` (P,)."""
    rows = grad_rows(table)
    for column in range(table.start.size - 1):
        which = rates.active[rates.start[column, 0] : rates.start[column + 1, 0]]
        count, first = which.size, rows * table.group_size * table.start[column]
        at = rows * rates.start[column, 1]
        for k in range(rows * table.group_size * (table.start[column + 1] - table.start[column])):
            # E' += dE/dB B'
            for p in range(count):
                out[which[p]] += gradient[first + k] * rates.grad[at + k * count + p]

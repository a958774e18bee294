"""Rates of the discretisation along design velocities, which all terms share."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.equilibrium.discretization import Discretization
from seal_mdao.rkpm.essential import rows_on_union, transformation_rates
from seal_mdao.rkpm.transformed import TableRates


@dataclass(frozen=True, eq=False)
class DiscretizationRates:
    """Rates of shape functions and weights along P design velocities; once per design.

    Attributes
    ----------
    matrix : ndarray, shape (c, u, P)
        T' of the essential transformation.
    cells : TableRates
    tables : tuple of TableRates or None
        Of the points of every term.
    weights : ndarray, shape (P, n_cells, q)
    """

    matrix: np.ndarray
    cells: TableRates
    tables: tuple
    weights: np.ndarray


def _matrix_rates(discretization: Discretization, velocity: np.ndarray) -> np.ndarray:
    """T' along design velocities (P, n, 2), shape (c, u, P)."""
    transformation, rows = discretization.transformation, discretization.constrained_rows
    # Phi_I(X_C)' of the constrained particles
    rates = rows.raw_rates(velocity)
    dense = np.zeros((rows.raw.neighbours.size, len(velocity)))
    # sparse in the parameters -> dense
    for g in range(rows.raw.n_groups):
        which = rates.active[rates.start[g, 0] : rates.start[g + 1, 0]]
        here = slice(rows.raw.start[g], rows.raw.start[g + 1])
        block = rates.phi[rates.start[g, 1] : rates.start[g + 1, 1]]
        dense[here, which] = block.reshape(here.stop - here.start, which.size)
    # T' from Lambda'
    return transformation_rates(
        transformation, rows_on_union(rows.raw, transformation.union, dense)
    )


def discretization_rates(discretization: Discretization, velocity) -> DiscretizationRates:
    """Compute all rates of the discretisation along design velocities (P, n, 2)."""
    matrix = _matrix_rates(discretization, velocity)
    # w' of the quadrature weights
    weights = discretization.cells.weight_rates(velocity)
    return DiscretizationRates(
        matrix,
        discretization.cells.rates(velocity, weights, matrix),
        tuple(table and table.rates(velocity, matrix) for table in discretization.tables),
        weights,
    )

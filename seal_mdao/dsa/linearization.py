"""Linearised discretisation and contact that direct and adjoint sensitivities share."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.analysis.body import Discretization, tributary_rates
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import ConvergedStep
from seal_mdao.contact.friction import contact_linearization
from seal_mdao.dsa.parameters import ParameterRates
from seal_mdao.rkpm.cells import weight_rates
from seal_mdao.rkpm.essential import rows_on_union, transformation_rates
from seal_mdao.rkpm.integration import cell_table_rates
from seal_mdao.rkpm.tables import PointTable, raw_rates, table_rates
from seal_mdao.rkpm.transformed import TableRates


@dataclass(frozen=True, eq=False)
class DiscretizationRates:
    """Rates of shape functions, weights and lengths along the design velocities; once per design.

    Attributes
    ----------
    matrix : ndarray, shape (c, u, P)
        T' of the essential transformation.
    cells, contact : TableRates
    weights : ndarray, shape (P, n_cells, q)
    length : ndarray, shape (k, P)
    """

    matrix: np.ndarray
    cells: TableRates
    contact: TableRates
    weights: np.ndarray
    length: np.ndarray


def matrix_rates(discretization: Discretization, velocity: np.ndarray) -> np.ndarray:
    """T' along design velocities (P, n, 2), shape (c, u, P)."""
    transformation, rows = discretization.transformation, discretization.constrained_rows
    rates = raw_rates(discretization.cloud, rows, velocity)
    dense = np.zeros((rows.raw.neighbours.size, len(velocity)))
    for g in range(rows.raw.n_groups):
        which = rates.active[rates.start[g, 0] : rates.start[g + 1, 0]]
        here = slice(rows.raw.start[g], rows.raw.start[g + 1])
        block = rates.phi[rates.start[g, 1] : rates.start[g + 1, 1]]
        dense[here, which] = block.reshape(here.stop - here.start, which.size)
    return transformation_rates(
        transformation, rows_on_union(rows.raw, transformation.union, dense)
    )


def discretization_rates(discretization: Discretization, velocity) -> DiscretizationRates:
    """All rates of the discretisation along design velocities (P, n, 2)."""
    body, cloud, t = discretization.body, discretization.cloud, discretization.transformation
    matrix = matrix_rates(discretization, velocity)
    weights = weight_rates(body.cell_map, cloud.particles, velocity)
    return DiscretizationRates(
        matrix,
        cell_table_rates(cloud, discretization.cells, velocity, weights, t, matrix),
        table_rates(cloud, discretization.contact, velocity, t, matrix),
        weights,
        np.ascontiguousarray(tributary_rates(body, cloud.particles, velocity).T),
    )


def point_table_rates(discretization, table: PointTable, velocity, matrix) -> TableRates:
    """Rates of one more point table (the stress particles)."""
    return table_rates(discretization.cloud, table, velocity, discretization.transformation, matrix)


def local_contact(problem: PathProblem, step: ConvergedStep, points: np.ndarray) -> np.ndarray:
    """Derivatives of force and history of the contact points ``points`` (s,), shape (s, 6, 10)."""
    out = np.empty((points.size, 6, 10))
    contact_linearization(
        problem.profile, problem.law, step.position, step.contact_x,
        problem.discretization.contact_length, step.before, points, out,
    )  # fmt: skip
    return out


def converged_factor(problem: PathProblem, step: ConvergedStep):
    """Factor of the tangent at a converged step: the kept one, or made again."""
    if step.factor is not None:
        return step.factor
    return problem.factorize_at(step)


def profile_share(step: ConvergedStep, n_steps: int) -> float:
    """Share of the final motion that the profile has made at a step."""
    return step.fraction / n_steps


def contact_input_rates(rates: ParameterRates, count: int) -> np.ndarray:
    """Rates of the contact inputs RADIUS ... FRICTION of every point, shape (count, 4, P)."""
    return np.broadcast_to(rates.contact.T, (count, 4, rates.count))

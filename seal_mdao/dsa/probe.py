"""Displacements and F at material points, which measures use directly from the solution.

u = Phi d,    F = 1 + grad Phi d
direct     u' = Phi' d + Phi d',    F' = grad Phi' d + grad Phi d'
adjoint    d_bar = Phi^T u_bar + grad Phi^T F_bar,    Phi_bar = u_bar d^T,    grad Phi_bar = F_bar d^T
"""

import numpy as np

from seal_mdao.equilibrium.discretization import Discretization
from seal_mdao.measures.measure import Seeds
from seal_mdao.rkpm.tables import PointTable
from seal_mdao.rkpm.transformed import TableRates
from seal_mdao.terms.point_rates import (
    add_displacement_rates,
    add_field,
    add_field_gradient,
    add_gradient_loads,
    add_gradient_rates,
    add_gradient_seeds,
    add_transposed,
)


class Probe:
    """Points at which measures take displacements and F: products with rates, and their transposes.

    Parameters
    ----------
    discretization : Discretization
    table : PointTable
    n_measures : int
        Columns of the seeds that are summed here; none for the direct method.
    """

    def __init__(self, discretization: Discretization, table: PointTable, n_measures: int = 0):
        self.layout, self.points, self.table = discretization.layout, table, table.table
        self.every, self.strains = np.arange(self.table.n_groups), discretization.body.strains
        self.phi_bar = np.zeros((self.table.phi.size, n_measures))
        self.grad_bar = np.zeros((self.table.grad.size, n_measures))

    # ---- direct ----

    def rates(self, shape: TableRates, step, solution, prescribed=None):
        """Rates of the displacements (s, 2, P) and of F (s, 4, P), with h (s, 5, P).

        Parameters
        ----------
        shape : TableRates
            Of the points' table.
        step : ConvergedStep
        solution : ndarray, shape (n_equations, P)
            d'.
        prescribed : ndarray, shape (2 n, P), or None
            d' of the imposed displacements.
        """
        table, count = self.table, solution.shape[1]
        moved = np.zeros((self.every.size, 2, count))
        f_rate = np.zeros((self.every.size, self.strains, count))
        # Phi' d and grad Phi' d
        add_displacement_rates(table, self.every, shape, step.d, moved)
        add_gradient_rates(table, shape, step.d, f_rate)
        # + Phi d' and grad Phi d'
        fields = [(self.layout.equations, solution)]
        if prescribed is not None:
            fields.append((self.layout.every_component.equations, prescribed))
        for equations, field in fields:
            add_field(table, self.every, equations, field, moved)
            add_field_gradient(table, equations, field, f_rate)
        return moved, f_rate

    # ---- adjoint ----

    def add_measured(self, step, seeds: Seeds, which, loads) -> None:
        """Add what measures ``which`` take of d to ``loads`` (n_equations + 1, len(which)), and keep
        their seeds on Phi and grad Phi."""
        table = self.table
        if seeds.gradient.any():
            # d_bar += grad Phi^T F_bar,  grad Phi_bar = F_bar d^T
            own = np.zeros((len(self.grad_bar), which.size))
            on_f = np.moveaxis(seeds.gradient[which], 0, 2)
            add_gradient_loads(table, on_f, self.layout.equations, loads)
            add_gradient_seeds(table, on_f, step.d, own)
            self.grad_bar[:, which] += own
        if seeds.displacement.any():
            # d_bar += Phi^T u_bar,  Phi_bar = u_bar d^T
            on_u = np.ascontiguousarray(np.moveaxis(seeds.displacement[which], 0, 2))
            add_transposed(table, self.every, self.layout.equations, on_u, loads)
            group = np.repeat(self.every, np.diff(table.start))
            self.phi_bar[:, which] += np.einsum("eim,ei->em", on_u[group], step.d[table.neighbours])

    def nodal_seeds(self, step, seeds: Seeds, which, equations, size) -> np.ndarray:
        """Seeds (size, len(which)) on the displacements of particles, placed by ``equations``."""
        out = np.zeros((size, which.size))
        on_f = np.moveaxis(seeds.gradient[which], 0, 2)
        add_gradient_loads(self.table, on_f, equations, out)
        on_u = np.ascontiguousarray(np.moveaxis(seeds.displacement[which], 0, 2))
        add_transposed(self.table, self.every, equations, on_u, out)
        return out

    def pull_back(self, particles_bar):
        """Pull the seeds back to the particles; returns those on the essential transformation."""
        return self.points.pull_back(self.phi_bar, self.grad_bar, particles_bar)

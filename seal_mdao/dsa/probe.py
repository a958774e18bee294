"""Displacements and F at material points, which measures take straight from the solution."""

import numpy as np

from seal_mdao.dsa.shape_rates import point_table_rates
from seal_mdao.equilibrium.discretization import Discretization
from seal_mdao.measures.measure import Seeds
from seal_mdao.rkpm.tables import PointTable, table_seeds
from seal_mdao.terms.point_rates import (
    add_displacement_rates,
    add_field,
    add_field_gradient,
    add_gradient_rates,
    add_gradient_seeds,
    add_transposed,
)


def probe_rates(discretization: Discretization, probe: PointTable, sweep, step, solution):
    """Rates of the displacements (s, 2, P) and of F (s, 4, P) of the points.

    Parameters
    ----------
    sweep : DirectSweep
    step : ConvergedStep
    solution : ndarray, shape (n_equations, P)
    """
    shape, velocity, layout = sweep.shape, sweep.rates.velocity, discretization.layout
    table, points = probe.table, np.arange(probe.table.n_groups)
    rates = point_table_rates(discretization, probe, velocity, shape.matrix)
    moved = np.zeros((points.size, 2, len(velocity)))
    f_rate = np.zeros((points.size, 4, len(velocity)))
    # B' d + B d' and the same with the gradients of shape functions
    add_displacement_rates(table, points, rates, step.d, moved)
    add_gradient_rates(table, rates, step.d, f_rate)
    fields, held = [(layout.equations, solution)], sweep.held(step)
    if held is not None:
        fields.append((layout.every_component.equations, held))
    for equations, field in fields:
        add_field(table, points, equations, field, moved)
        add_field_gradient(table, equations, field, f_rate)
    return moved, f_rate


class ProbeReverse:
    """Seeds of M measures on the points; the transpose of ``probe_rates``."""

    def __init__(self, discretization: Discretization, probe: PointTable, n_measures: int):
        self.discretization, self.probe = discretization, probe
        self.phi_bar = np.zeros((probe.table.phi.size, n_measures))
        self.grad_bar = np.zeros((probe.table.grad.size, n_measures))

    def add_measured(self, step, seeds: Seeds, which, loads) -> None:
        """Add seeds of the measures ``which`` to ``loads`` (n_equations + 1, len(which))."""
        table, equations = self.probe.table, self.discretization.layout.equations
        if seeds.gradient.any():
            own = np.zeros((len(self.grad_bar), which.size))
            on_f = np.moveaxis(seeds.gradient[which], 0, 2)
            add_gradient_seeds(table, on_f, step.d, equations, loads, own)
            self.grad_bar[:, which] += own
        if seeds.displacement.any():
            on_u = np.ascontiguousarray(np.moveaxis(seeds.displacement[which], 0, 2))
            every = np.arange(table.n_groups)
            add_transposed(table, every, equations, on_u, loads)
            group = np.repeat(every, np.diff(table.start))
            self.phi_bar[:, which] += np.einsum("eim,ei->em", on_u[group], step.d[table.neighbours])

    def nodal_seeds(self, step, seeds: Seeds, which, equations, size) -> np.ndarray:
        """Seeds (size, len(which)) on the displacements of particles, placed by ``equations``."""
        out, table = np.zeros((size, which.size)), self.probe.table
        unused = np.zeros((len(self.grad_bar), which.size))
        on_f = np.moveaxis(seeds.gradient[which], 0, 2)
        add_gradient_seeds(table, on_f, step.d, equations, out, unused)
        on_u = np.ascontiguousarray(np.moveaxis(seeds.displacement[which], 0, 2))
        add_transposed(table, np.arange(table.n_groups), equations, on_u, out)
        return out

    def finish(self, particles_bar):
        """Pull the seeds back to the particles; returns those on the essential transformation."""
        disc = self.discretization
        return table_seeds(
            disc.cloud, self.probe, self.phi_bar, self.grad_bar, particles_bar, disc.transformation
        )

"""The adjoint method's part of a term at points that act on each other: the transposes of
``coupled_forward``."""

from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.tables import table_seeds
from seal_mdao.terms.coupled_forward import through_points
from seal_mdao.terms.point_rates import add_displacement_seeds, add_shape_seeds, point_adjoint
from seal_mdao.terms.term import Reverse


class CoupledPlan(NamedTuple):
    """A step linearised, on its way back.

    Attributes
    ----------
    local : LocalMap
    out_bar : ndarray, shape (rows, M)
        Seeds on what the term gives.
    used : ndarray of int, shape (s,)
        Rows of the history that the next step uses.
    """

    local: NamedTuple
    out_bar: np.ndarray
    used: np.ndarray

    @property
    def count(self) -> int:
        """Columns for what is handed on."""
        return self.used.size


class CoupledReverse(Reverse):
    """Seeds on a term's points for M measures.

    Parameters
    ----------
    term : CoupledTerm
    n_measures : int
    """

    def __init__(self, term, n_measures: int):
        self.term, self.m, self.every = term, n_measures, np.arange(len(term.where))
        self.phi_bar = np.zeros((term.table.table.phi.size, n_measures))
        self.input_bar = np.zeros((term.inputs[-1].stop, n_measures))

    def no_history(self):
        return np.zeros((self.every.size, self.term.history_size, self.m))

    def prepare(self, step, following, measured, history_bar):
        term, place = self.term, self.term.place
        local = term.linearize(step.responses[place], step.fraction, step.before[place])
        out_bar = np.zeros((term.rows[-1].stop, self.m))
        out_bar[term.rows[1]] = history_bar.reshape(-1, self.m)
        used = np.empty(0, int)
        if following is not None:
            used = term.rows[1].start + term.uses_history(following.responses[place])
        return CoupledPlan(local, out_bar, used)

    def add_handed(self, plan, loads, mix):
        chosen = np.zeros((len(plan.out_bar), plan.count))
        chosen[plan.used, np.arange(plan.count)] = 1.0
        loads += through_points(self.term, plan.local.reverse(chosen)[self.term.inputs[0]])
        mix[:] = plan.out_bar[plan.used]

    def add_measured(self, plan, seeds, which, loads):
        own = np.zeros((len(plan.out_bar), which.size))
        own[self.term.rows[0]] = seeds.force[which].reshape(which.size, -1).T
        own[self.term.rows[2]] = seeds.outputs[which].reshape(which.size, -1).T
        plan.out_bar[:, which] += own
        loads += through_points(self.term, plan.local.reverse(own)[self.term.inputs[0]])

    def collect(self, plan, step, adjoints, mix, held_bar):
        term, table = self.term, self.term.table.table
        equations = term.discretization.layout.equations
        at_points = np.empty((self.every.size, 2, len(mix)))
        point_adjoint(table, self.every, adjoints, equations, at_points)
        plan.out_bar[term.rows[0]] -= (at_points @ mix).reshape(-1, self.m)
        in_bar = plan.local.reverse(plan.out_bar)
        self.input_bar += in_bar
        x_bar = np.ascontiguousarray(in_bar[term.inputs[0]]).reshape(-1, 2, self.m)
        force = step.responses[term.place].force
        add_shape_seeds(
            table, self.every, x_bar, force, step.d, adjoints, mix, equations, self.phi_bar
        )
        if held_bar is not None:
            every = term.discretization.layout.every_component.equations
            add_displacement_seeds(table, self.every, x_bar, every, held_bar)
        return in_bar[term.inputs[1]].reshape(self.every.size, term.history_size, self.m)

    def finish(self, start, history_bar, particles_bar):
        term, disc = self.term, self.term.discretization
        x, _, measure, parameters, reference = term.inputs
        if term.history_size:
            plan = self.prepare(start, None, False, history_bar)
            self.input_bar += plan.local.reverse(plan.out_bar)
        grad_bar = np.empty((0, self.m))
        matrix_bar = table_seeds(
            disc.cloud, term.table, self.phi_bar, grad_bar, particles_bar, disc.transformation
        )
        on_points = (self.input_bar[x] + self.input_bar[reference]).reshape(-1, 2, self.m)
        term.where.add_length_seeds(disc.particles, self.input_bar[measure], particles_bar)
        term.where.add_point_seeds(on_points, particles_bar)
        return self.input_bar[parameters], matrix_bar

"""The adjoint method's part of a term at single points: the transposes of ``point_forward``."""

from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.tables import table_seeds
from seal_mdao.terms.handed_on import HandedOn, add_handed_columns
from seal_mdao.terms.point_rates import add_displacement_seeds, add_shape_seeds, point_adjoint
from seal_mdao.terms.term import Reverse


class PointPlan(NamedTuple):
    """A step linearised, on its way back.

    Attributes
    ----------
    points : ndarray of int, shape (s,)
        The points that matter at this step.
    local : ndarray, shape (s, rows, columns)
    out_bar : ndarray, shape (s, rows, M)
        Seeds on what the points give.
    handed : HandedOn
    """

    points: np.ndarray
    local: np.ndarray
    out_bar: np.ndarray
    handed: HandedOn

    @property
    def count(self) -> int:
        """Columns for what is handed on."""
        return self.handed.points.size


class PointReverse(Reverse):
    """Seeds on a term's points for M measures.

    Parameters
    ----------
    term : PointTerm
    n_measures : int
    """

    def __init__(self, term, n_measures: int):
        self.term, self.m = term, n_measures
        k, m, h = len(term.where), n_measures, term.history_size
        self.every, self.remembered = np.arange(k), slice(2, 2 + h)
        self.phi_bar = np.zeros((term.table.table.phi.size, m))
        self.input_bar = np.zeros((k, term.local_shape[1], m))

    def no_history(self):
        return np.zeros((self.every.size, self.term.history_size, self.m))

    def prepare(self, step, following, measured, history_bar):
        term, response = self.term, step.responses[self.term.place]
        used = np.empty(0, int)
        if following is not None:
            used = term.uses_history(following.responses[term.place])
        touched = response.branch != 0
        touched[used] = True
        points = self.every if measured else np.flatnonzero(touched)
        local = term.linearize(response, step.fraction, step.before[term.place], points)
        out_bar = np.zeros((points.size, local.shape[1], self.m))
        out_bar[:, self.remembered] = history_bar[points]
        handed = HandedOn(np.empty(0, int), np.empty((0, 2)))
        if used.size:
            handed = term.handed_on(response, following.responses[term.place], local, points)
        return PointPlan(points, local, out_bar, handed)

    def add_handed(self, plan, loads, mix):
        if not plan.count:
            return
        at = np.searchsorted(plan.points, plan.handed.points)
        equations = self.term.discretization.layout.equations
        add_handed_columns(self.term.table.table, *plan.handed, equations, loads)
        through_x = plan.local[at][:, :, :2].transpose(0, 2, 1) @ plan.out_bar[at]
        mix[:] = (plan.handed.directions[:, :, None] * through_x).sum(axis=1)

    def add_measured(self, plan, seeds, which, loads):
        own = np.zeros((len(plan.points), plan.local.shape[1], which.size))
        own[:, :2] = np.moveaxis(seeds.force[which], 0, 2)
        own[:, 2 + self.term.history_size :] = np.moveaxis(seeds.outputs[which], 0, 2)
        plan.out_bar[:, :, which] += own
        through_x = plan.local[:, :, :2].transpose(0, 2, 1) @ own
        equations = self.term.discretization.layout.equations
        add_displacement_seeds(self.term.table.table, self.every, through_x, equations, loads)

    def collect(self, plan, step, adjoints, mix, held_bar):
        table, equations = self.term.table.table, self.term.discretization.layout.equations
        at_points = np.empty((plan.points.size, 2, len(mix)))
        point_adjoint(table, plan.points, adjoints, equations, at_points)
        plan.out_bar[:, :2] -= at_points @ mix
        in_bar = plan.local.transpose(0, 2, 1) @ plan.out_bar
        self.input_bar[plan.points] += in_bar
        x_bar = np.ascontiguousarray(in_bar[:, :2])
        force = step.responses[self.term.place].force
        add_shape_seeds(
            table, plan.points, x_bar, force, step.d, adjoints, mix, equations, self.phi_bar
        )
        if held_bar is not None:
            every = self.term.discretization.layout.every_component.equations
            add_displacement_seeds(table, plan.points, x_bar, every, held_bar)
        history_bar = self.no_history()
        history_bar[plan.points] = in_bar[:, self.remembered]
        return history_bar

    def finish(self, start, history_bar, particles_bar):
        term, disc = self.term, self.term.discretization
        if term.history_size:
            response, before = start.responses[term.place], start.before[term.place]
            local = term.linearize(response, start.fraction, before, self.every)
            self.input_bar += local[:, self.remembered].transpose(0, 2, 1) @ history_bar
        at, x_bar = self.remembered.stop, self.input_bar[:, :2]
        if term.uses_reference:
            x_bar = x_bar + self.input_bar[:, -2:]
        grad_bar = np.empty((0, self.m))
        matrix_bar = table_seeds(
            disc.cloud, term.table, self.phi_bar, grad_bar, particles_bar, disc.transformation
        )
        term.where.add_length_seeds(disc.particles, self.input_bar[:, at], particles_bar)
        term.where.add_point_seeds(x_bar, particles_bar)
        return self.input_bar[:, at + 1 : at + 1 + len(term.names)].sum(axis=0), matrix_bar

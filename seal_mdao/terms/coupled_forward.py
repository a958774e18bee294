"""The direct method's part of a term at points that act on each other."""

import numpy as np

from seal_mdao.terms.point_forward import PointSeeds
from seal_mdao.terms.point_rates import (
    add_displacement_seeds,
    add_force_rates,
    add_nodal_rates,
    add_solution_rates,
    displacement_rates,
)
from seal_mdao.terms.term import Forward


def through_points(term, on_places: np.ndarray) -> np.ndarray:
    """Columns (n_equations + 1, s) of functions of the points' places, from their derivatives
    (2 k, s) with those."""
    equations = term.discretization.layout.equations
    columns = np.zeros((term.discretization.layout.n_equations + 1, on_places.shape[1]))
    seeds = np.ascontiguousarray(on_places).reshape(len(term.where), 2, on_places.shape[1])
    add_displacement_seeds(term.table.table, np.arange(len(seeds)), seeds, equations, columns)
    return columns


class CoupledForward(Forward):
    """Rates of a term's points for P parameters.

    Parameters
    ----------
    term : CoupledTerm
    shape : DiscretizationRates
    rates : ParameterRates
    """

    def __init__(self, term, shape, rates):
        self.term, self.table_rates, self.count = term, shape.tables[term.place], rates.count
        self.velocity = term.where.velocity(rates.velocity)
        self.x, self.remembered, measure, parameters, reference = term.inputs
        self.inputs = np.zeros((reference.stop, rates.count))
        particles = term.discretization.particles
        self.inputs[measure] = term.where.length_rates(particles, rates.velocity)
        self.inputs[parameters] = rates.of(term.names)
        self.inputs[reference] = self.velocity.reshape(-1, rates.count)

    def _by_point(self, rows: np.ndarray) -> np.ndarray:
        return rows.reshape(len(self.term.where), self.term.history_size, self.count)

    def start(self, step):
        self.inputs[self.x] = self.velocity.reshape(-1, self.count)
        self.inputs[self.remembered] = 0.0
        return self._by_point(self._linearized(step).forward(self.inputs)[self.term.rows[1]])

    def _linearized(self, step):
        place = self.term.place
        return self.term.linearize(step.responses[place], step.fraction, step.before[place])

    def linearize(self, step, following, history_rates, held, load):
        local, response = self._linearized(step), step.responses[self.term.place]
        table, places = self.term.table.table, self.velocity.copy()
        displacement_rates(table, self.table_rates, step.d, places)
        if held is not None:
            add_nodal_rates(table, held, places)
        self.inputs[self.x] = places.reshape(-1, self.count)
        if history_rates is not None:
            self.inputs[self.remembered] = history_rates.reshape(-1, self.count)
        force_rate = local.forward(self.inputs)[self.term.rows[0]]
        add_force_rates(
            table, self.table_rates, response.force, force_rate.reshape(places.shape),
            response.loaded, self.term.discretization.layout.equations, load,
        )  # fmt: skip
        self._followed = None
        return local

    def handed_on(self, kept, following):
        self._used = self.term.uses_history(following.responses[self.term.place])
        chosen = np.zeros((self.term.rows[-1].stop, self._used.size))
        chosen[self.term.rows[1].start + self._used, np.arange(self._used.size)] = 1.0
        return through_points(self.term, kept.reverse(chosen)[self.x])

    def follow(self, kept, handed):
        self._followed = self._used, handed

    def follow_solution(self, kept, solution):
        places = np.zeros_like(self.velocity)
        equations = self.term.discretization.layout.equations
        add_solution_rates(self.term.table.table, equations, solution, places)
        self.inputs[self.x] += places.reshape(-1, self.count)

    def history(self, kept):
        if not self.term.history_size:
            return None
        rates = kept.forward(self.inputs)[self.term.rows[1]]
        if self._followed is not None:
            used, handed = self._followed
            rates[used] += handed
        return self._by_point(rates)

    def outputs(self, kept):
        """Rates of force and outputs, shape (2 k + places o, P)."""
        rates = kept.forward(self.inputs)
        return np.concatenate([rates[self.term.rows[0]], rates[self.term.rows[2]]])

    def contract(self, seeds: PointSeeds, outputs):
        flat = [part.reshape(len(part), -1) for part in (seeds.force, seeds.outputs)]
        return np.concatenate(flat, axis=1) @ outputs

"""The direct method's part of a term at single points: Eqs. (57), (63), (66) for contact."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.terms.handed_on import add_handed_columns, add_handed_rates
from seal_mdao.terms.point_rates import (
    add_force_rates,
    add_nodal_rates,
    add_solution_rates,
    displacement_rates,
)
from seal_mdao.terms.term import Forward


@dataclass(frozen=True, eq=False)
class PointSeeds:
    """What M measures take from a term at single points.

    Attributes
    ----------
    force : ndarray, shape (M, k, 2)
    outputs : ndarray, shape (M, k, o)
    """

    force: np.ndarray
    outputs: np.ndarray

    @property
    def used(self) -> np.ndarray:
        """Which measures take something, shape (M,)."""
        return self.force.any(axis=(1, 2)) | self.outputs.any(axis=(1, 2))

    def put(self, rows, other: "PointSeeds") -> None:
        """Set the ``rows`` of measures to ``other``."""
        self.force[rows], self.outputs[rows] = other.force, other.outputs


class Linearized(NamedTuple):
    """Local derivatives of a term's points at one step.

    Attributes
    ----------
    points : ndarray of int
        Those that matter.
    local : ndarray, shape (k, rows, columns)
        Zero at all others.
    response : PointResponse
    """

    points: np.ndarray
    local: np.ndarray
    response: tuple


class PointForward(Forward):
    """Rates of a term's points for P parameters.

    Parameters
    ----------
    term : PointTerm
    shape : DiscretizationRates
    rates : ParameterRates
    """

    def __init__(self, term, shape, rates):
        self.term, self.table_rates = term, shape.tables[term.place]
        self.velocity = term.where.velocity(rates.velocity)
        k, h = len(term.where), term.history_size
        self.inputs = np.zeros((k, term.local_shape[1], rates.count))
        at = 2 + h
        self.inputs[:, at] = term.where.length_rates(term.discretization.particles, rates.velocity)
        self.inputs[:, at + 1 : at + 1 + len(term.names)] = rates.of(term.names)
        if term.uses_reference:
            self.inputs[:, -2:] = self.velocity
        self.every, self.remembered = np.arange(k), slice(2, 2 + h)
        self.count = rates.count

    def _linearized(self, step, following=None):
        term, place = self.term, self.term.place
        response, before = step.responses[place], step.before[place]
        if following is None:
            local = term.linearize(response, step.fraction, before, self.every)
            return Linearized(self.every, local, response)
        matters = response.branch != 0
        matters[term.uses_history(following.responses[place])] = True
        points = np.flatnonzero(matters)
        local = np.zeros((len(matters), *term.local_shape))
        local[points] = term.linearize(response, step.fraction, before, points)
        return Linearized(points, local, response)

    def _rates(self, kept, rows):
        """Rates of some ``rows`` of the outputs, shape (k, r, P)."""
        own = kept.local[:, rows]
        found = np.zeros((*own.shape[:2], self.count))
        found[kept.points] = own[kept.points] @ self.inputs[kept.points]
        return found

    def start(self, step):
        inputs = self.inputs
        inputs[:, :2] = self.velocity
        inputs[:, self.remembered] = 0.0
        return self._rates(self._linearized(step), self.remembered)

    def linearize(self, step, following, history_rates, held, load):
        kept, response = self._linearized(step, following), step.responses[self.term.place]
        explicit = self.velocity.copy()
        table, equations = self.term.table.table, self.term.discretization.layout.equations
        displacement_rates(table, self.table_rates, step.d, explicit)
        if held is not None:
            add_nodal_rates(table, held, explicit)
        self.inputs[:, :2] = explicit
        self.inputs[:, self.remembered] = history_rates
        force_rate = self._rates(kept, slice(2))
        add_force_rates(
            table, self.table_rates, response.force, force_rate, response.branch, equations, load
        )
        return kept

    def handed_on(self, kept, following):
        layout = self.term.discretization.layout
        after = following.responses[self.term.place]
        self._handed = self.term.handed_on(kept.response, after, kept.local, self.every)
        columns = np.zeros((layout.n_equations + 1, self._handed.points.size))
        add_handed_columns(self.term.table.table, *self._handed, layout.equations, columns)
        return columns

    def follow(self, kept, handed):
        add_handed_rates(*self._handed, handed, self.inputs)

    def follow_solution(self, kept, solution):
        equations = self.term.discretization.layout.equations
        add_solution_rates(self.term.table.table, equations, solution, self.inputs)

    def history(self, kept):
        return self._rates(kept, self.remembered)

    def outputs(self, kept):
        """Rates of force and outputs, shape (k, 2 + o, P)."""
        return np.delete(self._rates(kept, slice(None)), self.remembered, axis=1)

    def contract(self, seeds: PointSeeds, outputs):
        taken = np.concatenate([seeds.force, seeds.outputs], axis=2)
        return np.tensordot(taken, outputs, 2)

"""Linearisation of a body with a history at one converged step: common base of relaxation and
softening.

A history law has a stress at the quadrature points that depends on the history y, and passes a history
y+ to the next step that depends on F = 1 + B d:

    direct     (w P)' += w P_y y' + ...,    y+' = y+_F : F' + y+_y y' + y+_c c',    F' = B' d + B d'
    adjoint    F_bar = y+_F y+_bar,    K^T lambda = ... + B^T F_bar,    B_bar = F_bar d^T
               y_bar = y+_y y+_bar + w P_y : e,    e = -B lambda

What the law within the step does is in K and in the block of all steps.
"""

from abc import abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao.structure.energy_gradient import BodySeeds
from seal_mdao.structure.linearized_body import BodyRates, LinearizedBody
from seal_mdao.terms.point_rates import (
    add_field_gradient,
    add_gradient_loads,
    add_gradient_rates,
    add_gradient_seeds,
)


class HistorySeeds(NamedTuple):
    """Seeds of the next step on the history, and of measures on the body.

    Attributes
    ----------
    history
    taken : BodySeeds or None
    on_law : ndarray
        What those on the history come to on what the law passes on of F: S+ of relaxation, W of
        softening, at the quadrature points.
    on_gradient : ndarray, shape (k, 4 or 5, M)
        F_bar of these.
    """

    history: object
    taken: BodySeeds | None
    on_law: np.ndarray
    on_gradient: np.ndarray


@dataclass(frozen=True, eq=False)
class HistoryRates(BodyRates):
    """Rates of a body with a history.

    Attributes
    ----------
    history : object
        Of the step before; once d' is known, what is passed to the next one.
    stress : ndarray, shape (k, 4 or 5, P), or None
        What history and its coefficients do to w P at the quadrature points.
    """

    history: object = None
    stress: np.ndarray | None = None

    def force(self, weights: np.ndarray) -> np.ndarray:
        # w . B^T of the further stress
        every = self.body.layout.every_component.equations
        out = np.zeros((every.size + 1, self.stress.shape[-1]))
        add_gradient_loads(self.body.term.cells.table, self.stress, every, out)
        return super().force(weights) + weights.reshape(len(weights), -1) @ out[:-1]


class LinearizedHistory(LinearizedBody):
    """A body with a history at one converged step."""

    # ---- the law: arrays (n_columns, q, ...) ----

    @abstractmethod
    def stress_rates(self, design, history) -> np.ndarray:
        """Compute what rates of the history do to P, and of h, at fixed F, (n_columns, q, 4 or 5, P)."""

    @abstractmethod
    def passed_rates(self, design, history, gradient):
        """Compute the rates of the history that is passed on from those of the history before and of F,
        ``gradient`` (n_columns, q, 4 or 5, P)."""

    @abstractmethod
    def law_seeds(self, history_bar) -> np.ndarray:
        """Compute ``on_law`` of seeds on the history that is passed on."""

    @abstractmethod
    def gradient_seeds(self, on_law) -> np.ndarray:
        """Compute F_bar of it, (n_columns, q, 4 or 5, M)."""

    @abstractmethod
    def pull_back_law(self, seeds: HistorySeeds, strain, design):
        """Compute the seeds on the history before, and add those on the constants.

        Parameters
        ----------
        strain : ndarray, shape (n_columns, q, 4 or 5, M)
            e.
        """

    # ---- the state ----

    @cached_property
    def response(self):
        """Response of the step."""
        return self.step.responses[self.term.index]

    @property
    def before(self):
        """History with which the step began."""
        return self.response.before

    @cached_property
    def deformation(self):
        """``Deformation`` of the step."""
        return self.term.deformation_of(self.step.d[None], [self.step.fraction])

    @property
    def f(self) -> np.ndarray:
        """F, J - 1, and h."""
        return self.deformation.f[0]

    @property
    def weights(self) -> np.ndarray:
        """w, shape (n_columns, q, 1, 1)."""
        return self.term.cells.column_weights[..., None, None]

    def _gradients(self, fields, found=None) -> np.ndarray:
        """Gradients B v of fields (equations, v), and of ``found`` (k, 4 or 5, P) beside them, shape
        (n_columns, q, 4 or 5, P)."""
        table, (columns, q, rows) = self.term.cells.table, self.f.shape
        if found is None:
            found = np.zeros((columns * q, rows - 1, fields[0][1].shape[-1]))
        for equations, field in fields:
            add_field_gradient(table, equations, field, found)
        return found.reshape(columns, q, *found.shape[1:])

    # ---- direct ----

    def rates(self, design, history, prescribed, load) -> HistoryRates:
        super().rates(design, history, prescribed, load)
        stress = self.stress_rates(design, history)
        stress *= self.weights
        stress = stress.reshape(np.prod(stress.shape[:2]), *stress.shape[2:])
        add_gradient_loads(self.term.cells.table, stress, self.layout.equations, load)
        return HistoryRates(self, design, prescribed, None, history, stress)

    def solved(self, found: HistoryRates, solution) -> HistoryRates:
        design, fields = found.design, [(self.layout.equations, solution)]
        if found.prescribed is not None:
            fields.append((self.layout.every_component.equations, found.prescribed))
        # F' = B' d + B d'
        rates = np.zeros_like(found.stress)
        add_gradient_rates(self.term.cells.table, design.grad, self.step.d, rates)
        passed = self.passed_rates(design, found.history, self._gradients(fields, rates))
        return replace(found, solution=solution, history=passed)

    def history_rates(self, found: HistoryRates):
        return found.history

    # ---- adjoint ----

    def seeds(self, history_bar, taken=None) -> HistorySeeds:
        on_law = self.law_seeds(history_bar)
        on_gradient = self.gradient_seeds(on_law)
        on_gradient = on_gradient.reshape(np.prod(on_gradient.shape[:2]), *on_gradient.shape[2:])
        return HistorySeeds(history_bar, taken, on_law, on_gradient)

    def history_loads(self, seeds: HistorySeeds) -> np.ndarray | None:
        if not seeds.on_law.any():
            return None
        loads = np.zeros((self.layout.n_equations + 1, seeds.on_gradient.shape[-1]))
        # B^T F_bar of the free components
        table = self.term.cells.table
        add_gradient_loads(table, seeds.on_gradient, self.layout.equations, loads)
        loads[-1] = 0.0
        return loads

    def pull_back(self, seeds: HistorySeeds, adjoints, mix, design, prescribed_bar):
        super().pull_back(seeds.taken, adjoints, mix, design, prescribed_bar)
        count, table = mix.shape[1], self.term.cells.table
        # e = -B lambda, and of weights on forces B w
        every = self.layout.every_component.equations
        fields = [(self.layout.equations, -adjoints[:-1] @ mix)]
        if seeds.taken is not None and seeds.taken.force.any():
            fields.append((every, np.moveaxis(seeds.taken.force, 0, 2).reshape(-1, count)))
        history = self.pull_back_law(seeds, self._gradients(fields), design)
        # B_bar = F_bar d^T
        add_gradient_seeds(table, seeds.on_gradient, self.step.d, design.grad)
        if prescribed_bar is not None:
            add_gradient_loads(table, seeds.on_gradient, every, prescribed_bar)
        return history

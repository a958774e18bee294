"""Linearisation of a body that softens at one converged step, with its history variable W_max.

With P of the elastic law, W_F = P / mu, and eta of ``materials.ogden_roxburgh``,

    direct     (w P)' += w (d eta/dW_max) W_max' P
               W_max+' = W_F : F' + dW/dc c' on the primary branch,    W_max' below it
    adjoint    F_bar = W_max+_bar W_F on the primary branch,    c_bar = W_max+_bar dW/dc
               W_max_bar = w (d eta/dW_max) P : e, and W_max+_bar below the primary branch

in the frame of ``linearized_history``.
"""

from functools import cached_property

import numpy as np

from seal_mdao.structure.internal_force import W_H
from seal_mdao.structure.linearized_history import HistorySeeds, LinearizedHistory
from seal_mdao.structure.second_stress import along_gradient, second_stress


class LinearizedSoftening(LinearizedHistory):
    """A body that softens at one converged step."""

    @cached_property
    def stress(self) -> np.ndarray:
        """P of the elastic law, and P_h, shape (n_columns, q, 4 or 5, 1)."""
        w = self.term.energy_derivatives(self.deformation)[:, 0]
        found = second_stress(self.f, w[0], w[1], *w[W_H : W_H + 1])
        return along_gradient(self.f, found[..., None])

    @property
    def energy_gradient(self) -> np.ndarray:
        """W_F and W_h."""
        # W_F = P / mu
        return self.stress / self.response.moduli[..., None, None]

    @cached_property
    def by_history(self) -> np.ndarray:
        """(d eta/dW_max) P."""
        law = self.term.material_history.law(self.response)
        return law.by_largest[..., None, None] * self.stress

    @cached_property
    def by_constants(self) -> dict:
        """Derivatives dW/dc at fixed F by the number of the parameter, where they are not zero."""
        law = self.term.material_history
        rows = law.constant_energies(self.term, self.deformation)[:, 0]
        return {number: row for number, row in enumerate(rows) if row.any()}

    @property
    def _below(self) -> np.ndarray:
        return self.response.below[..., None]

    # ---- direct ----

    def stress_rates(self, design, history):
        # P' at fixed F and constants: (d eta/dW_max) W_max' P
        return self.by_history * history[:, :, None]

    def passed_rates(self, design, history, gradient):
        # W' = W_F : F' + dW/dc c'
        energy = (self.energy_gradient * gradient).sum(axis=2)
        for number, own in self.by_constants.items():
            energy += own[..., None] * design.parameters[number]
        return np.where(self._below, history, energy)

    # ---- adjoint ----

    def law_seeds(self, history_bar):
        # W_max+ = W on the primary branch: its seed is that of W, else that of W_max
        return np.where(self._below, 0.0, history_bar)

    def gradient_seeds(self, on_law):
        # F_bar = W_F W_bar
        return self.energy_gradient * on_law[:, :, None]

    def pull_back_law(self, seeds: HistorySeeds, strain, design):
        if design.wanted:
            for number, own in self.by_constants.items():
                design.parameters[number] += np.einsum("cq,cqm->m", own, seeds.on_law)
        # W_max_bar = W_max+_bar below, and w (d eta/dW_max) P : (B lambda)
        passed = np.where(self._below, seeds.history, 0.0)
        return passed + (self.weights * self.by_history * strain).sum(axis=2)

"""Linearisation of a body that relaxes at one converged step, with its history variables.

With S, E of ``second_stress``, the coefficients k, a_i, b_i and H of ``relaxation``, and e = F',

    direct     H' = sum_i (a_i Q_i' - b_i S' + a_i' Q_i - b_i' S),    (w P)' += w (F H' + k' P(F))
               S+' = D : E' + dS/dc c',    Q_i+' = a_i Q_i' + b_i (S+' - S') + a_i' Q_i + b_i' (S+ - S)
    adjoint    e = -B lambda,    H_bar = w sym(F^T e),    G_i = Q_i+_bar + H_bar
               Q_i_bar = a_i G_i,    S_bar = -sum_i b_i G_i,    s = S+_bar + sum_i b_i Q_i+_bar
               F_bar = F (D : s),    a_i_bar = G_i : Q_i,    b_i_bar = G_i : (S+ - S)

where the coefficients depend on constants, time and temperature, b_i' and a_i'. F_bar of a step is
part of its right-hand side, K^T lambda = ... + B^T F_bar; H within the step is in K and in the block of
all steps.
"""

from functools import cached_property

import numpy as np

from seal_mdao.structure.linearized_history import HistorySeeds, LinearizedHistory
from seal_mdao.structure.relaxation import RegionRates, RelaxationHistory, advanced, carried
from seal_mdao.structure.second_stress import (
    along_gradient,
    green_rates,
    second_stress,
    stress_moduli,
)


class LinearizedRelaxation(LinearizedHistory):
    """A body that relaxes at one converged step."""

    # ---- the state: arrays (n_columns, q, ...) ----

    @cached_property
    def moduli(self) -> np.ndarray:
        """D = dS/dE."""
        return stress_moduli(self.f, self.term.energy_derivatives(self.deformation)[:, 0])

    @cached_property
    def by_constants(self) -> dict:
        """Derivatives dS/dc at fixed F by the number of the parameter, where they are not zero."""
        rows = self.term.law_derivatives(self.deformation)[:, :, 0]
        return {number: second_stress(self.f, *row) for number, row in enumerate(rows) if row.any()}

    @cached_property
    def coefficient_rates(self) -> list:
        """Derivatives of the coefficients of the regions that relax."""
        term = self.term
        return term.material_history.rates(term.names, self.before.fraction, self.step.fraction)

    def _by_cell(self, values: np.ndarray, axis: int = 0) -> np.ndarray:
        """View arrays with the axes (n_columns, q) from ``axis`` on as (n_cells, q of a cell)."""
        lead, rest = values.shape[:axis], values.shape[axis + 2 :]
        return values.reshape(*lead, *self.term.cells.weights.shape, *rest)

    def _carried(self, own: RegionRates):
        """Return Q_i (n, n_cells, q, c), and S and S+ (n_cells, q, c) in the cells of a region."""
        viscous = self._by_cell(self.before.viscous, 1)[: len(own.keep), own.at]
        both = self.before.stress, self.response.history.stress
        return viscous, *(self._by_cell(values)[own.at] for values in both)

    # ---- direct ----

    def stress_rates(self, design, history):
        # H' of the history
        out = carried(history, self.response.coefficients)
        for own in self.coefficient_rates:
            keep, take, factor = own.along(design.parameters)
            viscous, stress, law = self._carried(own)
            # sum_i (a_i' Q_i - b_i' S), and k' S+
            more = np.tensordot(viscous, keep, (0, 0))
            more += law[..., None] * factor - stress[..., None] * take.sum(axis=0)
            self._by_cell(out)[own.at] += more
        # F H' + k' P(F),  P(F) = F S
        return along_gradient(self.f, out)

    def passed_rates(self, design, history, gradient):
        # S+' = D : E' + dS/dc c'
        stress = self.moduli @ green_rates(self.f, gradient)
        for number, own in self.by_constants.items():
            stress += own[..., None] * design.parameters[number]
        # Q_i+' = a_i Q_i' + b_i (S+' - S') + a_i' Q_i + b_i' (S+ - S)
        passed = advanced(history, self.response.coefficients, stress, self.step.fraction)
        for own in self.coefficient_rates:
            keep, take, _ = own.along(design.parameters)
            viscous, stress, law = self._carried(own)
            for i in range(len(keep)):
                more = viscous[i][..., None] * keep[i] + (law - stress)[..., None] * take[i]
                self._by_cell(passed.viscous[i])[own.at] += more
        return passed

    # ---- adjoint ----

    def law_seeds(self, history_bar):
        # s = S+_bar + sum_i b_i Q_i+_bar
        take = self.response.coefficients.take[..., None, None]
        return history_bar.stress + (take * history_bar.viscous).sum(axis=0)

    def gradient_seeds(self, on_law):
        # F_bar = F (D : s)
        return along_gradient(self.f, self.moduli @ on_law)

    def pull_back_law(self, seeds: HistorySeeds, strain, design):
        # H_bar = w sym(F^T e),  G_i = Q_i+_bar + H_bar
        own, on_carried = self.response.coefficients, self.weights * green_rates(self.f, strain)
        both = seeds.history.viscous + on_carried
        self._pull_back_constants(design, seeds.on_law, both, on_carried)
        # Q_i_bar = a_i G_i,  S_bar = -sum_i b_i G_i
        keep, take = (part[..., None, None] for part in (own.keep, own.take))
        return RelaxationHistory(0.0, -(take * both).sum(axis=0), keep * both)

    def _pull_back_constants(self, design, on_stress, both, on_carried) -> None:
        """Add the seeds on constants of the laws, and on what the coefficients depend on."""
        if not design.wanted:
            return
        for number, own in self.by_constants.items():
            # s : dS/dc
            design.parameters[number] += np.einsum("cqi,cqim->m", own, on_stress)
        for own in self.coefficient_rates:
            viscous, stress, law = self._carried(own)
            # a_i_bar = G_i : Q_i,  b_i_bar = G_i : (S+ - S),  k_bar = w e : P(F) = H_bar : S+
            given = self._by_cell(both, 1)[: len(own.keep), own.at]
            on_keep = np.einsum("ncqi,ncqim->nm", viscous, given)
            on_take = np.einsum("cqi,ncqim->nm", law - stress, given)
            on_factor = np.einsum("cqi,cqim->m", law, self._by_cell(on_carried)[own.at])
            # k = e + sum_i b_i: of b_i alone, P has S+ - S, of which S+ is in k
            on_take -= on_factor
            seeds = own.keep.T @ on_keep + own.take.T @ on_take + np.outer(own.factor, on_factor)
            np.add.at(design.parameters, own.numbers, seeds)

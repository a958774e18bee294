"""Linearisation of a body that relaxes at one converged step, with what it carries along the path.

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
from seal_mdao.structure.relaxation import RelaxationHistory, advanced, carried
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
    def coefficient_rates(self) -> dict:
        """Derivatives of the coefficients by the number of the parameter."""
        found = self.term.material_history.rates(self.before.fraction, self.step.fraction)
        return {self.term.names.index(name): own for name, own in found.items()}

    # ---- direct ----

    def stress_rates(self, design, history):
        # H' of the history and of the coefficients
        on_stress = carried(history, self.response.coefficients)
        law = self.response.history.stress
        on_law = np.zeros_like(on_stress)
        for number, own in self.coefficient_rates.items():
            rate = design.parameters[number]
            on_stress += carried(self.before, own)[..., None] * rate
            on_law += (own.factor[..., None] * law)[..., None] * rate
        # F H' + k' P(F),  P(F) = F S
        return along_gradient(self.f, on_stress + on_law)

    def passed_rates(self, design, history, gradient):
        # S+' = D : E' + dS/dc c'
        stress = self.moduli @ green_rates(self.f, gradient)
        for number, own in self.by_constants.items():
            stress += own[..., None] * design.parameters[number]
        # Q_i+' = a_i Q_i' + b_i (S+' - S') + a_i' Q_i + b_i' (S+ - S)
        passed = advanced(history, self.response.coefficients, stress, self.step.fraction)
        for number, own in self.coefficient_rates.items():
            more = advanced(self.before, own, self.response.history.stress, 0.0).viscous
            passed.viscous[:] += more[..., None] * design.parameters[number]
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
        before, stress = self.before, self.response.history.stress
        # a_i_bar = G_i : Q_i,  b_i_bar = G_i : (S+ - S),  k_bar = w e : P(F) = H_bar : S+
        on_keep = np.einsum("ncqi,ncqim->ncqm", before.viscous, both)
        on_take = np.einsum("cqi,ncqim->ncqm", stress - before.stress, both)
        on_factor = np.einsum("cqi,cqim->cqm", stress, on_carried)
        # k = e + sum_i b_i: of b_i alone, P has S+ - S, of which S+ is in k
        on_take -= on_factor
        for number, own in self.coefficient_rates.items():
            design.parameters[number] += (
                np.einsum("ncq,ncqm->m", own.keep, on_keep)
                + np.einsum("ncq,ncqm->m", own.take, on_take)
                + np.einsum("cq,cqm->m", own.factor, on_factor)
            )

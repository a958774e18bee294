"""The structural form's parts of the direct and the adjoint method."""

import numpy as np

from seal_mdao.rkpm.cells import add_weight_seeds
from seal_mdao.rkpm.integration import cell_table_seeds
from seal_mdao.structure.energy_gradient import EnergySeeds, add_gradient_rates, energy_gradient
from seal_mdao.structure.internal_force import add_internal_change, assemble_internal
from seal_mdao.structure.rates import add_internal_rates
from seal_mdao.structure.seeds import add_internal_seeds
from seal_mdao.terms.blocks import is_full
from seal_mdao.terms.term import Forward, Reverse


class StructuralForward(Forward):
    """Structural fictitious loads of P parameters."""

    def __init__(self, term, shape, rates):
        self.term, self.shape = term, shape
        self.constant_rates = rates.of(term.names)

    def add_explicit(self, steps, loads):
        term, disc = self.term, self.term.discretization
        d, weights = np.array([step.d for step in steps]), disc.cells.column_weights
        deformation = term.deformation_of(d)
        add_internal_rates(
            disc.cells.table, weights, term.functions, self.shape.cells,
            self.shape.weights.reshape(-1, *weights.shape), deformation,
            term.energy_derivatives(deformation), term.bulk, d, disc.layout.equations, loads,
        )  # fmt: skip
        if self.constant_rates.any():
            self._add_constants(deformation, loads)

    def _add_constants(self, deformation, loads):
        """The force is linear in W_T, W_J and K; so its rates are forces of their rates."""
        term, disc = self.term, self.term.discretization
        by_constants = term.constant_derivatives(deformation)
        for row, rate in enumerate(self.constant_rates):
            if not rate.any():
                continue
            bulk = (term.bulk_row == row).astype(float)
            w = np.zeros((5, *deformation.square.shape))
            w[:2] = by_constants[row]
            for k, load in enumerate(loads):
                force = np.zeros(len(load))
                assemble_internal(
                    disc.cells.table, disc.cells.column_weights, term.functions, deformation, k,
                    w[:, k], bulk, disc.layout.force_scatter, force, np.empty(0),
                )  # fmt: skip
                load += np.outer(force, rate)

    def linearize(self, step, following, history_rates, held, load):
        if held is not None:
            _add_change(self.term, step, held, self.term.discretization.layout.equations, load)
        return SolvedStep(step, held)

    def follow_solution(self, kept, solution):
        kept.solution = solution

    def outputs(self, kept):
        """The step itself: the rate of its energy is formed where a measure takes it."""
        return kept

    def contract(self, seeds: EnergySeeds, outputs):
        return np.outer(seeds.energy, self._energy_rates(outputs))

    def _energy_rates(self, solved) -> np.ndarray:
        """Rates of the strain energy at a solved step, shape (P,)."""
        disc = self.term.discretization
        gradient = energy_gradient(self.term, solved.step.d)
        out = np.einsum("pcq,cq->p", self.shape.weights, gradient.weights)
        out += gradient.constants @ self.constant_rates
        add_gradient_rates(disc.cells.table, self.shape.cells, gradient.grad, out)
        free = disc.layout.equations >= 0
        out += gradient.nodal[free] @ solved.solution[disc.layout.equations[free]]
        if solved.held is not None:
            out += np.tensordot(gradient.nodal, solved.held, 2)
        return out


class SolvedStep:
    """A step under way in the direct method: the rates of its displacements."""

    def __init__(self, step, held):
        self.step, self.held, self.solution = step, held, None


def _add_change(term, step, nodal, equations, out) -> None:
    """Add K u at a converged step for displacements ``nodal`` (n, 2, P) of all particles to ``out``."""
    deformation = term.deformation_of(step.d[None])
    add_internal_change(
        term.cells.table, term.cells.column_weights, term.functions, deformation, 0,
        term.energy_derivatives(deformation)[:, 0], term.bulk, np.ascontiguousarray(nodal),
        equations, out,
    )  # fmt: skip


class StructuralPlan:
    """A step on its way back: the derivative of its energy in all displacements, where measured."""

    count = 0

    def __init__(self, step):
        self.step, self.nodal, self.energy = step, None, None


class StructuralReverse(Reverse):
    """Seeds on shape functions, weights and constants of M measures; steps are taken in blocks.

    Parameters
    ----------
    term : StructuralTerm
    n_measures : int
    by_constants : bool
        Whether derivatives with respect to any of the constants are wanted.
    """

    def __init__(self, term, n_measures: int, by_constants: bool):
        self.term, self.by_constants, disc = term, by_constants, term.discretization
        self.grad_bar = np.zeros((disc.cells.table.grad.size, n_measures))
        self.weight_bar = np.zeros((*disc.weights.shape, n_measures))
        self.parameters = np.zeros((len(term.names), n_measures))
        self.swept, self.size = [], 0

    def prepare(self, step, following, measured, history_bar):
        return StructuralPlan(step)

    def add_measured(self, plan, seeds: EnergySeeds, which, loads):
        gradient, weight = energy_gradient(self.term, plan.step.d), seeds.energy[which]
        equations = self.term.discretization.layout.equations
        free = equations >= 0
        loads[equations[free]] += np.outer(gradient.nodal[free], weight)
        self.grad_bar[:, which] += np.outer(gradient.grad, weight)
        self.weight_bar[:, :, which] += gradient.weights[..., None] * weight
        self.parameters[:, which] += np.outer(gradient.constants, weight)
        plan.nodal, plan.energy = gradient.nodal, seeds.energy

    def collect(self, plan, step, adjoints, mix, held_bar):
        layout = self.term.discretization.layout
        if held_bar is not None and plan.nodal is not None:
            held_bar[:-1] += np.outer(plan.nodal, plan.energy)
        if held_bar is not None and len(mix):
            change = np.zeros((len(held_bar), len(mix)))
            nodal = layout.gather(adjoints[:-1])
            _add_change(self.term, step, nodal, layout.every_component.equations, change)
            held_bar -= change @ mix
        if len(mix):
            self.swept.append((step, adjoints, mix))
            self.size += adjoints.nbytes
        if is_full(self.size):
            self._flush()

    def _constants(self, deformation):
        """Derivatives in the constants, rows of the bulk moduli, and room for what follows; none of
        them where they are not wanted."""
        term = self.term
        if self.by_constants:
            return term.constant_derivatives(deformation), term.bulk_row, self.parameters
        none = np.empty((0, 2, *deformation.square.shape))
        return none, np.full(len(term.bulk), -1), self.parameters[:0]

    def _flush(self):
        if not self.swept:
            return
        term, disc = self.term, self.term.discretization
        weights = disc.cells.column_weights
        steps, adjoints, mixes = zip(*self.swept, strict=True)
        d = np.array([step.d for step in steps])
        deformation = term.deformation_of(d)
        constants, bulk_row, parameters = self._constants(deformation)
        add_internal_seeds(
            disc.cells.table, weights, term.functions, deformation,
            term.energy_derivatives(deformation), constants, term.bulk, bulk_row, d,
            np.cumsum([0, *map(len, mixes)]), np.hstack(adjoints), np.vstack(mixes),
            disc.layout.equations, self.grad_bar, self.weight_bar.reshape(*weights.shape, -1),
            parameters,
        )  # fmt: skip
        self.swept, self.size = [], 0

    def finish(self, start, history_bar, particles_bar):
        self._flush()
        disc = self.term.discretization
        matrix_bar = cell_table_seeds(
            disc.cloud, disc.cells, self.grad_bar, self.weight_bar, particles_bar,
            disc.transformation,
        )  # fmt: skip
        add_weight_seeds(disc.body.cell_map, disc.particles, self.weight_bar, particles_bar)
        return self.parameters, matrix_bar

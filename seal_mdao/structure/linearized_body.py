"""Linearisation of the internal force: of a block of steps at fixed displacements, and of one step.

With the rows B = grad Phi of the quadrature points of a column of cells, weights w, stresses P with
the projected pressure, and constants c,

    f = B^T w P(F, w, c),    F = 1 + B d

direct     F' = B' d,    f' = B^T (w P)' + B'^T w P,    a'_V of Eq. (46)
adjoint    e = -B lambda,    B_bar = w P e^T + w S d^T with S = (dP/dF)^T e

Both are products with the same L = dP/dF (``column_law``), for a block of steps in each column of cells
(``force_products``). What imposed displacements do, and the strain energy, which measures may take, is
taken step by step.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.cells import add_weight_seeds
from seal_mdao.rkpm.transformed import TableRates
from seal_mdao.structure.energy_gradient import EnergySeeds, add_gradient_rates, energy_gradient
from seal_mdao.structure.force_products import (
    add_force_rates,
    add_force_seeds,
    add_tangent_product,
)
from seal_mdao.structure.internal_force import assemble_internal
from seal_mdao.terms.linearized_term import LinearizedTerm


class BodyDesign(NamedTuple):
    """Rates of what a design moves in the body, or seeds on it, in P columns.

    Attributes
    ----------
    grad : TableRates, or ndarray, shape (grad.size, P)
        Of the rows B: rates B', or seeds.
    weights : ndarray, shape (P, n_columns, q), seeds (n_columns, q, P)
        Of the quadrature weights.
    parameters : ndarray, shape (C, P)
        Of the material constants.
    wanted : bool
        Whether seeds on any of the constants are wanted.
    """

    grad: TableRates
    weights: np.ndarray
    parameters: np.ndarray
    wanted: bool = True


class CellBasis:
    """Rows B of the quadrature points, and their design derivatives."""

    def __init__(self, names: tuple, discretization):
        self.names, self.discretization = names, discretization

    def rates(self, shape, rates) -> BodyDesign:
        weights = self.discretization.cells.column_weights
        return BodyDesign(
            shape.cells, shape.weights.reshape(-1, *weights.shape), rates.of(self.names)
        )

    def no_seeds(self, count: int, wanted=()) -> BodyDesign:
        cells, n = self.discretization.cells, len(self.names)
        shapes = (cells.table.grad.size,), cells.column_weights.shape, (n,)
        zeros = (np.zeros((*shape, count)) for shape in shapes)
        return BodyDesign(*zeros, not set(wanted).isdisjoint(self.names))

    def pull_back(self, seeds: BodyDesign, particles_bar):
        disc = self.discretization
        weight_bar = seeds.weights.reshape(*disc.weights.shape, -1)
        # B_bar to the particles, by way of the consistent gradients and T
        matrix_bar = disc.cells.pull_back(seeds.grad, weight_bar, particles_bar)
        # w_bar to the particles
        add_weight_seeds(disc.body.cell_map, disc.particles, weight_bar, particles_bar)
        return matrix_bar


class BodyBlock:
    """The internal force at K converged steps; d of the steps is fixed.

    Parameters
    ----------
    term : StructuralTerm
    steps : sequence of ConvergedStep
    """

    def __init__(self, term, steps):
        self.term, self.layout = term, term.discretization.layout
        self.states = term.states(np.array([step.d for step in steps]))

    def add_rates(self, design: BodyDesign, loads) -> None:
        """f' = B^T (w P)' + B'^T w P, Eq. (46), and what the constants do."""
        equations = self.layout.equations
        add_force_rates(self.states, design.grad, design.weights, equations, loads)
        if design.parameters.any():
            self._add_constants(design.parameters, loads)

    def _add_constants(self, constant_rates, loads):
        """The force is linear in W_T, W_J and K; so its rates are forces of their rates."""
        states, by_constants = self.states, self.term.constant_derivatives(self.states.deformation)
        quadrature, w = (states.table, states.weights, states.functions), np.zeros_like(states.w)
        for row, rate in enumerate(constant_rates):
            if not rate.any():
                continue
            # f with W_T, W_J replaced by their derivatives in the constant, and K by 1 or 0
            bulk, w[:2] = (self.term.bulk_row == row).astype(float), by_constants[row]
            for k, load in enumerate(loads):
                force = np.zeros(len(load))
                assemble_internal(
                    *quadrature, states.deformation, k, w[:, k], bulk, self.layout.force_scatter,
                    force, np.empty(0),
                )  # fmt: skip
                load += np.outer(force, rate)

    def pull_back(self, adjoints, mixes, design: BodyDesign) -> None:
        """The transpose: seeds of -lambda . f on B, w and the constants."""
        term, n_steps = self.term, len(self.states.d)
        constants = np.empty((0, *self.states.w[:2].shape))
        bulk_row = np.full_like(term.bulk_row, -1)
        if design.wanted:
            constants, bulk_row = term.constant_derivatives(self.states.deformation), term.bulk_row
        add_force_seeds(
            self.states, constants, bulk_row, np.repeat(np.arange(n_steps), [*map(len, mixes)]),
            np.hstack(adjoints), np.vstack(mixes), self.layout.equations,
            (design.grad, design.weights, design.parameters[: len(constants)]),
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class BodyRates:
    """Rates of the body at a step, of which a measure may take that of the strain energy."""

    body: "LinearizedBody"
    design: BodyDesign
    prescribed: np.ndarray | None
    solution: np.ndarray | None = None

    def energy(self) -> np.ndarray:
        """E' = E_d d' + E_B B' + E_w w' + E_c c', shape (P,)."""
        gradient, design, term = self.body.energy, self.design, self.body.term
        # E_w w'
        out = np.einsum(
            "pcq,cq->p", design.weights, gradient.weights.reshape(design.weights.shape[1:])
        )
        # E_c c' and E_B B'
        out += gradient.constants @ design.parameters
        add_gradient_rates(term.cells.table, design.grad, gradient.grad, out)
        equations = term.discretization.layout.equations
        # E_d d', of free and of imposed components
        free = equations >= 0
        out += gradient.nodal[free] @ self.solution[equations[free]]
        if self.prescribed is not None:
            out += gradient.nodal.ravel() @ self.prescribed
        return out


class LinearizedBody(LinearizedTerm):
    """The body at one converged step: imposed displacements, and the strain energy as an output."""

    def __init__(self, term, step):
        self.term, self.step, self.layout = term, step, term.discretization.layout

    @cached_property
    def energy(self):
        """``EnergyGradient`` of the step."""
        return energy_gradient(self.term, self.step.d)

    def _add_change(self, nodal, equations, out) -> None:
        """Add K u for displacements u (n, 2, P) of all particles to ``out``."""
        states = self.term.states(self.step.d[None])
        add_tangent_product(states, np.ascontiguousarray(nodal), equations, out)

    # ---- direct ----

    def rates(self, design, history, prescribed, load) -> BodyRates:
        if prescribed is not None:
            nodal = prescribed.reshape(*self.layout.equations.shape, -1)
            self._add_change(nodal, self.layout.equations, load)
        return BodyRates(self, design, prescribed)

    def solved(self, found: BodyRates, solution) -> BodyRates:
        return replace(found, solution=solution)

    # ---- adjoint ----

    def seeds(self, history_bar, taken: EnergySeeds | None = None):
        return None if taken is None else taken.energy

    def measured_loads(self, taken: EnergySeeds, which) -> np.ndarray:
        loads, free = (
            np.zeros((self.layout.n_equations + 1, which.size)),
            self.layout.equations >= 0,
        )
        # E_d of the free components
        loads[self.layout.equations[free]] = np.outer(self.energy.nodal[free], taken.energy[which])
        return loads

    def pull_back(self, energy_bar, adjoints, mix, design: BodyDesign, prescribed_bar):
        if energy_bar is not None:
            # E_B, E_w, E_c; E_d of the free components is among the loads
            gradient, used = self.energy, np.flatnonzero(energy_bar)
            weights = gradient.weights.reshape(*design.weights.shape[:2], 1)
            design.grad[:, used] += np.outer(gradient.grad, energy_bar[used])
            design.weights[..., used] += weights * energy_bar[used]
            design.parameters[:, used] += np.outer(gradient.constants, energy_bar[used])
            if prescribed_bar is not None:
                prescribed_bar[:-1] += np.outer(gradient.nodal, energy_bar)
        if prescribed_bar is not None and len(mix):
            # K is symmetric
            change = np.zeros((len(prescribed_bar), len(mix)))
            self._add_change(
                self.layout.gather(adjoints[:-1]), self.layout.every_component.equations, change
            )
            prescribed_bar -= change @ mix

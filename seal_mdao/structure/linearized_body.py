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

from seal_mdao.rkpm.transformed import TableRates
from seal_mdao.structure.energy_gradient import BodySeeds, add_gradient_rates, energy_gradient
from seal_mdao.structure.force_products import (
    add_internal_force_rates,
    add_internal_force_seeds,
    add_tangent_product,
)
from seal_mdao.structure.internal_force import W_H, assemble_internal
from seal_mdao.terms.linearized_term import LinearizedTerm

_NOTHING = np.empty((0, 0, 0))


class BodyDesign(NamedTuple):
    """Rates of design dependent quantities of the body, or seeds on them, in P columns.

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
        disc.cells.add_weight_seeds(weight_bar, particles_bar)
        return matrix_bar


class BodyBlock:
    """The internal force at K converged steps; d of the steps is fixed.

    Parameters
    ----------
    term : StructuralTerm
    steps : sequence of ConvergedStep
    scatter : Scatter, optional
        Of the forces; those of the free components unless given.
    """

    def __init__(self, term, steps, scatter=None):
        self.term, self.steps, layout = term, steps, term.discretization.layout
        self.scatter = layout.force_scatter if scatter is None else scatter
        self.states = term.states(steps)

    def add_rates(self, design: BodyDesign, loads) -> None:
        """f' = B^T (w P)' + B'^T w P, Eq. (46), and what the constants do."""
        equations = self.scatter.equations
        add_internal_force_rates(self.states, design.grad, design.weights, equations, loads)
        if design.parameters.any():
            self._add_constants(design.parameters, loads)

    def _add_constants(self, constant_rates, loads):
        """The force is linear in W_T, W_J, W_h and p_h; so its rates are forces of their rates."""
        states = self.states
        by_constants = self.term.constant_derivatives(states.deformation, self.steps)
        by_pressure = self.term.pressure_rates(states.deformation)
        quadrature, w = (states.table, states.weights, states.functions), np.zeros_like(states.w)
        unit = np.ones(states.bulk.shape[1])
        for row, rate in enumerate(constant_rates):
            if not rate.any():
                continue
            # f with W_T, W_J, W_h and p_h replaced by their derivatives in the constant
            w[:2] = by_constants[row, :2]
            w[W_H : W_H + 1] = by_constants[row, 2:]
            deformation = states.deformation._replace(volume_strain=by_pressure[row])
            for k, load in enumerate(loads):
                force = np.zeros(len(load))
                assemble_internal(
                    *quadrature, deformation, k, w[:, k], unit, _NOTHING, self.scatter, force,
                    np.empty(0),
                )  # fmt: skip
                load += np.outer(force, rate)

    def pull_back(self, adjoints, mixes, design: BodyDesign) -> None:
        """The transpose: seeds of -lambda . f on B, w and the constants."""
        term, n_steps = self.term, len(self.states.d)
        constants, by_pressure = (
            np.empty((0, *self.states.w[:2].shape)),
            np.empty((0, n_steps, 0, 0)),
        )
        if design.wanted:
            constants = term.constant_derivatives(self.states.deformation, self.steps)
            by_pressure = term.pressure_rates(self.states.deformation)
        add_internal_force_seeds(
            self.states, constants, by_pressure, np.repeat(np.arange(n_steps), [*map(len, mixes)]),
            np.hstack(adjoints), np.vstack(mixes), self.scatter.equations,
            (design.grad, design.weights, design.parameters[: len(constants)]),
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class BodyRates:
    """Rates of the body at a step, of which measures may take the strain energy and the forces."""

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

    def force(self, weights: np.ndarray) -> np.ndarray:
        """w . f' of weights w (M, n, 2) on the internal forces of all components, shape (M, P)."""
        body, count = self.body, self.solution.shape[1]
        if not weights.any():
            return np.zeros((len(weights), count))
        every = body.layout.every_component
        rates = np.zeros((1, every.equations.size + 1, count))
        # f' = B^T (w P)' + B'^T w P, and what the constants do
        BodyBlock(body.term, [body.step], every).add_rates(self.design, rates)
        # K d', of free and of imposed components
        moved = body.layout.gather(self.solution)
        if self.prescribed is not None:
            moved = moved + self.prescribed.reshape(moved.shape)
        body.add_change(moved, every.equations, rates[0])
        return weights.reshape(len(weights), -1) @ rates[0, :-1]


class LinearizedBody(LinearizedTerm):
    """The body at one converged step: imposed displacements; strain energy and forces as outputs."""

    def __init__(self, term, step):
        self.term, self.step, self.layout = term, step, term.discretization.layout

    @cached_property
    def energy(self):
        """``EnergyGradient`` of the step."""
        return energy_gradient(self.term, self.step)

    def add_change(self, nodal, equations, out) -> None:
        """Add K u for displacements u (n, 2, P) of all particles to ``out``."""
        states = self.term.states([self.step])
        add_tangent_product(states, np.ascontiguousarray(nodal), equations, out)

    # ---- direct ----

    def rates(self, design, history, prescribed, load) -> BodyRates:
        if prescribed is not None:
            nodal = prescribed.reshape(*self.layout.equations.shape, -1)
            self.add_change(nodal, self.layout.equations, load)
        return BodyRates(self, design, prescribed)

    def solved(self, found: BodyRates, solution) -> BodyRates:
        return replace(found, solution=solution)

    # ---- adjoint ----

    def seeds(self, history_bar, taken: BodySeeds | None = None) -> BodySeeds | None:
        return taken

    def measured_loads(self, taken: BodySeeds, which) -> np.ndarray:
        loads, free = (
            np.zeros((self.layout.n_equations + 1, which.size)),
            self.layout.equations >= 0,
        )
        if taken.energy[which].any():
            # E_d of the free components
            nodal = np.outer(self.energy.nodal[free], taken.energy[which])
            loads[self.layout.equations[free]] = nodal
        if taken.force[which].any():
            # K w of weights w on the forces; K is symmetric
            nodal = np.moveaxis(taken.force[which], 0, 2)
            self.add_change(nodal, self.layout.equations, loads)
        return loads

    def pull_back(self, taken: BodySeeds | None, adjoints, mix, design: BodyDesign, prescribed_bar):
        if taken is not None and taken.energy.any():
            self._pull_back_energy(taken.energy, design, prescribed_bar)
        if taken is not None and taken.force.any():
            self._pull_back_force(taken.force, design, prescribed_bar)
        if prescribed_bar is not None and len(mix):
            # K is symmetric
            change = np.zeros((len(prescribed_bar), len(mix)))
            self.add_change(
                self.layout.gather(adjoints[:-1]), self.layout.every_component.equations, change
            )
            prescribed_bar -= change @ mix

    def _pull_back_energy(self, energy_bar, design: BodyDesign, prescribed_bar) -> None:
        """Add E_B, E_w, E_c to the seeds; E_d of the free components is among the loads."""
        gradient, used = self.energy, np.flatnonzero(energy_bar)
        weights = gradient.weights.reshape(*design.weights.shape[:2], 1)
        design.grad[:, used] += np.outer(gradient.grad, energy_bar[used])
        design.weights[..., used] += weights * energy_bar[used]
        design.parameters[:, used] += np.outer(gradient.constants, energy_bar[used])
        if prescribed_bar is not None:
            prescribed_bar[:-1] += np.outer(gradient.nodal, energy_bar)

    def _pull_back_force(self, force_bar, design: BodyDesign, prescribed_bar) -> None:
        """Add the seeds of w . f at fixed d; K w of the free components is among the loads."""
        every, used = self.layout.every_component, np.flatnonzero(force_bar.any(axis=(1, 2)))
        nodal, mix = np.moveaxis(force_bar[used], 0, 2), np.zeros((used.size, len(force_bar)))
        mix[np.arange(used.size), used] = 1.0
        # seeds of -lambda . f with lambda = -w
        adjoints = np.zeros((every.equations.size + 1, used.size))
        adjoints[:-1] = -nodal.reshape(-1, used.size)
        BodyBlock(self.term, [self.step], every).pull_back([adjoints], [mix], design)
        if prescribed_bar is not None:
            change = np.zeros_like(adjoints)
            self.add_change(nodal, every.equations, change)
            prescribed_bar += change @ mix

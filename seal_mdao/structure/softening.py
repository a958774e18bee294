"""Softening of the regions of a body: the largest previous energy at every quadrature point.

    P = eta(W, W_max) mu dW/dF + p J F^-T,    W_max+ = max(W_max, W)

with W of the isochoric law without the factor mu of its moduli over the temperature, so that heat alone
does not soften, and eta of ``materials.ogden_roxburgh``. Within a load step the law is an elastic one
of the energy mu phi(W, W_max) with the W_max of the steps before, and with U = mu W

    phi_T = eta U_T,    phi_TT = eta U_TT + (d eta/dW) U_T U_T / mu,    ...

A point is on its primary branch (W >= W_max, eta = 1), or below it, as a contact point sticks or slips;
the stress is continuous between them.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao.materials import stretch_and_growth
from seal_mdao.materials.hoop_stretch import is_isochoric
from seal_mdao.materials.ogden_roxburgh import is_below, softened, step_potential
from seal_mdao.structure.internal_force import W_H, W_HH, W_JH, W_TH

_NO_BRANCH = np.empty(0, int)
_NOTHING = np.empty((0, 0, 0))
_SLOPES = [0, 1, W_H]
"""Rows W_T, W_J, W_h."""
_SECOND = ((2, 0, 0), (3, 0, 1), (4, 1, 1), (W_TH, 0, W_H), (W_JH, 1, W_H), (W_HH, W_H, W_H))
"""Rows of second derivatives, each with those of the two first ones."""


@dataclass(frozen=True, eq=False)
class SofteningResponse:
    """Response of the structural form of a body that softens.

    Attributes
    ----------
    fraction : float
        Path parameter.
    before : ndarray, shape (n_columns, q)
        W_max with which the step began.
    energy : ndarray, shape (n_columns, q)
        W.
    moduli : ndarray, shape (n_columns, q)
        mu.
    """

    fraction: float
    before: np.ndarray
    energy: np.ndarray
    moduli: np.ndarray
    branch = _NO_BRANCH
    unconverged = 0

    def copied(self):
        """Return the response itself, whose arrays are not overwritten."""
        return self

    @property
    def below(self) -> np.ndarray:
        """Points that are not on their primary branch, shape (n_columns, q)."""
        return is_below(self.energy, self.before)

    @cached_property
    def history(self) -> np.ndarray:
        """W_max that is passed to the next step."""
        # max(W_max, W)
        return np.where(self.below, self.before, self.energy)


class PointConstants(NamedTuple):
    """Constants of the law at the quadrature points, shape (n_columns, q); r is infinite where rubber
    does not soften."""

    r: np.ndarray
    m: np.ndarray
    beta: np.ndarray


class Softening:
    """Softening of an ``ElasticBody`` on one design: a ``MaterialHistory``.

    Parameters
    ----------
    definition : ElasticBody
    cells : CellTable

    Raises
    ------
    ValueError
        Beside relaxation or an axial stretch, or of a compressible law.
    """

    def __init__(self, definition, cells):
        _refuse(definition)
        self.definition, self.cells = definition, cells
        shape = self.cells.weights.shape
        # r infinite: eta = 1
        found = PointConstants(np.full(shape, np.inf), np.ones(shape), np.zeros(shape))
        for region in definition.regions:
            if region.softening is not None:
                for row, value in zip(found, region.softening.constants.values(), strict=True):
                    row[region.at] = value
        points = cells.column_weights.shape
        self.constants = PointConstants(*(row.reshape(points) for row in found))

    def no_history(self, *count: int) -> np.ndarray:
        """W_max = 0 of the undeformed state; with a ``count`` of columns, rates that are zero."""
        return np.zeros((*self.cells.column_weights.shape, *count))

    def law(self, response: SofteningResponse):
        """Evaluate eta and its derivatives, ``Softened``, at the end of a step."""
        return softened(response.energy, response.before, *self.constants)

    # ---- the law of a step ----

    def respond(self, term, w, fraction, history):
        moduli = self._moduli(term, fraction)
        # U = mu W: the law softens with W, without the factor of the temperature
        energy = term.density(term.deformation) / moduli
        response = SofteningResponse(fraction, history, energy, moduli)
        return response, self._step_derivatives(w[:, None], [response])[:, 0], _NOTHING

    def _moduli(self, term, fraction: float) -> np.ndarray:
        """Evaluate mu at the quadrature points, shape (n_columns, q)."""
        out = np.ones(self.cells.weights.shape)
        for region in self.definition.regions:
            own = term.conditions(region, [fraction]).conditions
            if own is not None:
                out[region.at] = own.factor.ravel()
        return out.reshape(self.cells.column_weights.shape)

    def at_steps(self, w, responses):
        return self._step_derivatives(w, responses), _NOTHING[None]

    def _step_derivatives(self, w, responses) -> np.ndarray:
        """Differentiate mu phi at K steps from the derivatives ``w`` of U, (5 or 9, K, n_columns, q)."""
        laws = [self.law(response) for response in responses]
        factor = np.array([law.factor for law in laws])
        # (d eta/dW) / mu
        slope = np.array(
            [law.by_energy / own.moduli for law, own in zip(laws, responses, strict=True)]
        )
        # phi_T = eta U_T, ...
        out = w * factor
        for row, one, other in _SECOND:
            if row < len(w):
                # phi_TT = eta U_TT + (d eta/dW) U_T U_T / mu, ...
                out[row] += slope * w[one] * w[other]
        return out

    def constant_energies(self, term, deformation) -> np.ndarray:
        """Differentiate W in every parameter at K fields, shape (C, K, n_columns, q)."""
        out = np.zeros((len(term.names), *deformation.square.shape))
        by_cell = term.by_cell(out)
        for region, state in term.by_region(deformation):
            rows = stretch_and_growth.constant_energies(region.material, state, None)
            for name, row in zip(region.names, rows, strict=True):
                by_cell[term.names.index(name)][:, region.at] += row
        return out

    def constant_derivatives(self, term, deformation, rows, responses):
        w = term.energy_derivatives(deformation)
        slopes = w[_SLOPES[: rows.shape[1]]]
        energies, out = self.constant_energies(term, deformation), np.empty_like(rows)
        for k, response in enumerate(responses):
            law = self.law(response)
            # d(eta U_T)/dc = eta dU_T/dc + (d eta/dW) (dW/dc) U_T
            out[:, :, k] = law.factor * rows[:, :, k]
            change = law.by_energy * energies[:, k]
            # + (d eta/dr) U_T, ... of the constants of softening
            for region in self.definition.regions:
                if region.softening is not None:
                    for name, own in zip(region.softening.constants, law.by_constants, strict=True):
                        number = term.names.index(region.prefix + name)
                        by_cell, rate = term.by_cell(change[number]), term.by_cell(own)
                        by_cell[region.at] += rate[region.at]
            out[:, :, k] += change[:, None] * slopes[:, k]
        return out

    def step_density(self, density, f, response):
        if response is None:
            raise ValueError(
                "the strain energy of rubber with Mullins softening cannot be computed, because it "
                "depends on the largest earlier energy; leave out measures of strain energy and of "
                "dissipated work"
            )
        moduli = response.moduli
        # mu phi(W, W_max)
        return moduli * step_potential(density / moduli, response.before, *self.constants)


def _refuse(definition) -> None:
    """Refuse bodies whose softening is not known."""
    environment = definition.environment
    if any(region.prony is not None for region in definition.regions):
        raise ValueError(
            "Mullins softening and viscoelasticity cannot be combined in one seal; leave out either"
        )
    if environment is not None and environment.axial_stretch is not None:
        raise ValueError(
            "Mullins softening cannot be combined with an axial stretch; leave out either"
        )
    for region in definition.regions:
        if region.softening is not None and not is_isochoric(region.material):
            raise ValueError(
                "Mullins softening is available for nearly incompressible rubber only, but "
                f"{type(region.material).__name__} is compressible; leave out softening"
            )

"""Relaxation of the regions of a body: history variables at the quadrature points, and
coefficients.

    Q_i+ = a_i Q_i + b_i (S+ - S),    P = k P(F+) + F+ H,    H = sum_i (a_i Q_i - b_i S)

with S of ``second_stress`` and the coefficients a_i (keep), b_i (take), k = e + sum_i b_i (factor) of
``materials.viscoelastic``. So within a load step the law is an elastic one, k W + H : C / 2, and H the
stress that is carried.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao.materials.viscoelastic import StepCoefficients
from seal_mdao.structure.environment import TEMPERATURE
from seal_mdao.structure.internal_force import W_H
from seal_mdao.structure.second_stress import components, second_stress

_NO_BRANCH = np.empty(0, int)


class RelaxationHistory(NamedTuple):
    """History that a load step passes to the next one, or rates of it, or seeds on it, in P columns
    at the end.

    Attributes
    ----------
    fraction : float
        Path parameter at the end of the step.
    stress : ndarray, shape (n_columns, q, c)
        S.
    viscous : ndarray, shape (N, n_columns, q, c)
        Q_i; zero beyond the terms of a material.
    """

    fraction: float
    stress: np.ndarray
    viscous: np.ndarray


class CellCoefficients(NamedTuple):
    """Coefficients of one load step at the quadrature points.

    Attributes
    ----------
    factor : ndarray, shape (n_columns, q)
        k; 1 in a material that does not relax.
    keep, take : ndarray, shape (N, n_columns, q)
        a_i and b_i.
    """

    factor: np.ndarray
    keep: np.ndarray
    take: np.ndarray


class RegionRates(NamedTuple):
    """Derivatives of the coefficients of a region in R parameters.

    Attributes
    ----------
    at : ndarray or slice
        Cells of the region.
    numbers : ndarray of int, shape (R,)
        Of the parameters.
    factor : ndarray, shape (R,)
    keep, take : ndarray, shape (n, R)
        With the n terms of the region's series.
    """

    at: np.ndarray | slice
    numbers: np.ndarray
    factor: np.ndarray
    keep: np.ndarray
    take: np.ndarray

    def along(self, parameters: np.ndarray):
        """Rates a_i' (n, P), b_i' (n, P) and k' (P,) along rates of all parameters (C, P)."""
        own = parameters[self.numbers]
        return self.keep @ own, self.take @ own, self.factor @ own


@dataclass(frozen=True, eq=False)
class RelaxingResponse:
    """Response of the structural form of a body that relaxes.

    Attributes
    ----------
    fraction : float
        Path parameter.
    before : RelaxationHistory
        With which the step began.
    coefficients : CellCoefficients
    f : ndarray, shape (n_columns, q, 5 or 6)
        As of ``Deformation``.
    slopes : ndarray, shape (2 or 3, n_columns, q)
        W_T, W_J, and W_h in a body of revolution.
    """

    fraction: float
    before: RelaxationHistory
    coefficients: CellCoefficients
    f: np.ndarray
    slopes: np.ndarray
    branch = _NO_BRANCH
    unconverged = 0

    def copied(self):
        """Return a copy that later assemblies do not overwrite."""
        return replace(self, f=self.f.copy())

    @cached_property
    def history(self) -> RelaxationHistory:
        """History passed to the next step."""
        stress = second_stress(self.f, *self.slopes)
        return advanced(self.before, self.coefficients, stress, self.fraction)


class Relaxation:
    """Relaxation of an ``ElasticBody`` on one design, whose environment knows the time: a
    ``MaterialHistory``.

    Parameters
    ----------
    definition : ElasticBody
    cells : CellTable
    n_components : int
        c, 3 or 4.
    """

    def __init__(self, definition, cells, n_components: int):
        self.definition, self.environment, self.cells = definition, definition.environment, cells
        self.n_components = n_components
        self.n_terms = max(len(r.prony.g) for r in definition.regions if r.prony is not None)

    def _step(self, before: float, fraction: float):
        """Duration of a step, s, and the temperature in its middle, shape (1,) each."""
        return _steps(self.environment, np.array([before, fraction]))

    def of_region(self, region, before: float, fraction: float) -> StepCoefficients | None:
        """Coefficients of one region in a step; None where it does not relax."""
        return None if region.prony is None else region.prony.step(*self._step(before, fraction))

    def rates_of_region(self, region, before: float, fraction: float) -> dict:
        """Derivatives of its coefficients by the names of the parameters."""
        if region.prony is None:
            return {}
        by_name = region.prony.step_rates(*self._step(before, fraction))
        by_time, by_heat = by_name.pop("duration"), by_name.pop("temperature", None)
        found = {region.prefix + name: own for name, own in by_name.items()}
        # of dt in the parameters of the time, and of the mean temperature in its parameter
        for name, rates in self.environment.time_rates([before, fraction]).items():
            # a step has no part in the durations of other stages
            change = np.diff(rates)
            if change.any():
                found[name] = _times(by_time, change)
        if by_heat is not None and self.environment.temperature is not None:
            ends = self.environment.temperature.rates([before, fraction])
            found[TEMPERATURE] = _times(by_heat, np.mean(ends, keepdims=True))
        return found

    def coefficients(self, before: float, fraction: float) -> CellCoefficients:
        """Coefficients of the step between two path parameters; k = 1 where nothing relaxes."""
        shape = self.cells.weights.shape
        factor = np.ones(shape)
        keep, take = (np.zeros((self.n_terms, *shape)) for _ in range(2))
        for region in self.definition.regions:
            own = self.of_region(region, before, fraction)
            if own is not None:
                count = len(own.keep)
                # k, a_i and b_i of the region; a_i = b_i = 0 beyond its terms
                factor[region.at] = own.factor[0]
                keep[:count, region.at] = own.keep[..., None]
                take[:count, region.at] = own.take[..., None]
        points = self.cells.column_weights.shape
        return CellCoefficients(
            factor.reshape(points), keep.reshape(-1, *points), take.reshape(-1, *points)
        )

    def rates(self, names, before: float, fraction: float) -> list["RegionRates"]:
        """Differentiate the coefficients of a step, which are the same at all points of a region.

        Parameters
        ----------
        names : sequence of str
            All parameters of the body.
        """
        found = []
        for region in self.definition.regions:
            own = self.rates_of_region(region, before, fraction)
            if own:
                numbers = np.array([names.index(name) for name in own])
                factor, keep, take = (
                    np.array([part[..., 0] for part in parts])
                    for parts in zip(*own.values(), strict=True)
                )
                found.append(RegionRates(region.at, numbers, factor, keep.T, take.T))
        return found

    def no_history(self, *count: int) -> RelaxationHistory:
        """History of the undeformed state; with a ``count`` of columns, rates that are zero."""
        shape = (*self.cells.column_weights.shape, self.n_components, *count)
        return RelaxationHistory(0.0, np.zeros(shape), np.zeros((self.n_terms, *shape)))

    # ---- the law of a step ----

    def respond(self, term, w, fraction, history):
        own = self.coefficients(history.fraction, fraction)
        # W_T, W_J and, in a body of revolution, W_h: the stress S+ of the step
        slopes = w[[0, 1, W_H] if len(w) > W_H else [0, 1]]
        response = RelaxingResponse(fraction, history, own, term.deformation.f[0], slopes)
        # within a step: k W + H : C / 2
        return response, w * own.factor, carried(history, own)

    def at_steps(self, w, responses):
        more = np.array([carried(own.before, own.coefficients) for own in responses])
        return w * _factors(responses), more

    def constant_derivatives(self, term, deformation, rows, responses):
        return rows * _factors(responses)

    def step_density(self, density, f, response):
        if response is None:
            raise ValueError(
                "the strain energy of a viscoelastic seal cannot be computed from its stress; "
                "leave out measures of strain energy and of dissipated work"
            )
        own = response.coefficients
        f11, f12, f21, f22 = np.moveaxis(f[..., :4], -1, 0)
        # C_11, C_22, 2 C_12, and h^2
        stretch = [f11 * f11 + f21 * f21, f12 * f12 + f22 * f22, 2.0 * (f11 * f12 + f21 * f22)]
        if components(f) == 4:
            stretch.append(f[..., 5] ** 2)
        # k W + H : C / 2, the potential of the step
        stored = (carried(response.before, own) * np.stack(stretch, axis=-1)).sum(axis=-1)
        return own.factor * density + 0.5 * stored


def _factors(responses) -> np.ndarray:
    """Factors k of the law at K steps, (K, n_columns, q)."""
    return np.array([own.coefficients.factor for own in responses])


def _steps(environment, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Durations of the steps between path parameters (K + 1,), s, and temperatures in their middle."""
    duration, temperature = np.diff(environment.time.at(ends)), environment.temperature
    if temperature is None:
        # any number, as no material has a shift
        return duration, np.zeros(len(duration))
    return duration, _middle(temperature.at(ends))


def _middle(at_ends: np.ndarray) -> np.ndarray:
    """Means of neighbouring values (K + 1,), shape (K,)."""
    return 0.5 * (at_ends[:-1] + at_ends[1:])


def relaxed_modulus(region, environment, ends: np.ndarray) -> tuple[float, dict[str, float]]:
    """Compute G(t) / G of the law of a region that relaxes, for a strain that is kept since the start.

    Parameters
    ----------
    region : Region
    environment : Environment
    ends : ndarray, shape (K + 1,)
        Path parameters at the start and after every load step up to the time t.

    Returns
    -------
    float
    dict of str to float
        Its derivatives by the names of the parameters.
    """
    factor, by_name = region.prony.relaxed(*_steps(environment, ends))
    by_time, by_heat = by_name.pop("duration"), by_name.pop("temperature", None)
    found = {region.prefix + name: own for name, own in by_name.items()}
    for name, rates in environment.time_rates(ends).items():
        found[name] = float(by_time @ np.diff(rates))
    if by_heat is not None and environment.temperature is not None:
        found[TEMPERATURE] = float(by_heat @ _middle(environment.temperature.rates(ends)))
    return factor, found


def _times(own: StepCoefficients, rate) -> StepCoefficients:
    return StepCoefficients(*(part * rate for part in own))


def _spread(coefficient: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Coefficients (..., n_columns, q) as factors of ``values`` with further axes."""
    return coefficient.reshape(*coefficient.shape, *(1,) * (values.ndim - coefficient.ndim))


def carried(history: RelaxationHistory, own: CellCoefficients) -> np.ndarray:
    """Compute H = sum_i (a_i Q_i - b_i S), or its rates from those of the history."""
    # sum_i a_i Q_i - (sum_i b_i) S
    keep, total = _spread(own.keep, history.viscous), _spread(own.take.sum(axis=0), history.stress)
    return (keep * history.viscous).sum(axis=0) - total * history.stress


def advanced(
    history: RelaxationHistory, own: CellCoefficients, stress: np.ndarray, fraction: float
) -> RelaxationHistory:
    """Compute the history after a step that ends with the ``stress`` S+, or its rates from theirs."""
    # Q_i+ = a_i Q_i + b_i (S+ - S)
    keep, take = (_spread(part, history.viscous) for part in (own.keep, own.take))
    viscous = keep * history.viscous + take * (stress - history.stress)
    return RelaxationHistory(fraction, stress, viscous)

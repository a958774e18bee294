"""Environment of a body along the path: axial stretch, temperature, swelling, time.

A material at the temperature T grows freely by theta = (1 + alpha (T - T_0)) S^(1/3), with its expansion
alpha and the ratio S of its volume swollen and dry, and its moduli have the factor m(T). A long section
is stretched along its axis by h. See ``materials.stretch_and_growth`` for the energy.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from seal_mdao.materials.stretch_and_growth import Conditions
from seal_mdao.terms.ramp import Ramp, StageTimes
from seal_mdao.terms.term import Scalar

AXIAL_STRETCH, TEMPERATURE = "axial_stretch", "temperature"
TIME, DURATION = "time", "duration_{}"
"""Names of the parameters of all durations, and of that of a stage, from 1 on."""
EXPANSION, SWELLING = "expansion", "swelling"


@dataclass(frozen=True, eq=False)
class Environment:
    """Axial stretch, temperature and time of the complete body.

    Attributes
    ----------
    axial_stretch : Ramp, optional
        h along a plane section; 1 unless given.
    temperature : Ramp, optional
        In degrees Celsius, from that at which the body has its shape and its materials their constants.
    time : StageTimes, optional
        Of a body that relaxes.
    """

    axial_stretch: Ramp | None = None
    temperature: Ramp | None = None
    time: StageTimes | None = None

    @property
    def scalars(self) -> dict:
        """Parameters: the values farthest from those at the start."""
        given = (
            (AXIAL_STRETCH, self.axial_stretch, None, "Stretch along the section."),
            (TEMPERATURE, self.temperature, "degC", "Temperature."),
            (TIME, self.time, "s", "Time of the complete path as given; it scales all durations."),
        )
        found = {
            name: Scalar(own.value, units, text)
            for name, own, units, text in given
            if own is not None
        }
        for number, duration in enumerate(() if self.time is None else self.time.given, 1):
            text = f"Duration of stage {number}, where {TIME} has not been changed."
            found[DURATION.format(number)] = Scalar(float(duration), "s", text)
        return found

    @property
    def _ramps(self) -> dict:
        """Quantities that change along the path, those that are given."""
        own = {name: getattr(self, name) for name in (AXIAL_STRETCH, TEMPERATURE, TIME)}
        return {name: ramp for name, ramp in own.items() if ramp is not None}

    def with_parameters(self, values: dict) -> "Environment":
        """Return the environment with some of the ``scalars`` changed."""
        own = {n: ramp.with_value(values.get(n, ramp.value)) for n, ramp in self._ramps.items()}
        if self.time is not None:
            names = [DURATION.format(number) for number in range(1, len(self.time.given) + 1)]
            pairs = zip(names, self.time.given, strict=True)
            own[TIME] = own[TIME].with_durations([values.get(name, d) for name, d in pairs])
        return replace(self, **own)

    def time_rates(self, fractions) -> dict:
        """Evaluate the derivatives of the time at path parameters (K,) in its parameters, by name."""
        rates = enumerate(self.time.rates_of_durations(fractions), 1)
        by_stage = {DURATION.format(number): own for number, own in rates}
        return {TIME: self.time.rates(fractions)} | by_stage

    def acts_on(self, growth: "Growth") -> bool:
        """Return whether the environment changes the law of a material."""
        changing = self.axial_stretch, self.temperature, growth.swelling
        return any(own is not None for own in changing)

    def with_ends(self, ends) -> "Environment":
        """Return the same environment in other load steps, whose ``ends`` are in nominal steps."""
        own = {name: ramp.with_ends(ends) for name, ramp in self._ramps.items()}
        return replace(self, **own)


@dataclass(frozen=True, eq=False)
class Growth:
    """Effects of temperature and swelling on one material.

    Attributes
    ----------
    expansion : float
        Linear coefficient alpha, 1/K.
    swelling : Ramp, optional
        Ratio S of the volumes of the swollen and the dry material; 1 unless given.
    factors : ndarray, shape (k, 2), or None
        Temperatures and the factor m of the moduli there, linear between; the bulk modulus keeps its
        value.
    """

    expansion: float = 0.0
    swelling: Ramp | None = None
    factors: np.ndarray | None = None

    @property
    def scalars(self) -> dict:
        """Parameters, without the prefix of the material."""
        found = {EXPANSION: Scalar(self.expansion, "1/degK", "Linear thermal expansion.")}
        if self.swelling is not None:
            found[SWELLING] = Scalar(self.swelling.value, None, "Ratio of swollen and dry volume.")
        return found

    def with_parameters(self, values: dict) -> "Growth":
        """Return the growth with some of the ``scalars`` changed."""
        out = replace(self, expansion=values.get(EXPANSION, self.expansion))
        if SWELLING not in values:
            return out
        return replace(out, swelling=replace(self.swelling, value=values[SWELLING]))

    def with_ends(self, ends) -> "Growth":
        """Return the same growth in other load steps, whose ``ends`` are in nominal steps."""
        return (
            self if self.swelling is None else replace(self, swelling=self.swelling.with_ends(ends))
        )

    def factor(self, temperature: np.ndarray):
        """Evaluate m and dm/dT at temperatures (K,)."""
        if self.factors is None:
            return np.ones(len(temperature)), np.zeros(len(temperature))
        at, factors = np.asarray(self.factors, float).T
        piece = np.clip(np.searchsorted(at, temperature, "right") - 1, 0, len(at) - 2)
        # m = m_k + (m_(k+1) - m_k) (T - T_k) / (T_(k+1) - T_k), continued beyond both ends
        slope = (factors[piece + 1] - factors[piece]) / (at[piece + 1] - at[piece])
        return factors[piece] + slope * (temperature - at[piece]), slope

    def corners(self, temperature: np.ndarray) -> np.ndarray:
        """Select the temperatures (K,) at which the slope of m changes: inner points of its table."""
        if self.factors is None:
            return temperature[:0]
        at, factors = np.asarray(self.factors, float).T
        slopes = np.diff(factors) / np.diff(at)
        return temperature[np.isin(temperature, at[1:-1][slopes[1:] != slopes[:-1]])]


class RegionConditions(NamedTuple):
    """Conditions of one region at K path parameters.

    Attributes
    ----------
    conditions : Conditions or None
        Arrays (K, 1, 1); None in a body that has no environment.
    rates : dict of str to ndarray, shape (3, K, 1, 1)
        Derivatives of h, theta and m in the parameters, by their names with the region's prefix.
    """

    conditions: Conditions | None
    rates: dict


NO_CONDITIONS = RegionConditions(None, {})


def region_conditions(environment: Environment, growth: Growth, prefix: str, fractions):
    """Evaluate the ``RegionConditions`` of a material at path parameters (K,)."""
    count = len(fractions)
    zeros, rates = np.zeros(count), {}
    h = np.ones(count)
    if environment.axial_stretch is not None:
        # of h alone: dh
        h = environment.axial_stretch.at(fractions)
        rates[AXIAL_STRETCH] = environment.axial_stretch.rates(fractions), zeros, zeros
    # theta = (1 + alpha (T - T_0)) S^(1/3)
    heating, temperature, ratio = zeros, environment.temperature, np.ones(count)
    if growth.swelling is not None:
        ratio = growth.swelling.at(fractions)
    factor, swollen = np.ones(count), np.cbrt(ratio)
    if temperature is not None:
        hot = temperature.at(fractions)
        heating, (factor, slope) = hot - temperature.start, growth.factor(hot)
        r = temperature.rates(fractions)
        # d theta = alpha S^(1/3) dT, dm = m' dT;  d theta/d alpha = (T - T_0) S^(1/3)
        rates[TEMPERATURE] = zeros, growth.expansion * swollen * r, slope * r
        rates[prefix + EXPANSION] = zeros, heating * swollen, zeros
    theta = (1.0 + growth.expansion * heating) * swollen
    if growth.swelling is not None:
        # d theta/dS = theta / (3 S)
        by_ratio = theta / (3.0 * ratio) * growth.swelling.rates(fractions)
        rates[prefix + SWELLING] = zeros, by_ratio, zeros
    shape = count, 1, 1
    return RegionConditions(
        Conditions(h.reshape(shape), theta.reshape(shape), factor.reshape(shape)),
        {name: np.reshape(own, (3, *shape)) for name, own in rates.items()},
    )


def at_points(own: RegionConditions) -> RegionConditions:
    """Return conditions at one path parameter for arrays of points, (1,) in place of (1, 1, 1)."""
    if own.conditions is None:
        return own
    conditions = Conditions(*(np.ravel(values) for values in own.conditions))
    return RegionConditions(conditions, {n: rates.reshape(3, 1) for n, rates in own.rates.items()})

"""Environment of a body along the path: axial stretch, temperature, swelling.

A material at the temperature T grows freely by theta = (1 + alpha (T - T_0)) S^(1/3), with its expansion
alpha and the ratio S of its volume swollen and dry, and its moduli have the factor m(T). A long section
is stretched along its axis by h. See ``materials.conditioned`` for the energy.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from seal_mdao.materials.conditioned import Conditions
from seal_mdao.terms.ramp import Ramp
from seal_mdao.terms.term import Scalar

AXIAL_STRETCH, TEMPERATURE = "axial_stretch", "temperature"
EXPANSION, SWELLING = "expansion", "swelling"
ABSOLUTE_ZERO = -273.15
"""Degrees Celsius."""


@dataclass(frozen=True, eq=False)
class Environment:
    """Axial stretch and temperature of the whole body.

    Attributes
    ----------
    axial_stretch : Ramp, optional
        h along a plane section; 1 unless given.
    temperature : Ramp, optional
        In degrees Celsius, from that at which the body has its shape and its materials their constants.
    """

    axial_stretch: Ramp | None = None
    temperature: Ramp | None = None

    @property
    def scalars(self) -> dict:
        """Parameters: the values farthest from those at the start."""
        given = (
            (AXIAL_STRETCH, self.axial_stretch, None, "Stretch along the section."),
            (TEMPERATURE, self.temperature, "degC", "Temperature."),
        )
        return {
            name: Scalar(own.value, units, text)
            for name, own, units, text in given
            if own is not None
        }

    def with_parameters(self, values: dict) -> "Environment":
        """Return the environment with some of the ``scalars`` changed."""
        own = {name: values[name] for name in self.scalars if name in values}
        return replace(self, **{n: replace(getattr(self, n), value=v) for n, v in own.items()})

    def with_ends(self, ends) -> "Environment":
        """Return the same environment in other load steps, whose ``ends`` are in nominal steps."""
        own = {name: getattr(self, name).with_ends(ends) for name in self.scalars}
        return replace(self, **own)


@dataclass(frozen=True, eq=False)
class Growth:
    """What heat and a liquid do to one material.

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
        slope = (factors[piece + 1] - factors[piece]) / (at[piece + 1] - at[piece])
        return factors[piece] + slope * (temperature - at[piece]), slope


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
        rates[TEMPERATURE] = zeros, growth.expansion * swollen * r, slope * r
    theta = (1.0 + growth.expansion * heating) * swollen
    rates[prefix + EXPANSION] = zeros, heating * swollen, zeros
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

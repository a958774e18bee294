"""Distributions of a varying number, and its effect on parameters of a seal."""

from dataclasses import dataclass
from functools import cached_property
from importlib import import_module

from seal_mdao import values

VALUE, SHIFT, FACTOR = KINDS = ("value", "shift", "factor")
"""What a number does: it replaces the value of a parameter, is added to it, or multiplies it."""
CUT = 3.0
"""Default end of a normal distribution, standard deviations: parts beyond are rejected."""


def _stats():
    # on first use: the import takes longer than that of all of this package
    return import_module("scipy.stats")


@dataclass(frozen=True)
class Uniform:
    """Uniform distribution between two numbers."""

    low: float
    high: float

    def __post_init__(self):
        values.real("low", self.low)
        values.real("high", self.high, above=self.low)

    @property
    def ends(self) -> tuple[float, float]:
        """Least and largest number."""
        return self.low, self.high

    @cached_property
    def scipy(self):
        return _stats().uniform(self.low, self.high - self.low)


@dataclass(frozen=True)
class Triangular:
    """Triangular distribution between two numbers with its mode at a third."""

    low: float
    likely: float
    high: float

    def __post_init__(self):
        values.real("low", self.low)
        values.real("high", self.high, above=self.low)
        values.real("likely", self.likely, self.low, self.high)

    @property
    def ends(self) -> tuple[float, float]:
        """Least and largest number."""
        return self.low, self.high

    @cached_property
    def scipy(self):
        # SciPy's shape parameter is the relative position of the mode
        width = self.high - self.low
        return _stats().triang((self.likely - self.low) / width, self.low, width)


@dataclass(frozen=True)
class Normal:
    """Normal distribution truncated at ``cut`` standard deviations, which reduces its own slightly."""

    mean: float
    std: float
    cut: float = CUT

    def __post_init__(self):
        values.real("mean", self.mean)
        values.real("std", self.std, above=0.0)
        values.real("cut", self.cut, above=0.0)

    @property
    def ends(self) -> tuple[float, float]:
        """Least and largest number."""
        return self.mean - self.cut * self.std, self.mean + self.cut * self.std

    @cached_property
    def scipy(self):
        return _stats().truncnorm(-self.cut, self.cut, self.mean, self.std)


DISTRIBUTIONS = {"uniform": Uniform, "triangular": Triangular, "normal": Normal}

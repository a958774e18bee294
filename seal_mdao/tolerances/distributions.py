"""How a number scatters."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import stats

from seal_mdao import values

CUT = 3.0
"""Standard deviations at which a normal distribution ends: parts beyond are sorted out."""


@dataclass(frozen=True)
class Uniform:
    """Anything between two numbers, equally likely."""

    low: float
    high: float

    def __post_init__(self):
        values.real("low", self.low)
        values.real("high", self.high, above=self.low)

    @cached_property
    def scipy(self):
        """As a distribution of ``scipy.stats``."""
        return stats.uniform(self.low, self.high - self.low)


@dataclass(frozen=True)
class Triangular:
    """Between two numbers, most likely at a third."""

    low: float
    likely: float
    high: float

    def __post_init__(self):
        values.real("low", self.low)
        values.real("high", self.high, above=self.low)
        values.real("likely", self.likely, self.low, self.high)

    @cached_property
    def scipy(self):
        """As a distribution of ``scipy.stats``."""
        width = self.high - self.low
        return stats.triang((self.likely - self.low) / width, self.low, width)


@dataclass(frozen=True)
class Normal:
    """Normal, cut off at ``cut`` standard deviations (which makes its own a little smaller)."""

    mean: float
    std: float
    cut: float = CUT

    def __post_init__(self):
        values.real("mean", self.mean)
        values.real("std", self.std, above=0.0)
        values.real("cut", self.cut, above=0.0)

    @cached_property
    def scipy(self):
        """As a distribution of ``scipy.stats``."""
        return stats.truncnorm(-self.cut, self.cut, self.mean, self.std)


DISTRIBUTIONS = {"uniform": Uniform, "triangular": Triangular, "normal": Normal}


def scattered(distribution, shares: np.ndarray) -> np.ndarray:
    """The numbers below which the given shares of all lie."""
    return np.asarray(distribution.scipy.ppf(shares), float)


def mean_and_std(distribution) -> tuple[float, float]:
    """Mean and standard deviation."""
    return float(distribution.scipy.mean()), float(distribution.scipy.std())

"""Comparison of designs on the same samples."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.tolerances.statistics import CONFIDENCE, Fraction, described, fraction, quantiles


class SampledLimit(NamedTuple):
    """Limit of a measure: ``satisfied`` returns which rows of its values (n, m) satisfy it, (n,).

    ``key`` stands in summaries for the fraction of samples that satisfy it, ``text`` describes it,
    ``entry`` is the limited entry of a measure with several values, all by default; ``required`` is the
    fraction of samples that has to satisfy the limit, None where only the mean has to; ``band`` is the
    distance of its two bounds, None for one alone.
    """

    key: str
    text: str
    measure: str
    satisfied: Callable
    entry: int | None = None
    required: float | None = None
    band: float | None = None

    def numbers(self, values: np.ndarray) -> np.ndarray | None:
        """Return the limited entry of values (n, m), shape (n,); None for several."""
        # without an entry the measure must be a scalar
        if self.entry is None and values.shape[1] > 1:
            return None
        return values[:, self.entry or 0]


@dataclass(frozen=True, eq=False)
class SampledDesign:
    """Cost and limits of a design over samples; samples that failed satisfy no limit.

    Attributes
    ----------
    label : str
    cost : str
        Name of the measure that is minimised.
    values : dict of str to ndarray, shape (n, m)
        Values of every measure at the completed samples.
    failed : int
        Number of samples that could not be analysed.
    """

    label: str
    cost: str
    values: dict
    failed: int

    @property
    def costs(self) -> np.ndarray:
        """Values of the cost, shape (n,)."""
        return self.values[self.cost][:, 0]

    @property
    def samples(self) -> int:
        return len(self.costs) + self.failed

    def fraction(self, limit: SampledLimit) -> Fraction:
        """Return the fraction of all samples that satisfy a limit, with its confidence interval."""
        # failed samples count in the denominator only
        return fraction(int(np.sum(limit.satisfied(self.values[limit.measure]))), self.samples)

    def meets(self, limit: SampledLimit) -> bool:
        """Return whether the fraction that satisfies a limit is as large as required."""
        return limit.required is None or self.fraction(limit).value >= limit.required

    def too_wide(self, limit: SampledLimit) -> float | None:
        """Return the width of the band in which the required fraction lies, where the limit is narrower.

        A limit with two bounds that is not met: no design with this scatter meets it. None for a limit
        of several entries, each with a band of its own.
        """
        numbers = limit.numbers(self.values[limit.measure])
        if limit.band is None or numbers is None or self.meets(limit):
            return None
        # between the quantiles (1 - f)/2 and (1 + f)/2
        low, high = quantiles(numbers, [0.5 - 0.5 * limit.required, 0.5 + 0.5 * limit.required])
        return high - low if high - low > limit.band else None

    def in_words(self, limit: SampledLimit) -> str:
        """Write the fraction that satisfies a limit, with its confidence, and whether it suffices."""
        own = self.fraction(limit)
        text = (
            f"{100.0 * own.value:.1f} % of the samples ({100.0 * own.low:.1f} to "
            f"{100.0 * own.high:.1f} % with {100.0 * CONFIDENCE:.0f} % confidence)"
        )
        if limit.required is None:
            return text
        # the interval on one side of the required fraction decides; else more samples do
        required, met = f"{100.0 * limit.required:g} %", self.meets(limit)
        sure = not own.low < limit.required <= own.high
        doubt = "" if sure else ", within the confidence of these samples"
        return f"{text}, {required} required: {'met' if met else 'NOT MET'}{doubt}"

    def summary(self, limits) -> dict:
        """Summarise the samples in numbers."""
        found = {"samples": self.samples, "failed": self.failed, self.cost: described(self.costs)}
        # limited measures, then the fractions that satisfy them
        for limit in limits:
            numbers = limit.numbers(self.values[limit.measure])
            if numbers is not None:
                found[limit.measure] = described(numbers)
        for limit in limits:
            own = self.fraction(limit)
            found |= {limit.key: own.value, f"{limit.key}_interval": [own.low, own.high]}
        return found

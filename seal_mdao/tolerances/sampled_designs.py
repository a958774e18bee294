"""Comparison of designs on the same samples."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.tolerances.statistics import described


class SampledLimit(NamedTuple):
    """Limit of a measure: ``kept`` returns which rows of its values (n, m) satisfy it, (n,).

    ``key`` stands in summaries for the fraction of samples that satisfy it, ``text`` describes it,
    ``entry`` is the limited entry of a measure with several values, all by default.
    """

    key: str
    text: str
    measure: str
    kept: Callable
    entry: int | None = None

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

    def share(self, limit: SampledLimit) -> float:
        """Return the fraction of all samples that satisfy a limit."""
        # failed samples count in the denominator only
        return float(np.sum(limit.kept(self.values[limit.measure])) / self.samples)

    def summary(self, limits) -> dict:
        """Summarise the samples in numbers."""
        found = {"samples": self.samples, "failed": self.failed, self.cost: described(self.costs)}
        # limited measures, then the fractions that satisfy them
        for limit in limits:
            numbers = limit.numbers(self.values[limit.measure])
            if numbers is not None:
                found[limit.measure] = described(numbers)
        return found | {limit.key: self.share(limit) for limit in limits}

"""Designs side by side on the same samples."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seal_mdao.tolerances.statistics import described


@dataclass(frozen=True, eq=False)
class SampledLimit:
    """A limit that samples keep to or not.

    Attributes
    ----------
    key : str
        In summaries, of the share of the samples that keep to it.
    text : str
        The same for reading.
    measure : str
    kept : callable
        Which rows of values (n, m) of the measure keep to it, (n,).
    entry : int, optional
        Of a measure with several values, of all when left out.
    """

    key: str
    text: str
    measure: str
    kept: Callable
    entry: int | None = None

    def numbers(self, values: np.ndarray) -> np.ndarray | None:
        """The limited one of values (n, m), shape (n,); None for several."""
        if self.entry is None and values.shape[1] > 1:
            return None
        return values[:, self.entry or 0]


@dataclass(frozen=True, eq=False)
class SampledDesign:
    """What the samples of a design say about a cost and about limits.

    Samples that could not be analysed keep to no limit.

    Attributes
    ----------
    label : str
    cost : str
        Name of the measure that is made small.
    values : dict of str to ndarray, shape (n, m)
        Of every measure, of the samples that were completed.
    failed : int
        Samples that could not be analysed.
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
        """Share of all samples that keep to a limit."""
        return float(np.sum(limit.kept(self.values[limit.measure])) / self.samples)

    def summary(self, limits) -> dict:
        """All of it in numbers."""
        found = {"samples": self.samples, "failed": self.failed, self.cost: described(self.costs)}
        for limit in limits:
            numbers = limit.numbers(self.values[limit.measure])
            if numbers is not None:
                found[limit.measure] = described(numbers)
        return found | {limit.key: self.share(limit) for limit in limits}

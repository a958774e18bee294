"""Designs side by side on the same samples."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.tolerances.statistics import described


@dataclass(frozen=True, eq=False)
class SampledDesign:
    """What the samples of a design say about a cost, a force in its band and pressures above a floor.

    Samples that could not be analysed count as out of the band and below the floor.

    Attributes
    ----------
    label : str
    cost : ndarray, shape (n,)
        Of the samples that were completed.
    reaction : ndarray, shape (n,)
        N/m.
    pressure : ndarray, shape (n, patches)
        kPa.
    failed : int
        Samples that could not be analysed.
    """

    label: str
    cost: np.ndarray
    reaction: np.ndarray
    pressure: np.ndarray
    failed: int

    @property
    def samples(self) -> int:
        return len(self.cost) + self.failed

    def within(self, band) -> float:
        """Share of all samples whose reaction is between two limits, N/m."""
        low, high = band
        return float(np.sum((self.reaction >= low) & (self.reaction <= high)) / self.samples)

    def above(self, floor: np.ndarray) -> float:
        """Share of all samples whose pressures all reach their floors, kPa."""
        return float(np.sum((self.pressure >= floor).all(axis=1)) / self.samples)

    def summary(self, band, floor: np.ndarray) -> dict:
        """All of it in numbers."""
        return {
            "samples": self.samples,
            "failed": self.failed,
            "gap_square_integral": described(self.cost),
            "reaction": described(self.reaction),
            "share_in_reaction_band": self.within(band),
            "share_above_pressure_floor": self.above(floor),
        }

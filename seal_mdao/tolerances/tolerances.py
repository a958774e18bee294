"""All tolerances of a seal, and samples of them."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from seal_mdao import values
from seal_mdao.scenarios.variation import Scenarios, Variation
from seal_mdao.seals.seal import Seal
from seal_mdao.tolerances.boundary import BoundaryTolerance, boundary_covariance, square_root
from seal_mdao.tolerances.distributions import mean_and_std, scattered

METHODS = ("sobol", "latin_hypercube")
MOST_SAMPLES = 10**7
TINY = 1e-12
"""Shares are kept this far from 0 and 1, where a normal distribution has no end."""


@dataclass(frozen=True)
class Tolerance:
    """One thing that varies, and how.

    Attributes
    ----------
    variation : Variation
    distribution : Uniform, Triangular or Normal
        Of its number.
    """

    variation: Variation
    distribution: object


@dataclass(frozen=True)
class Tolerances:
    """What varies in a series of seals and cars.

    Attributes
    ----------
    scattered : tuple of Tolerance
    boundary : BoundaryTolerance, optional
    """

    scattered: tuple
    boundary: BoundaryTolerance | None = None

    @property
    def variations(self) -> tuple:
        return tuple(tolerance.variation for tolerance in self.scattered)

    @property
    def means(self) -> np.ndarray:
        """Of the numbers, shape (K,)."""
        return np.array([mean_and_std(t.distribution)[0] for t in self.scattered])

    @property
    def deviations(self) -> np.ndarray:
        """Standard deviations of the numbers, shape (K,)."""
        return np.array([mean_and_std(t.distribution)[1] for t in self.scattered])

    def offsets_covariance(self, seal: Seal) -> np.ndarray:
        """Of the boundary offsets, shape (P, P), mm^2."""
        if self.boundary is None:
            return np.zeros((seal.n_offsets, seal.n_offsets))
        return boundary_covariance(seal, self.boundary)

    def middle(self, seal: Seal) -> Scenarios:
        """The one scenario in the middle of all: every number at its mean, the boundary as drawn."""
        return Scenarios(self.variations, self.means[None], np.zeros((1, seal.n_offsets)))

    def samples(self, seal: Seal, count: int, method: str = "sobol", seed: int = 0) -> Scenarios:
        """Samples, the same for the same seed.

        Parameters
        ----------
        count : int
            Any number; powers of two balance Sobol's sequence best.
        method : {"sobol", "latin_hypercube"}
            Scrambled Sobol sequence, or Latin hypercube, of ``scipy.stats.qmc``.
        seed : int
        """
        values.integer("number of samples", count, 1, MOST_SAMPLES)
        values.one_of("method", method, METHODS)
        n_numbers = len(self.scattered)
        dimensions = n_numbers + (seal.n_offsets if self.boundary is not None else 0)
        if dimensions == 0:
            raise ValueError("nothing varies; give tolerances of parameters or of the boundary")
        shares = np.clip(_unit_samples(dimensions, count, method, seed), TINY, 1.0 - TINY)
        columns = [
            scattered(t.distribution, s) for t, s in zip(self.scattered, shares.T, strict=False)
        ]
        numbers = np.column_stack(columns) if columns else np.zeros((count, 0))
        if self.boundary is None:
            return Scenarios(self.variations, numbers, np.zeros((count, seal.n_offsets)))
        root = square_root(self.offsets_covariance(seal))
        return Scenarios(self.variations, numbers, ndtri(shares[:, n_numbers:]) @ root)


def _unit_samples(dimensions: int, count: int, method: str, seed: int) -> np.ndarray:
    """Points in the unit cube, shape (count, dimensions)."""
    rng = np.random.default_rng(values.integer("seed", seed, 0))
    if method == "sobol":
        powers = int(np.ceil(np.log2(count)))
        return qmc.Sobol(dimensions, rng=rng).random_base2(powers)[:count]
    return qmc.LatinHypercube(dimensions, rng=rng).random(count)

"""Tolerances of a seal, and the sampling of them: Sobol sequence or Latin hypercube.

The analysis of the samples is ``tolerance_study``.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from seal_mdao import values
from seal_mdao.scenarios.variation import Scenarios, Variation
from seal_mdao.seals.seal import Seal
from seal_mdao.tolerances.boundary_errors import BoundaryTolerance, boundary_covariance, square_root

METHODS = ("sobol", "latin_hypercube")
MOST_SAMPLES = 10**7
TINY = 1e-12
"""Distance of probabilities from 0 and 1, where a normal distribution is infinite."""


@dataclass(frozen=True)
class Tolerance:
    """A varying quantity with the distribution (Uniform, Triangular or Normal) of its number."""

    variation: Variation
    distribution: object


@dataclass(frozen=True)
class Tolerances:
    """Tolerances of a series of seals and cars.

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
        """Means of the numbers, shape (K,)."""
        return np.array([t.distribution.scipy.mean() for t in self.scattered])

    @property
    def deviations(self) -> np.ndarray:
        """Standard deviations of the numbers, shape (K,)."""
        return np.array([t.distribution.scipy.std() for t in self.scattered])

    def offsets_covariance(self, seal: Seal) -> np.ndarray:
        """Compute the covariance of the boundary offsets, shape (P, P), mm^2."""
        if self.boundary is None:
            return np.zeros((seal.n_offsets, seal.n_offsets))
        return boundary_covariance(seal, self.boundary)

    def middle(self, seal: Seal) -> Scenarios:
        """Return the mean scenario: every number at its mean, the nominal boundary."""
        return Scenarios(self.variations, self.means[None], np.zeros((1, seal.n_offsets)))

    def samples(self, seal: Seal, count: int, method: str = "sobol", seed: int = 0) -> Scenarios:
        """Draw samples, the same for the same seed.

        Parameters
        ----------
        count : int
            Any number; powers of two are best for Sobol's sequence.
        method : {"sobol", "latin_hypercube"}
            Scrambled Sobol sequence, or Latin hypercube, of ``scipy.stats.qmc``.
        seed : int
        """
        values.integer("number of samples", count, 1, MOST_SAMPLES)
        values.one_of("method", method, METHODS)
        # one dimension per number and, if the boundary varies, per offset
        n_numbers = len(self.scattered)
        dimensions = n_numbers + (seal.n_offsets if self.boundary is not None else 0)
        if dimensions == 0:
            raise ValueError(
                "the set of manufacturing tolerances is empty; add a tolerance of a parameter or "
                "of the boundary"
            )
        # inverse transform sampling: x = F^(-1)(u)
        probabilities = np.clip(_unit_samples(dimensions, count, method, seed), TINY, 1.0 - TINY)
        pairs = zip(self.scattered, probabilities.T, strict=False)
        columns = [tolerance.distribution.scipy.ppf(u) for tolerance, u in pairs]
        numbers = np.column_stack(columns) if columns else np.zeros((count, 0))
        if self.boundary is None:
            return Scenarios(self.variations, numbers, np.zeros((count, seal.n_offsets)))
        # offsets C^(1/2) z with independent standard normal z
        root = square_root(self.offsets_covariance(seal))
        return Scenarios(self.variations, numbers, ndtri(probabilities[:, n_numbers:]) @ root)


def _unit_samples(dimensions: int, count: int, method: str, seed: int) -> np.ndarray:
    """Draw points in the unit cube, shape (count, dimensions)."""
    rng = np.random.default_rng(values.integer("seed", seed, 0))
    if method == "sobol":
        # a Sobol sequence is balanced for powers of two: draw the next one, and cut
        powers = int(np.ceil(np.log2(count)))
        return qmc.Sobol(dimensions, rng=rng).random_base2(powers)[:count]
    return qmc.LatinHypercube(dimensions, rng=rng).random(count)

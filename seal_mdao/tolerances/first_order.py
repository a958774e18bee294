"""First-order estimate of the scatter of measures, from the gradient at the mean of all tolerances."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.scenarios.variation import Scenarios


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """Measures as linear functions of all varying quantities.

    Attributes
    ----------
    values : ndarray, shape (M,)
        Measures at the mean of all tolerances.
    by_number, by_offset : ndarray, shapes (M, K) and (M, P)
        Derivatives in the numbers of the variations, and in the boundary offsets, per mm.
    means, deviations : ndarray, shape (K,)
        Means and standard deviations of the numbers.
    covariance : ndarray, shape (P, P)
        Covariance of the boundary offsets, mm^2.
    """

    values: np.ndarray
    by_number: np.ndarray
    by_offset: np.ndarray
    means: np.ndarray
    deviations: np.ndarray
    covariance: np.ndarray

    @property
    def variances(self) -> np.ndarray:
        """Contribution of every variation, and last of the boundary, shape (M, K + 1)."""
        # (dm/dn_k sigma_k)^2, and dm/db C dm/db^T of the boundary
        own = (self.by_number * self.deviations) ** 2
        boundary = np.einsum("mp,pq,mq->m", self.by_offset, self.covariance, self.by_offset)
        return np.column_stack([own, boundary])

    @property
    def std(self) -> np.ndarray:
        """Standard deviations, shape (M,)."""
        return np.sqrt(self.variances.sum(axis=1))

    def at(self, scenarios: Scenarios) -> np.ndarray:
        """Evaluate the linear functions at samples, shape (S, M)."""
        # m + dm/dn (n - mean) + dm/db b
        found = self.values + (scenarios.numbers - self.means) @ self.by_number.T
        return found + scenarios.offsets @ self.by_offset.T

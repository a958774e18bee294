"""What the gradient at the middle of all tolerances says about the scatter of measures."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.errors import LoadPathError
from seal_mdao.scenarios.task import SealTask
from seal_mdao.scenarios.variation import Scenarios
from seal_mdao.tolerances.tolerances import Tolerances


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """Measures as linear functions of all that varies.

    Attributes
    ----------
    values : ndarray, shape (M,)
        At the middle.
    by_number : ndarray, shape (M, K)
        Derivatives in the numbers of the variations.
    by_offset : ndarray, shape (M, P)
        Derivatives in the boundary offsets, per mm.
    means : ndarray, shape (K,)
        Numbers at the middle.
    deviations : ndarray, shape (K,)
        Standard deviations of the numbers.
    covariance : ndarray, shape (P, P)
        Of the boundary offsets, mm^2.
    """

    values: np.ndarray
    by_number: np.ndarray
    by_offset: np.ndarray
    means: np.ndarray
    deviations: np.ndarray
    covariance: np.ndarray

    @property
    def variances(self) -> np.ndarray:
        """Share of every variation, and last that of the boundary, shape (M, K + 1)."""
        own = (self.by_number * self.deviations) ** 2
        boundary = np.einsum("mp,pq,mq->m", self.by_offset, self.covariance, self.by_offset)
        return np.column_stack([own, boundary])

    @property
    def std(self) -> np.ndarray:
        """Standard deviations, shape (M,)."""
        return np.sqrt(self.variances.sum(axis=1))

    def at(self, scenarios: Scenarios) -> np.ndarray:
        """The linear functions at samples, shape (S, M)."""
        found = self.values + (scenarios.numbers - self.means) @ self.by_number.T
        return found + scenarios.offsets @ self.by_offset.T


def first_order(
    task: SealTask, tolerances: Tolerances, offsets: np.ndarray, design: dict
) -> FirstOrder:
    """One analysis and its gradient.

    Parameters
    ----------
    task : SealTask
        With derivatives.
    tolerances : Tolerances
    offsets : ndarray, shape (P,)
        Of the design, mm.
    design : dict of str to float
        Scalar parameters of the design, those of the task.

    Raises
    ------
    LoadPathError
        When the middle cannot be analysed.
    """
    middle = tolerances.middle(task.seal)
    values = middle.values(0, design)
    outcome = task.run(offsets, np.array([values[name] for name in design]))
    if outcome.failure:
        raise LoadPathError(f"the middle of all tolerances: {outcome.failure}")
    n = task.seal.n_offsets
    by_number = outcome.gradient[:, n:] @ middle.rates(0, design)[1]
    return FirstOrder(
        outcome.values, by_number, outcome.gradient[:, :n], tolerances.means,
        tolerances.deviations, tolerances.offsets_covariance(task.seal),
    )  # fmt: skip

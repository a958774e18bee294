"""Rates of all data of an analysis with respect to design parameters: right-hand sides of Eq.
(70)."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class ParameterRates:
    """Rates of all data of the analysis with respect to P parameters.

    Attributes
    ----------
    velocity : ndarray, shape (P, n, 2)
        Design velocity V of the particles.
    names : tuple of str
        Scalar parameters of the terms.
    scalars : ndarray, shape (len(names), P)
        Rates of those.
    """

    velocity: np.ndarray
    names: tuple
    scalars: np.ndarray

    @property
    def count(self) -> int:
        return len(self.velocity)

    def of(self, names) -> np.ndarray:
        """Rates of the parameters ``names``, zero for those that do not move, (len(names), P)."""
        row_of = {name: row for row, name in enumerate(self.names)}
        none = np.zeros(self.count)
        rows = [self.scalars[row_of[name]] if name in row_of else none for name in names]
        return np.array(rows).reshape(len(names), self.count)


def parameter_rates(velocity: np.ndarray, names=()) -> ParameterRates:
    """Rates for parameters that move the particles by ``velocity`` (S, n, 2), then scalar ones."""
    # unit rates: shape parameters move particles, the others none
    shape, total = len(velocity), len(velocity) + len(names)
    still = np.zeros((len(names), *velocity.shape[1:]))
    return ParameterRates(np.concatenate([velocity, still]), tuple(names), np.eye(total)[shape:])

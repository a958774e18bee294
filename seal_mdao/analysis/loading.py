"""What drives the load path: the profile's motion, imposed displacements, dead loads."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class LoadPoint(NamedTuple):
    """Loading at one place of the path.

    Attributes
    ----------
    position : ndarray, shape (2,)
        Rigid translation of the profile.
    imposed : ndarray, shape (n, 2), or None
        Displacements of the fixed components.
    force : ndarray, shape (n, 2), or None
        Generalised dead loads, conjugate to the coefficients d.
    """

    position: np.ndarray
    imposed: np.ndarray | None
    force: np.ndarray | None


@dataclass(frozen=True, eq=False)
class LoadProgram:
    """Loading at the start and after every nominal step; straight lines between.

    Attributes
    ----------
    positions : ndarray, shape (n_steps + 1, 2)
        Rigid translations of the profile.
    imposed : ndarray, shape (n_steps + 1, n, 2), optional
        Displacements of the fixed components; zero when left out.
    force : ndarray, shape (n_steps + 1, n, 2), optional
        Dead loads; zero when left out.
    """

    positions: np.ndarray
    imposed: np.ndarray | None = None
    force: np.ndarray | None = None

    @property
    def n_steps(self) -> int:
        return len(self.positions) - 1

    def at(self, fraction: float) -> LoadPoint:
        """Loading after ``fraction`` nominal steps."""
        first = min(int(fraction), self.n_steps - 1)
        share = fraction - first
        return LoadPoint(
            *(
                None
                if values is None
                else values[first] + share * (values[first + 1] - values[first])
                for values in (self.positions, self.imposed, self.force)
            )
        )


def still_profile(n_steps: int) -> np.ndarray:
    """Positions of a profile that does not move, shape (n_steps + 1, 2)."""
    return np.zeros((n_steps + 1, 2))

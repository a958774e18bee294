"""What the displacements of one load step hand on to the next, and the few adjoints it takes.

Steps are coupled through the histories of terms alone. Of all displacements of a step that is not
measured no more is wanted than those of the points whose history the next step uses, and of these
often only one direction. With

    K_n^T Lambda_n = Phi^T q        a column for each wanted direction q of a point

they move by -Lambda_n^T f'_n, whatever the parameters (direct) or measures (adjoint).
"""

import math
from typing import NamedTuple

import numpy as np

# Sine of the angle between two directions below which they are one.
PARALLEL = 1e-13


class HandedOn(NamedTuple):
    """Displacements that the next step uses.

    Attributes
    ----------
    points : ndarray of int, shape (s,)
        Points of the term; one of them once or twice.
    directions : ndarray, shape (s, 2)
        Unit vectors.
    """

    points: np.ndarray
    directions: np.ndarray

    @property
    def seeds(self) -> np.ndarray:
        """Seeds (s, 2, s) on the points' displacements, a column for each direction."""
        return self.directions[:, :, None] * np.eye(len(self.directions))[:, None]


def directions_of(used: np.ndarray, slopes: np.ndarray) -> HandedOn:
    """Directions in which the wanted functions of the points ``used`` (s,) change.

    Parameters
    ----------
    slopes : ndarray, shape (s, 2, 2)
        Derivatives of two functions of every point with its displacement. The second may be zero.
    """
    points, directions = [], []
    for i, ((a_x, a_y), (b_x, b_y)) in zip(used, slopes.tolist(), strict=True):
        size = math.hypot(a_x, a_y)
        if abs(a_x * b_y - a_y * b_x) <= PARALLEL * size * math.hypot(b_x, b_y):
            points.append(i)
            directions.append((a_x / size, a_y / size))
        else:
            points += [i, i]
            directions += [(1.0, 0.0), (0.0, 1.0)]
    return HandedOn(np.array(points, int), np.array(directions).reshape(-1, 2))

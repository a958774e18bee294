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

from seal_mdao.compilation import compiled

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


def directions_of(used: np.ndarray, slopes: np.ndarray) -> HandedOn:
    """Directions in which the wanted functions of the points ``used`` (s,) change.

    Parameters
    ----------
    slopes : ndarray, shape (s, 2, 2)
        Derivatives of two functions of every point with its displacement. The second may be zero; a
        point where both are hands on nothing.
    """
    points, directions = np.empty(2 * used.size, int), np.empty((2 * used.size, 2))
    count = _fill_directions(used, slopes, points, directions)
    return HandedOn(points[:count], directions[:count])


@compiled
def _fill_directions(used, slopes, points, directions):
    """Fill points and directions; returns how many there are."""
    count = 0
    for k, i in enumerate(used):
        a_x, a_y, b_x, b_y = slopes[k, 0, 0], slopes[k, 0, 1], slopes[k, 1, 0], slopes[k, 1, 1]
        size = math.hypot(a_x, a_y)
        if size == 0.0:
            continue
        points[count] = i
        if abs(a_x * b_y - a_y * b_x) <= PARALLEL * size * math.hypot(b_x, b_y):
            directions[count, 0], directions[count, 1] = a_x / size, a_y / size
            count += 1
        else:
            points[count + 1] = i
            directions[count, 0], directions[count, 1] = 1.0, 0.0
            directions[count + 1, 0], directions[count + 1, 1] = 0.0, 1.0
            count += 2
    return count

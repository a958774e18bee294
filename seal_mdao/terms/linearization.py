"""Linearisation of a local law: its matrix, and products with rates and seeds.

A law gives the conjugate forces s of a term's points, the history h+ that they pass to the next step,
and outputs o for measures, from their deformed places x, the history h of the step before, weights w,
parameters theta and undeformed places X. Its linearisation at a converged step is

    L = d(s, h+, o) / d(x, h, w, theta, X).

The direct method forms ``L @ Inputs``, the adjoint method ``L.T @ Outputs``.
"""

import math
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np
from scipy.sparse import sparray

from seal_mdao.compilation import compiled

# Sine of the angle between two directions below which they are one.
PARALLEL = 1e-13


class Inputs(NamedTuple):
    """Rates of the inputs of a law at s points, or seeds on them, in P columns.

    Attributes
    ----------
    x : ndarray, shape (s, 2, P)
    history : ndarray, shape (s, h, P)
    measure : ndarray, shape (s, 1, P)
    parameters : ndarray, shape (n, P)
        Rates; seeds are (s or 1, n, P), to be summed.
    reference : ndarray, shape (s, 2, P)
        X; seeds are (s, 0, P) where the law does not depend on it.
    array : ndarray, optional
        The one of which the others are views.
    """

    x: np.ndarray
    history: np.ndarray
    measure: np.ndarray
    parameters: np.ndarray
    reference: np.ndarray
    array: np.ndarray | None = None


class Outputs(NamedTuple):
    """Rates of the results of a law at s points, or seeds on them, in P columns.

    Attributes
    ----------
    force : ndarray, shape (s, 2, P)
    history : ndarray, shape (s, h, P)
    outputs : ndarray, shape (s, o, P)
        Of terms at points that act on each other (places, o, P).
    array : ndarray, optional
        The one of which the others are views.
    """

    force: np.ndarray
    history: np.ndarray
    outputs: np.ndarray
    array: np.ndarray | None = None


class PointByPoint:
    """``Inputs`` or ``Outputs`` as one array (s, rows, P): the rows of every point by themselves.

    Parameters
    ----------
    kind : type
        ``Inputs`` or ``Outputs``.
    widths : tuple of int
        Rows of each of its fields.
    """

    def __init__(self, kind: type, widths: tuple):
        self.kind, self.size = kind, sum(widths)
        self.slices = [slice(*ends) for ends in pairwise(accumulate(widths, initial=0))]

    def joined(self, values) -> np.ndarray:
        if values.array is not None:
            return values.array
        rows = np.empty((len(values[0]), self.size, values[0].shape[2]))
        for part, at in zip(values, self.slices, strict=False):
            rows[:, at] = part[..., : at.stop - at.start, :]
        return rows

    def split(self, rows: np.ndarray):
        return self.kind(*[rows[:, at] for at in self.slices], rows)

    def zeros(self, s: int, count: int):
        return self.split(np.zeros((s, self.size, count)))

    def add(self, values, points, total) -> None:
        """Add those of the ``points`` to ``total`` of all points."""
        total.array[points] += values.array


class AllPoints(NamedTuple):
    """``Inputs`` or ``Outputs`` as one array (rows, P): all places, all histories, ..."""

    kind: type
    shapes: tuple

    @property
    def slices(self) -> list:
        """Where each field is among the rows."""
        ends = accumulate((a * b for a, b in self.shapes), initial=0)
        return [slice(*own) for own in pairwise(ends)]

    def joined(self, values) -> np.ndarray:
        if values.array is not None:
            return values.array
        # (a, b, P) to (a b, P), also for P = 0
        parts = zip(values[:-1], self.shapes, strict=True)
        return np.concatenate([own.reshape(a * b, own.shape[-1]) for own, (a, b) in parts])

    def split(self, rows: np.ndarray):
        parts = zip(self.shapes, self.slices, strict=True)
        return self.kind(*(rows[at].reshape(*shape, rows.shape[1]) for shape, at in parts), rows)

    def zeros(self, s: int, count: int):
        return self.split(np.zeros((sum(a * b for a, b in self.shapes), count)))

    def add(self, values, points, total) -> None:
        """Add to ``total``."""
        total.array[:] += values.array


class LocalMap(NamedTuple):
    """Matrix sparse + left right of points that interact.

    Rows: force (2k), history passed on, outputs; columns: x (2k), history, measure (k), parameters,
    X (2k), all point by point.

    Attributes
    ----------
    sparse : csr_array
    left, right : ndarray, shapes (rows, r), (r, columns)
    """

    sparse: sparray
    left: np.ndarray
    right: np.ndarray

    def __matmul__(self, rates: np.ndarray) -> np.ndarray:
        # (S + U V) r
        return self.sparse @ rates + self.left @ (self.right @ rates)

    @property
    def mT(self) -> "LocalMap":
        """The transpose, named as that of arrays."""
        # (S + U V)^T = S^T + V^T U^T
        return LocalMap(self.sparse.T, self.right.T, self.left.T)


class Linearization(NamedTuple):
    """L of some points of a term at one converged step.

    Attributes
    ----------
    points : ndarray of int, shape (s,)
        Of the term.
    matrix : ndarray, shape (s, rows, columns), or LocalMap
    rows, columns : PointByPoint or AllPoints
        How what is given and what is taken lie in its rows and columns.
    """

    points: np.ndarray
    matrix: object
    rows: NamedTuple
    columns: NamedTuple

    def __matmul__(self, values):
        # L r
        return self.rows.split(self.matrix @ self.columns.joined(values))

    @property
    def T(self) -> "Linearization":
        """The transpose, from seeds on what is given to seeds on what is taken."""
        return Linearization(self.points, self.matrix.mT, self.columns, self.rows)


class PassedOn(NamedTuple):
    """The c functions of the displacements of a step on which the next step depends.

    Attributes
    ----------
    directions : ndarray, shape (s, 2, c)
        Their derivatives with the places x of the step's points, G.
    history : ndarray, shape (s, h, c)
        Derivatives of the history passed on with these functions, H.
    are_indices : bool
        Whether the functions are themselves displacements of single points along unit vectors.
    """

    directions: np.ndarray
    history: np.ndarray
    are_indices: bool = False

    @property
    def count(self) -> int:
        return self.directions.shape[2]

    def seeds(self, history_bar: np.ndarray) -> np.ndarray:
        """H^T h+_bar, shape (c, M)."""
        # sum over points and variables
        c, m = self.count, history_bar.shape[2]
        return self.history.reshape(-1, c).T @ history_bar.reshape(-1, m)


# ---- what the displacements of one load step pass to the next ----
#
# Steps are coupled through the histories of terms alone. Of all displacements of a step that is not
# measured no more is wanted than those of the points whose history the next step uses, and of these
# often only one direction. With K_n^T Lambda_n = Phi^T q, a column for each wanted direction q of a
# point, they move by -Lambda_n^T f'_n, whatever the parameters (direct) or measures (adjoint).


class CarriedDirections(NamedTuple):
    """Directions of displacements on which the next step depends.

    Attributes
    ----------
    points : ndarray of int, shape (s,)
        Points of the term; one of them once or twice.
    directions : ndarray, shape (s, 2)
        Unit vectors.
    """

    points: np.ndarray
    directions: np.ndarray


def directions_of(used: np.ndarray, slopes: np.ndarray) -> CarriedDirections:
    """Directions in which the wanted functions of the points ``used`` (s,) change.

    Parameters
    ----------
    slopes : ndarray, shape (s, 2, 2)
        Derivatives of two functions of every point with its displacement. The second may be zero; a
        point where both are zero passes no sensitivity to the next step.
    """
    points, directions = np.empty(2 * used.size, int), np.empty((2 * used.size, 2))
    count = _fill_directions(used, slopes, points, directions)
    return CarriedDirections(points[:count], directions[:count])


@compiled
def _fill_directions(used, slopes, points, directions):
    """Fill points and directions; returns how many there are."""
    count = 0
    for k, i in enumerate(used):
        a_x, a_y, b_x, b_y = slopes[k, 0, 0], slopes[k, 0, 1], slopes[k, 1, 0], slopes[k, 1, 1]
        # |a|; a point with a = 0 passes on nothing
        size = math.hypot(a_x, a_y)
        if size == 0.0:
            continue
        points[count] = i
        # |a x b| <= eps |a||b|: one direction, a / |a|
        if abs(a_x * b_y - a_y * b_x) <= PARALLEL * size * math.hypot(b_x, b_y):
            directions[count, 0], directions[count, 1] = a_x / size, a_y / size
            count += 1
        else:
            points[count + 1] = i
            directions[count, 0], directions[count, 1] = 1.0, 0.0
            directions[count + 1, 0], directions[count + 1, 1] = 0.0, 1.0
            count += 2
    return count

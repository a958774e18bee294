"""Protocols of the linear solvers: storage of the tangent and its factors."""

from typing import NamedTuple, Protocol

import numpy as np

# placeholder of the arrays that a format does not use: kernels get one type of ``Scheme``
_NONE = np.empty(0, np.int32)


class Scheme(NamedTuple):
    """Storage format of a matrix, for the kernel that computes the slots of entries.

    Attributes
    ----------
    rows, width : int
        LAPACK band: leading dimension and half-width; 0 for compressed columns.
    pointers, indices : ndarray of int32
        Compressed columns with sorted rows; empty for a band.
    """

    rows: int = 0
    width: int = 0
    pointers: np.ndarray = _NONE
    indices: np.ndarray = _NONE


class Factor(Protocol):
    """A factorised tangent.

    Attributes
    ----------
    nbytes : int
        Memory, bytes.
    positive : bool
        Whether a matrix factorised as symmetric is positive definite; of another one whether its
        determinant is positive.
    """

    nbytes: int
    positive: bool

    def exact(self) -> "Factor":
        """Return the factor in double precision, itself unless it was made in reduced precision."""

    def solve(self, rhs: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solve for right-hand sides of shape (n,) or (n, m)."""


class Storage(Protocol):
    """Storage of the tangent of n equations, with its solver.

    Attributes
    ----------
    n, size : int
        Number of equations, and of stored entries.
    reuses_factors : bool
        Whether a factorisation costs so many solutions that quasi-Newton iterations, which reuse one,
        are to be tried before Newton's.
    has_sign : bool
        Whether its factors give the sign of the determinant at no cost.
    scheme : Scheme
    """

    n: int
    size: int
    reuses_factors: bool
    has_sign: bool
    scheme: Scheme

    def diagonal(self) -> np.ndarray:
        """Return the indices of the diagonal entries, shape (n,)."""

    def factorize(self, values: np.ndarray, symmetric: bool = False) -> Factor:
        """Factorise the matrix with the given entries, which must not change afterwards.

        A ``symmetric`` one is solved as any other; its factor knows whether it is definite.

        Raises
        ------
        LinAlgError
            The matrix is singular.
        """

    def factorize_roughly(self, values: np.ndarray) -> Factor:
        """Factorise in reduced precision, for quasi-Newton iterations; ``exact`` gives full precision.

        Called where ``reuses_factors`` holds.
        """

"""What the path and the sensitivities want of a linear solver."""

from typing import NamedTuple, Protocol

import numpy as np

_NONE = np.empty(0, np.int32)


class Scheme(NamedTuple):
    """How a storage arranges entries, for the kernel that finds their slots.

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
        Memory.

    positive : bool
        Of a matrix factorised as symmetric whether it is positive definite, of another one whether its
        determinant is positive.
    """

    nbytes: int
    positive: bool

    def kept(self) -> "Factor":
        """One that survives the next factorisation in the same storage."""

    def solve(self, rhs: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solve for one or several right-hand sides, shape (n,) or (n, m)."""


class Storage(Protocol):
    """Room for the tangent of n equations, and the solver that goes with it.

    Attributes
    ----------
    n, size : int
        Equations; entries of the buffer.
    reuses_factors : bool
        Whether a factorisation costs so many solutions that quasi-Newton iterations, which reuse one,
        are to be tried before Newton's.
    tells_sign : bool
        Whether its factors tell the sign of the determinant at no cost.
    scheme : Scheme
    """

    n: int
    size: int
    reuses_factors: bool
    tells_sign: bool
    scheme: Scheme

    def diagonal(self) -> np.ndarray:
        """Where the diagonal entries are, shape (n,)."""

    def factorize(self, values: np.ndarray, symmetric: bool = False) -> Factor:
        """Factor of the matrix in the buffer, which may be overwritten.

        A ``symmetric`` one is solved with as any other; its factor knows whether it is definite.

        Raises
        ------
        LinAlgError
            The matrix is singular.
        """

    def factorize_roughly(self, values: np.ndarray) -> Factor:
        """Factor good to some digits, for quasi-Newton iterations; what it ``kept`` is good to all.

        Asked of those that reuse factors.
        """

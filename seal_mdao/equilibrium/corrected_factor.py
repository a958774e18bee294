"""Sherman-Morrison-Woodbury: a factor of a matrix serves one that differs in few directions."""

import numpy as np

from seal_mdao.equilibrium.modes import nearest_mode


class CorrectedFactor:
    """(K + P D P^T)^-1 with the inverse of K given; P few columns.

    Parameters
    ----------
    factor : object
        Solves with K.
    columns : ndarray, shape (m, n)
        The columns of P.
    change : ndarray, shape (m, m)
        D, which may be singular.
    symmetric : bool
        K was factorised as symmetric, and D is.

    Raises
    ------
    LinAlgError
        The corrected matrix is singular.
    """

    def __init__(self, factor, columns: np.ndarray, change: np.ndarray, symmetric: bool = False):
        self.factor, self.columns, self.change = factor, columns, change
        self.symmetric = symmetric
        self.solved = np.array([factor.solve(column) for column in columns])
        self.relative = self._relative(self.solved, change)
        self.small = np.linalg.solve(self.relative, change)
        self._transposed = None

    def _relative(self, solved, change) -> np.ndarray:
        """1 + D P^T K^-1 P, singular where the corrected matrix is."""
        return np.eye(len(change)) + change @ (self.columns @ solved.T)

    @property
    def nbytes(self) -> int:
        """Memory."""
        return self.factor.nbytes + 3 * self.columns.nbytes

    @property
    def positive(self) -> bool:
        """Of a symmetric matrix whether it is positive definite, of another one its determinant."""
        if not self.symmetric:
            sign = np.linalg.slogdet(self.relative)[0]
            return self.factor.positive == (sign > 0.0)
        if self.factor.positive and np.linalg.eigvalsh(self.change)[0] >= 0.0:
            return True
        n = self.columns.shape[1]
        return nearest_mode(self, n, symmetric=True, negative=True)[0] > 0.0

    def kept(self) -> "CorrectedFactor":
        """One that survives the next factorisation in the same storage."""
        return CorrectedFactor(self.factor.kept(), self.columns, self.change, self.symmetric)

    def solve(self, rhs: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solve for one or several right-hand sides, shape (n,) or (n, m)."""
        if not transposed:
            solution = self.factor.solve(rhs)
            return solution - self.solved.T @ (self.small @ (self.columns @ solution))
        if self._transposed is None:
            solved = np.array([self.factor.solve(column, True) for column in self.columns])
            change = self.change.T
            self._transposed = solved, np.linalg.solve(self._relative(solved, change), change)
        solved, small = self._transposed
        solution = self.factor.solve(rhs, True)
        return solution - solved.T @ (small @ (self.columns @ solution))

"""Low-rank update of a factorised matrix by the Sherman-Morrison-Woodbury formula."""

import numpy as np

from seal_mdao.equilibrium.eigenmodes import nearest_mode


class CorrectedFactor:
    """Inverse of K + P D P^T from a factor of K; P has few columns.

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
        # (K + P D P^T)^-1 = K^-1 - K^-1 P S P^T K^-1,  S = (1 + D P^T K^-1 P)^-1 D;
        # rows of ``solved``: (K^-1 P)^T
        self.solved = np.array([factor.solve(column) for column in columns])
        self.relative = self._relative(self.solved, change)
        self.small = np.linalg.solve(self.relative, change)
        self._transposed = None

    def _relative(self, solved, change) -> np.ndarray:
        """Return 1 + D P^T K^-1 P, which is singular where the corrected matrix is."""
        return np.eye(len(change)) + change @ (self.columns @ solved.T)

    @property
    def nbytes(self) -> int:
        """Memory of the factor, bytes."""
        return self.factor.nbytes + 3 * self.columns.nbytes

    @property
    def positive(self) -> bool:
        """Whether a symmetric matrix is positive definite; for an unsymmetric one, whether its
        determinant is positive."""
        if not self.symmetric:
            # det(K + P D P^T) = det K det(1 + D P^T K^-1 P)
            sign = np.linalg.slogdet(self.relative)[0]
            return self.factor.positive == (sign > 0.0)
        # K > 0 and D >= 0 suffice; else the smallest eigenvalue of the inverse decides:
        # it is negative as soon as one eigenvalue of the matrix is
        if self.factor.positive and np.linalg.eigvalsh(self.change)[0] >= 0.0:
            return True
        n = self.columns.shape[1]
        return nearest_mode(self, n, symmetric=True, negative=True)[0] > 0.0

    def solve(self, rhs: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solve the corrected system for right-hand sides of shape (n,) or (n, m)."""
        if not transposed:
            solution = self.factor.solve(rhs)
            # x = y - K^-1 P S P^T y,  K y = rhs
            return solution - self.solved.T @ (self.small @ (self.columns @ solution))
        # the same with K^T and D^T; made at the first transposed solution
        if self._transposed is None:
            solved = np.array([self.factor.solve(column, True) for column in self.columns])
            change = self.change.T
            self._transposed = solved, np.linalg.solve(self._relative(solved, change), change)
        solved, small = self._transposed
        solution = self.factor.solve(rhs, True)
        return solution - solved.T @ (small @ (self.columns @ solution))

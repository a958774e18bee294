"""Block tridiagonal storage of the tangent and its LU factorisation by blocks (LAPACK).

Neighbouring equations are collected in blocks, so large that a block is coupled with itself, the one
before and the one after only. In the order of a breadth-first search of the particles these blocks are
layers across the section: few equations for a thin wall, more where an edge is glued, because the
essential transformation couples all particles near to it. A band has the width of the widest place
everywhere; blocks do not.

Gaussian elimination by blocks, with rows exchanged within blocks (G. H. Golub, C. F. Van Loan, Matrix
Computations, 4th edition 2013, sections 3.4 and 4.5). It is as stable as that of the whole matrix as
long as Schur complements do not grow, as those of positive definite matrices never do; if they do, the
whole matrix is factorised as one block. The triangular factors are applied to the blocks beside the
diagonal, not the inverses of the diagonal blocks: with these, errors grow with the condition of the
blocks (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd edition 2002, chapter 13).
"""

from functools import cached_property
from itertools import count, pairwise

import numpy as np
from scipy.linalg import blas, lapack

# Number of sizes of the first block that are tried: the others follow from it.
FIRST_BLOCKS = 12
# Largest entry of the Schur complements over that of the diagonal; with more, three digits are lost.
LARGEST_GROWTH = 1e3


def farthest_coupled(equations: np.ndarray, coupling) -> np.ndarray:
    """Compute for every equation the largest one that it, or any before it, is coupled with.

    Parameters
    ----------
    equations : ndarray of int, shape (n, 2)
        -1 for prescribed components.
    coupling : csr_array
        Coupled particles, each of them with itself.

    Returns
    -------
    ndarray of int, shape (n_equations,)
    """
    highest, free = equations.max(axis=1), equations >= 0
    # largest equation of the particles coupled with each particle
    owners = np.flatnonzero(np.diff(coupling.indptr))
    reached = np.full(len(equations), -1)
    reached[owners] = np.maximum.reduceat(highest[coupling.indices], coupling.indptr[owners])
    farthest = np.empty(np.count_nonzero(free), int)
    farthest[equations[free]] = np.broadcast_to(reached[:, None], equations.shape)[free]
    return np.maximum.accumulate(farthest)


def numbered(fixed: np.ndarray, order) -> np.ndarray:
    """Number the free components (n, 2) of the particles in the given order, -1 elsewhere."""
    equations = np.full(fixed.shape, -1)
    free = ~fixed[order]
    rank = np.cumsum(free.ravel()).reshape(free.shape) - 1
    equations[order] = np.where(free, rank, -1)
    return equations


def block_ends(farthest: np.ndarray) -> tuple[np.ndarray, float]:
    """Divide the equations into blocks with the least operations of a factorisation.

    Parameters
    ----------
    farthest : ndarray of int, shape (n,)
        Of ``farthest_coupled``.

    Returns
    -------
    ends : ndarray of int
        Ends of the blocks.
    operations : float
        Multiplications and additions of the factorisation.
    """
    found, reach = [], farthest.tolist()
    for first in np.unique(np.linspace(1, reach[0] + 1, FIRST_BLOCKS).astype(int)).tolist():
        ends = [first]
        while ends[-1] < len(reach):
            # up to the last equation coupled with the block before; equations that are not coupled
            # with it begin another body
            ends.append(max(reach[ends[-1] - 1], ends[-1]) + 1)
        found.append((_operations(ends), ends))
    operations, ends = min(found)
    return np.array(ends), operations


def _operations(ends: list) -> float:
    """Count the operations of a factorisation: sum_i 2/3 b_i^3 + 2 b_i b_i+1 (b_i + b_i+1)."""
    total, last, begin = 0.0, 0, 0
    for end in ends:
        size = end - begin
        total += 2.0 / 3.0 * size**3 + 2.0 * last * size * (last + size)
        last, begin = size, end
    return total


def rounding(diagonal: np.ndarray) -> float:
    """Estimate the rounding error n eps max |K_ii| of a zero eigenvalue (rigid motion)."""
    return diagonal.size * np.finfo(float).eps * float(np.abs(diagonal).max())


class BlockFactor:
    """Factors of a block tridiagonal matrix, row exchanges within the blocks.

    Attributes
    ----------
    rows : list of slice
        Equations of the blocks.
    factors : list of ndarray
        Triangular factors L_i U_i = P_i S_i of the Schur complements, in one array each.
    exchanged : list of ndarray of int
        Rows of the blocks in the order P_i.
    lower, upper : list of ndarray
        K_i+1,i U_i^-1 and L_i^-1 P_i K_i,i+1.
    signs : int
        Row exchanges and negative pivots.
    growth : float
        Largest entry of the Schur complements.
    definite : bool or None
        Whether a matrix factorised as symmetric is positive definite.

    Raises
    ------
    LinAlgError
        A Schur complement is singular.
    """

    def __init__(self, rows: list, blocks: list, symmetric: bool, rounded: float):
        self.rows, self.factors, self.exchanged, self.lower, self.upper = rows, [], [], [], []
        self.signs, self.growth, self.definite = 0, 0.0, True if symmetric else None
        # S_0 = K_00
        schur = blocks[0][0]
        for number, (_, right, below) in enumerate(blocks):
            self.growth = max(self.growth, float(np.abs(schur).max()))
            # row exchanges lose the inertia: K > 0 where all S + rounding have Cholesky factors
            if self.definite:
                self.definite = lapack.dpotrf(schur + rounded * np.eye(len(schur)))[1] == 0
            # P S = L U
            lu, pivots, info = lapack.dgetrf(schur)
            if info != 0:
                raise np.linalg.LinAlgError(f"the tangent is singular (dgetrf {info})")
            self.signs += np.count_nonzero(pivots != np.arange(len(lu)))
            self.signs += np.count_nonzero(lu.diagonal() < 0.0)
            order = _row_order(pivots)
            self.factors.append(lu)
            self.exchanged.append(order)
            if number + 1 < len(blocks):
                # S_i+1 = K_i+1,i+1 - (K_i+1,i U^-1) (L^-1 P K_i,i+1)
                upper = blas.dtrsm(1.0, lu, right[order], lower=1, diag=1)
                lower = blas.dtrsm(1.0, lu, below, side=1)
                schur = blas.dgemm(-1.0, lower, upper, 1.0, blocks[number + 1][0])
                self.lower.append(lower)
                self.upper.append(upper)

    @cached_property
    def nbytes(self) -> int:
        """Memory of the factors, bytes."""
        return sum(part.nbytes for part in (*self.factors, *self.lower, *self.upper))

    @property
    def positive(self) -> bool:
        """Whether a symmetric matrix is positive definite; for an unsymmetric one, whether its
        determinant is positive."""
        if self.definite is not None:
            return self.definite
        # sign of det K = (-1)^(row exchanges + negative pivots)
        return self.signs % 2 == 0

    def solve(self, rhs: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solve for right-hand sides of shape (n,) or (n, m)."""
        x = [rhs[own] for own in self.rows]
        blocks = list(zip(count(), self.factors, self.exchanged, strict=False))
        if transposed:
            for i, lu, _ in blocks:
                # z_i = U_i^-T (b_i - (L_i-1^-1 P_i-1 K_i-1,i)^T z_i-1)
                known = x[i] - self.upper[i - 1].T @ x[i - 1] if i else x[i]
                x[i] = _solved(lu, known, trans=1)
            for i, lu, order in reversed(blocks):
                # x_i = P_i^T L_i^-T (z_i - (K_i+1,i U_i^-1)^T x_i+1)
                known = x[i] - self.lower[i].T @ x[i + 1] if i < len(self.lower) else x[i]
                x[i] = np.empty_like(known)
                x[i][order] = _solved(lu, known, lower=1, trans=1)
        else:
            for i, lu, order in blocks:
                # z_i = L_i^-1 P_i (b_i - K_i,i-1 U_i-1^-1 z_i-1)
                known = x[i] - self.lower[i - 1] @ x[i - 1] if i else x[i]
                x[i] = _solved(lu, known[order], lower=1)
            for i, lu, _ in reversed(blocks):
                # x_i = U_i^-1 (z_i - L_i^-1 P_i K_i,i+1 x_i+1)
                known = x[i] - self.upper[i] @ x[i + 1] if i < len(self.upper) else x[i]
                x[i] = _solved(lu, known)
        return np.concatenate(x)


def _row_order(pivots: np.ndarray) -> np.ndarray:
    """Return the rows in the order to which LAPACK's exchanges, row i with row pivots[i], bring them."""
    rows = np.arange(len(pivots), dtype=float)[:, None]
    return lapack.dlaswp(rows, pivots)[:, 0].astype(int)


def _solved(lu, rhs, lower=0, trans=0):
    """Return L^-1 b or U^-1 b, or with the transpose, for b of shape (n,) or (n, m)."""
    if rhs.ndim == 1:
        return blas.dtrsv(lu, rhs, lower=lower, trans=trans, diag=lower)
    return blas.dtrsm(1.0, lu, rhs, lower=lower, trans_a=trans, diag=lower)


class BlockTridiagonal:
    """Storage of a block tridiagonal matrix.

    Each column has the rows of the block before its own, of its own, and of the block after.

    Parameters
    ----------
    ends : ndarray of int
        Ends of the blocks, in equations.
    """

    def __init__(self, ends: np.ndarray):
        self.n, edges = int(ends[-1]), [0, *ends.tolist()]
        # equations of every block, and rows of its columns
        self.rows = [slice(*pair) for pair in pairwise(edges)]
        self.stored = [
            slice(edges[max(i - 1, 0)], edges[min(i + 2, len(ends))]) for i in range(len(ends))
        ]
        shapes = [
            (stored.stop - stored.start, own.stop - own.start)
            for stored, own in zip(self.stored, self.rows, strict=True)
        ]
        self.shapes, self.starts = shapes, np.cumsum([0, *(m * n for m, n in shapes)]).tolist()

    @property
    def size(self) -> int:
        return self.starts[-1]

    @cached_property
    def origins(self) -> np.ndarray:
        """Slot of row 0 of every column, had it one, shape (n,): that of an entry is origins[j] + i."""
        found = zip(self.starts, self.stored, self.shapes, strict=False)
        # start of the block + j height + i - its first row
        origins = [start + m * np.arange(n) - stored.start for start, stored, (m, n) in found]
        return np.concatenate(origins)

    def diagonal(self) -> np.ndarray:
        """Return the indices of the diagonal entries, shape (n,)."""
        return self.origins + np.arange(self.n)

    def factorize(self, values: np.ndarray, symmetric: bool = False) -> BlockFactor:
        """Factorise the matrix with the given entries; the factor does not refer to them.

        Raises
        ------
        LinAlgError
            The matrix is singular.
        """
        # the columns of every block: K_i-1,i above K_ii above K_i+1,i
        columns = [
            values[start : start + m * n].reshape((m, n), order="F")
            for start, (m, n) in zip(self.starts, self.shapes, strict=False)
        ]
        blocks = []
        for i, (own, stored) in enumerate(zip(self.rows, self.stored, strict=True)):
            first, end = own.start - stored.start, own.stop - stored.start
            right = columns[i + 1][: end - first] if i + 1 < len(columns) else None
            blocks.append((columns[i][first:end], right, columns[i][end:]))
        diagonal = values[self.diagonal()]
        try:
            factor = BlockFactor(self.rows, blocks, symmetric, rounding(diagonal))
        except np.linalg.LinAlgError:
            factor = None
        if factor is not None and factor.growth <= LARGEST_GROWTH * np.abs(diagonal).max():
            return factor
        # a leading part of the matrix is nearly singular: exchange rows of all blocks
        whole = np.zeros((self.n, self.n), order="F")
        for own, stored, part in zip(self.rows, self.stored, columns, strict=True):
            whole[stored, own] = part
        return BlockFactor([slice(0, self.n)], [(whole, None, None)], symmetric, rounding(diagonal))

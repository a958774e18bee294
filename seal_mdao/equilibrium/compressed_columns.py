"""Compressed columns of the tangent, the storage of the sparse solvers."""

import numpy as np
from scipy.sparse import csc_array

from seal_mdao.equilibrium.storage import Scheme


class CompressedColumns:
    """Compressed sparse columns (CSC) of a matrix with symmetric pattern (``equilibrium.storage``).

    Attributes
    ----------
    n : int
    pointers, indices : ndarray of int32
    """

    reuses_factors = True
    has_sign = False

    def __init__(self, n, pointers, indices):
        self.n, self.pointers, self.indices = n, pointers, indices

    @property
    def size(self):
        return self.indices.size

    @property
    def scheme(self):
        return Scheme(pointers=self.pointers, indices=self.indices)

    def factorize_roughly(self, values):
        """Factorise as ``factorize`` does, unless a storage has a faster method."""
        return self.factorize(values)

    def diagonal(self):
        """Return the indices of the diagonal entries, shape (n,)."""
        # row = column; every column has its diagonal entry, for all couplings include themselves
        columns = np.repeat(np.arange(self.n), np.diff(self.pointers))
        return np.flatnonzero(self.indices == columns)


def rounding(diagonal: np.ndarray) -> float:
    """Estimate the rounding error n eps max |K_ii| of a zero eigenvalue (rigid motion)."""
    return diagonal.size * np.finfo(float).eps * float(np.abs(diagonal).max())


def dof_pattern(equations, n, coupling):
    """Build column pointers and sorted row indices of the equations from coupled particles."""
    # each pair of coupled particles gives a 2 x 2 block (component i of rows, k of columns);
    # prescribed components (-1) have no equation
    coupling = coupling.tocoo()
    rows, columns = [], []
    for i in range(2):
        for k in range(2):
            r, c = equations[coupling.row, i], equations[coupling.col, k]
            keep = (r >= 0) & (c >= 0)
            rows.append(r[keep])
            columns.append(c[keep])
    r, c = np.concatenate(rows), np.concatenate(columns)
    pattern = csc_array((np.ones(r.size, np.int8), (r, c)), shape=(n, n))
    pattern.sort_indices()
    return pattern.indptr.astype(np.int32), pattern.indices.astype(np.int32)

"""Storage of the tangent and its factorisation: banded LAPACK, SuperLU, or PARDISO when installed."""

from functools import cached_property
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np
from scipy.linalg import lapack
from scipy.sparse import csc_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from seal_mdao.equilibrium.compressed_columns import CompressedColumns, dof_pattern, rounding
from seal_mdao.equilibrium.pardiso import PardisoStorage
from seal_mdao.equilibrium.storage import Scheme, Storage

SOLVERS = ("auto", "banded", "superlu", "pardiso")

# Threshold c between band and sparse storage. The band has no fill-in and works in large blocks, but
# every Newton iteration factorises it; a sparse storage takes one factorisation a step and a few
# quasi-Newton iterations. With r band entries for one entry of the pattern and n unknowns,
# time(band) / time(sparse) = (r n^(1/5) / c)^1.3, fitted on one core to fourteen rings of 330 to 1,700
# unknowns with PARDISO (within a third), and to seven with SuperLU (within a quarter).
WIDEST_BAND = {"pardiso": 8.4, "superlu": 12.6}


class BandedFactor:
    """LU factors of a banded matrix (LAPACK gbtrf)."""

    def __init__(self, storage, band, pivots, definite=None):
        self.storage, self.band, self.pivots = storage, band, pivots
        self.definite = definite

    @property
    def nbytes(self) -> int:
        return self.band.nbytes

    def exact(self):
        """Return the factor itself, in double precision."""
        return self

    @property
    def positive(self) -> bool:
        """Whether a symmetric matrix is positive definite; for an unsymmetric one, whether its
        determinant is positive."""
        if self.definite is not None:
            return self.definite
        # sign of det K = (-1)^(row exchanges + negative pivots); U's diagonal is band row 2 w
        exchanges = np.count_nonzero(self.pivots != np.arange(self.storage.n))
        negative = np.count_nonzero(self.band[2 * self.storage.width] < 0.0)
        return (exchanges + negative) % 2 == 0

    def solve(self, rhs, transposed=False):
        """Solve for right-hand sides of shape (n,) or (n, m)."""
        s = self.storage
        # x = U^-1 L^-1 P b, or its transpose
        solution, info = lapack.dgbtrs(
            self.band, s.width, s.width, rhs, self.pivots, trans=int(transposed)
        )
        if info != 0:
            raise np.linalg.LinAlgError(f"dgbtrs returned {info}")
        return solution


class BandedStorage(NamedTuple):
    """LAPACK band storage with equal half-widths; see ``equilibrium.storage``."""

    n: int
    width: int
    reuses_factors = False
    has_sign = True

    @property
    def rows(self):
        return 3 * self.width + 1

    @property
    def size(self):
        return self.rows * self.n

    @property
    def scheme(self):
        return Scheme(rows=self.rows, width=self.width)

    def diagonal(self):
        """Return the indices of the diagonal entries, shape (n,)."""
        # AB[2 w, j] = K_jj
        return 2 * self.width + self.rows * np.arange(self.n)

    def factorize(self, values, symmetric=False):
        band = values[: self.rows * self.n].reshape((self.rows, self.n), order="F")
        definite = None
        if symmetric:
            # row exchanges in LU lose the inertia: K + rounding has a Cholesky factor iff K is definite
            lower = band[2 * self.width :].copy(order="F")
            lower[0] += rounding(lower[0])
            _, info = lapack.dpbtrf(lower, lower=1, overwrite_ab=True)
            definite = info == 0
        # P K = L U
        lu, pivots, info = lapack.dgbtrf(band, self.width, self.width)
        if info != 0:
            raise np.linalg.LinAlgError(f"the tangent is singular (dgbtrf {info})")
        return BandedFactor(self, lu, pivots, definite)


class SparseFactor:
    """SuperLU factors."""

    def __init__(self, lu, symmetric=False):
        self.lu, self.symmetric = lu, symmetric

    @property
    def nbytes(self) -> int:
        """Memory of the values (8 bytes) and row indices (4) of L and U."""
        return 12 * self.lu.nnz

    def exact(self):
        """Return the factor itself, in double precision."""
        return self

    @cached_property
    def positive(self) -> bool:
        """Whether a symmetric matrix is positive definite; for an unsymmetric one, whether its
        determinant is positive."""
        pivots = self.lu.U.diagonal()
        # Sylvester's law of inertia: with P K P^T = L D L^T the pivots have the signs of the eigenvalues
        if self.symmetric and np.array_equal(self.lu.perm_r, self.lu.perm_c):
            return bool((pivots > -rounding(pivots)).all())
        # sign of det K = sign of the pivots times the signs of both permutations
        odd = np.count_nonzero(pivots < 0.0) + exchanges(self.lu.perm_r) + exchanges(self.lu.perm_c)
        return odd % 2 == 0

    def solve(self, rhs, transposed=False):
        """Solve for right-hand sides of shape (n,) or (n, m)."""
        return self.lu.solve(np.ascontiguousarray(rhs), trans="T" if transposed else "N")


def exchanges(permutation: np.ndarray) -> int:
    """Count the transpositions of a permutation: its length minus the number of its cycles."""
    n = permutation.size
    links = csc_array((np.ones(n, np.int8), (np.arange(n), permutation)), shape=(n, n))
    return n - connected_components(links, directed=False, return_labels=False)


class SparseStorage(CompressedColumns):
    """Compressed columns factorised by SuperLU."""

    def factorize(self, values, symmetric=False):
        matrix = csc_array(
            (values[: self.size], self.indices, self.pointers), shape=(self.n, self.n)
        )
        try:
            # minimum degree on K^T + K; diagonal pivots preferred: rows and columns permuted alike
            lu = splu(
                matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001,
                options={"SymmetricMode": True},
            )  # fmt: skip
        except RuntimeError as error:
            raise np.linalg.LinAlgError(f"the tangent is singular ({error})") from None
        return SparseFactor(lu, symmetric)


def storage_for(solver: str, n: int, width: int, equations, coupling) -> Storage:
    """Choose storage and solver for ``n`` equations with half-width ``width``.

    Parameters
    ----------
    solver : {"auto", "banded", "superlu", "pardiso"}
        "auto" takes the band where it has few entries outside the pattern, else PARDISO where
        pypardiso is installed, else SuperLU.
    equations : ndarray of int, shape (n_particles, 2)
    coupling : csr_array
        Coupled particles.

    Raises
    ------
    ValueError
        Unknown solver.
    ImportError
        PARDISO is required, pypardiso not installed.
    """
    if solver not in SOLVERS:
        raise ValueError(f"the linear solver must be one of {SOLVERS}, got {solver!r}")
    if solver == "auto":
        sparse = "pardiso" if find_spec("pypardiso") else "superlu"
        # r = 2 w n entries of the band / 4 nnz entries of the pattern (2 x 2 for each pair)
        entries = width * n / (2.0 * coupling.nnz)
        solver = "banded" if entries * n**0.2 <= WIDEST_BAND[sparse] else sparse
    if solver == "banded":
        return BandedStorage(n, width)
    storage = SparseStorage if solver == "superlu" else PardisoStorage
    return storage(n, *dof_pattern(equations, n, coupling))

"""PARDISO of oneMKL through pypardiso (extra ``pardiso``), for clouds too wide for a band.

The ordering is computed once for a design; each factorisation then is numerical only. Those for the
iterations are in single precision, which halves time and memory traffic of every solution;
residuals, the tangents that are differentiated and the signs are in double precision.
"""

import ctypes
import os
import sys
from collections import deque
from contextlib import suppress
from functools import cached_property
from importlib import import_module
from pathlib import Path
from threading import Lock, local

import numpy as np
from scipy.sparse import csr_array

from seal_mdao.equilibrium.compressed_columns import CompressedColumns, rounding
from seal_mdao.equilibrium.eigenmodes import nearest_mode
from seal_mdao.equilibrium.threads import one_blas_thread

# Phases of a call: analysis, numerical factorisation, solution, release of one factor or of all;
# matrix types mtype: real, structurally symmetric or symmetric positive definite;
# indices (from 1) into iparm: solve with the transpose, entries of the factors, single precision.
ORDER, FACTORIZE, SOLVE, LET_GO, LET_ALL_GO = 11, 22, 33, 0, -1
STRUCTURALLY_SYMMETRIC, POSITIVE_DEFINITE = 1, 2
TRANSPOSE, ENTRIES, SINGLE = 12, 18, 28
TRANSPOSED = 2

# With its default settings PARDISO refines every solution twice, which adds twice its time and leaves
# residuals of the same size. With these it refines only where it perturbed a pivot: minimum degree
# (nested dissection is as fast with 9,000 unknowns, 5 % faster with 20,000), pivots of at least 1e-13,
# scaling, weighted matching.
SETTINGS = {1: 1, 2: 0, 10: 13, 11: 1, 13: 1}

MOST_FACTORS = 1000
"""Number of factors that one handle can hold; they are numbered from 1."""

LIBRARY = "PYPARDISO_MKL_RT"
"""Environment variable with pypardiso's path to MKL."""

WITH_BLAS = ("unopy", "ipyopt")
"""Modules with a BLAS of their own under the common symbol names. MKL exports its symbols to every
library loaded after it: these are loaded first, so that results are bitwise independent of earlier
PARDISO calls."""


def import_pypardiso():
    """Import pypardiso, or raise a one-line ImportError that names the extra."""
    for name in WITH_BLAS:
        with suppress(ImportError):
            import_module(name)
    # pip puts MKL beside Python's libraries; pypardiso would start programs and search all folders
    beside = sorted((Path(sys.prefix) / "lib").glob("libmkl_rt*"))
    if beside:
        os.environ.setdefault(LIBRARY, str(beside[0]))
    try:
        import pypardiso
    except ImportError as error:
        raise ImportError(
            f'the linear solver "pardiso" needs the Python package pypardiso ({error}): pip '
            'install "seal_mdao[pardiso]"'
        ) from None
    # without the path every handle searches the complete environment for the library
    os.environ.setdefault(LIBRARY, pypardiso.ps.libmkl._name)
    return pypardiso


class PardisoFactor:
    """One of the factors in a handle; its memory is freed with this object."""

    def __init__(self, handle, matrix):
        self.handle, self.matrix, self.definite = handle, matrix, None
        self.number = handle.factorize(matrix)

    @property
    def nbytes(self) -> int:
        # entries of L and U as PARDISO reports them, and the matrix itself (for the refinement)
        data = self.matrix.data
        return data.itemsize * (self.handle.entries + data.size)

    def exact(self):
        """Return the factor itself, in double precision."""
        return self

    @cached_property
    def positive(self) -> bool:
        """Whether a symmetric matrix is positive definite; for an unsymmetric one, whether its
        eigenvalue nearest to zero is positive, because PARDISO does not report the sign of the
        determinant."""
        if self.definite is not None:
            return self.definite
        return nearest_mode(self, self.matrix.shape[0], symmetric=False)[0] > 0.0

    def solve(self, rhs, transposed=False):
        """Solve for right-hand sides of shape (n,) or (n, m)."""
        return self.handle.solve(self.number, self.matrix, np.asfortranarray(rhs), transposed)

    def __del__(self, ending=sys.is_finalizing):  # ``sys`` may be gone by then
        if hasattr(self, "number") and not ending():
            self.handle.drop(self.number)


class RoughFactor:
    """Factors in single precision, of which ``exact`` gives those in double precision."""

    def __init__(self, storage: "PardisoStorage", values: np.ndarray):
        self.storage, self.values = storage, values
        self.factor = storage.factor_of(values.astype(np.float32))

    @property
    def nbytes(self) -> int:
        """Memory of the exact factors."""
        return 2 * self.factor.nbytes

    def exact(self):
        """Compute the factors in double precision."""
        return self.storage.factorize(self.values)

    @property
    def positive(self) -> bool:
        """``positive`` of the exact factors."""
        return self.exact().positive

    def solve(self, rhs, transposed=False):
        """Solve in single precision for right-hand sides of shape (n,) or (n, m)."""
        return self.factor.solve(np.asarray(rhs, np.float32), transposed).astype(float)


class PardisoStorage(CompressedColumns):
    """Compressed columns factorised by PARDISO.

    Every thread has its own handles with their ordering, one for each kind of factors.
    """

    def __init__(self, n, pointers, indices):
        super().__init__(n, pointers, indices)
        self._module, self._of_thread = import_pypardiso(), local()
        self._error = self._module.pardiso_wrapper.PyPardisoError
        one_blas_thread.find_libraries_again()

    def _handle(self, matrix, kind: int) -> "Handle":
        """Return the handle of this thread for matrices of a kind and precision."""
        handles, name = vars(self._of_thread), f"{kind} {matrix.dtype}"
        # the analysis (ordering, symbolic factorisation) depends on the pattern alone: once a handle
        if name not in handles or handles[name].full:
            handles[name] = Handle(self._module, matrix, kind)
        return handles[name]

    def factor_of(self, values) -> PardisoFactor:
        """Factorise a matrix in the precision of its entries."""
        # compressed columns of K are compressed rows of K^T; the pattern is symmetric
        matrix = csr_array((values, self.indices, self.pointers), shape=(self.n, self.n))
        try:
            return PardisoFactor(self._handle(matrix, STRUCTURALLY_SYMMETRIC), matrix)
        except self._error as error:
            raise np.linalg.LinAlgError(f"the tangent is singular (PARDISO: {error})") from None

    def factorize(self, values, symmetric=False):
        factor = self.factor_of(values[: self.size])
        if symmetric:
            factor.definite = self._is_definite(values)
        return factor

    def factorize_roughly(self, values):
        return RoughFactor(self, values[: self.size])

    @cached_property
    def _lower(self):
        """Indices of the entries on and below the diagonal, and their compressed columns."""
        columns = np.repeat(np.arange(self.n), np.diff(self.pointers))
        kept = np.flatnonzero(self.indices >= columns)
        counts = np.bincount(columns[kept], minlength=self.n)
        pointers = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        return kept, self.indices[kept], pointers

    def _is_definite(self, values) -> bool:
        """Return whether a symmetric matrix plus a rounding error has a Cholesky factor."""
        kept, indices, pointers = self._lower
        entries = values[kept]
        # the diagonal entry is the first of a column
        entries[pointers[:-1]] += rounding(entries[pointers[:-1]])
        # columns of the lower triangle are rows of the upper one
        matrix = csr_array((entries, indices, pointers), shape=(self.n, self.n))
        try:
            PardisoFactor(self._handle(matrix, POSITIVE_DEFINITE), matrix)
        except self._error:
            return False
        return True


def _integer(value: int):
    return ctypes.byref(ctypes.c_int32(value))


def _address(array: np.ndarray):
    """Return a pointer to the first entry of an array."""
    # the wrapper declares all numbers as double, whatever precision the library is asked for
    kind = ctypes.c_int32 if array.dtype == np.int32 else ctypes.c_double
    return array.ctypes.data_as(ctypes.POINTER(kind))


class Handle:
    """PARDISO's memory of one pattern: its ordering and its numbered factors, freed with the handle.

    pypardiso holds one factor for each ordering, in double precision.

    Parameters
    ----------
    module : module
        pypardiso.
    matrix : csr_array
        With the pattern, and the precision of all factors.
    kind : int
        Matrix type.
    """

    def __init__(self, module, matrix, kind: int):
        self.solver, self._error = module.PyPardisoSolver(mtype=kind), module.pardiso_wrapper
        self._lock, self._unused, self._dropped = Lock(), [*range(MOST_FACTORS, 0, -1)], deque()
        self._is_free = False
        settings = SETTINGS if kind == STRUCTURALLY_SYMMETRIC else {}
        # -1: report the number of entries of the factors
        settings = settings | {ENTRIES: -1, SINGLE: int(matrix.dtype == np.float32)}
        for index, value in settings.items():
            self.solver.set_iparm(index, value)
        # Fortran indices from 1; converted once for all calls of this handle
        self._pattern = matrix.indptr + np.int32(1), matrix.indices + np.int32(1)
        self._fixed = [_address(array) for array in (*self._pattern, self.solver.perm)]
        self._iparm, self._messages = _address(self.solver.iparm), _integer(0)
        self._memory = self.solver.pt.ctypes.data_as(ctypes.POINTER(ctypes.c_int64))
        self._nothing = np.zeros(matrix.shape[0], matrix.dtype)
        self._call(ORDER, 1, matrix, self._nothing)

    @property
    def full(self) -> bool:
        """Whether all numbers of factors are in use."""
        return not (self._unused or self._dropped)

    @property
    def entries(self) -> int:
        """Number of entries of a factor."""
        return int(self.solver.get_iparm(ENTRIES))

    def factorize(self, matrix) -> int:
        """Factorise a matrix under a number that no other factor has, and return that."""
        with self._lock:
            self._let_go()
            # the memory of a factor that is gone is used again
            number = (self._dropped or self._unused).pop()
            try:
                self._call(FACTORIZE, number, matrix, self._nothing)
            except self._error.PyPardisoError:
                self._dropped.append(number)
                raise
            return number

    def solve(self, number: int, matrix, rhs, transposed: bool):
        """Solve with the factor ``number`` of a matrix."""
        with self._lock:
            self._let_go()
            # the stored columns are the rows of the transposed matrix
            self.solver.set_iparm(TRANSPOSE, 0 if transposed else TRANSPOSED)
            return self._call(SOLVE, number, matrix, rhs)

    def drop(self, number: int) -> None:
        """Free a factor, at once or, where the handle is in use, with the next call; the memory of one
        stays for the next factorisation."""
        if self._is_free:  # the collector takes a handle and its factors in any order
            return
        self._dropped.append(number)
        # the collector may come in the middle of a call, so there is no waiting here
        if self._lock.acquire(blocking=False):
            try:
                self._let_go()
            finally:
                self._lock.release()

    def _let_go(self) -> None:
        while len(self._dropped) > 1:
            number = self._dropped.popleft()
            self._call(LET_GO, number, None, np.zeros(0))
            self._unused.append(number)

    def _call(self, phase, number, matrix, rhs):
        """Call MKL as pypardiso does, but without converting the pattern again in every call."""
        x, error = np.zeros_like(rhs), ctypes.c_int32(0)
        numbers = MOST_FACTORS, number, self.solver.mtype, phase, self._nothing.size
        data = _address(rhs if matrix is None else matrix.data)
        columns = 1 if rhs.ndim == 1 else rhs.shape[1]
        self.solver._mkl_pardiso(
            self._memory, *map(_integer, numbers), data, *self._fixed, _integer(columns), self._iparm,
            self._messages, _address(rhs), _address(x), ctypes.byref(error),
        )  # fmt: skip
        if error.value != 0:
            raise self._error.PyPardisoError(error.value)
        return np.ascontiguousarray(x)

    def __del__(self, ending=sys.is_finalizing):
        if not ending():
            self._is_free = True
            self._call(LET_ALL_GO, 1, None, np.zeros(0))

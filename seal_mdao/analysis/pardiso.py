"""PARDISO of oneMKL by way of pypardiso (extra ``pardiso``), for clouds too wide for a band.

The ordering is found once for a design; each factorisation then is numerical only.
"""

import ctypes
import os
import sys
from contextlib import suppress
from functools import cached_property
from importlib import import_module
from threading import Lock, local

import numpy as np
from scipy.sparse import csr_array

from seal_mdao.analysis.compressed_columns import CompressedColumns, rounding
from seal_mdao.analysis.modes import nearest_mode
from seal_mdao.analysis.threads import one_blas_thread

# Phases, and the matrix types: real, structurally symmetric or symmetric positive definite.
ORDER, FACTORIZE, SOLVE = 11, 22, 33
STRUCTURALLY_SYMMETRIC, POSITIVE_DEFINITE = 1, 2
TRANSPOSE, FACTOR_KIB = 12, 17
TRANSPOSED = 2

# With its own settings PARDISO refines every solution twice, which takes twice the time again and leaves
# residuals of the same size. With these it does so only where it had to change a pivot: minimum degree
# (nested dissection is as fast with 9,000 unknowns, 5 % faster with 20,000), pivots of at least 1e-13,
# scaling, matching.
SETTINGS = {1: 1, 2: 0, 10: 13, 11: 1, 13: 1}

LIBRARY = "PYPARDISO_MKL_RT"
"""Environment variable with pypardiso's path to MKL."""

WITH_BLAS = ("unopy", "ipyopt")
"""Modules with a BLAS of their own under the common names. MKL makes its names known to all that is
loaded after it: bits of an optimisation would hang on whether an analysis had taken PARDISO before."""


def import_pypardiso():
    """The module, or a one-line ImportError that names the extra."""
    for name in WITH_BLAS:
        with suppress(ImportError):
            import_module(name)
    try:
        import pypardiso
    except ImportError as error:
        raise ImportError(
            f'the solver "pardiso" needs pypardiso ({error}): pip install "seal_mdao[pardiso]"'
        ) from None
    # else every handle walks through the whole environment in search of it
    os.environ.setdefault(LIBRARY, pypardiso.ps.libmkl._name)
    return pypardiso


class PardisoFactor:
    """Factors that live in a PARDISO handle, which is freed with them."""

    def __init__(self, handle, matrix, definite=None):
        self.handle, self.matrix, self.definite = handle, matrix, definite

    @property
    def nbytes(self) -> int:
        return 1024 * int(self.handle.get_iparm(FACTOR_KIB))

    def kept(self):
        """This factor, with a matrix of its own; the next factorisation takes another handle."""
        self.handle.shared = False
        return PardisoFactor(self.handle, self.matrix.copy(), self.definite)

    @cached_property
    def positive(self) -> bool:
        """Whether a symmetric matrix is positive definite; of another one whether its eigenvalue next
        to zero is, for PARDISO tells no sign of the determinant."""
        if self.definite is not None:
            return self.definite
        return nearest_mode(self, self.matrix.shape[0], symmetric=False)[0] > 0.0

    def solve(self, rhs, transposed=False):
        """Solve for one or several right-hand sides, shape (n,) or (n, m)."""
        with self.handle.lock:
            # the stored columns are the rows of the transposed matrix
            self.handle.set_iparm(TRANSPOSE, 0 if transposed else TRANSPOSED)
            self.handle.set_phase(SOLVE)
            return self.handle._call_pardiso(self.matrix, np.asfortranarray(rhs))


class PardisoStorage(CompressedColumns):
    """Factorised by PARDISO; every thread has an ordered handle of its own."""

    def __init__(self, n, pointers, indices):
        super().__init__(n, pointers, indices)
        self._module, self._of_thread = import_pypardiso(), local()
        self._error = self._module.pardiso_wrapper.PyPardisoError
        one_blas_thread.find_libraries_again()

    def _factorized(self, matrix, kind: int):
        """A handle with the factor of a matrix, one that held no factor that is still wanted."""
        handles = vars(self._of_thread)
        handle = handles.get(str(kind))
        if handle is None or not handle.shared:
            handle = _handle_class(self._module)(matrix, kind)
            if kind == STRUCTURALLY_SYMMETRIC:
                for place, value in SETTINGS.items():
                    handle.set_iparm(place, value)
            handle.set_phase(ORDER)
            handle._call_pardiso(matrix, np.zeros(self.n))
            handles[str(kind)] = handle
        handle.set_phase(FACTORIZE)
        handle._call_pardiso(matrix, np.zeros(self.n))
        return handle

    def factorize(self, values, symmetric=False):
        matrix = csr_array(
            (values[: self.size], self.indices, self.pointers), shape=(self.n, self.n)
        )
        try:
            handle = self._factorized(matrix, STRUCTURALLY_SYMMETRIC)
        except self._error as error:
            raise np.linalg.LinAlgError(f"the tangent is singular (PARDISO: {error})") from None
        return PardisoFactor(handle, matrix, self._is_definite(values) if symmetric else None)

    @cached_property
    def _lower(self):
        """Where the entries on and below the diagonal are, and their compressed columns."""
        columns = np.repeat(np.arange(self.n), np.diff(self.pointers))
        kept = np.flatnonzero(self.indices >= columns)
        counts = np.bincount(columns[kept], minlength=self.n)
        pointers = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        return kept, self.indices[kept], pointers

    def _is_definite(self, values) -> bool:
        """Whether a symmetric matrix has a Cholesky factor, but for rounding."""
        kept, indices, pointers = self._lower
        entries = values[kept]
        # the diagonal entry is the first of a column
        entries[pointers[:-1]] += rounding(entries[pointers[:-1]])
        # columns of the lower triangle are rows of the upper one
        matrix = csr_array((entries, indices, pointers), shape=(self.n, self.n))
        try:
            self._factorized(matrix, POSITIVE_DEFINITE)
        except self._error:
            return False
        return True


def _integer(value: int):
    return ctypes.byref(ctypes.c_int32(value))


def _address(array: np.ndarray):
    """Where an array begins."""
    kind = ctypes.c_double if array.dtype == np.float64 else ctypes.c_int32
    return array.ctypes.data_as(ctypes.POINTER(kind))


def _handle_class(module):
    """PARDISO's handle for one pattern, which frees MKL's memory when it is dropped."""

    class Handle(module.PyPardisoSolver):
        shared = True

        def __init__(self, matrix, kind: int):
            super().__init__(mtype=kind)
            self.lock = Lock()
            self._pattern = matrix.indptr + np.int32(1), matrix.indices + np.int32(1)

        def _call_pardiso(self, matrix, rhs):
            """As of pypardiso, which makes the pattern anew in every call."""
            x, error = np.zeros_like(rhs), ctypes.c_int32(0)
            numbers = 1, 1, self.mtype, self.phase, matrix.shape[0]
            arrays = matrix.data, *self._pattern, self.perm
            columns = 1 if rhs.ndim == 1 else rhs.shape[1]
            self._mkl_pardiso(
                self.pt.ctypes.data_as(ctypes.POINTER(self._pt_type[0])), *map(_integer, numbers),
                *map(_address, arrays), _integer(columns), _address(self.iparm),
                _integer(self.msglvl), _address(rhs), _address(x), ctypes.byref(error),
            )  # fmt: skip
            if error.value != 0:
                raise module.pardiso_wrapper.PyPardisoError(error.value)
            return np.ascontiguousarray(x)

        def __del__(self, ending=sys.is_finalizing):  # ``sys`` may be gone by then
            if not ending():
                self.free_memory(everything=True)

    return Handle

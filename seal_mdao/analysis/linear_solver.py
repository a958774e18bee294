"""Where the entries of the tangent go, and its factorisation: banded LAPACK or sparse SuperLU.

The assembly kernels add to one flat buffer through precomputed slots, so they do not know which
solver is behind. The last entry of the buffer collects what belongs to imposed displacements.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numba as nb
import numpy as np
from scipy.linalg import lapack
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, reverse_cuthill_mckee
from scipy.sparse.linalg import splu

SOLVERS = ("auto", "banded", "superlu")

# Clouds up to this size get their band narrowed by trying that many starting particles.
SEARCHED_CLOUD, SEARCHED_STARTS = 2000, 20

WIDEST_BAND = 160


class Scatter(NamedTuple):
    """Destinations of the element entries of one shape table.

    Attributes
    ----------
    equations : ndarray of int, shape (n, 2)
        Equation of every displacement component, -1 where it is imposed.
    start : ndarray of int, shape (n_groups + 1,)
        Where the slots of a group begin.
    slots : ndarray of int32
        Flat (group, column, row) with local rows and columns ordered (component, neighbour).
    """

    equations: np.ndarray
    start: np.ndarray
    slots: np.ndarray


@dataclass(frozen=True, eq=False)
class TangentLayout:
    """Equation numbers, scatter maps and the storage of the tangent.

    Attributes
    ----------
    n_equations, size : int
        Unknowns, and length of the value buffer.
    scatter : tuple of Scatter
        One for each shape table, in the order given.
    storage : BandedStorage or SparseStorage
    """

    n_equations: int
    size: int
    scatter: tuple
    storage: object

    @property
    def equations(self) -> np.ndarray:
        return self.scatter[0].equations

    def factorize(self, values: np.ndarray):
        """Factor of the matrix in the buffer ``values``, which may be overwritten by it.

        The factor is good until the buffer is filled again; ``factor.kept()`` stays.
        """
        return self.storage.factorize(values)

    def reduce(self, nodal: np.ndarray | None):
        """Values of particles (n, 2) in the order of the equations; zero for None."""
        if nodal is None:
            return 0.0
        free = self.equations >= 0
        out = np.empty(self.n_equations)
        out[self.equations[free]] = nodal[free]
        return out

    def gather(self, vector: np.ndarray) -> np.ndarray:
        """Spread a solution (n_equations, ...) to particles (n, 2, ...), zero where imposed."""
        padded = np.concatenate([vector, np.zeros((1, *vector.shape[1:]))])
        return padded[self.equations]


class BandedFactor:
    """LU factors of a banded matrix (LAPACK gbtrf)."""

    def __init__(self, storage, band, pivots):
        self.storage, self.band, self.pivots = storage, band, pivots

    def kept(self):
        """A copy that does not share the buffer of the matrix."""
        return BandedFactor(self.storage, self.band.copy(order="F"), self.pivots)

    def solve(self, rhs, transposed=False):
        """Solve for one or several right-hand sides, shape (n,) or (n, m)."""
        s = self.storage
        solution, info = lapack.dgbtrs(
            self.band, s.width, s.width, rhs, self.pivots, trans=int(transposed)
        )
        if info != 0:
            raise np.linalg.LinAlgError(f"dgbtrs returned {info}")
        return solution


class BandedStorage(NamedTuple):
    """LAPACK band storage with equal half-widths."""

    n: int
    width: int

    @property
    def rows(self):
        return 3 * self.width + 1

    @property
    def size(self):
        return self.rows * self.n + 1

    def factorize(self, values):
        band = values[:-1].reshape((self.rows, self.n), order="F")
        lu, pivots, info = lapack.dgbtrf(band, self.width, self.width, overwrite_ab=True)
        if info != 0:
            raise np.linalg.LinAlgError(f"the tangent is singular (dgbtrf {info})")
        return BandedFactor(self, lu, pivots)


class SparseFactor:
    """SuperLU factors."""

    def __init__(self, lu):
        self.lu = lu

    def kept(self):
        """The factor itself: SuperLU has its own memory."""
        return self

    def solve(self, rhs, transposed=False):
        """Solve for one or several right-hand sides, shape (n,) or (n, m)."""
        return self.lu.solve(np.ascontiguousarray(rhs), trans="T" if transposed else "N")


class SparseStorage(NamedTuple):
    """Compressed columns; the pattern is symmetric."""

    n: int
    pointers: np.ndarray
    indices: np.ndarray

    @property
    def size(self):
        return self.indices.size + 1

    def factorize(self, values):
        matrix = csc_array((values[:-1], self.indices, self.pointers), shape=(self.n, self.n))
        try:
            lu = splu(
                matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001,
                options={"SymmetricMode": True},
            )  # fmt: skip
        except RuntimeError as error:
            raise np.linalg.LinAlgError(f"the tangent is singular ({error})") from None
        return SparseFactor(lu)


def _coupling(n_particles, tables):
    """Particles that share a group, as a CSR pattern."""
    pattern = csr_array((n_particles, n_particles), dtype=np.int32)
    for table in tables:
        ones = np.ones(table.neighbours.size, np.int32)
        sees = csr_array((ones, table.neighbours, table.start), shape=(table.n_groups, n_particles))
        pattern = pattern + sees.T @ sees
    return csr_array(pattern)


@nb.njit(cache=True, error_model="numpy")
def _half_width(start, neighbours, equations):
    width = 0
    for g in range(start.size - 1):
        low, high = equations.size, -1
        for a in range(start[g], start[g + 1]):
            for c in range(2):
                e = equations[neighbours[a], c]
                if e >= 0:
                    low, high = min(low, e), max(high, e)
        width = max(width, high - low)
    return width


def _number(fixed, order) -> np.ndarray:
    """Equations (n, 2) of the particles in the given order, -1 for imposed components."""
    equations = np.full(fixed.shape, -1)
    free = ~fixed[order]
    rank = np.cumsum(free.ravel()).reshape(free.shape) - 1
    equations[order] = np.where(free, rank, -1)
    return equations


def number_equations(fixed: np.ndarray, coupling, tables) -> tuple[np.ndarray, int]:
    """Equation numbers that keep the band narrow.

    Reverse Cuthill-McKee, and for small clouds breadth-first orders from a fixed set of starting
    particles too: where a ring is tied to its base, the former's own start is not the best.

    Returns
    -------
    equations : ndarray of int, shape (n, 2)
        -1 for imposed components.
    width : int
        Half-width of the band.
    """
    movable = np.flatnonzero(~fixed.all(axis=1))
    graph = csr_array(coupling[movable][:, movable])
    orders = [reverse_cuthill_mckee(graph, symmetric_mode=True)]
    if movable.size <= SEARCHED_CLOUD:
        for start in range(0, movable.size, -(-movable.size // SEARCHED_STARTS)):
            order = breadth_first_order(graph, start, directed=False, return_predecessors=False)
            if order.size == movable.size:
                orders.append(order)
    numbered = [_number(fixed, movable[order]) for order in orders]
    widths = [
        max(_half_width(t.start, t.neighbours, equations) for t in tables) for equations in numbered
    ]
    best = int(np.argmin(widths))
    return numbered[best], widths[best]


@nb.njit(cache=True, error_model="numpy")
def _fill_slots(start, neighbours, equations, begin, rows, width, pointers, indices, dump, slots):
    """Slots of all groups; banded where ``rows`` > 0, else searched in the compressed columns."""
    for g in range(start.size - 1):
        n = start[g + 1] - start[g]
        at = begin[g]
        for j in range(2 * n):
            column = equations[neighbours[start[g] + j % n], j // n]
            for i in range(2 * n):
                row = equations[neighbours[start[g] + i % n], i // n]
                if row < 0 or column < 0:
                    slots[at] = dump
                elif rows > 0:
                    slots[at] = column * rows + 2 * width + row - column
                else:
                    inside = indices[pointers[column] : pointers[column + 1]]
                    slots[at] = pointers[column] + np.searchsorted(inside, row)
                at += 1


def _sparse_storage(equations, n, coupling):
    """Compressed columns of the dof pattern that belongs to a particle coupling pattern."""
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
    return SparseStorage(n, pattern.indptr.astype(np.int32), pattern.indices.astype(np.int32))


def _choose(solver, width):
    """Banded factorisation costs n width^2; measured, it wins up to this half-width."""
    if solver != "auto":
        return solver
    return "banded" if width <= WIDEST_BAND else "superlu"


def tangent_layout(fixed: np.ndarray, tables, solver: str = "auto") -> TangentLayout:
    """Equation numbers and storage for the given shape tables.

    Parameters
    ----------
    fixed : ndarray of bool, shape (n, 2)
        Imposed components.
    tables : sequence of ShapeTable
    solver : {"auto", "banded", "superlu"}
    """
    if solver not in SOLVERS:
        raise ValueError(f"solver must be one of {SOLVERS}, got {solver!r}")
    coupling = _coupling(len(fixed), tables)
    equations, width = number_equations(fixed, coupling, tables)
    n = int(equations.max()) + 1
    if _choose(solver, width) == "banded":
        storage = BandedStorage(n, width)
        rows, pointers, indices = storage.rows, np.empty(0, np.int32), np.empty(0, np.int32)
    else:
        storage = _sparse_storage(equations, n, coupling)
        rows, pointers, indices = 0, storage.pointers, storage.indices
    scatter = []
    for table in tables:
        begin = np.concatenate([[0], np.cumsum((2 * np.diff(table.start)) ** 2)])
        slots = np.empty(begin[-1], np.int32)
        _fill_slots(table.start, table.neighbours, equations, begin, rows, width, pointers,
                    indices, storage.size - 1, slots)  # fmt: skip
        scatter.append(Scatter(equations, begin, slots))
    return TangentLayout(n, storage.size, tuple(scatter), storage)

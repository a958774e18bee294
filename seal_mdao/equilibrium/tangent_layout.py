"""Equation numbers and slots of the entries of the tangent.

The assembly kernels add to one flat buffer through precomputed slots. The buffer holds, in this order:
the entries of the matrix (``tangent_storage``); the rows K_C. and the columns K_.C of the constrained
particles; the dump, one entry that collects what belongs to prescribed displacements; the columns of the
rank-one parts, and their sizes.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, reverse_cuthill_mckee

from seal_mdao.compilation import compiled, inlined
from seal_mdao.equilibrium.block_tridiagonal import (
    BlockFactor,
    block_ends,
    farthest_coupled,
    numbered,
)
from seal_mdao.equilibrium.condensation import Condensation, condense_force, condense_tangent
from seal_mdao.equilibrium.corrected_factor import CorrectedFactor
from seal_mdao.equilibrium.couplings import couplings
from seal_mdao.equilibrium.tangent_storage import ReorderedFactor, TangentStorage

Factor = BlockFactor | ReorderedFactor | CorrectedFactor
"""Factorised tangent: ``solve``, ``positive`` and its memory ``nbytes``."""

# Number of starting particles tried in the body, and at its base, for small blocks.
SEARCHED_STARTS = 24


class Scatter(NamedTuple):
    """Destinations of the element entries of one shape table.

    Attributes
    ----------
    equations : ndarray of int, shape (n, 2)
        Index of every component in a force buffer: its equation, -1 where it is prescribed, those of
        constrained particles behind the equations.
    start : ndarray of int, shape (n_groups + 1,)
        Index of the first slot of a group.
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
    equations : ndarray of int, shape (n, 2)
        Equation of every displacement component, -1 where it is prescribed.
    n_equations, size, force_size : int
        Unknowns, and lengths of the value and the force buffers.
    scatter : tuple of Scatter
        One for each raw shape table, in the order given.
    storage : TangentStorage
    condensation : Condensation, optional
        None where no particle is constrained.
    stored : _StoredIndices
        Data that determine the slot of an entry.
    n_columns : int
        Rank-one parts beside the stored pattern: sums over many points, such as the pressure of
        trapped air, couple all of their equations.
    """

    equations: np.ndarray
    n_equations: int
    size: int
    force_size: int
    scatter: tuple
    storage: TangentStorage
    condensation: Condensation | None
    stored: NamedTuple
    n_columns: int = 0

    @property
    def force_scatter(self) -> Scatter:
        """Scatter map for forces alone, with transformed shape functions."""
        return Scatter(self.equations, np.empty(0, int), np.empty(0, np.int32))

    @property
    def every_component(self) -> Scatter:
        """Scatter map for forces of all components, prescribed ones included, by particle."""
        numbers = np.arange(self.equations.size).reshape(self.equations.shape)
        return Scatter(numbers, np.empty(0, int), np.empty(0, np.int32))

    def condense_force(self, force: np.ndarray) -> None:
        """Add the forces T^T f_C of the constrained particles to the equations (f~ = N^T f)."""
        if self.condensation is not None:
            condense_force(self.condensation, force)

    def condense_tangent(self, values: np.ndarray) -> None:
        """Add the rows and columns of the constrained particles to the tangent (K~ = N^T K N)."""
        if self.condensation is not None:
            condense_tangent(self.condensation, values)
            # rank-one parts s g g^T transform as forces: g~ = N^T g
            for column in self.columns(values)[0]:
                condense_force(self.condensation, column)

    def columns(self, values: np.ndarray):
        """Return views of the rank-one parts in a tangent's buffer: sum_k s_k g_k g_k^T.

        Returns
        -------
        columns : ndarray, shape (n_columns, force_size)
            g_k, assembled as forces are.
        sizes : ndarray, shape (n_columns,)
            s_k.
        """
        # end of the buffer: n_columns vectors g_k of force_size entries, then the sizes s_k
        end = self.size - self.n_columns
        first = end - self.n_columns * self.force_size
        return values[first:end].reshape(self.n_columns, self.force_size), values[end : self.size]

    def factorize(self, values: np.ndarray, symmetric: bool = False) -> Factor:
        """Factorise the matrix with the entries ``values``.

        The factor of a ``symmetric`` one knows whether it is positive definite.

        Raises
        ------
        LinAlgError
            The matrix is singular.
        """
        factor = self.storage.factorize(values, symmetric)
        if not self.n_columns:
            return factor
        # K + G diag(s) G^T by Sherman-Morrison-Woodbury: the pattern of K stays sparse
        columns, sizes = self.columns(values)
        columns, change = columns[:, : self.n_equations].copy(), np.diag(sizes)
        return CorrectedFactor(factor, columns, change, symmetric)

    def pair_slots(self, table, pairs: np.ndarray):
        """Compute the slots of the entries of pairs of points.

        Parameters
        ----------
        table : ShapeTable
            Raw shape functions of the points, one a group.
        pairs : ndarray of int, shape (m, 2)
            Point of the rows, point of the columns; all within the pattern.

        Returns
        -------
        start : ndarray of int, shape (m + 1,)
        slots : ndarray of int32
            Flat (pair, column, row), each ordered (component, neighbour).
        """
        return _slots(table.start, table.neighbours, pairs, self.stored)

    @property
    def uncoupled(self) -> Scatter:
        """Scatter map for forces alone, with raw shape functions."""
        return self.scatter[0]._replace(start=np.empty(0, int), slots=np.empty(0, np.int32))

    def reduce(self, nodal: np.ndarray) -> np.ndarray:
        """Return the free components of particle values (n, 2) in the order of the equations."""
        free = self.equations >= 0
        out = np.empty(self.n_equations)
        out[self.equations[free]] = nodal[free]
        return out

    def gather(self, vector: np.ndarray) -> np.ndarray:
        """Return a solution (n_equations, ...) by particle (n, 2, ...), zero where prescribed."""
        # equation -1 of prescribed components picks the zero appended at the end
        padded = np.concatenate([vector, np.zeros((1, *vector.shape[1:]))])
        return padded[self.equations]


def _spread(particles: np.ndarray) -> np.ndarray:
    """Select at most ``SEARCHED_STARTS`` of the particles at equal distances in the list."""
    return particles[:: max(1, -(-particles.size // SEARCHED_STARTS))]


def number_equations(fixed: np.ndarray, coupling, base=()) -> np.ndarray:
    """Number the equations so that their blocks are small (``block_tridiagonal``).

    Reverse Cuthill-McKee, and breadth-first orders from starts all over the body and around its
    base: where a ring is tied to a base, the former's own start is far from the best.

    Parameters
    ----------
    fixed : ndarray of bool, shape (n, 2)
    coupling : csr_array
    base : ndarray of int
        Particles around the essential boundary.

    Returns
    -------
    equations : ndarray of int, shape (n, 2)
        -1 for prescribed components.
    """
    movable = np.flatnonzero(~fixed.all(axis=1))
    # particles without any free component have no equation and are left out of the graph
    graph = csr_array(coupling[movable][:, movable])
    orders = [reverse_cuthill_mckee(graph, symmetric_mode=True)]
    for start in np.union1d(
        _spread(np.arange(movable.size)), _spread(np.flatnonzero(np.isin(movable, base)))
    ):
        order = breadth_first_order(graph, start, directed=False, return_predecessors=False)
        # a start reaches one connected body only; with several bodies Cuthill-McKee remains
        if order.size == movable.size:
            orders.append(order)
    found = [numbered(fixed, movable[order]) for order in orders]
    operations = [block_ends(farthest_coupled(number, coupling))[1] for number in found]
    return found[int(np.argmin(operations))]


class _StoredIndices(NamedTuple):
    """Data that determine the slot of an entry.

    Attributes
    ----------
    equations : ndarray of int, shape (n, 2)
        Of ``Scatter``: from ``n_equations`` on they belong to constrained particles.
    n_equations : int
    coupled : ndarray of int, shape (n,)
        Index among the ``n_coupled`` coupled particles, -1 for others.
    origins, first, end : ndarray of int, shape (n_equations,)
        Rows of every column within the blocks: row i has the slot ``origins`` + i.
    start : ndarray of int, shape (n_equations + 1,)
    outside : ndarray of int
        Rows outside the blocks, of ``TangentStorage``, with slots from ``first_outside`` on.
    first_outside, first_row, first_column, dump : int
        First slots of the rows and of the columns of constrained particles; slot of the dump.
    """

    equations: np.ndarray
    n_equations: int
    n_constrained: int
    coupled: np.ndarray
    n_coupled: int
    origins: np.ndarray
    first: np.ndarray
    end: np.ndarray
    start: np.ndarray
    outside: np.ndarray
    first_outside: int
    first_row: int
    first_column: int
    dump: int


@inlined
def _stored(stored, row, column):
    """Return the slot of the entry (row, column) of two equations."""
    if row < 0 or column < 0:
        return stored.dump
    if stored.first[column] <= row < stored.end[column]:
        return stored.origins[column] + row
    # bisection among the rows of the column outside the blocks
    low, high = stored.start[column], stored.start[column + 1]
    while low < high:
        middle = (low + high) // 2
        if stored.outside[middle] < row:
            low = middle + 1
        else:
            high = middle
    return stored.first_outside + low


@inlined
def _slot(stored, p, i, q, k):
    """Return the slot of row (particle p, component i) and column (q, k)."""
    row, column = stored.equations[p, i], stored.equations[q, k]
    if row >= stored.n_equations:
        # row of a constrained particle: K_C. flat (component, constrained; component, coupled)
        at = (row - stored.n_equations) * 2 * stored.n_coupled
        return stored.first_row + at + k * stored.n_coupled + stored.coupled[q]
    if column >= stored.n_equations:
        # column of a constrained particle: K_.C flat (component, coupled; component, constrained)
        if row < 0:
            return stored.dump
        at = (i * stored.n_coupled + stored.coupled[p]) * 2 * stored.n_constrained
        return stored.first_column + at + column - stored.n_equations
    return _stored(stored, row, column)


@compiled
def _fill_slots(start, neighbours, pairs, stored, begin, slots):
    """Fill the slots of pairs of groups (rows, columns), flat (pair, column, row)."""
    for m in range(len(pairs)):
        rows = neighbours[start[pairs[m, 0]] : start[pairs[m, 0] + 1]]
        columns = neighbours[start[pairs[m, 1]] : start[pairs[m, 1] + 1]]
        at = begin[m]
        # local index j = (component, neighbour): component j // n, neighbour j % n
        for j in range(2 * columns.size):
            for i in range(2 * rows.size):
                slots[at] = _slot(
                    stored, rows[i % rows.size], i // rows.size, columns[j % columns.size],
                    j // columns.size,
                )  # fmt: skip
                at += 1


def _slots(start, neighbours, pairs, stored) -> tuple:
    """Compute the first slot of every pair of groups, and the slots: flat (pair, column, row), columns
    and rows ordered (component, neighbour)."""
    count = np.diff(start)
    # a pair with n_r and n_c neighbours has an element matrix of 2 n_r x 2 n_c entries
    sizes = 4 * count[pairs[:, 0]] * count[pairs[:, 1]]
    begin = np.concatenate([[0], np.cumsum(sizes)]).astype(int)
    slots = np.empty(begin[-1], np.int32)
    _fill_slots(start, neighbours, pairs, stored, begin, slots)
    return begin, slots


def equation_numbers(fixed: np.ndarray, tables, transformation=None) -> np.ndarray:
    """Number the equations (n, 2) so that the blocks of the given raw shape tables are small.

    The numbering of the nominal body is valid for all designs.
    """
    coupled, coupling, _ = couplings(len(fixed), tables, _effective(transformation))
    return number_equations(fixed, coupling, coupled)


def _effective(transformation):
    """Return the transformation, or None where it constrains no particle."""
    if transformation is not None and transformation.constrained.size == 0:
        return None
    return transformation


def tangent_layout(
    equations: np.ndarray, tables, transformation=None, links=(), n_columns=0
) -> TangentLayout:
    """Build the storage of the tangent and all scatter maps for the given raw shape tables.

    Parameters
    ----------
    equations : ndarray of int, shape (n, 2)
        Of ``equation_numbers``; -1 for prescribed components.
    tables : sequence of ShapeTable
    transformation : EssentialTransformation, optional
    links : sequence of Link
        Points that act on each other.
    n_columns : int
        Rank-one parts beside the stored pattern.
    """
    transformation, constrained = _effective(transformation), np.empty(0, int)
    if transformation is not None:
        constrained = transformation.constrained
    coupled, body, whole = couplings(len(equations), tables, transformation, links)
    n, c, v = int(equations.max()) + 1, constrained.size, coupled.size
    storage = TangentStorage(equations, body, whole)
    # n equations, c constrained and v coupled particles: K_C. and K_.C have 2 c x 2 v entries each
    stored = _StoredIndices(
        equations.copy(), n, c, np.full(len(equations), -1), v, storage.blocks.origins, storage.first,
        storage.end, storage.start, storage.outside, storage.blocks.size, storage.size,
        storage.size + 4 * c * v, storage.size + 8 * c * v,
    )  # fmt: skip
    # components of constrained particles behind the equations, flat (component, particle)
    stored.equations[constrained] = n + np.arange(2 * c).reshape(2, c).T
    stored.coupled[coupled] = np.arange(v)
    scatter = []
    for table in tables:
        # an element matrix couples the neighbours of a group with each other: pairs (g, g)
        with_itself = np.repeat(np.arange(table.n_groups), 2).reshape(-1, 2)
        slots = _slots(table.start, table.neighbours, with_itself, stored)
        scatter.append(Scatter(stored.equations, *slots))
    condensation = (
        None
        if transformation is None
        else _condensation(transformation, coupled, equations, stored)
    )
    # each rank-one part: a vector of force_size = n + 2 c + 1 entries and its size
    size = stored.dump + 1 + n_columns * (n + 2 * c + 2)
    return TangentLayout(
        equations, n, size, n + 2 * c + 1, tuple(scatter), storage, condensation, stored, n_columns
    )


def _condensation(transformation, coupled, equations, stored) -> Condensation:
    """Compute the slots of the products of T with the constrained rows and columns."""
    union, constrained = transformation.union, transformation.constrained
    # two artificial groups, the union and the coupled particles: blocks (U, v) and (v, U)
    start = np.array([0, union.size, union.size + coupled.size])
    own, pairs = stored._replace(equations=equations), np.array([[0, 1], [1, 0]])
    _, slots = _slots(start, np.concatenate([union, coupled]), pairs, own)
    rows, columns = slots.reshape(2, -1)
    # flat (column, row), in the order of ``Condensation``
    union_slots = rows.reshape(2, coupled.size, 2, union.size).transpose(2, 3, 0, 1)
    coupled_slots = columns.reshape(2, union.size, 2, coupled.size).transpose(2, 3, 0, 1).copy()
    coupled_slots[:, stored.coupled[constrained]] = stored.dump  # their rows are stored aside
    return Condensation(
        np.ascontiguousarray(transformation.matrix), stored.coupled[constrained],
        stored.coupled[union], np.ascontiguousarray(equations[union].T),
        np.ascontiguousarray(union_slots), coupled_slots, stored.n_equations, stored.first_row,
        stored.first_column,
    )  # fmt: skip

"""Equation numbers, and where the entries of the tangent go.

The assembly kernels add to one flat buffer through precomputed slots, so they do not know which
solver is behind. The last entry of the buffer collects what belongs to imposed displacements.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, reverse_cuthill_mckee

from seal_mdao.compilation import compiled, inlined
from seal_mdao.equilibrium.condensation import Condensation, condense_force, condense_tangent
from seal_mdao.equilibrium.corrected_factor import CorrectedFactor
from seal_mdao.equilibrium.couplings import couplings
from seal_mdao.equilibrium.linear_solver import storage_for
from seal_mdao.equilibrium.storage import Scheme, Storage
from seal_mdao.rkpm.sorted_lists import first_not_below

# The band is narrowed by trying that many starting particles in the body, and at its base.
SEARCHED_STARTS = 24


class Scatter(NamedTuple):
    """Destinations of the element entries of one shape table.

    Attributes
    ----------
    equations : ndarray of int, shape (n, 2)
        Place of every component in a force buffer: its equation, -1 where it is imposed, those of
        constrained particles behind the equations.
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
    equations : ndarray of int, shape (n, 2)
        Equation of every displacement component, -1 where it is imposed.
    n_equations, size, force_size : int
        Unknowns, and lengths of the value and the force buffers.
    scatter : tuple of Scatter
        One for each raw shape table, in the order given.
    storage : Storage
    condensation : Condensation, optional
        None where no particle is constrained.
    places : _Places
        What decides where an entry goes.
    n_columns : int
        Parts of rank one beside the stored pattern: sums over many points, such as the pressure of
        trapped air, couple all of their equations.
    """

    equations: np.ndarray
    n_equations: int
    size: int
    force_size: int
    scatter: tuple
    storage: Storage
    condensation: Condensation | None
    places: NamedTuple
    n_columns: int = 0

    @property
    def force_scatter(self) -> Scatter:
        """For forces alone, through transformed shape functions."""
        return Scatter(self.equations, np.empty(0, int), np.empty(0, np.int32))

    @property
    def every_component(self) -> Scatter:
        """For forces of all components, imposed ones included, particle by particle."""
        places = np.arange(self.equations.size).reshape(self.equations.shape)
        return Scatter(places, np.empty(0, int), np.empty(0, np.int32))

    def condense_force(self, force: np.ndarray) -> None:
        """Bring what the raw shape functions put on constrained particles to the equations."""
        if self.condensation is not None:
            condense_force(self.condensation, force)

    def condense_tangent(self, values: np.ndarray) -> None:
        """Bring the rows and columns of constrained particles to the equations."""
        if self.condensation is not None:
            condense_tangent(self.condensation, values)
            for column in self.columns(values)[0]:
                condense_force(self.condensation, column)

    def columns(self, values: np.ndarray):
        """Views of the parts of rank one in a tangent's buffer: sum of size g g^T.

        Returns
        -------
        columns : ndarray, shape (n_columns, force_size)
            g, as forces are assembled.
        sizes : ndarray, shape (n_columns,)
        """
        end = self.size - self.n_columns
        first = end - self.n_columns * self.force_size
        return values[first:end].reshape(self.n_columns, self.force_size), values[end : self.size]

    def factorize(self, values: np.ndarray, symmetric: bool = False):
        """Factor of the matrix in the buffer ``values``, which may be overwritten by it.

        The factor is good until the buffer is filled again; ``factor.kept()`` stays.
        """
        return self._with_columns(self.storage.factorize(values, symmetric), values, symmetric)

    def factorize_roughly(self, values: np.ndarray):
        """As ``factorize``, good to some digits where the storage has such a way."""
        return self._with_columns(self.storage.factorize_roughly(values), values, False)

    def _with_columns(self, factor, values, symmetric):
        if not self.n_columns:
            return factor
        columns, sizes = self.columns(values)
        columns, change = columns[:, : self.n_equations].copy(), np.diag(sizes)
        return CorrectedFactor(factor, columns, change, symmetric)

    def pair_slots(self, table, pairs: np.ndarray):
        """Where the entries of pairs of points go.

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
        return _slots(table.start, table.neighbours, pairs, self.places)

    @property
    def uncoupled(self) -> Scatter:
        """For forces alone, through raw shape functions."""
        return self.scatter[0]._replace(start=np.empty(0, int), slots=np.empty(0, np.int32))

    def reduce(self, nodal: np.ndarray) -> np.ndarray:
        """Values of particles (n, 2) in the order of the equations."""
        free = self.equations >= 0
        out = np.empty(self.n_equations)
        out[self.equations[free]] = nodal[free]
        return out

    def gather(self, vector: np.ndarray) -> np.ndarray:
        """Spread a solution (n_equations, ...) to particles (n, 2, ...), zero where imposed."""
        padded = np.concatenate([vector, np.zeros((1, *vector.shape[1:]))])
        return padded[self.equations]


def _half_width(coupling, equations) -> int:
    """Largest distance between the equations of coupled particles."""
    count = np.diff(coupling.indptr)
    highest, free = equations.max(axis=1), equations >= 0
    lowest = np.where(free, equations, equations.max()).min(axis=1)
    rows, columns = np.repeat(lowest, count), highest[coupling.indices]
    return int(np.max(columns - rows, initial=0))


def _number(fixed, order) -> np.ndarray:
    """Equations (n, 2) of the particles in the given order, -1 for imposed components."""
    equations = np.full(fixed.shape, -1)
    free = ~fixed[order]
    rank = np.cumsum(free.ravel()).reshape(free.shape) - 1
    equations[order] = np.where(free, rank, -1)
    return equations


def _spread(places: np.ndarray) -> np.ndarray:
    """At most ``SEARCHED_STARTS`` of ``places``, evenly."""
    return places[:: max(1, -(-places.size // SEARCHED_STARTS))]


def number_equations(fixed: np.ndarray, coupling, base=()) -> tuple[np.ndarray, int]:
    """Equation numbers that keep the band narrow.

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
        -1 for imposed components.
    width : int
        Half-width of the band.
    """
    movable = np.flatnonzero(~fixed.all(axis=1))
    graph = csr_array(coupling[movable][:, movable])
    orders = [reverse_cuthill_mckee(graph, symmetric_mode=True)]
    for start in np.union1d(
        _spread(np.arange(movable.size)), _spread(np.flatnonzero(np.isin(movable, base)))
    ):
        order = breadth_first_order(graph, start, directed=False, return_predecessors=False)
        if order.size == movable.size:
            orders.append(order)
    numbered = [_number(fixed, movable[order]) for order in orders]
    widths = [_half_width(coupling, number) for number in numbered]
    best = int(np.argmin(widths))
    return numbered[best], widths[best]


class _Places(NamedTuple):
    """What decides the slot of an entry.

    Attributes
    ----------
    equations : ndarray of int, shape (n, 2)
        Of ``Scatter``: from ``n_equations`` on they belong to constrained particles.
    n_equations : int
    coupled : ndarray of int, shape (n,)
        Place among the ``n_coupled`` coupled particles, -1 for others.
    scheme : Scheme
        Of the storage.
    first_row, first_column, dump : int
        Where the rows and the columns of constrained particles begin; the last entry.
    """

    equations: np.ndarray
    n_equations: int
    n_constrained: int
    coupled: np.ndarray
    n_coupled: int
    scheme: Scheme
    first_row: int
    first_column: int
    dump: int


@inlined
def _stored(places, row, column):
    """Slot of the entry of two equations."""
    if row < 0 or column < 0:
        return places.dump
    scheme = places.scheme
    if scheme.rows > 0:
        return column * scheme.rows + 2 * scheme.width + row - column
    first, end = scheme.pointers[column], scheme.pointers[column + 1]
    return first_not_below(scheme.indices, row, first, end)


@inlined
def _slot(places, p, i, q, k):
    """Slot of row (particle p, component i) and column (q, k)."""
    row, column = places.equations[p, i], places.equations[q, k]
    if row >= places.n_equations:
        at = (row - places.n_equations) * 2 * places.n_coupled
        return places.first_row + at + k * places.n_coupled + places.coupled[q]
    if column >= places.n_equations:
        if row < 0:
            return places.dump
        at = (i * places.n_coupled + places.coupled[p]) * 2 * places.n_constrained
        return places.first_column + at + column - places.n_equations
    return _stored(places, row, column)


@compiled
def _fill_slots(start, neighbours, pairs, places, begin, slots):
    """Slots of pairs of groups, the one of the rows and the one of the columns."""
    for m in range(len(pairs)):
        rows = neighbours[start[pairs[m, 0]] : start[pairs[m, 0] + 1]]
        columns = neighbours[start[pairs[m, 1]] : start[pairs[m, 1] + 1]]
        at = begin[m]
        for j in range(2 * columns.size):
            for i in range(2 * rows.size):
                slots[at] = _slot(
                    places, rows[i % rows.size], i // rows.size, columns[j % columns.size],
                    j // columns.size,
                )  # fmt: skip
                at += 1


def _slots(start, neighbours, pairs, places) -> tuple:
    """Where the slots of every pair of groups begin, and the slots: flat (pair, column, row), columns
    and rows ordered (component, neighbour)."""
    count = np.diff(start)
    sizes = 4 * count[pairs[:, 0]] * count[pairs[:, 1]]
    begin = np.concatenate([[0], np.cumsum(sizes)]).astype(int)
    slots = np.empty(begin[-1], np.int32)
    _fill_slots(start, neighbours, pairs, places, begin, slots)
    return begin, slots


def equation_numbers(fixed: np.ndarray, tables, transformation=None) -> np.ndarray:
    """Equation numbers (n, 2) that keep the band of the given raw shape tables narrow.

    They do not depend on the design by necessity: those of the drawn body serve all designs.
    """
    coupled, coupling = couplings(len(fixed), tables, _effective(transformation))
    return number_equations(fixed, coupling, coupled)[0]


def _effective(transformation):
    """The transformation, or None where it constrains no particle."""
    if transformation is not None and transformation.constrained.size == 0:
        return None
    return transformation


def tangent_layout(
    equations: np.ndarray, tables, transformation=None, solver: str = "auto", links=(), n_columns=0
) -> TangentLayout:
    """Storage of the tangent, and where everything goes, for the given raw shape tables.

    Parameters
    ----------
    equations : ndarray of int, shape (n, 2)
        Of ``equation_numbers``; -1 for imposed components.
    tables : sequence of ShapeTable
    transformation : EssentialTransformation, optional
    solver : {"auto", "banded", "superlu", "pardiso"}
    links : sequence of Link
        Points that act on each other.
    n_columns : int
        Parts of rank one beside the stored pattern.
    """
    transformation, constrained = _effective(transformation), np.empty(0, int)
    if transformation is not None:
        constrained = transformation.constrained
    coupled, coupling = couplings(len(equations), tables, transformation, links)
    width = _half_width(coupling, equations)
    n, c, v = int(equations.max()) + 1, constrained.size, coupled.size
    storage = storage_for(solver, n, width, equations, coupling)
    places = _Places(
        equations.copy(), n, c, np.full(len(equations), -1), v, storage.scheme, storage.size,
        storage.size + 4 * c * v, storage.size + 8 * c * v,
    )  # fmt: skip
    places.equations[constrained] = n + np.arange(2 * c).reshape(2, c).T
    places.coupled[coupled] = np.arange(v)
    scatter = []
    for table in tables:
        with_itself = np.repeat(np.arange(table.n_groups), 2).reshape(-1, 2)
        slots = _slots(table.start, table.neighbours, with_itself, places)
        scatter.append(Scatter(places.equations, *slots))
    condensation = (
        None
        if transformation is None
        else _condensation(transformation, coupled, equations, places)
    )
    size = places.dump + 1 + n_columns * (n + 2 * c + 2)
    return TangentLayout(
        equations, n, size, n + 2 * c + 1, tuple(scatter), storage, condensation, places, n_columns
    )


def _condensation(transformation, coupled, equations, places) -> Condensation:
    """Where the products of T with the constrained rows and columns go."""
    union, constrained = transformation.union, transformation.constrained
    start = np.array([0, union.size, union.size + coupled.size])
    own, pairs = places._replace(equations=equations), np.array([[0, 1], [1, 0]])
    _, slots = _slots(start, np.concatenate([union, coupled]), pairs, own)
    rows, columns = slots.reshape(2, -1)
    # flat (column, row), in the order of ``Condensation``
    union_slots = rows.reshape(2, coupled.size, 2, union.size).transpose(2, 3, 0, 1)
    coupled_slots = columns.reshape(2, union.size, 2, coupled.size).transpose(2, 3, 0, 1).copy()
    coupled_slots[:, places.coupled[constrained]] = places.dump  # their rows are kept aside
    return Condensation(
        np.ascontiguousarray(transformation.matrix), places.coupled[constrained],
        places.coupled[union], np.ascontiguousarray(equations[union].T),
        np.ascontiguousarray(union_slots), coupled_slots, places.n_equations, places.first_row,
        places.first_column,
    )  # fmt: skip

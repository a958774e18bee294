"""Storage of the tangent, in which points that act on each other may couple distant equations.

Cells couple neighbours, so that the matrix of the body is block tridiagonal with small blocks
(``block_tridiagonal``). Contact of walls with each other, or a fluid that contact stops, may couple any
two of many points, but acts between few of them at a time. Blocks for all pairs would be nearly the
whole matrix. So the entries of these links are stored beside the blocks of the body, and those that are
not zero choose an order of the equations with blocks of their own for the factorisation:

    P K P^T is block tridiagonal,    K^-1 b = P^T (P K P^T)^-1 P b,

P the reverse Cuthill-McKee order of the particles, or that of the body if it takes fewer operations. It
depends on the places of these entries alone, so that the same matrix always has the same factor.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from seal_mdao.equilibrium.block_tridiagonal import (
    BlockFactor,
    BlockTridiagonal,
    block_ends,
    farthest_coupled,
    numbered,
)


class Entries(NamedTuple):
    """Entries of the matrix, by column and row.

    Attributes
    ----------
    row, column : ndarray of int, shape (k,)
    """

    row: np.ndarray
    column: np.ndarray


def entries_of(equations: np.ndarray, coupling) -> Entries:
    """List the entries of coupled particles.

    Parameters
    ----------
    equations : ndarray of int, shape (n, 2)
        -1 for prescribed components.
    coupling : csr_array, shape (n, n)
    """
    one, other = coupling.nonzero()
    # both components of one with both of the other
    row = np.repeat(equations[one], 2, axis=1).ravel()
    column = np.tile(equations[other], 2).ravel()
    free = (row >= 0) & (column >= 0)
    row, column = row[free], column[free]
    order = np.lexsort([row, column])
    return Entries(row[order], column[order])


class TangentStorage:
    """Blocks of the body, and the entries of links that lie outside of them.

    Parameters
    ----------
    equations : ndarray of int, shape (n, 2)
        -1 for prescribed components.
    body : csr_array, shape (n, n)
        Coupled particles without links, each of them with itself; symmetric.
    whole : csr_array, shape (n, n)
        The same with all links.

    Attributes
    ----------
    n : int
        Number of equations.
    blocks : BlockTridiagonal
        The first ``blocks.size`` entries of the storage.
    first, end : ndarray of int, shape (n,)
        Rows of every column within the blocks.
    outside : ndarray of int, shape (k,)
        Rows of the entries outside the blocks, which follow these: ascending in every column, the
        columns one after the other.
    start : ndarray of int, shape (n + 1,)
        Index of the first of them in every column.
    """

    def __init__(self, equations: np.ndarray, body, whole):
        self._equations, self._body = equations, body
        self.blocks = BlockTridiagonal(block_ends(farthest_coupled(equations, body))[0])
        self.n = self.blocks.n
        ranges = [(own.start, own.stop) for own in self.blocks.stored]
        sizes = [own.stop - own.start for own in self.blocks.rows]
        self.first, self.end = np.repeat(np.array(ranges), sizes, axis=0).T.copy()
        self._links = entries_of(equations, _without(whole, body))
        row, column = self._links
        self._beyond = (row < self.first[column]) | (row >= self.end[column])
        self.outside = row[self._beyond]
        count = np.bincount(column[self._beyond], minlength=self.n)
        self.start = np.concatenate([[0], np.cumsum(count)])
        self._latest: tuple[bytes, _ReorderedBlocks] | None = None

    @property
    def size(self) -> int:
        """Number of entries stored."""
        return self.blocks.size + self.outside.size

    def diagonal(self) -> np.ndarray:
        """Return the indices of the diagonal entries, shape (n,)."""
        return self.blocks.diagonal()

    @cached_property
    def _link_slots(self) -> np.ndarray:
        row, column = self._links
        slots = self.blocks.origins[column] + row
        slots[self._beyond] = self.blocks.size + np.arange(self.outside.size)
        return slots

    @cached_property
    def _body_entries(self) -> Entries:
        return entries_of(self._equations, self._body)

    def factorize(self, values: np.ndarray, symmetric: bool = False):
        """Factorise the matrix with the given entries; the factor does not refer to them.

        Returns
        -------
        BlockFactor or ReorderedFactor

        Raises
        ------
        LinAlgError
            The matrix is singular.
        """
        if not values[self.blocks.size : self.size].any():
            return self.blocks.factorize(values[: self.blocks.size], symmetric)
        acting = np.flatnonzero(values[self._link_slots])
        # successive iterations often have the same links
        key, latest = acting.tobytes(), self._latest
        if latest is None or latest[0] != key:
            latest = self._latest = key, self._reordered(acting)
        return latest[1].factorize(values, symmetric)

    def _reordered(self, acting: np.ndarray) -> "_ReorderedBlocks":
        """Choose the order of the equations for the links with the indices ``acting``."""
        free, (row, column) = self._equations >= 0, (own[acting] for own in self._links)
        particle = np.empty(self.n, int)
        particle[self._equations[free]] = free.nonzero()[0]
        pairs = np.stack([particle[row], particle[column]])
        pairs = np.concatenate([pairs, pairs[::-1]], axis=1)
        ones = np.ones(pairs.shape[1], self._body.dtype)
        coupling = csr_array(self._body + csr_array((ones, tuple(pairs)), self._body.shape))
        # particles with an equation
        movable = np.flatnonzero(free.any(axis=1))
        graph = csr_array(coupling[movable][:, movable])
        order = movable[reverse_cuthill_mckee(graph, symmetric_mode=True)]
        candidates = [numbered(~free, order), self._equations]
        blocks = [block_ends(farthest_coupled(own, coupling)) for own in candidates]
        # the first of equals
        best = int(np.argmin([operations for _, operations in blocks]))
        place = np.empty(self.n, int)
        place[self._equations[free]] = candidates[best][free]
        body_row, body_column = self._body_entries
        slots = np.append(self.blocks.origins[body_column] + body_row, self._link_slots[acting])
        row, column = np.append(body_row, row), np.append(body_column, column)
        return _ReorderedBlocks(
            BlockTridiagonal(blocks[best][0]), place, Entries(row, column), slots
        )


def _without(whole, body):
    """Return the entries of the pattern ``whole`` that ``body`` does not have."""
    one, other = (csr_array((np.ones(own.nnz, np.int8), own.indices, own.indptr), own.shape)
                  for own in (whole, body))  # fmt: skip
    found = csr_array(one - other)
    found.eliminate_zeros()
    return found


class _ReorderedBlocks:
    """Storage of P K P^T.

    Parameters
    ----------
    blocks : BlockTridiagonal
    place : ndarray of int, shape (n,)
        Row of P K P^T of every equation.
    entries : Entries
        Of K, in its own order.
    slots : ndarray of int, shape (k,)
        Where they are in the storage of K.
    """

    def __init__(self, blocks: BlockTridiagonal, place: np.ndarray, entries: Entries, slots):
        self.blocks, self.place, self._slots = blocks, place, slots
        self._into = blocks.origins[place[entries.column]] + place[entries.row]

    def factorize(self, values: np.ndarray, symmetric: bool) -> "ReorderedFactor":
        """Factorise the matrix with the entries ``values`` of K."""
        moved = np.zeros(self.blocks.size)
        moved[self._into] = values[self._slots]
        return ReorderedFactor(self.blocks.factorize(moved, symmetric), self.place)


class ReorderedFactor:
    """Factor of P K P^T that solves with K.

    Parameters
    ----------
    factor : BlockFactor
    place : ndarray of int, shape (n,)
        Row of P K P^T of every equation.
    """

    def __init__(self, factor: BlockFactor, place: np.ndarray):
        self.factor, self.place, self._order = factor, place, np.argsort(place)

    @property
    def nbytes(self) -> int:
        """Memory of the factors, bytes."""
        return self.factor.nbytes

    @property
    def positive(self) -> bool:
        """As of ``BlockFactor``: P K P^T has the eigenvalues of K."""
        return self.factor.positive

    def solve(self, rhs: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solve for right-hand sides of shape (n,) or (n, m)."""
        # x = P^T (P K P^T)^-1 P b
        return self.factor.solve(np.ascontiguousarray(rhs[self._order]), transposed)[self.place]

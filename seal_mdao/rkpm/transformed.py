"""Apply the transformation of ``essential`` to tables of shape functions, with its derivatives.

For every row (point, component) of a group that sees a constrained particle,

    table       Phi~ = Phi T,    Phi~_u = [u not in C] Phi_u + sum_C Phi_C T_Cu
    rates       Phi~' = Phi' T + Phi T'
    seeds       Phi_bar = Phi~_bar T^T,    T_bar += Phi^T Phi~_bar

with the same indices, which ``TableTransform`` finds once. All other groups are left as they are.
"""

from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.essential import EssentialTransformation
from seal_mdao.rkpm.shape_functions import ShapeTable, grad_rows


class TableRates(NamedTuple):
    """Design derivatives of a table along P design velocities, sparse in the parameters.

    Attributes
    ----------
    start : ndarray of int, shape (n_groups + 1, 2)
        Where the active parameters, and where the entries of a group begin.
    active : ndarray of int
        Parameters that touch group g: ``active[start[g, 0]:start[g + 1, 0]]``.
    phi, grad : ndarray
        Flat (group, point, neighbour, parameter), (group, point, component, neighbour, parameter);
        empty where the array of the table is empty.
    """

    start: np.ndarray
    active: np.ndarray
    phi: np.ndarray
    grad: np.ndarray


def entry_starts(counts_active, table):
    """Compute where the rates of every group begin, given its number of active parameters."""
    sizes = counts_active * np.diff(table.start) * table.group_size
    return np.concatenate([[0], np.cumsum(sizes)])


class TouchedGroup(NamedTuple):
    """Indices of a group that sees constrained particles.

    Attributes
    ----------
    fixed : ndarray of int, shape (f,)
        Of the constrained particles among the raw neighbours.
    rows : ndarray of int, shape (f,)
        Their rows of T.
    new, union : ndarray of int, shapes (n_raw,), (u,)
        Of the raw neighbours (where free), and of the union, among the new neighbours.
    """

    fixed: np.ndarray
    rows: np.ndarray
    new: np.ndarray
    union: np.ndarray

    def add_product(self, raw, of_fixed, out) -> None:
        """Add the free columns of ``raw`` (rows, n_raw, ...) and what each constrained one becomes,
        ``of_fixed`` (rows, u, ...), to ``out`` (rows, n_new, ...), in the order of the neighbours."""
        begin = 0
        for end, term in zip(self.fixed, of_fixed, strict=True):
            # free columns up to the next constrained one, then Phi_C T_Cu in its place
            out[:, self.new[begin:end]] += raw[:, begin:end]
            out[:, self.union] += term
            begin = end + 1
        out[:, self.new[begin:]] += raw[:, begin:]


class TableTransform:
    """The transformation of one raw table: its product, the rates of it, and its transpose.

    Parameters
    ----------
    raw : ShapeTable
    transformation : EssentialTransformation

    Attributes
    ----------
    touched : ndarray of bool, shape (n_groups,)
        Groups that see a constrained particle.
    table : ShapeTable
        Transformed; ``raw`` itself where no group is touched.
    """

    def __init__(self, raw: ShapeTable, transformation: EssentialTransformation):
        self.raw, self.transformation, self.table = raw, transformation, raw
        group = np.repeat(np.arange(raw.n_groups), np.diff(raw.start))
        # groups with a neighbour in C
        hit = np.isin(raw.neighbours, transformation.constrained)
        self.touched = np.bincount(group[hit], minlength=raw.n_groups) > 0
        if self.touched.any():
            start, neighbours = self._extended_lists()
            new = ShapeTable(start, neighbours, raw.phi, raw.grad, raw.group_size)
            self.table = new._replace(
                phi=self._product(new, raw.phi, raw.group_size),
                grad=self._product(new, raw.grad, self._grad_rows),
            )

    @cached_property
    def groups(self) -> dict:
        """``TouchedGroup`` by the number of the group."""
        raw, t, found = self.raw, self.transformation, {}
        for g in np.flatnonzero(self.touched):
            near = raw.neighbours[raw.start[g] : raw.start[g + 1]]
            new = np.union1d(near, t.union)
            # which neighbours are in C, their rows of T, indices of both lists in the new one
            fixed = np.flatnonzero(np.isin(near, t.constrained))
            rows = np.searchsorted(t.constrained, near[fixed])
            at = np.searchsorted(new, near), np.searchsorted(new, t.union)
            found[int(g)] = TouchedGroup(fixed, rows, *at)
        return found

    @property
    def _grad_rows(self) -> int:
        """Rows of the gradients of a group."""
        return grad_rows(self.raw) * self.raw.group_size

    def _extended_lists(self):
        """Build the neighbour lists after the transformation: groups that see C also see the union."""
        near = np.split(self.raw.neighbours, self.raw.start[1:-1])
        for g in self.groups:
            near[g] = np.union1d(near[g], self.transformation.union)
        return np.cumsum([0, *map(len, near)]), np.concatenate(near)

    def _copied(self, values, old_ends, new_ends, first=0, last=None) -> np.ndarray:
        """Copy the entries (..., columns) of untouched groups to their new index, zero elsewhere.

        ``old_ends`` and ``new_ends`` (n_groups + 1,) are where the entries of every group begin.
        """
        last = self.raw.n_groups if last is None else last
        out = np.zeros((new_ends[last] - new_ends[first], *values.shape[1:]))
        # untouched groups in succession lie together before and after
        cuts = [first - 1, *(g for g in self.groups if first <= g < last), last]
        for before, after in pairwise(cuts):
            old, new = (ends[[before + 1, after]] - ends[first] for ends in (old_ends, new_ends))
            out[slice(*new)] = values[slice(*old)]
        return out

    def _product(self, new: ShapeTable, values, n_rows: int) -> np.ndarray:
        """Compute Phi~ = Phi T for all ``n_rows`` rows of every group, flat ``values``."""
        if not values.size:
            return values
        ends = n_rows * self.raw.start, n_rows * new.start
        out = self._copied(values, *ends)
        for g, own in self.groups.items():
            phi, found = (
                of_group(*part, g, n_rows) for part in zip((values, out), ends, strict=True)
            )
            # Phi_C T_Cu
            factors = self.transformation.matrix[own.rows]
            own.add_product(
                phi, (phi[:, [i]] * t for i, t in zip(own.fixed, factors, strict=True)), found
            )
        return out

    def rates(self, rates: TableRates, matrix_rate) -> TableRates:
        """Differentiate the transformed table, given the rates of the raw one.

        Parameters
        ----------
        matrix_rate : ndarray, shape (c, u, P)
            T' of ``essential.transformation_rates``.
        """
        raw, table = self.raw, self.table
        if table is raw:
            return rates
        ends = entry_starts(np.diff(rates.start[:, 0]), table)
        parts = (raw.phi, rates.phi, raw.group_size), (raw.grad, rates.grad, self._grad_rows)
        found = [self._product_rates(*part, rates, ends, matrix_rate) for part in parts]
        return TableRates(np.column_stack([rates.start[:, 0], ends]), rates.active, *found)

    def _product_rates(self, values, value_rates, n_rows, rates, ends, matrix_rate) -> np.ndarray:
        """Compute Phi~' = Phi' T + Phi T' of all rows, the parameter running fastest."""
        if not value_rates.size:
            return value_rates
        per_point = n_rows // self.raw.group_size
        ends = per_point * rates.start[:, 1], per_point * ends
        out = self._copied(value_rates, *ends)
        for g, own in self.groups.items():
            which = rates.active[rates.start[g, 0] : rates.start[g + 1, 0]]
            if which.size:
                phi = of_group(values, n_rows * self.raw.start, g, n_rows)
                d_phi, found = (
                    of_group(*part, g, n_rows, which.size)
                    for part in zip((value_rates, out), ends, strict=True)
                )
                # Phi_C' T_Cu + Phi_C T_Cu'
                factors = self.transformation.matrix[own.rows], matrix_rate[own.rows][..., which]
                terms = (
                    d_phi[:, [i]] * t[:, None] + phi[:, i, None, None] * t_rate
                    for i, t, t_rate in zip(own.fixed, *factors, strict=True)
                )
                own.add_product(d_phi, terms, found)
        return out

    def pull_back(self, groups, values, n_rows: int, bar, matrix_bar) -> np.ndarray:
        """Apply the transpose to some groups: seeds on their raw rows, (raw rows, M).

        Parameters
        ----------
        groups : tuple of int
            First, and one past the last.
        values : ndarray
            Raw values of the complete table, ``n_rows`` rows per point.
        bar : ndarray, shape (rows, M)
            Seeds on the transformed rows of the groups.
        matrix_bar : ndarray, shape (c, u, M)
            Seeds on T, added to.
        """
        (first, last), m, size = groups, bar.shape[1], n_rows * self.raw.group_size
        if not bar.size or not self.touched[first:last].any():
            return bar
        ends, new_ends = size * self.raw.start, size * self.table.start
        out = self._copied(bar, new_ends, ends, first, last)
        for g in range(first, last):
            if g in self.groups:
                own, phi = self.groups[g], of_group(values, ends, g, size)
                seeds = of_group(bar, new_ends - new_ends[first], g, size, m)
                found = of_group(out, ends - ends[first], g, size, m)
                # Phi_bar_u = Phi~_bar_u, u not in C;  Phi_bar_C = sum_u T_Cu Phi~_bar_u
                on_union = seeds[:, own.union]
                found[:] = seeds[:, own.new]
                found[:, own.fixed] = self.transformation.matrix[own.rows] @ on_union
                # T_bar_Cu += sum_rows Phi_C Phi~_bar_u
                sums = phi[:, own.fixed].T @ on_union.reshape(size, -1)
                matrix_bar[own.rows] += sums.reshape(-1, *on_union.shape[1:])
        return out


def of_group(values, ends, g: int, n_rows: int, *columns) -> np.ndarray:
    """View the entries of group ``g`` as (row, neighbour, ...)."""
    return values[ends[g] : ends[g + 1]].reshape(n_rows, -1, *columns)

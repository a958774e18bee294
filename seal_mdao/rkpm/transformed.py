"""Apply the transformation of ``essential`` to tables of shape functions, with its derivatives."""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, internal
from seal_mdao.rkpm.essential import EssentialTransformation
from seal_mdao.rkpm.shape_functions import ShapeTable
from seal_mdao.rkpm.sorted_lists import first_not_below


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


def _extended_lists(raw: ShapeTable, touched: np.ndarray, transformation):
    """Build the neighbour lists after the transformation: groups that see C also see the union."""
    groups = np.flatnonzero(touched)
    lists = [
        np.union1d(raw.neighbours[raw.start[g] : raw.start[g + 1]], transformation.union)
        for g in groups
    ]
    counts = np.diff(raw.start)
    counts[touched] = [near.size for near in lists]
    start = np.concatenate([[0], np.cumsum(counts)])
    neighbours = np.empty(start[-1], int)
    # groups that see no constrained particle keep their lists
    keep_raw = np.repeat(~touched, np.diff(raw.start))
    neighbours[np.repeat(~touched, counts)] = raw.neighbours[keep_raw]
    for g, near in zip(groups, lists, strict=True):
        neighbours[start[g] : start[g + 1]] = near
    return start, neighbours


def touched_groups(raw: ShapeTable, transformation: EssentialTransformation) -> np.ndarray:
    """Find the groups of a raw table that see a constrained particle, a mask of shape (n_groups,)."""
    group = np.repeat(np.arange(raw.n_groups), np.diff(raw.start))
    hit = np.isin(raw.neighbours, transformation.constrained)
    return np.bincount(group[hit], minlength=raw.n_groups) > 0


def transform_table(raw: ShapeTable, transformation: EssentialTransformation) -> ShapeTable:
    """Compute Phi~ of ``essential`` for every group of a raw table; the same table if none sees C."""
    touched = touched_groups(raw, transformation)
    if not touched.any():
        return raw
    start, neighbours = _extended_lists(raw, touched, transformation)
    new = ShapeTable(start, neighbours, raw.phi, raw.grad, raw.group_size)
    products = _products(raw, new, transformation)
    return new._replace(
        phi=_transformed(raw, new, products, raw.phi, raw.group_size),
        grad=_transformed(raw, new, products, raw.grad, 2 * raw.group_size),
    )


def _products(raw: ShapeTable, new: ShapeTable, transformation: EssentialTransformation):
    """List the terms of Phi~: group, index among its raw and among its new neighbours, factor."""
    constrained, union = transformation.constrained, transformation.union
    groups, far = np.arange(raw.n_groups), int(np.max(new.neighbours, initial=0)) + 1
    group, listed = np.repeat(groups, np.diff(raw.start)), raw.neighbours
    key = np.repeat(groups, np.diff(new.start)) * far + new.neighbours
    # Phi~_u = [u not in C] Phi_u + sum_C Phi_C T_Cu: a free neighbour u gives one term of factor 1,
    # a constrained one a term of factor T_Cu for every u of the union
    is_free = ~np.isin(listed, constrained)
    free, constrained_rows = np.flatnonzero(is_free), np.flatnonzero(~is_free)
    old = np.concatenate([free, np.repeat(constrained_rows, union.size)])
    columns = [listed[free], np.tile(union, constrained_rows.size)]
    factor = transformation.matrix[np.searchsorted(constrained, listed[constrained_rows])].ravel()
    factor = np.concatenate([np.ones(free.size), factor])
    # index of (group, u) in the new lists, sorted by group and particle
    at = np.searchsorted(key, group[old] * far + np.concatenate(columns))
    # fixed order of the sum over C, that of the raw neighbours
    order = np.argsort(old, kind="stable")
    old, at, factor, group = old[order], at[order], factor[order], group[old[order]]
    return group, old - raw.start[group], at - new.start[group], factor


def _transformed(raw: ShapeTable, new: ShapeTable, products, values, n_rows: int):
    """Sum the terms of Phi~ for all ``n_rows`` rows (point, component) of a group, flat ``values``."""
    if not values.size:
        return values
    group, old, at, factor = products
    row = np.arange(n_rows)[:, None]
    count, count_new = np.diff(raw.start)[group], np.diff(new.start)[group]
    # row r of group g begins at n_rows start_g + r n_g
    terms = factor * values[n_rows * raw.start[group] + row * count + old]
    to = n_rows * new.start[group] + row * count_new + at
    return np.bincount(to.ravel(), terms.ravel(), minlength=n_rows * new.neighbours.size)


@internal
def _positions(near, wanted, out):
    """Find the index of each ``near[i]`` in the sorted ``wanted``, or -1; return the number found."""
    count = 0
    for i in range(near.size):
        at = first_not_below(wanted, near[i], 0, wanted.size)
        out[i] = -1
        if at < wanted.size and wanted[at] == near[i]:
            out[i], count = at, count + 1
    return count


@compiled
def _transform_rates(
    raw,
    table,
    rates,
    raw_rates,
    constrained,
    union,
    matrix,
    matrix_rate,
    values,
    raw_d,
    n_rows,
    out,
):
    """Differentiate ``transform_table``: Phi~' = Phi' T + Phi T', the parameter running fastest."""
    for g in range(table.start.size - 1):
        n_raw, n_new = raw.start[g + 1] - raw.start[g], table.start[g + 1] - table.start[g]
        near = raw.neighbours[raw.start[g] : raw.start[g + 1]]
        here = table.neighbours[table.start[g] : table.start[g + 1]]
        which = rates.active[rates.start[g, 0] : rates.start[g + 1, 0]]
        count = which.size
        in_c, in_new = np.empty(n_raw, np.int64), np.empty(n_raw, np.int64)
        if _positions(near, constrained, in_c) == 0:
            old_d, new_d = raw_rates.start[g, 1] * n_rows, rates.start[g, 1] * n_rows
            # no constrained neighbour: Phi~' = Phi'
            size = raw.group_size * n_rows * n_raw * count
            for k in range(size):
                out[new_d + k] = raw_d[old_d + k]
            continue
        _positions(near, here, in_new)
        of_union = np.empty(union.size, np.int64)
        _positions(union, here, of_union)
        for row in range(raw.group_size * n_rows):
            old = raw.start[g] * raw.group_size * n_rows + row * n_raw
            old_d = raw_rates.start[g, 1] * n_rows + row * n_raw * count
            new_d = rates.start[g, 1] * n_rows + row * n_new * count
            for i in range(n_raw):
                d_value = raw_d[old_d + i * count : old_d + (i + 1) * count]
                if in_c[i] < 0:
                    at = new_d + in_new[i] * count
                    for p in range(count):
                        # Phi~_u' += Phi_u', u not in C
                        out[at + p] += d_value[p]
                else:
                    for u in range(union.size):
                        at = new_d + of_union[u] * count
                        weight = matrix[in_c[i], u]
                        for p in range(count):
                            # Phi~_u' += Phi_C' T_Cu + Phi_C T_Cu'
                            out[at + p] += (
                                d_value[p] * weight
                                + values[old + i] * matrix_rate[in_c[i], u, which[p]]
                            )


@compiled
def _untransform(raw, table, groups, transformation, values, n_rows, bar, raw_bar, matrix_bar):
    """Apply the transpose of ``transform_table``: seeds ``bar`` (rows, M) on the new rows of the
    ``groups`` (first, last) to those on their raw rows; adds seeds on T to ``matrix_bar`` (c, u, M).

    ``transformation`` are constrained, union and matrix."""
    (constrained, union, matrix), (first, last) = transformation, groups
    size, count = raw.group_size * n_rows, bar.shape[1]
    of_union, seeds = np.empty(union.size, np.int64), np.empty((size, union.size, count))
    for g in range(first, last):
        n_raw, n_new = raw.start[g + 1] - raw.start[g], table.start[g + 1] - table.start[g]
        near = raw.neighbours[raw.start[g] : raw.start[g + 1]]
        here = table.neighbours[table.start[g] : table.start[g + 1]]
        of_raw = (raw.start[g] - raw.start[first]) * size
        of_new = (table.start[g] - table.start[first]) * size
        in_c, in_new = np.empty(n_raw, np.int64), np.empty(n_raw, np.int64)
        n_fixed = _positions(near, constrained, in_c)
        _positions(near, here, in_new)
        for row in range(size):
            for i in range(n_raw):
                if in_c[i] < 0:
                    at, to = of_new + row * n_new + in_new[i], of_raw + row * n_raw + i
                    for m in range(count):
                        # Phi_bar_u = Phi~_bar_u, u not in C
                        raw_bar[to, m] = bar[at, m]
        if n_fixed == 0:
            continue
        fixed, number = np.empty(n_fixed, np.int64), 0
        for i in range(n_raw):
            if in_c[i] >= 0:
                fixed[number], number = i, number + 1
        _positions(union, here, of_union)
        # dense blocks of the group: T_Cu, Phi_C in every row, Phi~_bar_u
        factors, at_rows = np.empty((n_fixed, union.size)), np.empty((n_fixed, size))
        on_fixed, on_factors = np.empty((n_fixed, count)), np.empty((n_fixed, union.size * count))
        for k, i in enumerate(fixed):
            for u in range(union.size):
                factors[k, u] = matrix[in_c[i], u]
            for row in range(size):
                at_rows[k, row] = values[raw.start[g] * size + row * n_raw + i]
        for row in range(size):
            for u in range(union.size):
                for m in range(count):
                    seeds[row, u, m] = bar[of_new + row * n_new + of_union[u], m]
            # Phi_bar_C = sum_u T_Cu Phi~_bar_u
            np.dot(factors, seeds[row], on_fixed)
            for k, i in enumerate(fixed):
                for m in range(count):
                    raw_bar[of_raw + row * n_raw + i, m] = on_fixed[k, m]
        # T_bar_Cu += sum_rows Phi_C Phi~_bar_u
        np.dot(at_rows, seeds.reshape(size, union.size * count), on_factors)
        for k, i in enumerate(fixed):
            for u in range(union.size):
                for m in range(count):
                    matrix_bar[in_c[i], u, m] += on_factors[k, u * count + m]


def transformed_rates(raw: ShapeTable, table: ShapeTable, rates, transformation, matrix_rate):
    """Differentiate a transformed table, given the rates of the raw one.

    Parameters
    ----------
    rates : TableRates
        Of ``raw``.
    matrix_rate : ndarray, shape (c, u, P)
        T' of ``essential.transformation_rates``.
    """
    if transformation is None or table is raw:
        return rates
    count = np.diff(rates.start[:, 0])
    starts = np.column_stack([rates.start[:, 0], entry_starts(count, table)])
    new = TableRates(
        starts, rates.active, np.zeros(rates.phi.size and starts[-1, 1]),
        np.zeros(rates.grad.size and 2 * starts[-1, 1]),
    )  # fmt: skip
    c, u, matrix = transformation.constrained, transformation.union, transformation.matrix
    matrix_rate = np.ascontiguousarray(matrix_rate)
    parts = (raw.phi, rates.phi, 1, new.phi), (raw.grad, rates.grad, 2, new.grad)
    for part in parts:
        if part[1].size:
            _transform_rates(raw, table, new, rates, c, u, matrix, matrix_rate, *part)
    return new


def untransformed_rows(raw, table, groups, transformation, values, n_rows: int, bar, matrix_bar):
    """Apply the transpose of ``transform_table`` to some groups: seeds on raw rows, (raw rows, M).

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
    size = (raw.start[groups[1]] - raw.start[groups[0]]) * raw.group_size * n_rows
    raw_bar = np.empty((size, bar.shape[1]))
    t = transformation.constrained, transformation.union, transformation.matrix
    _untransform(raw, table, groups, t, values, n_rows, bar, raw_bar, matrix_bar)
    return raw_bar


def untransformed_seeds(raw: ShapeTable, table: ShapeTable, phi_bar, grad_bar, transformation):
    """Apply the transpose of ``transformed_rates``: seeds on the raw table (phi, grad), on T or None."""
    if transformation is None:
        return phi_bar, grad_bar, None
    matrix_bar = np.zeros((*transformation.matrix.shape, phi_bar.shape[1]))
    if table is raw:
        return phi_bar, grad_bar, matrix_bar
    every = 0, raw.n_groups
    raw_bars = (
        untransformed_rows(raw, table, every, transformation, values, n_rows, bar, matrix_bar)
        if bar.size
        else bar
        for values, n_rows, bar in ((raw.phi, 1, phi_bar), (raw.grad, 2, grad_bar))
    )
    return *raw_bars, matrix_bar

"""Shape function tables of a point set: neighbours, values, and their design derivatives.

``build_table`` is the analysis side, ``table_rates`` the forward derivative along design velocities
(direct differentiation), ``table_seeds`` its transpose (adjoint).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numba as nb
import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from seal_mdao.errors import SingularMomentMatrixError
from seal_mdao.rkpm.essential import EssentialTransformation
from seal_mdao.rkpm.shape_derivatives import forward_shape_functions, reverse_shape_functions
from seal_mdao.rkpm.shape_functions import Cloud, PointSet, ShapeTable, evaluate_shape_functions


class TableRates(NamedTuple):
    """Design derivatives of a table along P design velocities, sparse in the parameters.

    Attributes
    ----------
    start : ndarray of int, shape (n_groups + 1, 2)
        Where the active parameters, and where the entries of a group begin.
    active : ndarray of int
        Parameters that touch group g: ``active[start[g, 0]:start[g + 1, 0]]``.
    phi, grad : ndarray
        Flat (group, point, neighbour, parameter), (group, point, component, neighbour, parameter).
    """

    start: np.ndarray
    active: np.ndarray
    phi: np.ndarray
    grad: np.ndarray


@dataclass(frozen=True)
class PointTable:
    """A point set with its raw and its transformed shape functions.

    Attributes
    ----------
    points : PointSet
    coordinates : ndarray, shape (n_points, 2)
    raw : ShapeTable
        Eq. (13) as it stands.
    table : ShapeTable
        After the essential transformation; what the analysis uses.
    """

    points: PointSet
    coordinates: np.ndarray
    raw: ShapeTable
    table: ShapeTable


def neighbour_lists(cloud: Cloud, coordinates: np.ndarray, group_size: int):
    """Particles whose support covers any point of a group, as (start, neighbours), sorted."""
    tree = cKDTree(coordinates)
    hits = tree.query_ball_point(cloud.particles, cloud.radius, return_sorted=False)
    counts = np.fromiter((len(h) for h in hits), int, len(hits))
    particle = np.repeat(np.arange(len(hits)), counts)
    point = np.concatenate([np.asarray(h, int) for h in hits]) if len(hits) else np.empty(0, int)
    n_groups = len(coordinates) // group_size
    n = len(cloud.particles)
    key = np.unique((point // group_size) * n + particle)
    group, neighbours = np.divmod(key, n)
    start = np.searchsorted(group, np.arange(n_groups + 1))
    return start, neighbours


def raw_table(cloud: Cloud, points: PointSet) -> tuple[np.ndarray, ShapeTable]:
    """Coordinates and raw shape functions of a point set.

    Raises
    ------
    SingularMomentMatrixError
        Where the supports of the particles do not cover a point well enough.
    """
    coordinates = points.at(cloud.particles)
    start, neighbours = neighbour_lists(cloud, coordinates, points.group_size)
    size = neighbours.size * points.group_size
    phi, grad = np.empty(size), np.empty(2 * size)
    bad = evaluate_shape_functions(cloud, coordinates, start, neighbours, phi, grad)
    if bad >= 0:
        x, y = coordinates[bad]
        raise SingularMomentMatrixError(
            f"the moment matrix is singular at ({x:.4g}, {y:.4g}): too few particle supports cover "
            "this point; use a larger support"
        )
    return coordinates, ShapeTable(start, neighbours, phi, grad, points.group_size)


def build_table(
    cloud: Cloud, points: PointSet, transformation: EssentialTransformation | None = None
) -> PointTable:
    """Shape functions of a point set, transformed for the essential conditions."""
    coordinates, raw = raw_table(cloud, points)
    table = raw if transformation is None else transform_table(raw, transformation)
    return PointTable(points, coordinates, raw, table)


def _extended_lists(raw: ShapeTable, transformation: EssentialTransformation):
    """Neighbour lists after the transformation: groups that see C also see the whole union."""
    touched = _touched_groups(raw, transformation)
    lists = [
        np.union1d(raw.neighbours[raw.start[g] : raw.start[g + 1]], transformation.union)
        for g in touched
    ]
    counts = np.diff(raw.start)
    counts[touched] = [near.size for near in lists]
    start = np.concatenate([[0], np.cumsum(counts)])
    neighbours = np.empty(start[-1], int)
    keep = np.repeat(~np.isin(np.arange(raw.n_groups), touched), counts)
    keep_raw = np.repeat(~np.isin(np.arange(raw.n_groups), touched), np.diff(raw.start))
    neighbours[keep] = raw.neighbours[keep_raw]
    for g, near in zip(touched, lists, strict=True):
        neighbours[start[g] : start[g + 1]] = near
    return start, neighbours


def _touched_groups(raw: ShapeTable, transformation: EssentialTransformation):
    group = np.repeat(np.arange(raw.n_groups), np.diff(raw.start))
    return np.unique(group[np.isin(raw.neighbours, transformation.constrained)])


def transform_table(raw: ShapeTable, transformation: EssentialTransformation) -> ShapeTable:
    """Phi~ of ``essential`` for every group of a raw table."""
    if transformation.constrained.size == 0:
        return raw
    start, neighbours = _extended_lists(raw, transformation)
    size = neighbours.size * raw.group_size
    phi, grad = np.zeros(size), np.zeros(2 * size)
    _transform(raw, start, neighbours, transformation.constrained, transformation.union,
               transformation.matrix, raw.phi, 1, phi)  # fmt: skip
    _transform(raw, start, neighbours, transformation.constrained, transformation.union,
               transformation.matrix, raw.grad, 2, grad)  # fmt: skip
    return ShapeTable(start, neighbours, phi, grad, raw.group_size)


@nb.njit(cache=True, error_model="numpy")
def _positions(near, wanted, out):
    """``out[i]`` = place of ``near[i]`` in the sorted ``wanted``, or -1."""
    at = np.searchsorted(wanted, near)
    for i in range(near.size):
        out[i] = at[i] if at[i] < wanted.size and wanted[at[i]] == near[i] else -1


@nb.njit(cache=True, error_model="numpy")
def _transform(raw, start, neighbours, constrained, union, matrix, values, n_rows, out):
    """Apply T to ``n_rows`` rows (1: phi, 2: grad) of every point of every group."""
    for g in range(start.size - 1):
        n_raw, n_new = raw.start[g + 1] - raw.start[g], start[g + 1] - start[g]
        near = raw.neighbours[raw.start[g] : raw.start[g + 1]]
        in_c, in_new = np.empty(n_raw, np.int64), np.empty(n_raw, np.int64)
        _positions(near, constrained, in_c)
        _positions(near, neighbours[start[g] : start[g + 1]], in_new)
        of_union = np.empty(union.size, np.int64)
        _positions(union, neighbours[start[g] : start[g + 1]], of_union)
        for row in range(raw.group_size * n_rows):
            old = raw.start[g] * raw.group_size * n_rows + row * n_raw
            new = start[g] * raw.group_size * n_rows + row * n_new
            for i in range(n_raw):
                value = values[old + i]
                if in_c[i] < 0:
                    out[new + in_new[i]] += value
                else:
                    for u in range(union.size):
                        out[new + of_union[u]] += value * matrix[in_c[i], u]


@nb.njit(cache=True, error_model="numpy")
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
    """Rates of ``_transform``: value' T + value T', the parameter running fastest."""
    for g in range(table.start.size - 1):
        n_raw, n_new = raw.start[g + 1] - raw.start[g], table.start[g + 1] - table.start[g]
        near = raw.neighbours[raw.start[g] : raw.start[g + 1]]
        here = table.neighbours[table.start[g] : table.start[g + 1]]
        in_c, in_new = np.empty(n_raw, np.int64), np.empty(n_raw, np.int64)
        _positions(near, constrained, in_c)
        _positions(near, here, in_new)
        of_union = np.empty(union.size, np.int64)
        _positions(union, here, of_union)
        which = rates.active[rates.start[g, 0] : rates.start[g + 1, 0]]
        count = which.size
        for row in range(raw.group_size * n_rows):
            old = raw.start[g] * raw.group_size * n_rows + row * n_raw
            old_d = raw_rates.start[g, 1] * n_rows + row * n_raw * count
            new_d = rates.start[g, 1] * n_rows + row * n_new * count
            for i in range(n_raw):
                d_value = raw_d[old_d + i * count : old_d + (i + 1) * count]
                if in_c[i] < 0:
                    at = new_d + in_new[i] * count
                    for p in range(count):
                        out[at + p] += d_value[p]
                else:
                    for u in range(union.size):
                        at = new_d + of_union[u] * count
                        weight = matrix[in_c[i], u]
                        for p in range(count):
                            out[at + p] += (
                                d_value[p] * weight
                                + values[old + i] * matrix_rate[in_c[i], u, which[p]]
                            )


@nb.njit(cache=True, error_model="numpy")
def _transform_seeds(
    raw, table, constrained, union, matrix, values, n_rows, bar, raw_bar, matrix_bar
):
    """Transpose of ``_transform`` for M measures: seeds on the new to seeds on the raw rows and T."""
    for g in range(table.start.size - 1):
        n_raw, n_new = raw.start[g + 1] - raw.start[g], table.start[g + 1] - table.start[g]
        near = raw.neighbours[raw.start[g] : raw.start[g + 1]]
        here = table.neighbours[table.start[g] : table.start[g + 1]]
        in_c, in_new = np.empty(n_raw, np.int64), np.empty(n_raw, np.int64)
        _positions(near, constrained, in_c)
        _positions(near, here, in_new)
        of_union = np.empty(union.size, np.int64)
        _positions(union, here, of_union)
        for measure in range(bar.shape[0]):
            for row in range(raw.group_size * n_rows):
                old = raw.start[g] * raw.group_size * n_rows + row * n_raw
                new = table.start[g] * raw.group_size * n_rows + row * n_new
                for i in range(n_raw):
                    if in_c[i] < 0:
                        raw_bar[measure, old + i] = bar[measure, new + in_new[i]]
                    else:
                        value = 0.0
                        for u in range(union.size):
                            seed = bar[measure, new + of_union[u]]
                            value += seed * matrix[in_c[i], u]
                            matrix_bar[measure, in_c[i], u] += seed * values[old + i]
                        raw_bar[measure, old + i] = value


def _active_parameters(point_table, velocity, transformation):
    """Parameters that move a neighbour or an anchor of each group, as (start, active)."""
    raw, points = point_table.raw, point_table.points
    moves = np.any(velocity != 0.0, axis=2).T.astype(np.int32)  # particle, parameter
    n_particles = moves.shape[0]
    sees = csr_array(
        (np.ones(raw.neighbours.size, np.int32), raw.neighbours, raw.start),
        shape=(raw.n_groups, n_particles),
    )
    ends = np.arange(raw.n_groups + 1) * points.anchors[: points.group_size].size
    anchored = csr_array(
        (np.ones(points.anchors.size, np.int32), points.anchors.ravel(), ends), shape=sees.shape
    )
    hit = (sees @ moves + anchored @ moves) > 0
    if transformation is not None and transformation.constrained.size:
        touched = _touched_groups(raw, transformation)
        hit[touched] |= moves[transformation.union].any(axis=0)
    start = np.concatenate([[0], np.cumsum(hit.sum(axis=1))])
    return start, np.nonzero(hit)[1]


def entry_starts(counts_active, table):
    """Where the rate entries of every group begin, given its number of active parameters."""
    sizes = counts_active * np.diff(table.start) * table.group_size
    return np.concatenate([[0], np.cumsum(sizes)])


def raw_rates(cloud, point_table: PointTable, velocity, transformation=None) -> TableRates:
    """Rates of the raw shape functions along design velocities ``velocity`` (P, n_particles, 2)."""
    points, raw = point_table.points, point_table.raw
    start, active = _active_parameters(point_table, velocity, transformation)
    starts = np.column_stack([start, entry_starts(np.diff(start), raw)])
    point_velocity = np.einsum("pk,vpki->vpi", points.weights, velocity[:, points.anchors])
    dphi, dgrad = np.empty(starts[-1, 1]), np.empty(2 * starts[-1, 1])
    forward_shape_functions(
        cloud, point_table.coordinates, raw.start, raw.neighbours, velocity, point_velocity,
        active, starts, dphi, dgrad,
    )  # fmt: skip
    return TableRates(starts, active, dphi, dgrad)


def transformed_rates(raw: ShapeTable, table: ShapeTable, rates, transformation, matrix_rate):
    """Rates of a transformed table from those of the raw one.

    Parameters
    ----------
    rates : TableRates
        Of ``raw``.
    matrix_rate : ndarray, shape (c, u, P)
        T' of ``essential.transformation_rates``.
    """
    if transformation is None or transformation.constrained.size == 0:
        return rates
    count = np.diff(rates.start[:, 0])
    starts = np.column_stack([rates.start[:, 0], entry_starts(count, table)])
    new = TableRates(starts, rates.active, np.zeros(starts[-1, 1]), np.zeros(2 * starts[-1, 1]))
    c, u, matrix = transformation.constrained, transformation.union, transformation.matrix
    matrix_rate = np.ascontiguousarray(matrix_rate)
    _transform_rates(
        raw, table, new, rates, c, u, matrix, matrix_rate, raw.phi, rates.phi, 1, new.phi
    )
    _transform_rates(
        raw, table, new, rates, c, u, matrix, matrix_rate, raw.grad, rates.grad, 2, new.grad
    )
    return new


def table_rates(
    cloud: Cloud,
    point_table: PointTable,
    velocity: np.ndarray,
    transformation: EssentialTransformation | None = None,
    matrix_rate: np.ndarray | None = None,
) -> TableRates:
    """Rates of a transformed table along design velocities (P, n_particles, 2)."""
    rates = raw_rates(cloud, point_table, velocity, transformation)
    return transformed_rates(point_table.raw, point_table.table, rates, transformation, matrix_rate)


def untransformed_seeds(raw: ShapeTable, table: ShapeTable, phi_bar, grad_bar, transformation):
    """Transpose of ``transformed_rates``: seeds on the raw table (phi, grad), and on T or None."""
    if transformation is None or transformation.constrained.size == 0:
        return phi_bar, grad_bar, None
    c, u, matrix = transformation.constrained, transformation.union, transformation.matrix
    m = len(phi_bar)
    matrix_bar = np.zeros((m, *matrix.shape))
    raw_phi, raw_grad = np.empty((m, raw.phi.size)), np.empty((m, raw.grad.size))
    _transform_seeds(raw, table, c, u, matrix, raw.phi, 1, phi_bar, raw_phi, matrix_bar)
    _transform_seeds(raw, table, c, u, matrix, raw.grad, 2, grad_bar, raw_grad, matrix_bar)
    return raw_phi, raw_grad, matrix_bar


def raw_seeds(cloud: Cloud, point_table: PointTable, phi_bar, grad_bar, x_bar) -> None:
    """Transpose of ``raw_rates``: seeds on the raw table added to ``x_bar`` (M, n_particles, 2)."""
    raw, points = point_table.raw, point_table.points
    point_bar = np.zeros((len(phi_bar), *point_table.coordinates.shape))
    reverse_shape_functions(
        cloud, point_table.coordinates, raw.start, raw.neighbours, phi_bar, grad_bar, x_bar,
        point_bar,
    )  # fmt: skip
    add_point_seeds(points, point_bar, x_bar)


def table_seeds(cloud, point_table: PointTable, phi_bar, grad_bar, x_bar, transformation=None):
    """Pull seeds on a transformed table back to the particles (transpose of ``table_rates``).

    Parameters
    ----------
    phi_bar, grad_bar : ndarray, shapes (M, phi.size), (M, grad.size)
    x_bar : ndarray, shape (M, n_particles, 2)
        Added to.

    Returns
    -------
    ndarray, shape (M, c, u), or None
        Seeds on T, which the caller sums over all tables before pulling them back.
    """
    phi_bar, grad_bar, matrix_bar = untransformed_seeds(
        point_table.raw, point_table.table, phi_bar, grad_bar, transformation
    )
    raw_seeds(cloud, point_table, phi_bar, grad_bar, x_bar)
    return matrix_bar


def add_point_seeds(points: PointSet, point_bar: np.ndarray, x_bar: np.ndarray) -> None:
    """Transpose of ``PointSet.at``: seeds on the points (M, n_points, 2) to the particles."""
    for k in range(points.anchors.shape[1]):
        weighted = point_bar * points.weights[:, k, None]
        np.add.at(x_bar, (slice(None), points.anchors[:, k]), weighted)

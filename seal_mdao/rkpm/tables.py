"""Shape function tables of a point set: neighbours, values, and their design derivatives.

``build_table`` is the analysis side. A table owns its derivatives: ``PointTable.rates`` along design
velocities (direct differentiation) and ``PointTable.pull_back``, its transpose (adjoint). Both are
products with the same coefficients of ``shape_derivatives`` and the same ``TableTransform``.
"""

from dataclasses import dataclass, replace
from itertools import chain, pairwise

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from seal_mdao.errors import SingularMomentMatrixError
from seal_mdao.rkpm.axisymmetry import hoop_rates, split_hoop_seeds, with_hoop_rows
from seal_mdao.rkpm.essential import EssentialTransformation
from seal_mdao.rkpm.shape_derivatives import (
    forward_shape_functions,
    linearize_shape_functions,
    reverse_shape_functions,
)
from seal_mdao.rkpm.shape_functions import (
    Cloud,
    PointSet,
    ShapeTable,
    evaluate_shape_functions,
    grad_rows,
)
from seal_mdao.rkpm.transformed import TableRates, TableTransform, entry_starts

RUN_ROWS = 2048
"""Rows (point, neighbour) differentiated at once, so that their coefficients stay in the cache."""


@dataclass(frozen=True)
class PointTable:
    """A point set with its raw and its transformed shape functions.

    Attributes
    ----------
    points : PointSet
    coordinates : ndarray, shape (n_points, 2)
    raw : ShapeTable
        Eq. (13), without essential conditions.
    table : ShapeTable
        After the essential transformation; what the analysis uses.
    inverses : ndarray, shape (n_points, m, m)
        M^-1 of Eq. (7), which the derivatives use too.
    hidden : ndarray of bool
        Neighbours of a group that a point of it does not see, flat (group, point, neighbour); empty if
        every point sees them all.
    interpolated : ndarray of bool, shape (n_points,)
        Points on interfaces, where values are linear between two particles; empty if there are none.
    cloud : Cloud
    transform : TableTransform or None
        From ``raw`` to ``table``.
    """

    points: PointSet
    coordinates: np.ndarray
    raw: ShapeTable
    table: ShapeTable
    inverses: np.ndarray
    hidden: np.ndarray
    interpolated: np.ndarray
    cloud: Cloud
    transform: TableTransform | None = None

    def rates(self, velocity: np.ndarray, matrix_rate: np.ndarray | None = None) -> TableRates:
        """Differentiate the table along design velocities V (P, n_particles, 2).

        Parameters
        ----------
        matrix_rate : ndarray, shape (c, u, P)
            T' of ``essential.transformation_rates``, where the table is transformed.
        """
        if self.transform is None:
            return self.raw_rates(velocity)
        # Phi~' = Phi' T + Phi T'
        return self.transform.rates(self.raw_rates(velocity, self.transform), matrix_rate)

    def pull_back(self, phi_bar, grad_bar, x_bar):
        """Apply the transpose of ``rates``: seeds on the table back to the particles.

        Parameters
        ----------
        phi_bar, grad_bar : ndarray, shapes (phi.size, M), (grad.size, M)
        x_bar : ndarray, shape (n_particles, 2, M)
            Added to.

        Returns
        -------
        ndarray, shape (c, u, M), or None
            Seeds on T, which the caller sums over all tables before pulling them back.
        """
        raw, matrix_bar, every = self.raw, None, (0, self.raw.n_groups)
        if self.transform is not None:
            transform = self.transform
            matrix_bar = np.zeros((*transform.transformation.matrix.shape, x_bar.shape[2]))
            # Phi_bar = Phi~_bar T^T, T_bar = Phi^T Phi~_bar, of values and of gradients
            phi_bar = transform.pull_back(every, raw.phi, 1, phi_bar, matrix_bar)
            grad_bar = transform.pull_back(every, raw.grad, grad_rows(raw), grad_bar, matrix_bar)
        point_bar = np.zeros((*self.coordinates.shape, x_bar.shape[2]))
        for first, last in runs(raw):
            rows = slice(*(raw.start[[first, last]] * raw.group_size))
            slopes = slice(grad_rows(raw) * rows.start, grad_rows(raw) * rows.stop)
            self.add_raw_seeds((first, last), phi_bar[rows], grad_bar[slopes], x_bar, point_bar)
        # X_k_bar += w_k x_bar of the points, which move with their anchors
        self.points.add_seeds(self.cloud.particles, point_bar, x_bar)
        return matrix_bar

    def raw_rates(self, velocity, transform=None, like: TableRates | None = None) -> TableRates:
        """Differentiate the raw shape functions along design velocities (P, n_particles, 2).

        ``transform`` is the one that the rates go through afterwards; ``like``, if given, are those of
        a table whose groups have the same neighbours and anchors, so the same active parameters.
        """
        points, raw = self.points, self.raw
        start, active = (
            self._active(velocity, transform) if like is None else (like.start[:, 0], like.active)
        )
        starts = np.column_stack([start, entry_starts(np.diff(start), raw)])
        # V(x) = sum_k w_k V(X_k) of the anchors
        point_velocity = np.einsum("pk,vpki->vpi", points.weights, velocity[:, points.anchors])
        size, needed = starts[-1, 1], points.valued or points.hooped
        dphi, dgrad = np.empty(size * needed), np.empty(2 * size * points.sloped)
        for groups in runs(raw, np.diff(start) > 0):
            forward_shape_functions(
                self._linearized(groups), raw.start, raw.neighbours, groups, velocity,
                point_velocity, active, starts, dphi, dgrad,
            )  # fmt: skip
        rates = TableRates(starts, active, dphi, dgrad)
        return self._with_hoop_rates(rates, point_velocity) if points.hooped else rates

    def _with_hoop_rates(self, rates: TableRates, point_velocity) -> TableRates:
        """Complete the rates by those of the hoop rows."""
        raw, rows = self.raw, np.empty(3 * rates.phi.size)
        hoop_rates(
            raw.start, raw.group_size, rates, raw.grad, self.coordinates[:, 0],
            np.ascontiguousarray(point_velocity[:, :, 0].T), rows,
        )  # fmt: skip
        return rates._replace(phi=rates.phi if self.points.valued else np.empty(0), grad=rows)

    def add_raw_seeds(self, groups, phi_bar, grad_bar, x_bar, point_bar) -> None:
        """Apply the transpose of ``raw_rates`` to the ``groups`` (first, last): seeds on their raw rows
        added to ``x_bar`` (n_particles, 2, M) and, on the points, to ``point_bar`` (n_points, 2, M)."""
        if self.points.hooped:
            phi_bar, grad_bar = self._split_seeds(groups, phi_bar, grad_bar, point_bar[:, 0])
        reverse_shape_functions(
            self._linearized(groups), self.raw.start, self.raw.neighbours, groups, phi_bar, grad_bar,
            x_bar, point_bar,
        )  # fmt: skip

    def _split_seeds(self, groups, phi_bar, grad_bar, radius_bar):
        """Seeds on values and gradients from those with the hoop rows; adds to ``radius_bar``."""
        raw, count = self.raw, len(grad_bar) // 3
        on_phi, on_slopes = (np.empty((size, grad_bar.shape[1])) for size in (count, 2 * count))
        split_hoop_seeds(
            raw.start, groups, raw.group_size, grad_bar, raw.grad, self.coordinates[:, 0], on_slopes,
            on_phi, radius_bar,
        )  # fmt: skip
        # seeds on Phi of the hoop rows Phi / R and of the values
        return on_phi + phi_bar if self.points.valued else on_phi, on_slopes

    def _linearized(self, groups):
        """Compute the coefficients of the derivatives of the ``groups`` (first, last)."""
        raw, points = self.raw, self.points
        return linearize_shape_functions(
            self.cloud, self.coordinates, self.inverses, raw.start, raw.neighbours, self.hidden,
            self.interpolated, groups, points.group_size, 3 if points.sloped else 1,
        )  # fmt: skip

    def _active(self, velocity, transform):
        """Find the parameters that move a neighbour or an anchor of each group, as (start, active)."""
        raw, points = self.raw, self.points
        # particle i moves with parameter p: V_p(X_i) != 0
        moves = np.any(velocity != 0.0, axis=2).T.astype(np.int32)  # particle, parameter
        # incidence (group, neighbour) and (group, anchor), times (particle, parameter)
        sees = csr_array(
            (np.ones(raw.neighbours.size, np.int32), raw.neighbours, raw.start),
            shape=(raw.n_groups, len(moves)),
        )
        ends = np.arange(raw.n_groups + 1) * points.anchors[: points.group_size].size
        anchored = csr_array(
            (np.ones(points.anchors.size, np.int32), points.anchors.ravel(), ends), shape=sees.shape
        )
        hit = (sees @ moves + anchored @ moves) > 0
        if transform is not None and transform.transformation.constrained.size:
            # T' depends on the particles of the union
            hit[transform.touched] |= moves[transform.transformation.union].any(axis=0)
        return np.concatenate([[0], np.cumsum(hit.sum(axis=1))]), np.nonzero(hit)[1]


def neighbour_lists(cloud: Cloud, coordinates: np.ndarray, *sets: PointSet):
    """Find the particles whose support covers any point of a group, as (start, neighbours), sorted.

    Groups with the same index in several sets, whose ``coordinates`` follow each other, are one group. A
    particle that is hidden from all points of a group is no neighbour of the group.

    Returns
    -------
    start, neighbours : ndarray of int
    hidden : list of ndarray of bool
        Of every set, ``PointTable.hidden``.
    """
    group_of = np.concatenate([np.arange(len(own.anchors)) // own.group_size for own in sets])
    tree = cKDTree(coordinates)
    # |x - X_I| <= a_I
    hits = tree.query_ball_point(cloud.particles, cloud.radius, return_sorted=False)
    counts = np.fromiter(map(len, hits), int, len(hits))
    particle = np.repeat(np.arange(len(hits)), counts)
    point = np.fromiter(chain.from_iterable(hits), int, particle.size)
    if cloud.axes is not None:
        # product kernels: |a . r| < 1 and |b . r| < 1
        away = coordinates[point] - cloud.particles[particle]
        along, across = np.einsum("kij,kj->ik", cloud.axes[particle], away)
        inside = (np.abs(along) < 1.0) & (np.abs(across) < 1.0)
        particle, point = particle[inside], point[inside]
    n, unseen = len(cloud.particles), None
    if cloud.hidden_pairs.size or cloud.in_parts.size:
        foreign = _foreign(cloud.in_parts, sets, point, particle)
        unseen = np.union1d(_unseen(cloud.hidden_pairs, sets, n), foreign)
        seen = ~_among(point * n + particle, unseen)
        particle, point = particle[seen], point[seen]
    # pairs (group, particle) as one integer, sorted by group, then particle; several points of a group
    # have the same one. Sorting is ten times faster than np.unique, which hashes integers first
    key = np.sort(group_of[point] * n + particle)
    key = key[np.diff(key, prepend=-1) > 0]
    group, neighbours = np.divmod(key, n)
    start = np.searchsorted(group, np.arange(len(sets[0].anchors) // sets[0].group_size + 1))
    hidden, first = [], 0
    for own in sets:
        hidden.append(_hidden(start, neighbours, own.group_size, first, unseen, n))
        first += len(own.anchors)
    return start, neighbours, hidden


def _unseen(hidden_pairs: np.ndarray, sets, n: int) -> np.ndarray:
    """Find pairs of a point and a particle hidden from one of its anchors, as sorted point n + particle;
    the points of all sets are numbered one after the other."""
    blind = np.zeros(n, bool)
    blind[hidden_pairs[:, 1]] = True
    points, anchors, first = [], [], 0
    for own in sets:
        # anchors that have a weight and do not see every particle
        weighted = own.weights[:, : own.ends] != 0.0
        point, corner = np.nonzero(weighted & blind[own.anchors[:, : own.ends]])
        points.append(first + point)
        anchors.append(own.anchors[point, corner])
        first += len(own.anchors)
    points, anchors = np.concatenate(points), np.concatenate(anchors)
    # the particles that are hidden from every anchor
    order = np.argsort(hidden_pairs[:, 1], kind="stable")
    particles = hidden_pairs[order, 0]
    ends = np.searchsorted(hidden_pairs[order, 1], np.arange(n + 1))
    counts = np.diff(ends)[anchors]
    which = np.repeat(ends[anchors], counts) + _counted(counts)
    return np.unique(np.repeat(points, counts) * n + particles[which])


def _foreign(in_parts: np.ndarray, sets, point, particle) -> np.ndarray:
    """Find the pairs of a point of one part and a particle in other parts only, numbered as ``_unseen``
    does."""
    if not in_parts.size:
        return np.empty(0, int)
    # -1 for points of all parts of their anchors
    part = np.concatenate([
        np.full(len(own.anchors), -1) if own.parts is None else own.parts for own in sets
    ])[point]  # fmt: skip
    foreign = (part >= 0) & ~in_parts[particle, part]
    return point[foreign] * len(in_parts) + particle[foreign]


def _among(keys: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Find which of the integers ``keys`` are among the sorted ``known``, a mask."""
    at = np.searchsorted(known, keys)
    return (
        known[np.minimum(at, known.size - 1)] == keys if known.size else np.zeros(keys.shape, bool)
    )


def _hidden(start, neighbours, group_size: int, first: int, unseen, n: int) -> np.ndarray:
    """Mark the neighbours of groups that their points do not see, as ``PointTable.hidden``; in the pairs
    ``unseen`` the points of the set are numbered from ``first`` on."""
    if unseen is None:
        return np.empty(0, bool)
    # the neighbours of the group of every point, flat (group, point, neighbour)
    sizes = np.repeat(np.diff(start), group_size)
    row = np.repeat(np.arange(sizes.size), sizes)
    at = _counted(sizes) + np.repeat(start[:-1], np.diff(start) * group_size)
    hidden = _among((first + row) * n + neighbours[at], unseen)
    return hidden if hidden.any() else np.empty(0, bool)


def raw_tables(cloud: Cloud, *sets: PointSet) -> tuple[PointTable, ...]:
    """Evaluate raw shape functions of point sets that share their neighbour lists, group by group.

    Raises
    ------
    SingularMomentMatrixError
        Where the supports of the particles do not cover a point well enough.
    """
    coordinates = [own.at(cloud.particles) for own in sets]
    start, neighbours, hidden = neighbour_lists(cloud, np.concatenate(coordinates), *sets)
    # one list of neighbours for all sets: cells need Gauss and edge points on the same one
    return tuple(
        _evaluated(cloud, own, x, start, neighbours, unseen)
        for own, x, unseen in zip(sets, coordinates, hidden, strict=True)
    )


def _evaluated(cloud, points, coordinates, start, neighbours, hidden) -> PointTable:
    size, needed = neighbours.size * points.group_size, points.valued or points.hooped
    phi, grad = np.empty(size * needed), np.empty(2 * size * points.sloped)
    inverses = np.empty((len(coordinates), cloud.n_basis, cloud.n_basis))
    singular = evaluate_shape_functions(
        cloud, coordinates, start, neighbours, hidden, phi, grad, inverses
    )
    if singular >= 0:
        x, y = coordinates[singular]
        raise SingularMomentMatrixError(
            f"the RKPM moment matrix is singular at ({x:.4g}, {y:.4g}): too few kernel supports "
            "cover this point; use a larger kernel support (support of the door seal and of Kernels, "
            "support_radius of a mesh file), or smaller boundary offsets"
        )
    interpolated = _interpolated(cloud, points)
    if interpolated.size and phi.size:
        _interpolate(points, np.flatnonzero(interpolated), start, neighbours, phi)
    if points.hooped:
        rows = np.empty(3 * size)
        with_hoop_rows(start, points.group_size, grad, phi, coordinates[:, 0], rows)
        phi, grad = phi if points.valued else np.empty(0), rows
    raw = ShapeTable(start, neighbours, phi, grad, points.group_size)
    return PointTable(points, coordinates, raw, raw, inverses, hidden, interpolated, cloud)


def _interpolated(cloud: Cloud, points: PointSet) -> np.ndarray:
    """Find the points at or between two particles of interfaces, a mask (n_points,), empty for none."""
    if not cloud.in_parts.size:
        return np.empty(0, bool)
    weighted, several = points.weights != 0.0, cloud.in_parts.sum(axis=1) > 1
    found = (several[points.anchors] | ~weighted).all(axis=1)
    # not those inside a cell whose corners all lie on interfaces
    lowest = np.where(weighted, points.anchors, points.anchors.max(initial=0)).min(axis=1)
    highest = np.where(weighted, points.anchors, 0).max(axis=1)
    between = (points.anchors == lowest[:, None]) | (points.anchors == highest[:, None])
    found &= (between | ~weighted).all(axis=1)
    return found if found.any() else np.empty(0, bool)


def _interpolate(points: PointSet, which, start, neighbours, phi) -> None:
    """Set the values Phi_I of the points ``which`` to the weights of their anchors, in place."""
    n = int(neighbours.max()) + 1
    groups, sizes = which // points.group_size, np.diff(start)
    rows = start[groups] * points.group_size + which % points.group_size * sizes[groups]
    phi[np.repeat(rows, sizes[groups]) + _counted(sizes[groups])] = 0.0
    # neighbours are sorted in every group
    keys = np.repeat(np.arange(sizes.size), sizes) * n + neighbours
    for anchors, weights in zip(points.anchors[which].T, points.weights[which].T, strict=True):
        # an anchor without a weight need not be a neighbour
        some = np.flatnonzero(weights)
        at = np.searchsorted(keys, groups[some] * n + anchors[some]) - start[groups[some]]
        # Phi_I(x) = sum of the weights of I
        phi[rows[some] + at] += weights[some]


def _counted(sizes: np.ndarray) -> np.ndarray:
    """Count from 0 within consecutive runs of these sizes."""
    return np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)


def build_table(
    cloud: Cloud, points: PointSet, transformation: EssentialTransformation | None = None
) -> PointTable:
    """Build the shape functions of a point set, transformed for the essential conditions."""
    (plain,) = raw_tables(cloud, points)
    if transformation is None:
        return plain
    transform = TableTransform(plain.raw, transformation)
    return replace(plain, table=transform.table, transform=transform)


def runs(raw: ShapeTable, wanted=None) -> list:
    """Split groups, all or ``wanted`` (mask), into runs (first, last) of about ``RUN_ROWS`` rows."""
    groups = np.arange(raw.n_groups) if wanted is None else np.flatnonzero(wanted)
    number = raw.start[groups] * raw.group_size // RUN_ROWS
    # a run ends before a group that is left out, and at every multiple of RUN_ROWS
    cuts = np.flatnonzero((np.diff(groups) > 1) | (np.diff(number) > 0)) + 1
    ends = [0, *cuts, groups.size] if groups.size else []
    return [(int(groups[a]), int(groups[b - 1]) + 1) for a, b in pairwise(ends)]

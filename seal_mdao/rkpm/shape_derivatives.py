"""Derivatives of Phi_I and grad Phi_I when the particles and the evaluation point move.

Everything depends on the differences r_I = x - X_I alone. With q = M^-1 H(0), q_j = -M^-1 M_j q and the
polynomials p = q . H, p_j = q_j . H + q . H_j:

    Phi_I   = p phi_a
    Phi_I,j = p_j phi_a + p phi_a,j

    (Phi, Phi_,x, Phi_,y)' = D r' + S (q, q_x, q_y)',    (q, q_x, q_y)' = G C^T r'

``linearize_shape_functions`` collects the exact coefficients D, S G, C at the points of a run of groups
once; the forward kernel (design velocities, direct method) and the reverse kernel (adjoint seeds) are
products with them. S G is formed: where M is badly conditioned G is large, and the two agree only with
the same product. All arrays of a point have ``rows`` blocks: 3, or 1 where only Phi_I is needed.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.rkpm.basis import basis_slope
from seal_mdao.rkpm.moment import (
    clear_hidden,
    correction_polynomials,
    gathered,
    moment_matrices,
    n_monomials,
    neighbour_terms,
)


class Coefficients(NamedTuple):
    """Coefficients D, C, S G of the derivatives at the points of a run of groups, flat
    (group, point, ..., neighbour).

    Attributes
    ----------
    direct : ndarray
        At a point with n neighbours (rows, 2, n): D, derivative in a neighbour's own r_I, q, q_j fixed.
    pull : ndarray
        (rows, m, 2, n): C, derivatives of M q and of M_j q + M q_j in r_I, q, q_j fixed.
    pull_sums : ndarray, shape (n_points, rows, m, 2)
        C summed over all neighbours.
    on_value : ndarray
        (m, n): S G, from the first block of C^T r' to Phi.
    on_slope : ndarray
        (rows, m, rows - 1, n): S G, from the blocks of C^T r' to Phi_j; from block j it is ``on_value``.
    """

    direct: np.ndarray
    pull: np.ndarray
    pull_sums: np.ndarray
    on_value: np.ndarray
    on_slope: np.ndarray


@inlined
def _rows(flat, at, n, size):
    """Slice ``n`` rows (point, neighbour) of ``size`` entries each, after the first ``at``."""
    return flat[at * size : (at + n) * size]


@inlined
def _second(j, k):
    """Index of the second derivative (j, k), components counted from 0, in the six-row tables."""
    return 3 + j + k


@inlined
def _fill_polynomials(b, h, scale, p):
    """Evaluate values and slopes ``p`` (rows, 3, n) of the polynomials of ``moment`` at neighbours."""
    rows, m = b.shape
    n = p.shape[2]
    for u in range(rows):
        for i in range(n):
            # p_u = b_u0 + sum_a b_ua H_a
            p[u, 0, i] = b[u, 0]
            p[u, 1, i] = p[u, 2, i] = 0.0
        for a in range(1, m):
            value = b[u, a]
            for i in range(n):
                p[u, 0, i] += value * h[a, i]
            for c in range(2):
                # p_u,c = sum_a b_ua H_a,c
                factor, lowered = basis_slope(a, c, scale)
                if factor > 0.0:
                    value = factor * b[u, a]
                    for i in range(n):
                        p[u, 1 + c, i] += value * h[lowered, i]


@inlined
def _fill_direct(p, k, phi, direct):
    """Evaluate Phi, Phi_x, Phi_y (``phi``), and their derivatives D in r at fixed q, q_j."""
    rows, n = phi.shape
    for i in range(n):
        # Phi = p phi_a
        phi[0, i] = p[0, 0, i] * k[0, i]
    for c in range(2):
        for i in range(n):
            # D_c = p_,c phi_a + p phi_a,c
            direct[0, c, i] = p[0, 1 + c, i] * k[0, i] + p[0, 0, i] * k[1 + c, i]
    for j in range(1, rows):
        for i in range(n):
            # Phi_,j = p_j phi_a + p phi_a,j
            phi[j, i] = p[j, 0, i] * k[0, i] + p[0, 0, i] * k[j, i]
        for c in range(2):
            jc = _second(j - 1, c)
            for i in range(n):
                # D_jc = p_j,c phi_a + p_j phi_a,c + p_,c phi_a,j + p phi_a,jc
                direct[j, c, i] = p[j, 1 + c, i] * k[0, i] + p[j, 0, i] * k[1 + c, i]
            for i in range(n):
                direct[j, c, i] += p[0, 1 + c, i] * k[j, i] + p[0, 0, i] * k[jc, i]


@inlined
def _fill_pull(h, scale, phi, direct, pull):
    """Evaluate C, the derivatives in r_I of M q = sum H Phi_I and M_j q + M q_j = sum (H Phi_I)_,j."""
    rows, m, _, n = pull.shape
    for u in range(rows):
        for a in range(m):
            for c in range(2):
                by_c, ac = basis_slope(a, c, scale)
                for i in range(n):
                    # u = 0:  C_ac = H_a D_c + H_a,c Phi
                    # u = j:  C_jac = [H_a D_jc + H_a,c Phi_j] + [H_a,j D_c + H_a,jc Phi], the first
                    pull[u, a, c, i] = h[a, i] * direct[u, c, i] + by_c * h[ac, i] * phi[u, i]
                if u > 0:
                    by_j, aj = basis_slope(a, u - 1, scale)
                    by_jc, ajc = basis_slope(aj, c, scale)
                    by_jc *= by_j
                    if by_j > 0.0:
                        for i in range(n):
                            # and the second bracket
                            pull[u, a, c, i] += (
                                by_j * h[aj, i] * direct[0, c, i] + by_jc * h[ajc, i] * phi[0, i]
                            )


@inlined
def _fill_chain(h, k, scale, moments, inverse, spread, on_value, on_slope):
    """Evaluate S G, which maps C^T r' to the part of Phi', Phi_,j' that comes with q', q_j'."""
    m, n = on_value.shape
    # M q = H(0):             q'   = -M^-1 C_0^T r'
    # M_j q + M q_j = 0:      q_j' = -M^-1 (C_j^T r' + M_j q')
    # Phi' = H phi_a . q',    Phi_,j' = (H phi_a)_,j . q' + H phi_a . q_j'
    on_value[:] = 0.0
    for a in range(m):
        for i in range(n):
            # A = -H phi_a M^-1: Phi' = A C_0^T r'
            spread[i] = -h[a, i] * k[0, i]
        for b in range(m):
            for i in range(n):
                on_value[b, i] += inverse[a, b] * spread[i]
    on_slope[:] = 0.0
    for j in range(on_slope.shape[2]):
        for a in range(m):
            factor, lowered = basis_slope(a, j, scale)
            for i in range(n):
                # Phi_,j' = -[(H phi_a)_,j + A M_j] M^-1 C_0^T r' + A C_j^T r'
                spread[i] = -h[a, i] * k[1 + j, i] - factor * h[lowered, i] * k[0, i]
            for e in range(m):
                for i in range(n):
                    spread[i] -= moments[1 + j, a, e] * on_value[e, i]
            for b in range(m):
                for i in range(n):
                    # (...) M^-1, M^-1 being symmetric
                    on_slope[0, b, j, i] += inverse[a, b] * spread[i]
        for b in range(m):
            for i in range(n):
                # A; between q_k and Phi_,j with k != j it is zero
                on_slope[1 + j, b, j, i] = on_value[b, i]


@compiled
def linearize_shape_functions(
    cloud, points, inverses, start, neighbours, hidden, interpolated, groups, group_size, rows
):
    """Compute the coefficients D, C, S G at the points of the ``groups`` (first, last) of a table.

    Parameters
    ----------
    points, inverses : ndarray, shapes (n_points, 2), (n_points, m, m)
        Of the complete table; M^-1 at the points.
    hidden, interpolated : ndarray of bool
        Of ``PointTable``.
    """
    m, scale, (first, last) = cloud.n_basis, cloud.scale, groups
    size = (start[last] - start[first]) * group_size
    out = Coefficients(
        np.empty(size * rows * 2),
        np.empty(size * rows * m * 2),
        np.empty(((last - first) * group_size, rows, m, 2)),
        np.empty(size * m),
        np.empty(size * rows * m * (rows - 1)),
    )
    moments, b = np.empty((rows, m, m)), np.empty((rows, m))
    for g in range(first, last):
        # what all points of the group have in common
        near = gathered(
            cloud.particles, cloud.radius, cloud.axes, neighbours[start[g] : start[g + 1]]
        )
        n = near.shape[1]
        h, k, spread = np.empty((n_monomials(m), n)), np.empty((6, n)), np.empty(n)
        p, phi, ones = np.empty((rows, 3, n)), np.empty((rows, n)), np.ones(n)
        before = (start[g] - start[first]) * group_size
        for q in range(group_size):
            at, point = before + q * n, g * group_size + q
            direct = _rows(out.direct, at, n, 2 * rows).reshape(rows, 2, n)
            pull = _rows(out.pull, at, n, rows * m * 2).reshape(rows, m, 2, n)
            on_value = _rows(out.on_value, at, n, m).reshape(m, n)
            on_slope = _rows(out.on_slope, at, n, rows * m * (rows - 1))
            on_slope = on_slope.reshape(rows, m, rows - 1, n)
            # H, phi_a -> M, M_j -> p, p_j -> Phi, D -> C, S G
            neighbour_terms(points[point], near, cloud.axes, scale, h, k)
            clear_hidden(hidden, start[first] * group_size + at, k)
            if rows > 1:
                moment_matrices(h, k, scale, moments)
            correction_polynomials(moments, inverses[point], scale, b)
            _fill_polynomials(b, h, scale, p)
            _fill_direct(p, k, phi, direct)
            _fill_pull(h, scale, phi, direct, pull)
            _fill_chain(h, k, scale, moments, inverses[point], spread, on_value, on_slope)
            if interpolated.size > 0 and interpolated[point]:
                # Phi_I is the weight of an anchor in all designs
                direct[0] = 0.0
                on_value[:] = 0.0
        # sum_I C: the point itself moves every r_I
        pulls = _rows(out.pull, before, group_size * n, rows * m * 2).reshape(-1, n)
        sums = out.pull_sums[(g - first) * group_size : (g - first + 1) * group_size]
        np.dot(pulls, ones, sums.reshape(-1))
    return out


@internal
def _add_direct(direct, here, moves, out):
    """Add D r' of P parameters, ``direct`` (2, n), with r' = V(x) - V(X_I)."""
    n, count = out.shape
    for i in range(n):
        dx, dy = direct[0, i], direct[1, i]
        for p in range(count):
            out[i, p] += dx * (here[0, p] - moves[0, i, p]) + dy * (here[1, p] - moves[1, i, p])


@compiled
def forward_shape_functions(
    own, start, neighbours, groups, velocity, point_velocity, active, dstart, dphi, dgrad
):
    """Differentiate the ``groups`` (first, last) of a table along design velocities V.

    Parameters
    ----------
    own : Coefficients
        Of these groups.
    velocity, point_velocity : ndarray, shapes (P, n_particles, 2), (P, n_points, 2)
        Design velocities V at the particles and at the points of the complete table.
    active, dstart : ndarray of int
        Parameters that touch group g: ``active[dstart[g, 0]:dstart[g + 1, 0]]``;
        ``dstart[g, 1]`` is where its entries begin in ``dphi``.
    dphi, dgrad : ndarray
        Flat (group, point, neighbour, parameter), (group, point, component, neighbour, parameter);
        empty where not needed.
    """
    (first, last), (n_points, rows, m, _) = groups, own.pull_sums.shape
    group_size = n_points // (last - first)
    for g in range(first, last):
        near = neighbours[start[g] : start[g + 1]]
        which = active[dstart[g, 0] : dstart[g + 1, 0]]
        n, count, before = near.size, which.size, (start[g] - start[first]) * group_size
        moves, here = np.empty((2, n, count)), np.empty((2, count))
        for p in range(count):
            for i in range(n):
                for c in range(2):
                    # V(X_I) of the neighbours
                    moves[c, i, p] = velocity[which[p], near[i], c]
        # C^T r' = (sum_I C_I) V(x) - sum_I C_I V(X_I), one product for all points of the group
        pull = _rows(own.pull, before, group_size * n, rows * m * 2).reshape(-1, 2 * n)
        moved = np.dot(pull, moves.reshape(2 * n, count)).reshape(group_size, rows * m, count)
        for q in range(group_size):
            point = g * group_size + q
            for p in range(count):
                for c in range(2):
                    here[c, p] = point_velocity[which[p], point, c]
            sums = own.pull_sums[point - first * group_size].reshape(rows * m, 2)
            for a in range(rows * m):
                for p in range(count):
                    moved[q, a, p] = (
                        sums[a, 0] * here[0, p] + sums[a, 1] * here[1, p] - moved[q, a, p]
                    )
            at, to = before + q * n, dstart[g, 1] + q * n * count
            direct = _rows(own.direct, at, n, 2 * rows).reshape(rows, 2, n)
            if dphi.size > 0:
                out = dphi[to : to + n * count].reshape(n, count)
                on_value = _rows(own.on_value, at, n, m).reshape(m, n)
                # Phi' = S G C^T r' + D r'
                np.dot(on_value.T, moved[q, :m], out)
                _add_direct(direct[0], here, moves, out)
            if rows > 1:
                out = dgrad[2 * to : 2 * (to + n * count)].reshape(2 * n, count)
                on_slope = _rows(own.on_slope, at, n, rows * m * (rows - 1))
                on_slope = on_slope.reshape(rows * m, 2 * n)
                # Phi_,j' = S G C^T r' + D_j r'
                np.dot(on_slope.T, moved[q], out)
                for u in range(1, rows):
                    _add_direct(direct[u], here, moves, out[(u - 1) * n : u * n])


@internal
def _add_direct_seeds(direct, seed, on_near, on_point):
    """Apply the transpose of ``_add_direct``: D^T seed, added to the sums of neighbours and point."""
    n, count = seed.shape
    for c in range(2):
        for i in range(n):
            d = direct[c, i]
            for p in range(count):
                value = d * seed[i, p]
                on_near[c * n + i, p] += value
                on_point[c, p] += value


@compiled
def reverse_shape_functions(own, start, neighbours, groups, phi_bar, grad_bar, x_bar, point_bar):
    """Apply the transpose of ``forward_shape_functions``: pull seeds back to particles and points.

    Parameters
    ----------
    own : Coefficients
        Of the ``groups`` (first, last).
    phi_bar, grad_bar : ndarray, shapes (..., M)
        Seeds of M measures on the rows of these groups, in the flat layout of ``ShapeTable``; empty
        where not needed.
    x_bar, point_bar : ndarray, shapes (n_particles, 2, M), (n_points, 2, M)
        Added to: derivatives with respect to the coordinates of the particles and of the points of the
        complete table.
    """
    (first, last), (n_points, rows, m, _) = groups, own.pull_sums.shape
    group_size, count = n_points // (last - first), x_bar.shape[2]
    for g in range(first, last):
        near = neighbours[start[g] : start[g + 1]]
        n, before = near.size, (start[g] - start[first]) * group_size
        on_near, moved = np.empty((2 * n, count)), np.zeros((group_size, rows * m, count))
        on_first = np.empty((m, count))
        for q in range(group_size):
            at = before + q * n
            if rows > 1:
                on_slope = _rows(own.on_slope, at, n, rows * m * (rows - 1))
                on_slope = on_slope.reshape(rows * m, 2 * n)
                # (S G) Phi_,j_bar
                np.dot(on_slope, grad_bar[2 * at : 2 * (at + n)], moved[q])
            if phi_bar.size > 0:
                on_value = _rows(own.on_value, at, n, m).reshape(m, n)
                # + (S G) Phi_bar
                np.dot(on_value, phi_bar[at : at + n], on_first)
                for a in range(m):
                    for p in range(count):
                        moved[q, a, p] += on_first[a, p]
        pull = _rows(own.pull, before, group_size * n, rows * m * 2).reshape(-1, 2 * n)
        # r_bar_I = C_I (S G) seeds, one product for all points of the group
        np.dot(pull.T, moved.reshape(-1, count), on_near)
        for q in range(group_size):
            point, at = g * group_size + q, before + q * n
            on_point, sums = point_bar[point], own.pull_sums[point - first * group_size]
            for u in range(rows):
                for a in range(m):
                    for c in range(2):
                        for p in range(count):
                            # x_bar = (sum_I C_I) (S G) seeds
                            on_point[c, p] += sums[u, a, c] * moved[q, u * m + a, p]
            direct = _rows(own.direct, at, n, 2 * rows).reshape(rows, 2, n)
            if phi_bar.size > 0:
                # + D^T Phi_bar, + D_j^T Phi_,j_bar, to r_bar_I and x_bar
                _add_direct_seeds(direct[0], phi_bar[at : at + n], on_near, on_point)
            for u in range(1, rows):
                by_slope = grad_bar[2 * at + (u - 1) * n : 2 * at + u * n]
                _add_direct_seeds(direct[u], by_slope, on_near, on_point)
        for i in range(n):
            for c in range(2):
                for p in range(count):
                    # r_I = x - X_I: X_bar_I = -r_bar_I
                    x_bar[near[i], c, p] -= on_near[c * n + i, p]

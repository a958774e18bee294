"""Derivatives of Phi_I and grad Phi_I when the particles and the evaluation point move.

Everything depends on the differences r_I = x - X_I alone. With q = M^-1 H(0), q_j = -M^-1 M_j q and the
polynomials p = q . H, p_j = q_j . H + q . H_j:

    Phi_I   = p phi_a
    Phi_I,j = p_j phi_a + p phi_a,j

    (Phi, Phi_,x, Phi_,y)' = D r' + S (q, q_x, q_y)',    (q, q_x, q_y)' = G C^T r'

``linearize_shape_functions`` collects the exact coefficients D, S G, C at the points of a run of groups
once; the forward kernel (design velocities, direct method) and the reverse kernel (adjoint seeds) are
products with them. S G is formed: where M is badly conditioned G is large, and both ways agree only with
the same product. All arrays of a point have ``rows`` blocks: 3, or 1 where only Phi_I is asked for.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.rkpm.basis import basis_slope
from seal_mdao.rkpm.moment import (
    correction_polynomials,
    gathered,
    moment_matrices,
    n_monomials,
    neighbour_terms,
)


class Coefficients(NamedTuple):
    """Of the derivatives at the points of a run of groups; flat (group, point, ..., neighbour).

    Attributes
    ----------
    direct : ndarray
        Of a point with n neighbours (rows, 2, n): D, by a neighbour's own r_I at fixed q, q_j.
    pull : ndarray
        (rows, m, 2, n): C, derivatives of M q, and of M_j q + M q_j, by r_I at fixed q, q_j.
    pull_sums : ndarray, shape (n_points, rows, m, 2)
        Of all neighbours.
    on_value : ndarray
        (m, n): S G of Phi by what is pulled for q.
    on_slope : ndarray
        (rows, m, rows - 1, n): S G of Phi_j by what is pulled for q, q_x, q_y; that of Phi_j by what is
        pulled for q_j is ``on_value``.
    """

    direct: np.ndarray
    pull: np.ndarray
    pull_sums: np.ndarray
    on_value: np.ndarray
    on_slope: np.ndarray


@inlined
def _rows(flat, at, n, size):
    """The ``n`` rows after the first ``at`` of what has ``size`` entries a row (point, neighbour)."""
    return flat[at * size : (at + n) * size]


@inlined
def _second(j, k):
    """Row of the second derivative (j, k), components counted from 0, in the six-row tables."""
    return 3 + j + k


@inlined
def _fill_polynomials(b, h, scale, p):
    """Values and slopes ``p`` (rows, 3, n) of the polynomials of ``moment`` at the neighbours."""
    rows, m = b.shape
    n = p.shape[2]
    for u in range(rows):
        for i in range(n):
            p[u, 0, i] = b[u, 0]
            p[u, 1, i] = p[u, 2, i] = 0.0
        for a in range(1, m):
            value = b[u, a]
            for i in range(n):
                p[u, 0, i] += value * h[a, i]
            for c in range(2):
                factor, lowered = basis_slope(a, c, scale)
                if factor > 0.0:
                    value = factor * b[u, a]
                    for i in range(n):
                        p[u, 1 + c, i] += value * h[lowered, i]


@inlined
def _fill_direct(p, k, phi, direct):
    """Phi, Phi_x, Phi_y (``phi``), and D."""
    rows, n = phi.shape
    for i in range(n):
        phi[0, i] = p[0, 0, i] * k[0, i]
    for c in range(2):
        for i in range(n):
            direct[0, c, i] = p[0, 1 + c, i] * k[0, i] + p[0, 0, i] * k[1 + c, i]
    for j in range(1, rows):
        for i in range(n):
            phi[j, i] = p[j, 0, i] * k[0, i] + p[0, 0, i] * k[j, i]
        for c in range(2):
            jc = _second(j - 1, c)
            for i in range(n):
                direct[j, c, i] = p[j, 1 + c, i] * k[0, i] + p[j, 0, i] * k[1 + c, i]
            for i in range(n):
                direct[j, c, i] += p[0, 1 + c, i] * k[j, i] + p[0, 0, i] * k[jc, i]


@inlined
def _fill_pull(h, scale, phi, direct, pull):
    """C: M q = sum H Phi, so M_j q + M q_j = sum (H Phi)_j."""
    rows, m, _, n = pull.shape
    for u in range(rows):
        for a in range(m):
            for c in range(2):
                by_c, ac = basis_slope(a, c, scale)
                for i in range(n):
                    pull[u, a, c, i] = h[a, i] * direct[u, c, i] + by_c * h[ac, i] * phi[u, i]
                if u > 0:
                    by_j, aj = basis_slope(a, u - 1, scale)
                    by_jc, ajc = basis_slope(aj, c, scale)
                    by_jc *= by_j
                    if by_j > 0.0:
                        for i in range(n):
                            pull[u, a, c, i] += (
                                by_j * h[aj, i] * direct[0, c, i] + by_jc * h[ajc, i] * phi[0, i]
                            )


@inlined
def _fill_chain(h, k, scale, moments, inverse, spread, on_value, on_slope):
    """S G with G = (M^-1, -M^-1 M_j M^-1) and S = -(H phi_a, (H phi_a)_j)."""
    m, n = on_value.shape
    on_value[:] = 0.0
    for a in range(m):
        for i in range(n):
            spread[i] = -h[a, i] * k[0, i]
        for b in range(m):
            for i in range(n):
                on_value[b, i] += inverse[a, b] * spread[i]
    on_slope[:] = 0.0
    for j in range(on_slope.shape[2]):
        for a in range(m):
            factor, lowered = basis_slope(a, j, scale)
            for i in range(n):
                spread[i] = -h[a, i] * k[1 + j, i] - factor * h[lowered, i] * k[0, i]
            for e in range(m):
                for i in range(n):
                    spread[i] -= moments[1 + j, a, e] * on_value[e, i]
            for b in range(m):
                for i in range(n):
                    on_slope[0, b, j, i] += inverse[a, b] * spread[i]
        for b in range(m):
            for i in range(n):
                on_slope[1 + j, b, j, i] = on_value[b, i]


@compiled
def linearize_shape_functions(cloud, points, inverses, start, neighbours, groups, group_size, rows):
    """Coefficients at the points of the ``groups`` (first, last) of a table.

    Parameters
    ----------
    points, inverses : ndarray, shapes (n_points, 2), (n_points, m, m)
        Of the whole table; M^-1 at the points.
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
            neighbour_terms(points[point], near, cloud.axes, scale, h, k)
            if rows > 1:
                moment_matrices(h, k, scale, moments)
            correction_polynomials(moments, inverses[point], scale, b)
            _fill_polynomials(b, h, scale, p)
            _fill_direct(p, k, phi, direct)
            _fill_pull(h, scale, phi, direct, pull)
            _fill_chain(h, k, scale, moments, inverses[point], spread, on_value, on_slope)
        pulls = _rows(out.pull, before, group_size * n, rows * m * 2).reshape(-1, n)
        sums = out.pull_sums[(g - first) * group_size : (g - first + 1) * group_size]
        np.dot(pulls, ones, sums.reshape(-1))
    return out


@internal
def _add_direct(direct, here, moves, out):
    """Add D r' of P parameters, ``direct`` (2, n): r' = V(x) - V(X_I)."""
    n, count = out.shape
    for i in range(n):
        dx, dy = direct[0, i], direct[1, i]
        for p in range(count):
            out[i, p] += dx * (here[0, p] - moves[0, i, p]) + dy * (here[1, p] - moves[1, i, p])


@compiled
def forward_shape_functions(
    own, start, neighbours, groups, velocity, point_velocity, active, dstart, dphi, dgrad
):
    """Derivatives of the ``groups`` (first, last) of a table along design velocities.

    Parameters
    ----------
    own : Coefficients
        Of these groups.
    velocity, point_velocity : ndarray, shapes (P, n_particles, 2), (P, n_points, 2)
        Design velocities V of Eq. (48) at the particles and at the points of the whole table.
    active, dstart : ndarray of int
        Parameters that touch group g: ``active[dstart[g, 0]:dstart[g + 1, 0]]``;
        ``dstart[g, 1]`` is where its entries begin in ``dphi``.
    dphi, dgrad : ndarray
        Flat (group, point, neighbour, parameter), (group, point, component, neighbour, parameter); what
        is not asked for has no entries.
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
                    moves[c, i, p] = velocity[which[p], near[i], c]
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
                np.dot(on_value.T, moved[q, :m], out)
                _add_direct(direct[0], here, moves, out)
            if rows > 1:
                out = dgrad[2 * to : 2 * (to + n * count)].reshape(2 * n, count)
                on_slope = _rows(own.on_slope, at, n, rows * m * (rows - 1))
                on_slope = on_slope.reshape(rows * m, 2 * n)
                np.dot(on_slope.T, moved[q], out)
                for u in range(1, rows):
                    _add_direct(direct[u], here, moves, out[(u - 1) * n : u * n])


@internal
def _add_direct_seeds(direct, seed, on_near, on_point):
    """Transpose of ``_add_direct``."""
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
    """Transpose of ``forward_shape_functions``: pull seeds back to the particles and to the points.

    Parameters
    ----------
    own : Coefficients
        Of the ``groups`` (first, last).
    phi_bar, grad_bar : ndarray, shapes (..., M)
        Seeds of M measures on the rows of these groups, in the flat layout of ``ShapeTable``; what is
        not asked for has no entries.
    x_bar, point_bar : ndarray, shapes (n_particles, 2, M), (n_points, 2, M)
        Added to: derivatives with respect to the coordinates of the particles and of the points of the
        whole table.
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
                np.dot(on_slope, grad_bar[2 * at : 2 * (at + n)], moved[q])
            if phi_bar.size > 0:
                on_value = _rows(own.on_value, at, n, m).reshape(m, n)
                np.dot(on_value, phi_bar[at : at + n], on_first)
                for a in range(m):
                    for p in range(count):
                        moved[q, a, p] += on_first[a, p]
        pull = _rows(own.pull, before, group_size * n, rows * m * 2).reshape(-1, 2 * n)
        np.dot(pull.T, moved.reshape(-1, count), on_near)
        for q in range(group_size):
            point, at = g * group_size + q, before + q * n
            on_point, sums = point_bar[point], own.pull_sums[point - first * group_size]
            for u in range(rows):
                for a in range(m):
                    for c in range(2):
                        for p in range(count):
                            on_point[c, p] += sums[u, a, c] * moved[q, u * m + a, p]
            direct = _rows(own.direct, at, n, 2 * rows).reshape(rows, 2, n)
            if phi_bar.size > 0:
                _add_direct_seeds(direct[0], phi_bar[at : at + n], on_near, on_point)
            for u in range(1, rows):
                by_slope = grad_bar[2 * at + (u - 1) * n : 2 * at + u * n]
                _add_direct_seeds(direct[u], by_slope, on_near, on_point)
        for i in range(n):
            for c in range(2):
                for p in range(count):
                    x_bar[near[i], c, p] -= on_near[c * n + i, p]

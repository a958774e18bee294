"""Derivatives of Phi_I and grad Phi_I when the particles and the evaluation point move.

Everything depends on the differences r_I = x - X_I alone. With q = M^-1 H(0), q_j = -M^-1 M_j q and the
polynomials p = q . H, p_j = q_j . H + q . H_j:

    Phi_I   = p phi_a
    Phi_I,j = p_j phi_a + p phi_a,j

    (Phi, Phi_,x, Phi_,y)' = D r' + S (q, q_x, q_y)',    (q, q_x, q_y)' = G C^T r'

``linearize_group`` collects the exact coefficients D, S G, C of the points of a group once; the forward
kernel (design velocities, direct method) and the reverse kernel (adjoint seeds) are products with them.
S G is formed: where M is badly conditioned G is large, and both ways agree only with the same product.
All arrays of a point have ``rows`` blocks: 3, or 1 where only Phi_I is asked for.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, internal
from seal_mdao.rkpm.basis import basis_slope
from seal_mdao.rkpm.moment import (
    correction_polynomials,
    gathered,
    moment_matrices,
    n_monomials,
    neighbour_terms,
)


class Coefficients(NamedTuple):
    """Of the derivatives at the Q points of a group of n neighbours.

    Attributes
    ----------
    direct : ndarray, shape (Q, rows, 2, n)
        D, by a neighbour's own r_I at fixed q, q_j.
    pull : ndarray, shape (Q, rows, m, 2, n)
        C: derivatives of M q, and of M_j q + M q_j, by r_I at fixed q, q_j.
    pull_sums : ndarray, shape (Q, rows, m, 2)
        Of all neighbours.
    on_value : ndarray, shape (Q, m, n)
        S G of Phi by what is pulled for q; of Phi_j by what is pulled for q_j.
    on_slope : ndarray, shape (Q, m, rows - 1, n)
        S G of Phi_j by what is pulled for q.
    """

    direct: np.ndarray
    pull: np.ndarray
    pull_sums: np.ndarray
    on_value: np.ndarray
    on_slope: np.ndarray


@internal
def _second(j, k):
    """Row of the second derivative (j, k), components counted from 0, in the six-row tables."""
    return 3 + j + k


@internal
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


@internal
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


@internal
def _fill_pull(h, scale, phi, direct, pull, sums):
    """C and its sums: M q = sum H Phi, so M_j q + M q_j = sum (H Phi)_j."""
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
                total = 0.0
                for i in range(n):
                    total += pull[u, a, c, i]
                sums[u, a, c] = total


@internal
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
    for j in range(on_slope.shape[1]):
        for a in range(m):
            factor, lowered = basis_slope(a, j, scale)
            for i in range(n):
                spread[i] = -h[a, i] * k[1 + j, i] - factor * h[lowered, i] * k[0, i]
            for e in range(m):
                for i in range(n):
                    spread[i] -= moments[1 + j, a, e] * on_value[e, i]
            for b in range(m):
                for i in range(n):
                    on_slope[b, j, i] += inverse[a, b] * spread[i]


@internal
def linearize_group(cloud, points, inverses, neighbours, rows):
    """Coefficients of the derivatives at the points (Q, 2) of a group with their M^-1 (Q, m, m)."""
    m, n, q_count, scale = cloud.n_basis, neighbours.size, len(points), cloud.scale
    near = gathered(cloud.particles, cloud.radius, cloud.axes, neighbours)
    h, k, spread = np.empty((n_monomials(m), n)), np.empty((6, n)), np.empty(n)
    p, phi = np.empty((rows, 3, n)), np.empty((rows, n))
    moments, b = np.empty((rows, m, m)), np.empty((rows, m))
    out = Coefficients(
        np.empty((q_count, rows, 2, n)),
        np.empty((q_count, rows, m, 2, n)),
        np.empty((q_count, rows, m, 2)),
        np.empty((q_count, m, n)),
        np.empty((q_count, m, rows - 1, n)),
    )
    for q in range(q_count):
        inverse = inverses[q]
        neighbour_terms(points[q], near, cloud.axes, scale, h, k)
        if rows > 1:
            moment_matrices(h, k, scale, moments)
        correction_polynomials(moments, inverse, scale, b)
        _fill_polynomials(b, h, scale, p)
        _fill_direct(p, k, phi, out.direct[q])
        _fill_pull(h, scale, phi, out.direct[q], out.pull[q], out.pull_sums[q])
        _fill_chain(h, k, scale, moments, inverse, spread, out.on_value[q], out.on_slope[q])
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
    cloud,
    points,
    inverses,
    start,
    neighbours,
    velocity,
    point_velocity,
    active,
    dstart,
    group_size,
    dphi,
    dgrad,
):
    """Derivatives of a whole table along design velocities.

    Parameters
    ----------
    velocity, point_velocity : ndarray, shapes (P, n_particles, 2), (P, n_points, 2)
        Design velocities V of Eq. (48) at the particles and at the points.
    inverses : ndarray, shape (n_points, m, m)
        M^-1 at the points.
    active, dstart : ndarray of int
        Parameters that touch group g: ``active[dstart[g, 0]:dstart[g + 1, 0]]``;
        ``dstart[g, 1]`` is where its entries begin in ``dphi``.
    dphi, dgrad : ndarray
        Flat (group, point, neighbour, parameter), (group, point, component, neighbour, parameter); what
        is not asked for has no entries.
    """
    m, rows = cloud.n_basis, 3 if dgrad.size > 0 else 1
    for g in range(start.size - 1):
        near = neighbours[start[g] : start[g + 1]]
        which = active[dstart[g, 0] : dstart[g + 1, 0]]
        n, count, first = near.size, which.size, g * group_size
        if count == 0:
            continue
        own = linearize_group(
            cloud,
            points[first : first + group_size],
            inverses[first : first + group_size],
            near,
            rows,
        )
        moves, here = np.empty((2, n, count)), np.empty((2, count))
        for p in range(count):
            for i in range(n):
                for c in range(2):
                    moves[c, i, p] = velocity[which[p], near[i], c]
        pull = own.pull.reshape(group_size * rows * m, 2 * n)
        moved = np.dot(pull, moves.reshape(2 * n, count)).reshape(group_size, rows * m, count)
        for q in range(group_size):
            for p in range(count):
                for c in range(2):
                    here[c, p] = point_velocity[which[p], first + q, c]
            sums = own.pull_sums[q].reshape(rows * m, 2)
            for a in range(rows * m):
                for p in range(count):
                    moved[q, a, p] = (
                        sums[a, 0] * here[0, p] + sums[a, 1] * here[1, p] - moved[q, a, p]
                    )
            at, size = dstart[g, 1] + q * n * count, n * count
            if dphi.size > 0:
                out = dphi[at : at + size].reshape(n, count)
                np.dot(own.on_value[q].T, moved[q, :m], out)
                _add_direct(own.direct[q, 0], here, moves, out)
            if rows > 1:
                out = dgrad[2 * at : 2 * (at + size)].reshape(2 * n, count)
                np.dot(own.on_slope[q].reshape(m, 2 * n).T, moved[q, :m], out)
                for u in range(1, rows):
                    row = out[(u - 1) * n : u * n]
                    row += np.dot(own.on_value[q].T, moved[q, u * m : (u + 1) * m])
                    _add_direct(own.direct[q, u], here, moves, row)


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


@internal
def reverse_group(cloud, points, inverses, near, phi_bar, grad_bar, x_bar, point_bar):
    """Pull seeds on the rows of one group (its rows, M) back to the particles and to its points."""
    m, rows, count = cloud.n_basis, 3 if grad_bar.size > 0 else 1, phi_bar.shape[1]
    q_count, n = len(points), near.size
    own = linearize_group(cloud, points, inverses, near, rows)
    on_near, moved = np.empty((2 * n, count)), np.zeros((q_count, rows * m, count))
    for q in range(q_count):
        if phi_bar.size > 0:
            np.dot(own.on_value[q], phi_bar[q * n : (q + 1) * n], moved[q, :m])
        if rows > 1:
            seed = grad_bar[2 * q * n : 2 * (q + 1) * n]
            moved[q, :m] += np.dot(own.on_slope[q].reshape(m, 2 * n), seed)
            for u in range(1, rows):
                by_slope = seed[(u - 1) * n : u * n]
                np.dot(own.on_value[q], by_slope, moved[q, u * m : (u + 1) * m])
    pull = own.pull.reshape(q_count * rows * m, 2 * n)
    np.dot(pull.T, moved.reshape(q_count * rows * m, count), on_near)
    for q in range(q_count):
        on_point, sums = point_bar[q], own.pull_sums[q].reshape(rows * m, 2)
        for a in range(rows * m):
            for c in range(2):
                for p in range(count):
                    on_point[c, p] += sums[a, c] * moved[q, a, p]
        if phi_bar.size > 0:
            _add_direct_seeds(own.direct[q, 0], phi_bar[q * n : (q + 1) * n], on_near, on_point)
        for u in range(1, rows):
            at = (2 * q + u - 1) * n
            _add_direct_seeds(own.direct[q, u], grad_bar[at : at + n], on_near, on_point)
    for i in range(n):
        for c in range(2):
            for p in range(count):
                x_bar[near[i], c, p] -= on_near[c * n + i, p]


@compiled
def reverse_shape_functions(
    cloud, points, inverses, start, neighbours, group_size, phi_bar, grad_bar, x_bar, point_bar
):
    """Transpose of ``forward_shape_functions``: pull seeds back to the particles and to the points.

    Parameters
    ----------
    inverses : ndarray, shape (n_points, m, m)
        M^-1 at the points.
    phi_bar, grad_bar : ndarray, shapes (..., M)
        Seeds of M measures in the flat layout of ``ShapeTable``; what is not asked for has no entries.
    x_bar, point_bar : ndarray, shapes (n_particles, 2, M), (n_points, 2, M)
        Added to: derivatives with respect to the particle and the point coordinates.
    """
    for g in range(start.size - 1):
        first, last = start[g] * group_size, start[g + 1] * group_size
        here = slice(g * group_size, (g + 1) * group_size)
        reverse_group(
            cloud, points[here], inverses[here], neighbours[start[g] : start[g + 1]],
            phi_bar[first:last], grad_bar[2 * first : 2 * last], x_bar, point_bar[here],
        )  # fmt: skip

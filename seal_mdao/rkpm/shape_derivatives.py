"""Derivatives of Phi_I and grad Phi_I when the particles and the evaluation point move.

Everything depends on the differences r_I = x - X_I alone. With g_I = H phi_a, q = M^-1 H(0) and
q_j = -M^-1 M_j q:

    Phi_I   = q . g_I
    Phi_I,j = q_j . g_I + q . g_I,j

    (Phi, Phi_,x, Phi_,y)' = D r' + S (q, q_x, q_y)',    (q, q_x, q_y)' = G C^T r'

``linearize_point`` collects the exact coefficients D, S G, C of one point once; the forward kernel
(design velocities, direct method) and the reverse kernel (adjoint seeds) are products with them. S G is
formed: where M is badly conditioned G is large, and both ways agree only with the same product. All
arrays of a point have ``rows`` blocks: 3, or 1 where only Phi_I is asked for; and only those of its
neighbours whose support reaches it.
"""

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.rkpm.moment import (
    correction_coefficients,
    invert_moment,
    moment_matrices,
    neighbour_terms,
)


@inlined
def _second(j, k):
    """Row of the second derivative (j, k), components counted from 0, in the six-row tables."""
    return 3 + j + k


@inlined
def _first(row):
    """The first monomial whose derivative in a row of the tables is not zero everywhere."""
    return 0 if row == 0 else (1 if row < 3 else 3)


@internal
def linearize_point(h, k, b, direct, pull):
    """Coefficients of the derivative of one point's shape functions with respect to r_I.

    Parameters
    ----------
    h, k : ndarray, shapes (n, 6, m), (n, 6)
        Basis and kernel terms of the neighbours.
    b : ndarray, shape (rows, m)
        q, q_x, q_y.
    direct : ndarray, shape (n, rows, 2)
        Written: D, whose row of each neighbour sees its own r_I only.
    pull : ndarray, shape (2 n, rows m)
        Written: C, derivatives of M q, M_x q + M q_x, M_y q + M q_y at fixed q, q_x, q_y.
    """
    n, _, m = h.shape
    rows = b.shape[0]
    dots = np.empty((rows, 6))
    for i in range(n):
        for u in range(rows):
            for row in range(6):
                value = 0.0
                for a in range(_first(row), m):
                    value += b[u, a] * h[i, row, a]
                dots[u, row] = value
        f = k[i]
        for c in range(2):
            kc, at = 1 + c, 2 * i + c
            direct[i, 0, c] = dots[0, kc] * f[0] + dots[0, 0] * f[kc]
            for a in range(m):
                pull[at, a] = h[i, kc, a] * dots[0, 0] * f[0] + h[i, 0, a] * direct[i, 0, c]
            for kj in range(1, rows):
                kjc = _second(kj - 1, c)
                t = (
                    dots[kj, kc] * f[0]
                    + dots[kj, 0] * f[kc]
                    + dots[0, kjc] * f[0]
                    + dots[0, kj] * f[kc]
                    + dots[0, kc] * f[kj]
                    + dots[0, 0] * f[kjc]
                )
                direct[i, kj, c] = t
                # (H H^T phi)_,c q_j + (H H^T phi)_,jc q, sorted by the H left of the dots;
                # what H itself carries is t
                on_hc = dots[kj, 0] * f[0] + dots[0, kj] * f[0] + dots[0, 0] * f[kj]
                on_hj = dots[0, kc] * f[0] + dots[0, 0] * f[kc]
                on_hjc = dots[0, 0] * f[0]
                for a in range(m):
                    pull[at, kj * m + a] = (
                        h[i, 0, a] * t + h[i, kc, a] * on_hc + h[i, kj, a] * on_hj
                    )
                for a in range(_first(kjc), m):
                    pull[at, kj * m + a] += h[i, kjc, a] * on_hjc


@internal
def _fill_chain(h, k, moments, inverse, spread, chain):
    """S G: rows (Phi, Phi_,x, Phi_,y) by neighbour; q_j' = -M^-1 ((M_j q + M q_j)' at fixed q, q_j +
    M_j q'). Written are its first m columns; of the others only S_0 G_0, the block in the first n
    rows, again in the row and the column of each gradient, is not zero."""
    n, _, m = h.shape
    for u in range(len(moments)):
        for i in range(n):
            for a in range(m):
                spread[u * n + i, a] = -h[i, u, a] * k[i, 0]
                if u > 0:
                    spread[u * n + i, a] -= h[i, 0, a] * k[i, u]
    np.dot(spread, inverse, chain)
    for u in range(1, len(moments)):
        chain[u * n : (u + 1) * n] -= chain[:n] @ (moments[u] @ inverse)


@internal
def _workspace(n, m, rows):
    """M and its gradient, q and its gradient, D, C, S, S G."""
    return (
        np.empty((rows, m, m)),
        np.empty((rows, m)),
        np.empty((n, rows, 2)),
        np.empty((2 * n, rows * m)),
        np.empty((rows * n, m)),
        np.empty((rows * n, m)),
    )


@internal
def _prepare(x, near, cloud, h, k, seen, inverse, work):
    """Everything of one point: D, C, S G, and ``seen``, the places of the neighbours that it sees."""
    moments, b, direct, pull, spread, chain = work
    n = neighbour_terms(x, near, cloud, h, k, seen)
    h, k, rows = h[:n], k[:n], len(moments)
    moment_matrices(h, k, moments)
    invert_moment(moments[0], inverse)
    correction_coefficients(moments, inverse, b)
    direct, pull, chain = direct[:n], pull[: 2 * n], chain[: rows * n]
    linearize_point(h, k, b, direct, pull)
    _fill_chain(h, k, moments, inverse, spread[: rows * n], chain)
    return direct, pull, chain, seen[:n]


@internal
def forward_point(direct, pull, chain, delta, first, out):
    """Derivatives of one point's shape functions along P motions ``delta`` (2 n, P) of r_I.

    ``out`` (rows n, P) receives Phi', Phi_,x', Phi_,y' from the block ``first`` on.
    """
    n, rows, _ = direct.shape
    m = chain.shape[1]
    moved = pull.T @ delta
    np.dot(chain[first * n :], moved[:m], out[first * n :])
    for u in range(first, rows):
        own = out[u * n : (u + 1) * n]
        if u > 0:
            own += chain[:n] @ moved[u * m : (u + 1) * m]
        for i in range(n):
            dx, dy, row = direct[i, u, 0], direct[i, u, 1], own[i]
            for p in range(row.size):
                row[p] += dx * delta[2 * i, p] + dy * delta[2 * i + 1, p]


@internal
def reverse_point(direct, pull, chain, seed, first, out):
    """Transpose of ``forward_point``: ``seed`` (rows n, M) on Phi, Phi_,x, Phi_,y ``out`` (2 n, M)."""
    n, rows, _ = direct.shape
    m = chain.shape[1]
    moved = np.empty((rows * m, seed.shape[1]))
    np.dot(chain[first * n :].T, seed[first * n :], moved[:m])
    for u in range(1, rows):
        np.dot(chain[:n].T, seed[u * n : (u + 1) * n], moved[u * m : (u + 1) * m])
    np.dot(pull, moved, out)
    for i in range(n):
        for u in range(first, rows):
            row = seed[u * n + i]
            for c in range(2):
                d = direct[i, u, c]
                for p in range(row.size):
                    out[2 * i + c, p] += d * row[p]


@compiled
def forward_shape_functions(
    cloud,
    points,
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
    active, dstart : ndarray of int
        Parameters that touch group g: ``active[dstart[g, 0]:dstart[g + 1, 0]]``;
        ``dstart[g, 1]`` is where its entries begin in ``dphi``.
    dphi, dgrad : ndarray
        Flat (group, point, neighbour, parameter), (group, point, component, neighbour, parameter); what
        is not asked for has no entries.
    """
    m, first, rows = cloud.n_basis, 0 if dphi.size > 0 else 1, 3 if dgrad.size > 0 else 1
    inverse = np.empty((m, m))
    for g in range(start.size - 1):
        near = neighbours[start[g] : start[g + 1]]
        which = active[dstart[g, 0] : dstart[g + 1, 0]]
        n, count = near.size, which.size
        if count == 0:
            continue
        h, k, places = np.empty((n, 6, m)), np.empty((n, 6)), np.empty(n, np.int64)
        work = _workspace(n, m, rows)
        deltas, outs = np.empty((2 * n, count)), np.empty((rows * n, count))
        for q in range(group_size):
            point = g * group_size + q
            direct, pull, chain, seen = _prepare(
                points[point], near, cloud, h, k, places, inverse, work
            )
            s = seen.size
            delta, out = deltas[: 2 * s], outs[: rows * s]
            for i in range(s):
                for c in range(2):
                    for p in range(count):
                        delta[2 * i + c, p] = (
                            point_velocity[which[p], point, c]
                            - velocity[which[p], near[seen[i]], c]
                        )
            forward_point(direct, pull, chain, delta, first, out)
            at = dstart[g, 1] + q * n * count
            dphi[at : at + n * count] = 0.0
            dgrad[2 * at : 2 * at + (rows - 1) * n * count] = 0.0
            for i in range(s):
                if first == 0:
                    for p in range(count):
                        dphi[at + seen[i] * count + p] = out[i, p]
                for u in range(1, rows):
                    to = 2 * at + ((u - 1) * n + seen[i]) * count
                    for p in range(count):
                        dgrad[to + p] = out[u * s + i, p]


@compiled
def reverse_shape_functions(
    cloud, points, start, neighbours, group_size, phi_bar, grad_bar, x_bar, point_bar
):
    """Pull seeds on a whole table back to the particles and to the points.

    Parameters
    ----------
    phi_bar, grad_bar : ndarray, shapes (..., M)
        Seeds of M measures in the flat layout of ``ShapeTable``; what is not asked for has no entries.
    x_bar, point_bar : ndarray, shapes (n_particles, 2, M), (n_points, 2, M)
        Added to: derivatives with respect to the particle and the point coordinates.
    """
    m, first, rows = cloud.n_basis, 0 if phi_bar.size > 0 else 1, 3 if grad_bar.size > 0 else 1
    n_measures = phi_bar.shape[1]
    inverse = np.empty((m, m))
    for g in range(start.size - 1):
        near = neighbours[start[g] : start[g + 1]]
        n = near.size
        h, k, places = np.empty((n, 6, m)), np.empty((n, 6)), np.empty(n, np.int64)
        work = _workspace(n, m, rows)
        seeds, outs = np.empty((rows * n, n_measures)), np.empty((2 * n, n_measures))
        for q in range(group_size):
            point = g * group_size + q
            direct, pull, chain, seen = _prepare(
                points[point], near, cloud, h, k, places, inverse, work
            )
            s = seen.size
            seed, out = seeds[: rows * s], outs[: 2 * s]
            at = start[g] * group_size + q * n
            for i in range(s):
                if first == 0:
                    for measure in range(n_measures):
                        seed[i, measure] = phi_bar[at + seen[i], measure]
                for u in range(1, rows):
                    source = 2 * at + (u - 1) * n + seen[i]
                    for measure in range(n_measures):
                        seed[u * s + i, measure] = grad_bar[source, measure]
            reverse_point(direct, pull, chain, seed, first, out)
            for i in range(s):
                for d in range(2):
                    row = out[2 * i + d]
                    for measure in range(n_measures):
                        x_bar[near[seen[i]], d, measure] -= row[measure]
                        point_bar[point, d, measure] += row[measure]

"""Derivatives of Phi_I and grad Phi_I when the particles and the evaluation point move.

Everything depends on the differences r_I = x - X_I alone. With g_I = H phi_a, q = M^-1 H(0) and
q_j = -M^-1 M_j q:

    Phi_I   = q . g_I
    Phi_I,j = q_j . g_I + q . g_I,j

    (Phi, Phi_,x, Phi_,y)' = D r' + S (q, q_x, q_y)',    (q, q_x, q_y)' = G C^T r'

``linearize_point`` collects the exact coefficients D, S, G, C of one point once; the forward kernel
(design velocities, direct method) and the reverse kernel (adjoint seeds) are products with them.
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


@internal
def _fill_part(sign, part, row, column, out):
    """``out[row:, column:]`` = +-part."""
    for a in range(part.shape[0]):
        for b in range(part.shape[1]):
            out[row + a, column + b] = sign * part[a, b]


@internal
def linearize_point(h, k, b, moments, inverse, direct, pull, chain):
    """Coefficients of the derivative of one point's shape functions with respect to r_I.

    Parameters
    ----------
    h, k : ndarray, shapes (n, 6, m), (n, 6)
        Basis and kernel terms of the neighbours.
    b : ndarray, shape (3, m)
        q, q_x, q_y.
    moments, inverse : ndarray, shapes (3, m, m), (m, m)
        M, M_x, M_y, and M^-1.
    direct : ndarray, shape (n, 3, 2)
        Written: D, whose row of each neighbour sees its own r_I only.
    pull : ndarray, shape (2 n, 3 m)
        Written: C, derivatives of M q, M_x q + M q_x, M_y q + M q_y at fixed q, q_x, q_y.
    chain : ndarray, shape (3 n, 3 m)
        Written: S G, rows (Phi, Phi_,x, Phi_,y) by neighbour.
    """
    n, _, m = h.shape
    dots = np.empty((3, 6))
    spread, solve = np.zeros((3 * n, 3 * m)), np.zeros((3 * m, 3 * m))
    for i in range(n):
        for u in range(3):
            for row in range(6):
                value = 0.0
                for a in range(m):
                    value += b[u, a] * h[i, row, a]
                dots[u, row] = value
        f = k[i]
        for c in range(2):
            kc, at = 1 + c, 2 * i + c
            direct[i, 0, c] = dots[0, kc] * f[0] + dots[0, 0] * f[kc]
            for a in range(m):
                pull[at, a] = h[i, kc, a] * dots[0, 0] * f[0] + h[i, 0, a] * direct[i, 0, c]
            for j in range(2):
                kj, kjc = 1 + j, _second(j, c)
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
                        h[i, 0, a] * t
                        + h[i, kc, a] * on_hc
                        + h[i, kj, a] * on_hj
                        + h[i, kjc, a] * on_hjc
                    )
        for a in range(m):
            g0 = h[i, 0, a] * f[0]
            spread[i, a] = g0
            for j in (1, 2):
                spread[j * n + i, a] = h[i, j, a] * f[0] + h[i, 0, a] * f[j]
                spread[j * n + i, j * m + a] = g0
    # q_j' = -M^-1 ((M_j q + M q_j)' at fixed q, q_j  +  M_j q')
    for u in range(3):
        _fill_part(-1.0, inverse, u * m, u * m, solve)
        if u > 0:
            _fill_part(1.0, inverse @ moments[u] @ inverse, u * m, 0, solve)
    np.dot(spread, solve, chain)


@internal
def _prepare(x, near, cloud, h, k, moments, inverse, b):
    neighbour_terms(x, near, cloud, h, k)
    moment_matrices(h, k, moments)
    invert_moment(moments[0], inverse)
    correction_coefficients(moments, inverse, b)


@internal
def forward_point(direct, pull, chain, delta, out):
    """Derivatives of one point's shape functions along P motions ``delta`` (2 n, P) of r_I.

    ``out`` (3 n, P) receives Phi', Phi_,x', Phi_,y'.
    """
    n = direct.shape[0]
    np.dot(chain, pull.T @ delta, out)
    for i in range(n):
        for u in range(3):
            dx, dy, row = direct[i, u, 0], direct[i, u, 1], out[u * n + i]
            for p in range(row.size):
                row[p] += dx * delta[2 * i, p] + dy * delta[2 * i + 1, p]


@internal
def reverse_point(direct, pull, chain, seed, out):
    """Transpose of ``forward_point``: ``seed`` (3 n, M) on Phi, Phi_,x, Phi_,y to ``out`` (2 n, M)."""
    n = direct.shape[0]
    np.dot(pull, chain.T @ seed, out)
    for i in range(n):
        for u in range(3):
            row = seed[u * n + i]
            for c in range(2):
                d = direct[i, u, c]
                for m in range(row.size):
                    out[2 * i + c, m] += d * row[m]


@compiled
def forward_shape_functions(
    cloud, points, start, neighbours, velocity, point_velocity, active, dstart, dphi, dgrad
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
        Flat (group, point, neighbour, parameter), (group, point, component, neighbour, parameter).
    """
    m = cloud.n_basis
    n_groups = start.size - 1
    group_size = points.shape[0] // n_groups
    moments, inverse, b = np.empty((3, m, m)), np.empty((m, m)), np.empty((3, m))
    for g in range(n_groups):
        n = start[g + 1] - start[g]
        near = neighbours[start[g] : start[g + 1]]
        which = active[dstart[g, 0] : dstart[g + 1, 0]]
        count = which.size
        if count == 0:
            continue
        h, k = np.empty((n, 6, m)), np.empty((n, 6))
        direct, pull, chain = (
            np.empty((n, 3, 2)),
            np.empty((2 * n, 3 * m)),
            np.empty((3 * n, 3 * m)),
        )
        delta, out = np.empty((2 * n, count)), np.empty((3 * n, count))
        for q in range(group_size):
            point = g * group_size + q
            _prepare(points[point], near, cloud, h, k, moments, inverse, b)
            linearize_point(h, k, b, moments, inverse, direct, pull, chain)
            for i in range(n):
                for c in range(2):
                    for p in range(count):
                        delta[2 * i + c, p] = (
                            point_velocity[which[p], point, c] - velocity[which[p], near[i], c]
                        )
            forward_point(direct, pull, chain, delta, out)
            at = dstart[g, 1] + q * n * count
            for i in range(n):
                for p in range(count):
                    dphi[at + i * count + p] = out[i, p]
            for i in range(2 * n):
                for p in range(count):
                    dgrad[2 * at + i * count + p] = out[n + i, p]


@compiled
def reverse_shape_functions(cloud, points, start, neighbours, phi_bar, grad_bar, x_bar, point_bar):
    """Pull seeds on a whole table back to the particles and to the points.

    Parameters
    ----------
    phi_bar, grad_bar : ndarray, shapes (..., M)
        Seeds of M measures in the flat layout of ``ShapeTable``.
    x_bar, point_bar : ndarray, shapes (n_particles, 2, M), (n_points, 2, M)
        Added to: derivatives with respect to the particle and the point coordinates.
    """
    m, n_measures = cloud.n_basis, phi_bar.shape[1]
    n_groups = start.size - 1
    group_size = points.shape[0] // n_groups
    moments, inverse, b = np.empty((3, m, m)), np.empty((m, m)), np.empty((3, m))
    for g in range(n_groups):
        n = start[g + 1] - start[g]
        near = neighbours[start[g] : start[g + 1]]
        h, k = np.empty((n, 6, m)), np.empty((n, 6))
        direct, pull, chain = (
            np.empty((n, 3, 2)),
            np.empty((2 * n, 3 * m)),
            np.empty((3 * n, 3 * m)),
        )
        seed, out = np.empty((3 * n, n_measures)), np.empty((2 * n, n_measures))
        for q in range(group_size):
            point = g * group_size + q
            _prepare(points[point], near, cloud, h, k, moments, inverse, b)
            linearize_point(h, k, b, moments, inverse, direct, pull, chain)
            at = start[g] * group_size + q * n
            for measure in range(n_measures):
                for i in range(n):
                    seed[i, measure] = phi_bar[at + i, measure]
                for i in range(2 * n):
                    seed[n + i, measure] = grad_bar[2 * at + i, measure]
            reverse_point(direct, pull, chain, seed, out)
            for i in range(n):
                for d in range(2):
                    for measure in range(n_measures):
                        x_bar[near[i], d, measure] -= out[2 * i + d, measure]
                        point_bar[point, d, measure] += out[2 * i + d, measure]

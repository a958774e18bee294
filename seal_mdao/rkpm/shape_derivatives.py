"""Derivatives of Phi_I and grad Phi_I when the particles and the evaluation point move.

Everything depends on the differences r_I = x - X_I alone. ``linearize_point`` collects the exact
coefficients of one point once; the forward kernel (design velocities, direct method) and the
reverse kernel (adjoint seeds) are dot products with the same coefficients.

With g_I = H phi_a, q = M^-1 H(0) and q_j = -M^-1 M_j q:

    Phi_I   = q . g_I
    Phi_I,j = q_j . g_I + q . g_I,j
"""

import numba as nb
import numpy as np

from seal_mdao.rkpm.moment import (
    correction_coefficients,
    invert_moment,
    moment_matrices,
    neighbour_terms,
)


@nb.njit(cache=True, error_model="numpy", inline="always")
def _second(j, k):
    """Row of the second derivative (j, k), components counted from 0, in the six-row tables."""
    return 3 + j + k


@nb.njit(cache=True, error_model="numpy")
def linearize_point(h, k, b, s, t, moment_b, moment_grad):
    """Coefficients of the derivative with respect to r_I of one point.

    Parameters
    ----------
    h, k : ndarray, shapes (n, 6, m), (n, 6)
        Basis and kernel terms of the neighbours.
    b : ndarray, shape (3, m)
        q, q_x, q_y.
    s : ndarray, shape (n, 2)
        q . g_I,k
    t : ndarray, shape (n, 2, 2)
        q_j . g_I,k + q . g_I,jk
    moment_b : ndarray, shape (n, 2, m)
        (d M / d r_Ik) q
    moment_grad : ndarray, shape (n, 2, 2, m)
        (d M / d r_Ik) q_j + (d M_j / d r_Ik) q, axes (n, j, k, m)
    """
    n, _, m = h.shape
    dots = np.empty((3, 6))
    for i in range(n):
        for u in range(3):
            for row in range(6):
                value = 0.0
                for a in range(m):
                    value += b[u, a] * h[i, row, a]
                dots[u, row] = value
        f = k[i]
        for c in range(2):
            kc = 1 + c
            s[i, c] = dots[0, kc] * f[0] + dots[0, 0] * f[kc]
            for a in range(m):
                moment_b[i, c, a] = h[i, kc, a] * dots[0, 0] * f[0] + h[i, 0, a] * (
                    dots[0, kc] * f[0] + dots[0, 0] * f[kc]
                )
            for j in range(2):
                kj, kjc = 1 + j, _second(j, c)
                t[i, j, c] = (
                    dots[kj, kc] * f[0]
                    + dots[kj, 0] * f[kc]
                    + dots[0, kjc] * f[0]
                    + dots[0, kj] * f[kc]
                    + dots[0, kc] * f[kj]
                    + dots[0, 0] * f[kjc]
                )
                # (H H^T phi)_,c q_j + (H H^T phi)_,jc q, sorted by the H left of the dots;
                # what H itself carries is t
                on_hc = dots[kj, 0] * f[0] + dots[0, kj] * f[0] + dots[0, 0] * f[kj]
                on_hj = dots[0, kc] * f[0] + dots[0, 0] * f[kc]
                on_hjc = dots[0, 0] * f[0]
                for a in range(m):
                    moment_grad[i, j, c, a] = (
                        h[i, 0, a] * t[i, j, c]
                        + h[i, kc, a] * on_hc
                        + h[i, kj, a] * on_hj
                        + h[i, kjc, a] * on_hjc
                    )


@nb.njit(cache=True, error_model="numpy")
def _prepare(x, near, cloud, h, k, moments, inverse, b):
    neighbour_terms(x, near, cloud, h, k)
    moment_matrices(h, k, moments)
    invert_moment(moments[0], inverse)
    correction_coefficients(moments, inverse, b)


@nb.njit(cache=True, error_model="numpy")
def forward_point(h, k, b, moments, inverse, s, t, moment_b, moment_grad, delta, out):
    """Derivative of one point's shape functions along the motion ``delta`` (n, 2) of r_I.

    ``out`` (3, n) receives Phi', Phi_,x', Phi_,y'.
    """
    n, _, m = h.shape
    rhs = np.zeros((3, m))
    for i in range(n):
        for c in range(2):
            d = delta[i, c]
            for a in range(m):
                rhs[0, a] += d * moment_b[i, c, a]
                rhs[1, a] += d * moment_grad[i, 0, c, a]
                rhs[2, a] += d * moment_grad[i, 1, c, a]
    db = np.empty((3, m))
    for u in range(3):
        if u > 0:
            for a in range(m):
                for e in range(m):
                    rhs[u, a] += moments[u, a, e] * db[0, e]
        for a in range(m):
            value = 0.0
            for e in range(m):
                value -= inverse[a, e] * rhs[u, e]
            db[u, a] = value
    for i in range(n):
        value = delta[i, 0] * s[i, 0] + delta[i, 1] * s[i, 1]
        for a in range(m):
            value += db[0, a] * h[i, 0, a] * k[i, 0]
        out[0, i] = value
        for j in range(2):
            value = delta[i, 0] * t[i, j, 0] + delta[i, 1] * t[i, j, 1]
            for a in range(m):
                g0 = h[i, 0, a] * k[i, 0]
                gj = h[i, 1 + j, a] * k[i, 0] + h[i, 0, a] * k[i, 1 + j]
                value += db[1 + j, a] * g0 + db[0, a] * gj
            out[1 + j, i] = value


@nb.njit(cache=True, error_model="numpy")
def reverse_point(h, k, moments, inverse, s, t, moment_b, moment_grad, seed, out):
    """Transpose of ``forward_point``: ``seed`` (3, n) on Phi, Phi_,x, Phi_,y to ``out`` (n, 2)."""
    n, _, m = h.shape
    bar = np.zeros((3, m))
    for i in range(n):
        for a in range(m):
            g0 = h[i, 0, a] * k[i, 0]
            bar[0, a] += seed[0, i] * g0
            for j in (1, 2):
                gj = h[i, j, a] * k[i, 0] + h[i, 0, a] * k[i, j]
                bar[0, a] += seed[j, i] * gj
                bar[j, a] += seed[j, i] * g0
    c = np.zeros((3, m))
    for u in (1, 2, 0):
        for a in range(m):
            for e in range(m):
                c[u, a] += inverse[a, e] * bar[u, e]
        if u > 0:
            for a in range(m):
                for e in range(m):
                    bar[0, a] -= moments[u, e, a] * c[u, e]
    for i in range(n):
        for d in range(2):
            value = seed[0, i] * s[i, d] + seed[1, i] * t[i, 0, d] + seed[2, i] * t[i, 1, d]
            for a in range(m):
                value -= (
                    c[0, a] * moment_b[i, d, a]
                    + c[1, a] * moment_grad[i, 0, d, a]
                    + c[2, a] * moment_grad[i, 1, d, a]
                )
            out[i, d] = value


@nb.njit(cache=True, error_model="numpy")
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
        s, t = np.empty((n, 2)), np.empty((n, 2, 2))
        moment_b, moment_grad = np.empty((n, 2, m)), np.empty((n, 2, 2, m))
        delta, out = np.empty((n, 2)), np.empty((3, n))
        for q in range(group_size):
            point = g * group_size + q
            _prepare(points[point], near, cloud, h, k, moments, inverse, b)
            linearize_point(h, k, b, s, t, moment_b, moment_grad)
            at = dstart[g, 1] + q * n * count
            for p in range(count):
                for i in range(n):
                    for c in range(2):
                        delta[i, c] = (
                            point_velocity[which[p], point, c] - velocity[which[p], near[i], c]
                        )
                forward_point(h, k, b, moments, inverse, s, t, moment_b, moment_grad, delta, out)
                for i in range(n):
                    dphi[at + i * count + p] = out[0, i]
                    dgrad[2 * at + i * count + p] = out[1, i]
                    dgrad[2 * at + (n + i) * count + p] = out[2, i]


@nb.njit(cache=True, error_model="numpy")
def reverse_shape_functions(cloud, points, start, neighbours, phi_bar, grad_bar, x_bar, point_bar):
    """Pull seeds on a whole table back to the particles and to the points.

    Parameters
    ----------
    phi_bar, grad_bar : ndarray, shapes (M, ...)
        Seeds of M measures in the flat layout of ``ShapeTable``.
    x_bar, point_bar : ndarray, shapes (M, n_particles, 2), (M, n_points, 2)
        Added to: derivatives with respect to the particle and the point coordinates.
    """
    m = cloud.n_basis
    n_groups = start.size - 1
    group_size = points.shape[0] // n_groups
    moments, inverse, b = np.empty((3, m, m)), np.empty((m, m)), np.empty((3, m))
    for g in range(n_groups):
        n = start[g + 1] - start[g]
        near = neighbours[start[g] : start[g + 1]]
        h, k = np.empty((n, 6, m)), np.empty((n, 6))
        s, t = np.empty((n, 2)), np.empty((n, 2, 2))
        moment_b, moment_grad = np.empty((n, 2, m)), np.empty((n, 2, 2, m))
        seed, out = np.empty((3, n)), np.empty((n, 2))
        for q in range(group_size):
            point = g * group_size + q
            _prepare(points[point], near, cloud, h, k, moments, inverse, b)
            linearize_point(h, k, b, s, t, moment_b, moment_grad)
            at = start[g] * group_size + q * n
            for measure in range(phi_bar.shape[0]):
                for i in range(n):
                    seed[0, i] = phi_bar[measure, at + i]
                    seed[1, i] = grad_bar[measure, 2 * at + i]
                    seed[2, i] = grad_bar[measure, 2 * at + n + i]
                reverse_point(h, k, moments, inverse, s, t, moment_b, moment_grad, seed, out)
                for i in range(n):
                    for c in range(2):
                        x_bar[measure, near[i], c] -= out[i, c]
                        point_bar[measure, point, c] += out[i, c]

"""Discrete moment matrix M(x) of Eqs. (7)-(8) with unit weights, and the vectors solved from it."""

import numpy as np

from seal_mdao.compilation import inlined, internal
from seal_mdao.rkpm.basis import fill_basis
from seal_mdao.rkpm.kernel import kernel_derivatives, product_kernel_derivatives

# Smallest pivot of M, relative to M_00, at which the supports still count as covering the point.
PIVOT_TOLERANCE = 1e-8


@internal
def _kernel(rx, ry, radius, axes, particle):
    """The kernel of a particle: numba compiles only the one that ``axes``, None or not, calls for."""
    if axes is None:
        return kernel_derivatives(rx, ry, radius)
    return product_kernel_derivatives(rx, ry, axes[particle])


@inlined
def neighbour_terms(x, neighbours, cloud, h, k):
    """Basis ``h`` (n, 6, m) and kernel ``k`` (n, 6) terms of every neighbour of the point ``x``.

    The six rows are the value, the two first and the three second derivatives (xx, xy, yy).
    """
    for i in range(neighbours.size):
        p = neighbours[i]
        rx, ry = x[0] - cloud.particles[p, 0], x[1] - cloud.particles[p, 1]
        fill_basis(rx, ry, cloud.scale, h[i])
        k[i, 0], k[i, 1], k[i, 2], k[i, 3], k[i, 4], k[i, 5] = _kernel(
            rx, ry, cloud.radius[p], cloud.axes, p
        )


@internal
def moment_matrices(h, k, moments):
    """M = sum_I H H^T phi_a and its gradient: ``moments`` (3, m, m) holds M, M_x, M_y; (1, m, m) M."""
    moments[:] = 0.0
    m = h.shape[2]
    part = np.empty(m)
    for i in range(h.shape[0]):
        if k[i, 0] == 0.0:
            continue
        for j in range(moments.shape[0]):
            # half of the gradient: H (H_j phi + H phi_j / 2)^T, to which its transpose is added below
            for a in range(m):
                part[a] = h[i, j, a] * k[i, 0]
                if j > 0:
                    part[a] += 0.5 * h[i, 0, a] * k[i, j]
            for a in range(m):
                for b in range(m):
                    moments[j, a, b] += h[i, 0, a] * part[b]
    for j in range(1, moments.shape[0]):
        for a in range(m):
            for b in range(a + 1):
                moments[j, a, b] = moments[j, b, a] = moments[j, a, b] + moments[j, b, a]


@internal
def invert_moment(moment, inverse):
    """Inverse of the symmetric positive definite M by Cholesky; False where M is singular."""
    m = moment.shape[0]
    lower = np.empty((m, m))
    for i in range(m):
        for j in range(i + 1):
            s = moment[i, j]
            for a in range(j):
                s -= lower[i, a] * lower[j, a]
            if i == j:
                # written so that NaN fails too
                if not s > PIVOT_TOLERANCE * moment[0, 0]:
                    return False
                lower[i, i] = s**0.5
            else:
                lower[i, j] = s / lower[j, j]
    for col in range(m):
        column = inverse[:, col]
        for i in range(m):
            s = 1.0 if i == col else 0.0
            for a in range(i):
                s -= lower[i, a] * column[a]
            column[i] = s / lower[i, i]
        for i in range(m - 1, -1, -1):
            s = column[i]
            for a in range(i + 1, m):
                s -= lower[a, i] * column[a]
            column[i] = s / lower[i, i]
    return True


@inlined
def correction_coefficients(moments, inverse, b):
    """q(x) = M^-1 H(0) of Eq. (7) and its gradient: ``b`` (3, m) holds q, q_x, q_y; (1, m) q."""
    m = inverse.shape[0]
    for a in range(m):
        b[0, a] = inverse[a, 0]
    for j in range(1, b.shape[0]):
        for a in range(m):
            b[j, a] = 0.0
        for c in range(m):
            t = 0.0
            for e in range(m):
                t += moments[j, c, e] * b[0, e]
            for a in range(m):
                b[j, a] -= inverse[a, c] * t

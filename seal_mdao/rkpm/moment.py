"""Discrete moment matrix M(x) of Eqs. (7)-(8) with unit weights, and the vectors solved from it."""

import numpy as np

from seal_mdao.compilation import inlined, internal
from seal_mdao.rkpm.basis import LOWERED, POWER, PRODUCT, fill_basis, fill_monomials
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
def neighbour_terms(x, neighbours, cloud, h, k, seen):
    """Basis ``h`` (n, 6, m) and kernel ``k`` (n, 6) terms of the neighbours whose supports reach ``x``.

    The six rows are the value, the two first and the three second derivatives (xx, xy, yy). ``seen``
    receives their places among all ``neighbours``; returns how many they are.
    """
    n = 0
    for i in range(neighbours.size):
        p = neighbours[i]
        rx, ry = x[0] - cloud.particles[p, 0], x[1] - cloud.particles[p, 1]
        k[n, 0], k[n, 1], k[n, 2], k[n, 3], k[n, 4], k[n, 5] = _kernel(
            rx, ry, cloud.radius[p], cloud.axes, p
        )
        if k[n, 0] > 0.0:
            fill_basis(rx, ry, cloud.scale, h[n])
            seen[n] = i
            n += 1
    return n


@internal
def moment_matrices(h, k, moments):
    """M = sum_I H H^T phi_a and its gradient: ``moments`` (3, m, m) holds M, M_x, M_y; (1, m, m) M.

    Many of their entries are equal: they are the moments of the kernels, of twice the basis' degree."""
    rows, m, _ = moments.shape
    size = PRODUCT[m - 1, m - 1] + 1  # the square of the last monomial comes last
    monomials, sums = np.empty(size), np.empty((rows, size))
    sums[:] = 0.0
    for i in range(h.shape[0]):
        fill_monomials(h[i, 0, 1], h[i, 0, 2], monomials)
        for j in range(rows):
            for e in range(size):
                sums[j, e] += monomials[e] * k[i, j]
    for a in range(m):
        for b in range(m):
            e = PRODUCT[a, b]
            moments[0, a, b] = sums[0, e]
            for j in range(1, rows):
                # H_j = h[0, j, j], the inverse scale, in the monomial x or y
                slope = POWER[j - 1, e] * h[0, j, j] * sums[0, LOWERED[j - 1, e]]
                moments[j, a, b] = sums[j, e] + slope


@internal
def invert_moment(moment, inverse):
    """Inverse of the symmetric positive definite M = L L^T as L^-T L^-1; False where M is singular."""
    m = moment.shape[0]
    lower, turned = np.empty((m, m)), np.empty((m, m))
    for i in range(m):
        for j in range(i):
            s = moment[i, j]
            for a in range(j):
                s -= lower[i, a] * lower[j, a]
            lower[i, j] = s * turned[j, j]
        pivot = moment[i, i]
        for a in range(i):
            pivot -= lower[i, a] * lower[i, a]
        # written so that NaN fails too
        if not pivot > PIVOT_TOLERANCE * moment[0, 0]:
            return False
        turned[i, i] = pivot**-0.5
        for j in range(i):
            s = 0.0
            for a in range(j, i):
                s -= lower[i, a] * turned[a, j]
            turned[i, j] = s * turned[i, i]
    for i in range(m):
        for j in range(i + 1):
            s = 0.0
            for a in range(i, m):
                s += turned[a, i] * turned[a, j]
            inverse[i, j] = inverse[j, i] = s
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

"""Discrete moment matrix M(x) of Eqs. (7)-(8) with unit weights, and the correction solved from it."""

import numpy as np

from seal_mdao.compilation import inlined, internal
from seal_mdao.rkpm.basis import PRODUCT, basis_slope, fill_monomials
from seal_mdao.rkpm.kernel import kernel_derivatives, product_kernel_derivatives

# Smallest pivot of M, relative to M_00, at which the supports still count as covering the point.
PIVOT_TOLERANCE = 1e-8


@internal
def gathered(particles, radius, axes, neighbours):
    """Gather coordinates of the neighbours, and their radii or four inverse half-widths: (3 or 6, n).

    Here and in ``neighbour_terms`` numba compiles only what ``axes``, None or not, calls for."""
    near = np.empty((3 if axes is None else 6, neighbours.size))
    for i in range(neighbours.size):
        p = neighbours[i]
        near[0, i], near[1, i], near[2, i] = particles[p, 0], particles[p, 1], radius[p]
        if axes is not None:
            near[2, i], near[3, i] = axes[p, 0, 0], axes[p, 0, 1]
            near[4, i], near[5, i] = axes[p, 1, 0], axes[p, 1, 1]
    return near


@internal
def neighbour_terms(x, near, axes, scale, h, k):
    """Evaluate monomials ``h`` (size, n) and kernel terms ``k`` (6, n) at ``x`` of the neighbours.

    The six rows are the value, the two first and the three second derivatives (xx, xy, yy); they are
    zero where the support of a neighbour does not reach ``x``.
    """
    for i in range(near.shape[1]):
        # H(r / s) and phi_a(r) with r = x - X_I   Eqs. (1), (2)
        rx, ry = x[0] - near[0, i], x[1] - near[1, i]
        h[1, i], h[2, i] = rx / scale, ry / scale
        if axes is None:
            terms = kernel_derivatives(rx, ry, near[2, i])
        else:
            terms = product_kernel_derivatives(
                rx, ry, near[2, i], near[3, i], near[4, i], near[5, i]
            )
        k[0, i], k[1, i], k[2, i], k[3, i], k[4, i], k[5, i] = terms
    fill_monomials(h)


@internal
def clear_hidden(hidden, at, k):
    """Set the kernel terms (6, n) of neighbours that are hidden from a point to zero.

    ``hidden`` is flat, from ``at`` on that of this point, or empty."""
    if hidden.size > 0:
        for i in range(k.shape[1]):
            if hidden[at + i]:
                k[:, i] = 0.0


@inlined
def n_monomials(m):
    """Count the monomials up to twice the degree of a basis of ``m``."""
    # the square of the last monomial of the basis is the last of them
    return PRODUCT[m - 1, m - 1] + 1


@internal
def moment_matrices(h, k, scale, moments):
    """Compute the moment matrix and its gradient: ``moments`` (3, m, m) holds M, M_x, M_y; (1, m, m) M.

    M_ab = m_(ab) as in Eq. (8): only the distinct moments, to twice the degree, are summed."""
    rows, m, _ = moments.shape
    # m_e = sum_I H_e phi_a   Eq. (5) with unit weights;  rows 1, 2: sum_I H_e phi_a,j
    sums = np.empty((rows, len(h)))
    for j in range(rows):
        for e in range(len(h)):
            value = 0.0
            for i in range(h.shape[1]):
                value += h[e, i] * k[j, i]
            sums[j, e] = value
    # M_ab = m_e with H_e = H_a H_b;  M_ab,j = sum_I H_e phi_a,j + H_e,j phi_a
    for a in range(m):
        for b in range(m):
            e = PRODUCT[a, b]
            moments[0, a, b] = sums[0, e]
            for j in range(1, rows):
                factor, lowered = basis_slope(e, j - 1, scale)
                moments[j, a, b] = sums[j, e] + factor * sums[0, lowered]


@internal
def invert_moment(moment, inverse):
    """Invert the symmetric positive definite M by Gauss-Jordan elimination; False where M is singular.

    Its pivots are those of L D L^T."""
    m = len(moment)
    for i in range(m):
        for j in range(m):
            inverse[i, j] = moment[i, j]
    for k in range(m):
        # written so that NaN fails too
        if not inverse[k, k] > PIVOT_TOLERANCE * moment[0, 0]:
            return False
        # row k over its pivot, the unit column of the inverse in place
        scale, inverse[k, k] = 1.0 / inverse[k, k], 1.0
        for j in range(m):
            inverse[k, j] *= scale
        for i in range(m):
            if i != k:
                # row i -= a_ik row k
                factor, inverse[i, k] = inverse[i, k], 0.0
                for j in range(m):
                    inverse[i, j] -= factor * inverse[k, j]
    return True


@inlined
def correction_polynomials(moments, inverse, scale, b):
    """Compute the correction function, Eq. (10), and its gradient as coefficients of monomials.

    ``b`` (3, m) holds those of p = q . H and of p_j = q_j . H + q . H_j, j = x, y; (1, m) those of p.
    With them Phi = p phi_a and Phi_,j = p_j phi_a + p phi_a,j."""
    m = inverse.shape[0]
    for a in range(m):
        # q = M^-1 H(0), H(0) = (1, 0, ...)   Eqs. (7), (9): sum_I Phi_I H(x - X_I) = M q = H(0), the
        # reproducing conditions (6)
        b[0, a] = inverse[a, 0]
    for j in range(1, b.shape[0]):
        for a in range(m):
            b[j, a] = 0.0
        for c in range(m):
            # M q = H(0) gives q_j = -M^-1 M_j q
            t = 0.0
            for e in range(m):
                t += moments[j, c, e] * b[0, e]
            for a in range(m):
                b[j, a] -= inverse[a, c] * t
        for a in range(1, m):
            # + q . H_j
            factor, lowered = basis_slope(a, j - 1, scale)
            b[j, lowered] += factor * b[0, a]


@inlined
def polynomial_value(b, j, h, i):
    """Evaluate the polynomial with the coefficients ``b[j]`` at neighbour ``i``."""
    value = b[j, 0]
    for a in range(1, b.shape[1]):
        value += b[j, a] * h[a, i]
    return value

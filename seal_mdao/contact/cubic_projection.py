"""Closest point of a cubic piece: all solutions of Eq. (18) on it, and the smallest distance.

On a piece (x_c - x).t is a polynomial of degree five in xi. Between neighbouring zeros of its
derivative it is monotonic, and so on down to degree one: every zero is bracketed, none is missed, and
no starting value decides.
"""

import numpy as np

from seal_mdao.compilation import inlined, internal
from seal_mdao.geometry.curve import END_SLACK


@inlined
def _horner(p, degree, u):
    """Value and slope of sum_k p_k u^k."""
    value, slope = p[degree], 0.0
    # Horner: p <- p u + p_k, p' <- p' u + p
    for k in range(degree - 1, -1, -1):
        slope = slope * u + value
        value = value * u + p[k]
    return value, slope


@internal
def _bracketed(p, degree, low, high, low_value):
    """The zero between ``low`` and ``high``: Newton, halving where it would leave the bracket."""
    u = 0.5 * (low + high)
    for _ in range(200):
        value, slope = _horner(p, degree, u)
        if value == 0.0:
            return u
        # keep the bracket
        if (value > 0.0) == (low_value > 0.0):
            low = u
        else:
            high = u
        # Newton step, or the middle
        new = u - value / slope if slope != 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - u) <= 1e-16 * abs(u) or not low < new < high:
            return new
        u = new
    return u


@internal
def zeros_of_quintic(p, zeros):
    """Compute the zeros of sum_k p_k u^k, k = 0..5, for 0 < u <= 1.

    Parameters
    ----------
    p : ndarray, shape (6,)
    zeros : ndarray, shape (2, 6)
        Scratch; the first row begins with the zeros, in increasing order.

    Returns
    -------
    int
        How many they are.
    """
    q, count = np.empty(6), 0
    # near the piece p itself is monotonic
    bends = 2.0 * abs(p[2]) + 3.0 * abs(p[3]) + 4.0 * abs(p[4]) + 5.0 * abs(p[5])
    for degree in range(5 if p[1] > bends else 1, 6):
        # the derivative of p that has this degree
        # q_k = p_(k+n) (k+1)(k+2)...(k+n) with n = 5 - degree
        for k in range(degree + 1):
            q[k] = p[k + 5 - degree]
            for factor in range(k + 1, k + 6 - degree):
                q[k] *= factor
        for i in range(count):
            zeros[1, i] = zeros[0, i]
        # between zeros of the derivative q is monotonic: at most one zero each
        breaks, count, low = count, 0, 0.0
        low_value = q[0]
        for i in range(breaks + 1):
            high = zeros[1, i] if i < breaks else 1.0
            value, _ = _horner(q, degree, high)
            if value == 0.0 and high > low:
                zeros[0, count] = high
                count += 1
            elif low_value * value < 0.0:
                zeros[0, count] = _bracketed(q, degree, low, high, low_value)
                count += 1
            low, low_value = high, value
    return count


@inlined
def _end(coefficient, length, u, x, y, open_end):
    """Distance squared and s of the end u = 0 or 1, or of its tangent beyond it."""
    c0, c1, c2, c3 = coefficient[0], coefficient[1], coefficient[2], coefficient[3]
    s = u * length
    # t = x_c,xi and x - x_c at the end
    tx = c1[0] + s * (2.0 * c2[0] + 3.0 * s * c3[0])
    ty = c1[1] + s * (2.0 * c2[1] + 3.0 * s * c3[1])
    dx = x - (c0[0] + s * (c1[0] + s * (c2[0] + s * c3[0])))
    dy = y - (c0[1] + s * (c1[1] + s * (c2[1] + s * c3[1])))
    t2, square = tx * tx + ty * ty, dx * dx + dy * dy
    # s of the projection on the tangent, from the end
    beyond = (dx * tx + dy * ty) / t2
    if (beyond < 0.0) != (u == 0.0):
        return square, s
    # distance to the tangent: (x - x_c) x t / |t|
    if open_end:
        square = (dx * ty - dy * tx) ** 2 / t2
    return square, s + beyond


@internal
def nearest_on_cubic(coefficient, length, x, y, open_start, open_end):
    """Compute the squared distance to the closest point of a cubic piece, and its s = xi - start.

    An end that is nearest is continued along its tangent: s is then that of the projection on it.
    The distance is that to the end itself, or to the tangent where the profile is unbounded.
    """
    c = coefficient
    d = (c[0, 0] - x, c[0, 1] - y)
    p, zeros = np.zeros(6), np.empty((2, 6))
    for a in range(2):
        # (x_c - x) . x_c,u as a polynomial in u = s / length, Eq. (18)
        c1, c2, c3 = c[1, a] * length, c[2, a] * length**2, c[3, a] * length**3
        p[0] += d[a] * c1
        p[1] += c1 * c1 + 2.0 * d[a] * c2
        p[2] += 3.0 * (c1 * c2 + d[a] * c3)
        p[3] += 2.0 * c2 * c2 + 4.0 * c1 * c3
        p[4] += 5.0 * c2 * c3
        p[5] += 3.0 * c3 * c3
    best, best_s = _end(c, length, 0.0, x, y, open_start)
    square, s = _end(c, length, 1.0, x, y, open_end)
    if square < best:
        best, best_s = square, s
    for i in range(zeros_of_quintic(p, zeros)):
        s = zeros[0, i] * length
        dx = d[0] + s * (c[1, 0] + s * (c[2, 0] + s * c[3, 0]))
        dy = d[1] + s * (c[1, 1] + s * (c[2, 1] + s * c[3, 1]))
        # an end of equal distance to rounding is this zero itself
        if dx * dx + dy * dy <= best * (1.0 + END_SLACK):
            best, best_s = dx * dx + dy * dy, s
    return best, best_s

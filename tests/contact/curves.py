"""A rigid curve with non-unit, non-constant |t| that depends on a design parameter; complex-safe.

x_c(xi; tau) = sum_k (a_k + tau b_k) xi^k. Everything here is written from the definitions (16)-(19)
and evaluated in complex arithmetic, so derivatives come from complex steps without truncation.
"""

import numpy as np

A = np.array([[0.1, -0.2], [1.4, 0.3], [0.3, 0.5], [-0.15, 0.1], [0.05, 0.07]])
B = np.array([[0.2, 0.1], [-0.3, 0.2], [0.15, -0.25], [0.1, 0.05], [-0.02, 0.03]])
STEP = 1e-30


def derivative(coefficients, xi, order):
    """d^order/dxi^order of sum_k coefficients_k xi^k."""
    for _ in range(order):
        coefficients = coefficients[1:] * np.arange(1, len(coefficients))[:, None]
    return sum(c * xi**k for k, c in enumerate(coefficients))


def frame(xi, tau=0.0):
    """x_c, t, x_c,xixi, x_c,xixixi, |t|, e_t, e_n; e_n is e_t turned clockwise."""
    x, t, x2, x3 = (derivative(A + tau * B, xi, k) for k in range(4))
    size = np.sqrt(t @ t)
    e_t = t / size
    return x, t, x2, x3, size, e_t, np.array([e_t[1], -e_t[0]])


def project(x, tau=0.0, guess=0.3):
    """Solve (18) by Newton; the last iterations carry complex parts along exactly."""
    xi = complex(guess)
    for _ in range(60):
        x_c, t, x2, *_ = frame(xi, tau)
        xi -= ((x - x_c) @ t) / ((x - x_c) @ x2 - t @ t)
    return xi


def scalars(x, tau=0.0):
    """All that ``rates`` needs: e_t, e_n, |t|, alpha, beta, gamma, c, g_n; and xi."""
    xi = project(x, tau)
    x_c, _, x2, x3, size, e_t, e_n = frame(xi, tau)
    g_n = (x - x_c) @ e_n
    alpha, beta, gamma = e_n @ x2, e_t @ x2, e_n @ x3
    return xi, (e_t, e_n, size, alpha, beta, gamma, size**2 - g_n * alpha, g_n)


def real(args):
    """The arguments of ``rates`` as floats."""
    return tuple(tuple(v.real) if np.ndim(v) else float(np.real(v)) for v in args)


def beside(xi, gap):
    """The point at a distance ``gap`` from the curve."""
    x_c, *_, e_n = frame(xi)
    return x_c + gap * e_n

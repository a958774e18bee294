"""Smooth aggregates of many local values, each with its derivatives.

They do not depend on which particle has the largest value, and only weakly on the refinement.
"""

import numpy as np

NORM_ORDER = 40
"""Order of ``p_norm``: it exceeds 174 equal values by 14 %, a few peaks by 2 to 5 %."""

MEAN_ORDER = 8
"""Order of ``lehmer_mean``."""


def p_norm(values: np.ndarray, order: int = NORM_ORDER):
    """Compute the p-norm of values v >= 0, never below the largest, and its derivatives.

    Returns
    -------
    value : float
    by_value : ndarray
    """
    largest = float(values.max(initial=0.0))
    if largest == 0.0:
        return 0.0, np.zeros_like(values)
    ratio = values / largest
    # N = v_max [sum (v / v_max)^p]^(1/p),  dN/dv = (v / N)^(p - 1); scaled against overflow
    total = float((ratio**order).sum())
    return largest * total ** (1 / order), ratio ** (order - 1) * total ** (1 / order - 1)


def lehmer_mean(values: np.ndarray, order: int = MEAN_ORDER):
    """Compute the Lehmer mean of values v >= 0, never above the largest, and its derivatives."""
    largest = float(values.max(initial=0.0))
    if largest == 0.0:
        return 0.0, np.zeros_like(values)
    ratio = values / largest
    # L = sum v^(p+1) / sum v^p,  dL/dv = [(p + 1) v^p - p v^(p-1) L] / sum v^p
    lower, upper = float((ratio**order).sum()), float((ratio ** (order + 1)).sum())
    mean = upper / lower
    by_value = ((order + 1) * ratio**order - order * ratio ** (order - 1) * mean) / lower
    return largest * mean, by_value


def opened_square_integral(gap: np.ndarray, length: np.ndarray):
    """Integrate max(g, 0)^2 along a line of points, with g linear between them.

    Parameters
    ----------
    gap : ndarray, shape (k,)
    length : ndarray, shape (k - 1,)
        Distances between neighbours.

    Returns
    -------
    value : float
    by_gap, by_length : ndarray, shapes (k,), (k - 1,)
    """
    a, b = gap[:-1], gap[1:]
    both, first, second = (a >= 0) & (b >= 0), (a >= 0) & (b < 0), (a < 0) & (b >= 0)
    # gaps a, b at the ends of a segment of length L:
    # both open:     L (a^2 + a b + b^2) / 3
    # a >= 0 > b:    L a^3 / (3 (a - b)), open up to the fraction a / (a - b);  b >= 0 > a: mirrored
    on_first, on_second = np.where(first, a, 0.0), np.where(second, b, 0.0)
    span = np.where(first | second, np.abs(a - b), 1.0)
    mean = np.where(both, (a * a + a * b + b * b) / 3.0, (on_first**3 + on_second**3) / (3 * span))
    by_a = np.where(both, (2 * a + b) / 3.0, 0.0)
    by_b = np.where(both, (a + 2 * b) / 3.0, 0.0)
    # d/da = a^2 / (a - b) - a^3 / (3 (a - b)^2),  d/db = a^3 / (3 (a - b)^2); mirrored
    square, cube = on_first**2 / span, on_first**3 / (3 * span**2)
    by_a, by_b = by_a + square - cube, by_b + cube
    square, cube = on_second**2 / span, on_second**3 / (3 * span**2)
    by_b, by_a = by_b + square - cube, by_a + cube
    by_gap = np.zeros_like(gap)
    by_gap[:-1] += length * by_a
    by_gap[1:] += length * by_b
    return float(length @ mean), by_gap, mean

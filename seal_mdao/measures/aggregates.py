"""Smooth aggregates of many local values, each with its derivatives.

They do not depend on which particle happens to be the worst, and hardly on the refinement.
"""

import numpy as np

NORM_ORDER = 40
"""Order of ``p_norm``: of 174 equal values it is 14 % too large, of a few peaks 2 to 5 %."""

MEAN_ORDER = 8
"""Order of ``lehmer_mean``."""


def p_norm(values: np.ndarray, order: int = NORM_ORDER):
    """(sum v^p)^(1/p), never below the largest of the values v >= 0, and its derivatives.

    Returns
    -------
    value : float
    by_value : ndarray
    """
    largest = float(values.max(initial=0.0))
    if largest == 0.0:
        return 0.0, np.zeros_like(values)
    share = values / largest
    total = float((share**order).sum())
    return largest * total ** (1 / order), share ** (order - 1) * total ** (1 / order - 1)


def lehmer_mean(values: np.ndarray, order: int = MEAN_ORDER):
    """sum v^(p+1) / sum v^p, never above the largest of the values v >= 0, and its derivatives."""
    largest = float(values.max(initial=0.0))
    if largest == 0.0:
        return 0.0, np.zeros_like(values)
    share = values / largest
    lower, upper = float((share**order).sum()), float((share ** (order + 1)).sum())
    mean = upper / lower
    by_value = ((order + 1) * share**order - order * share ** (order - 1) * mean) / lower
    return largest * mean, by_value


def opened_square_integral(gap: np.ndarray, length: np.ndarray):
    """Integral of max(g, 0)^2 along a line of points, g being linear between them.

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
    on_first, on_second = np.where(first, a, 0.0), np.where(second, b, 0.0)
    fall = np.where(first | second, np.abs(a - b), 1.0)
    mean = np.where(both, (a * a + a * b + b * b) / 3.0, (on_first**3 + on_second**3) / (3 * fall))
    by_a = np.where(both, (2 * a + b) / 3.0, 0.0)
    by_b = np.where(both, (a + 2 * b) / 3.0, 0.0)
    # a^3 / 3 (a - b) where b < 0 <= a, and the mirror image
    square, cube = on_first**2 / fall, on_first**3 / (3 * fall**2)
    by_a, by_b = by_a + square - cube, by_b + cube
    square, cube = on_second**2 / fall, on_second**3 / (3 * fall**2)
    by_b, by_a = by_b + square - cube, by_a + cube
    by_gap = np.zeros_like(gap)
    by_gap[:-1] += length * by_a
    by_gap[1:] += length * by_b
    return float(length @ mean), by_gap, mean

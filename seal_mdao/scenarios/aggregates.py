"""What S scenarios say together: smooth functions of a column of values, with exact derivatives.

Every function takes values (S, m) of S scenarios and gives one number a column, shape (m,), and its
derivatives, shape (S, m). Complex values pass through. Sums go over the scenarios in their order.
"""

import numpy as np
from scipy.special import ndtr, ndtri

SHARPNESS = 20.0
"""Of ``highest``: at most log(S) / 20 standard deviations above the largest value."""
BISECTIONS = 200
"""More than enough: the quantile is found to the last bit."""


def mean(values: np.ndarray):
    """Arithmetic mean."""
    return values.mean(axis=0), np.full(values.shape, 1.0 / len(values), values.dtype)


def deviation(values: np.ndarray):
    """Standard deviation of a sample (S - 1 in the denominator); no derivative where all are equal."""
    away = values - values.mean(axis=0)
    size = np.sqrt((away * away).sum(axis=0) / (len(values) - 1))
    safe = np.where(size == 0.0, 1.0, size)
    return size, away / ((len(values) - 1) * safe)


def highest(values: np.ndarray, sharpness: float = SHARPNESS):
    """Smooth largest value (Kreisselmeier and Steinhauser, 1979), scaled by the standard deviation s.

    m + s / rho log sum exp(rho (v - m) / s): never below the largest value, and at most
    s log(S) / rho above it. It has the units of the values and scales with them.
    """
    size, by_size = deviation(values)
    safe = np.where(size == 0.0, 1.0, size) / sharpness
    largest = np.take_along_axis(values, values.real.argmax(axis=0)[None], axis=0)
    away = (values - largest) / safe
    parts = np.exp(away)
    total = parts.sum(axis=0)
    share = parts / total
    above = np.log(total)
    # d(s log sum exp(v / s)) / ds, by the softmax weights
    in_size = (above - (share * away).sum(axis=0)) / sharpness
    value = largest[0] + np.where(size == 0.0, 0.0, safe * above)
    return value, share + in_size * by_size


def lowest(values: np.ndarray, sharpness: float = SHARPNESS):
    """Smooth smallest value, as ``highest``."""
    value, gradient = highest(-values, sharpness)
    return -value, gradient


def quantile(values: np.ndarray, level: float):
    """Smooth quantile: where the distribution, smoothed by a normal kernel, reaches ``level``.

    The kernel's width is s S^(-1/3), which goes to zero with more scenarios at the rate that suits
    distribution functions (Azzalini, 1981). Order statistics jump where two scenarios change places;
    this does not.
    """
    size, by_size = deviation(values)
    width = np.where(size == 0.0, 1.0, size) * len(values) ** (-1.0 / 3.0)
    found = _level_crossing(values.real, width.real, level)
    z = (found - values) / width
    density = np.exp(-0.5 * z * z)
    total = density.sum(axis=0)
    # one Newton step: exact derivatives of the implicit function, complex ones included
    off = (_normal_distribution(z) - level).sum(axis=0) * np.sqrt(2.0 * np.pi)
    value = found - off * width / total
    by_width = (density * z).sum(axis=0) / total * len(values) ** (-1.0 / 3.0)
    return np.where(size == 0.0, values[0], value), density / total + by_width * by_size


def _normal_distribution(z):
    """Distribution function of the normal distribution, to first order in an imaginary part."""
    if not np.iscomplexobj(z):
        return ndtr(z)
    slope = np.exp(-0.5 * z.real**2) / np.sqrt(2.0 * np.pi)
    return ndtr(z.real) + 1j * z.imag * slope


def _level_crossing(values, width, level) -> np.ndarray:
    """Where the smoothed distribution functions reach ``level``, by bisection, shape (m,)."""
    margin = abs(ndtri(level)) * width
    low, high = values.min(axis=0) - margin - width, values.max(axis=0) + margin + width
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        below = ndtr((middle - values) / width).mean(axis=0) < level
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)

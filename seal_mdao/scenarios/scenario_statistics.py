"""Statistics of S scenarios: smooth functions of a column of values, with exact derivatives.

Every function takes values (S, m) of S scenarios and returns one number per column, shape (m,), and its
derivatives, shape (S, m). Complex values are accepted. Sums are taken in the order of the scenarios.
"""

import numpy as np
from scipy.special import ndtr, ndtri

SHARPNESS = 20.0
"""Sharpness rho of ``highest``: at most log(S) / 20 standard deviations above the largest value."""
BISECTIONS = 200
"""Number of bisections, enough for the quantile to the last bit."""


def mean(values: np.ndarray):
    """Compute the arithmetic mean."""
    return values.mean(axis=0), np.full(values.shape, 1.0 / len(values), values.dtype)


def deviation(values: np.ndarray):
    """Compute the sample standard deviation (S - 1), zero for a single scenario; derivative zero where
    all values are equal."""
    # v - mean from d = v - v_1, so that equal values have exactly the deviation zero, and derivatives
    # do not contain the rounding of the mean
    away = values - values[0]
    difference = away - away.mean(axis=0)
    # s^2 = sum (v - mean)^2 / (S - 1),  ds/dv = (v - mean) / ((S - 1) s)
    freedom = max(len(values) - 1, 1)
    size = np.sqrt((difference * difference).sum(axis=0) / freedom)
    safe = np.where(size == 0.0, 1.0, size)
    return size, difference / (freedom * safe)


def highest(values: np.ndarray, sharpness: float = SHARPNESS):
    """Compute a smooth maximum (Kreisselmeier and Steinhauser, 1979), scaled by the deviation s.

    m + s / rho log sum exp(rho (v - m) / s): never below the largest value, and at most
    s log(S) / rho above it. It has the units of the values and scales with them.
    """
    size, by_size = deviation(values)
    safe = np.where(size == 0.0, 1.0, size) / sharpness
    # KS = v_max + (s / rho) log sum exp(rho (v - v_max) / s)
    largest = np.take_along_axis(values, values.real.argmax(axis=0)[None], axis=0)
    scaled = (values - largest) / safe
    parts = np.exp(scaled)
    total = parts.sum(axis=0)
    weight = parts / total
    above = np.log(total)
    # dKS/dv = w + (dKS/ds) ds/dv with softmax weights w = exp(.) / sum exp(.)
    # dKS/ds = (1 / rho) [log sum exp(.) - sum w rho (v - v_max) / s]
    in_size = (above - (weight * scaled).sum(axis=0)) / sharpness
    value = largest[0] + np.where(size == 0.0, 0.0, safe * above)
    return value, weight + in_size * by_size


def lowest(values: np.ndarray, sharpness: float = SHARPNESS):
    """Compute a smooth minimum, as ``highest``."""
    # min v = -max(-v)
    value, gradient = highest(-values, sharpness)
    return -value, gradient


def quantile(values: np.ndarray, level: float):
    """Compute a smooth quantile: where the distribution, smoothed by a normal kernel, is ``level``.

    The width of the kernel is h = s S^(-1/3), which decreases with the number of scenarios at the
    optimal rate for distribution functions (Azzalini, 1981). Order statistics are not differentiable
    where two scenarios exchange their order; this quantile is.
    """
    size, by_size = deviation(values)
    width = np.where(size == 0.0, 1.0, size) * len(values) ** (-1.0 / 3.0)
    # (1/S) sum Phi((q - v) / h) = level
    found = _level_crossing(values.real, width.real, level)
    z = (found - values) / width
    density = np.exp(-0.5 * z * z)
    total = density.sum(axis=0)
    # one Newton step, exact to first order, also for complex values:
    # q - h sum (Phi(z) - level) / sum phi(z),  z = (q - v) / h
    off = (_normal_distribution(z) - level).sum(axis=0) * np.sqrt(2.0 * np.pi)
    value = found - off * width / total
    # dq/dv = phi(z) / sum phi + (dq/dh) dh/dv,  dq/dh = sum z phi(z) / sum phi
    by_width = (density * z).sum(axis=0) / total * len(values) ** (-1.0 / 3.0)
    return np.where(size == 0.0, values[0], value), density / total + by_width * by_size


def _normal_distribution(z):
    """Evaluate the normal distribution function, to first order in an imaginary part."""
    if not np.iscomplexobj(z):
        return ndtr(z)
    slope = np.exp(-0.5 * z.real**2) / np.sqrt(2.0 * np.pi)
    return ndtr(z.real) + 1j * z.imag * slope


def _level_crossing(values, width, level) -> np.ndarray:
    """Solve for the points where the smoothed distribution functions equal ``level``, shape (m,)."""
    margin = abs(ndtri(level)) * width
    # all normal kernels are below, or all above, the level at these ends
    low, high = values.min(axis=0) - margin - width, values.max(axis=0) + margin + width
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        below = ndtr((middle - values) / width).mean(axis=0) < level
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)

"""Piecewise linear ramps of loads along the path."""

import numpy as np


def at_fraction(values: np.ndarray, fraction: float) -> np.ndarray:
    """Interpolate values (n_steps + 1, ...) given after every nominal step at a path parameter."""
    first = min(int(fraction), len(values) - 2)
    # v = v_k + (s - k)(v_(k+1) - v_k),  k <= s <= k + 1
    within = fraction - first
    return values[first] + within * (values[first + 1] - values[first])


def at_ends(values: np.ndarray, ends) -> np.ndarray:
    """Interpolate values (len(ends) + 1, ...) at new ends of load steps, given in nominal steps."""
    return np.stack([values[0], *(at_fraction(values, end) for end in ends)])

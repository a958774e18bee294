"""Smooth peaks of many local values, each with its derivatives: p-norm and Lehmer mean.

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

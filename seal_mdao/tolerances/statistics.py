"""Statistics of sampled measures."""

from typing import NamedTuple

import numpy as np
from scipy.stats import binomtest, rankdata

CONFIDENCE = 0.95
"""Confidence of the interval of a fraction."""
LEVELS = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)


def described(values: np.ndarray) -> dict:
    """Compute mean, standard deviation, extremes and quantiles of one measure's samples (S,).

    A leak rate is infinite without contact: mean and standard deviation are infinite then, quantiles
    only as far as they are among the infinite samples.
    """
    infinite = np.isinf(values).any()
    # the sample standard deviation, with S - 1
    std = values.std(ddof=1) if len(values) > 1 and not infinite else 0.0
    found = {
        "mean": values.mean(),
        "std": np.inf if infinite else std,
        "lowest": values.min(),
        "highest": values.max(),
    }
    return found | {
        level_name(p): q for p, q in zip(LEVELS, quantiles(values, LEVELS), strict=True)
    }


def quantiles(values: np.ndarray, levels) -> np.ndarray:
    """Compute quantiles of samples (S,), some of which may be infinite, linearly between the samples."""
    finite = np.isfinite(values)
    # any finite number in place of infinity, as infinity minus infinity is not a number
    replaced = np.where(finite, values, values[finite].max(initial=0.0))
    # above the last finite sample a quantile is infinite
    above = np.quantile(values, levels, method="higher")
    return np.where(np.isinf(above), above, np.quantile(replaced, levels))


class Fraction(NamedTuple):
    """Fraction of samples, and its exact confidence interval (Clopper and Pearson, 1934)."""

    value: float
    low: float
    high: float


def fraction(count: int, samples: int) -> Fraction:
    """Estimate the probability of what ``count`` of ``samples`` independent samples show."""
    interval = binomtest(count, samples).proportion_ci(CONFIDENCE)
    return Fraction(count / samples, float(interval.low), float(interval.high))


def level_name(level: float) -> str:
    """Return the key of a quantile: q05 for 0.05."""
    return f"q{round(100 * level):02d}"


def rank_correlations(inputs: np.ndarray, outputs: np.ndarray) -> np.ndarray:
    """Compute Spearman's rank correlation of every output with every input, shape (M, K); zero where one
    of them does not vary."""
    # the correlation coefficient of the ranks: rho = x . y of standardised ranks
    x, y = (_standardised(rankdata(table, axis=0)) for table in (inputs, outputs))
    return y.T @ x


def _standardised(ranks: np.ndarray) -> np.ndarray:
    # (r - mean) / |r - mean|
    away = ranks - ranks.mean(axis=0)
    size = np.linalg.norm(away, axis=0)
    return away / np.where(size == 0.0, 1.0, size)

"""Statistics of sampled measures."""

from typing import NamedTuple

import numpy as np
from scipy.stats import binomtest, rankdata

CONFIDENCE = 0.95
"""Confidence of the interval of a fraction."""
LEVELS = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)


def described(values: np.ndarray) -> dict:
    """Compute mean, standard deviation, extremes and quantiles of one measure's samples (S,)."""
    # the sample standard deviation, with S - 1
    found = {
        "mean": values.mean(),
        "std": values.std(ddof=1) if len(values) > 1 else 0.0,
        "lowest": values.min(),
        "highest": values.max(),
    }
    quantiles = np.quantile(values, LEVELS)
    return found | {level_name(p): q for p, q in zip(LEVELS, quantiles, strict=True)}


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

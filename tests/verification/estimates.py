"""The most certain derivative out of difference quotients at several steps: numbers only."""

from dataclasses import dataclass

import numpy as np

LEAST_RATIO = 1.7
"""Neighbouring steps of an extrapolation differ by at least this factor."""
NEARLY_ZERO = 1e-2
"""Entries below this share of the largest one of their measure are judged relative to that one."""


@dataclass(frozen=True)
class Estimate:
    """Derivatives of m measures.

    Attributes
    ----------
    value, step, uncertainty : ndarray, shape (m,)
        ``step`` is the largest one that was used; ``uncertainty`` rounding plus truncation.
    """

    value: np.ndarray
    step: np.ndarray
    uncertainty: np.ndarray


def nothing(m: int) -> Estimate:
    """No estimate: no quotient could be had."""
    return Estimate(*np.full((3, m), np.nan))


def most_certain(estimates: list[Estimate]) -> Estimate:
    """The estimate of least uncertainty for every measure."""
    uncertainty = np.array([estimate.uncertainty for estimate in estimates])
    best, columns = np.argmin(uncertainty, axis=0), np.arange(uncertainty.shape[1])
    value, step = (
        np.array([getattr(estimate, name) for estimate in estimates])[best, columns]
        for name in ("value", "step")
    )
    return Estimate(value, step, uncertainty[best, columns])


def plateau(quotient: np.ndarray, steps: np.ndarray, noise: np.ndarray) -> Estimate:
    """Extrapolate quotients (n, m) at falling steps (n,) to step zero; the most certain result.

    Up to three neighbouring steps are extrapolated by a polynomial in the step. The uncertainty of
    a result has two parts. Rounding, ``noise`` (m,) over the step, grows as the steps shrink.
    Truncation is what still changes towards smaller steps beyond their rounding. Where the sum is
    least the step study has its plateau.
    """
    chain = _chain(steps)
    quotient, steps = quotient[chain], steps[chain]
    found, lower = [], None
    for order in range(min(3, len(steps))):
        value, rounding = _extrapolated(quotient, steps, order, noise)
        truncation = _truncation(value, rounding, lower)
        found += [
            Estimate(v, np.full(v.size, h), r + t)
            for v, h, r, t in zip(value, steps, rounding, truncation, strict=False)
        ]
        lower = value
    return most_certain(found)


def _chain(steps: np.ndarray) -> list[int]:
    """Places of falling steps, thinned until neighbours differ by ``LEAST_RATIO``."""
    chosen = [0]
    for i in range(1, len(steps)):
        if steps[chosen[-1]] >= LEAST_RATIO * steps[i]:
            chosen.append(i)
    return chosen


def _extrapolated(quotient, steps, order: int, noise):
    """Values at step zero of the polynomials through ``order + 1`` neighbours, and their rounding."""
    values, rounding = [], []
    for first in range(len(steps) - order):
        h = steps[first : first + order + 1]
        others = [np.delete(h, i) for i in range(order + 1)]
        weights = np.array([np.prod(o / (o - own)) for o, own in zip(others, h, strict=True)])
        values.append(weights @ quotient[first : first + order + 1])
        rounding.append(np.linalg.norm(weights / h) * noise)
    return np.array(values), np.array(rounding)


def _truncation(value, rounding, lower) -> np.ndarray:
    """Change to the next two results at smaller steps, beyond their rounding.

    The last result is compared with the last one of the ``lower`` order; a single quotient cannot
    be compared with anything.
    """
    truncation = np.zeros_like(value)
    for k in range(len(value) - 1):
        for other in range(k + 1, min(k + 3, len(value))):
            change = np.abs(value[k] - value[other]) - rounding[other]
            truncation[k] = np.maximum(truncation[k], change)
    if lower is not None:
        truncation[-1] = np.abs(value[-1] - lower[-1])
    elif len(value) > 1:
        truncation[-1] = np.inf
    return truncation


def fitted(changes: np.ndarray, values: np.ndarray, noise: np.ndarray) -> Estimate:
    """Slope at zero of the parabola fitted to values (n, m) at parameter changes (n,).

    Many values average the rounding noise out where the usable range is short. The standard error
    is scaled up where the residual is larger than ``noise`` (m,).
    """
    reach = np.abs(changes).max()
    basis = np.vander(changes / reach, 3, increasing=True)
    inverse = np.linalg.pinv(basis)
    coefficients = inverse @ values
    residual = values - basis @ coefficients
    spread = np.sqrt(np.sum(residual**2, axis=0) / (len(changes) - 3))
    error = np.linalg.norm(inverse[1]) * np.maximum(spread, noise) / reach
    return Estimate(coefficients[1] / reach, np.full(noise.size, reach), error)


def error_scale(analytic: np.ndarray) -> np.ndarray:
    """What errors are relative to: each entry of (m, P), or its row's largest where nearly zero."""
    size = np.abs(analytic)
    largest = size.max(axis=1, keepdims=True)
    scale = np.where(size < NEARLY_ZERO * largest, largest, size)
    return np.where(scale > 0.0, scale, 1.0)

"""Designs away from the drawn seal, and the limit of difference quotients, for gradient checks."""

import numpy as np

from seal_mdao.model import SealModel

DISTANCE = 0.3
"""Distance from the drawn seal, mm."""
LEAST_RATIO = 1.7


def design_away(model: SealModel, seed: int, distance: float = DISTANCE) -> np.ndarray:
    """Boundary offsets and door radius, shape (26,), mm.

    Random offsets, the largest of which is ``distance``; the radius is larger by ``distance``.
    """
    offsets = np.random.default_rng(seed).uniform(-1.0, 1.0, model.n_offsets)
    offsets *= distance / np.abs(offsets).max()
    return np.append(offsets, model.drawn_door_radius + distance)


def second_order_limit(steps: np.ndarray, quotients: np.ndarray) -> np.ndarray:
    """Limit of second-order difference quotients (n, m) at falling steps (n,): Richardson's.

    From the first step and the next one that is smaller by at least ``LEAST_RATIO``.

    Raises
    ------
    ValueError
        When there is none.
    """
    smaller = np.flatnonzero(steps * LEAST_RATIO <= steps[0])
    if smaller.size == 0:
        raise ValueError(f"the steps {steps} are too near to each other")
    next_one = smaller[0]
    ratio = (steps[0] / steps[next_one]) ** 2
    return quotients[next_one] + (quotients[next_one] - quotients[0]) / (ratio - 1.0)

"""Designs away from the nominal seal, for gradient checks."""

import numpy as np

from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.seal import Seal

DISTANCE = 0.3
"""Distance from the nominal seal, mm."""


def design_away(model: Seal, seed: int, distance: float = DISTANCE) -> np.ndarray:
    """Boundary offsets and door radius, shape (26,), mm.

    Random offsets, the largest of which is ``distance``; the radius is larger by ``distance``.
    """
    offsets = np.random.default_rng(seed).uniform(-1.0, 1.0, model.n_offsets)
    offsets *= distance / np.abs(offsets).max()
    return np.append(offsets, options_of(model).nominal_door_radius + distance)

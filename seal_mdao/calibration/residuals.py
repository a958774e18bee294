"""Residuals of a fit: weighted differences of law and data.

- relative: (P - data) / max(|data|, floor), the same relative error of every reading. Seals work at
  moderate stretches, where stresses are small compared with those at the end of a tensile test.
- absolute: (P - data) / largest |data| of all, the same error in kPa everywhere.

The floor, a fraction of the largest stress of the mode, limits the weight of readings near zero, which
are noise. Differences are divided by the square root of the number of readings in their mode: a tensile
test of a thousand readings has the same weight as a biaxial one of ten.
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.calibration.data import MaterialTests
from seal_mdao.calibration.modes import MODES, response

WEIGHTINGS = ("relative", "absolute")
FLOOR = 0.02
"""Floor of the relative weighting, as a fraction of the largest stress of a mode."""
LATERAL_FLOOR = 0.01
"""Smallest lateral strain to which differences of lateral stretch are related."""


@dataclass(frozen=True, eq=False)
class Part:
    """Readings of one mode with the scales of their residuals.

    Attributes
    ----------
    mode : Mode
    data : ModeData
    stress_scale, lateral_scale : ndarray, shape (m,)
        The second is None where the free stretch is not fitted.
    """

    mode: object
    data: object
    stress_scale: np.ndarray
    lateral_scale: np.ndarray | None

    def evaluate(self, law, names):
        """Evaluate weighted differences and their derivatives in the constants ``names``."""
        found = response(law, self.mode, self.data.stretch)
        # r_i = (P(lambda_i) - P_i) / s_i, and likewise for the lateral stretch
        rows = [law.names.index(name) for name in names]
        values = [(found.stress - self.data.stress) / self.stress_scale]
        slopes = [found.stress_rates[rows] / self.stress_scale]
        if self.lateral_scale is not None:
            values.append((found.lateral - self.data.lateral) / self.lateral_scale)
            slopes.append(found.lateral_rates[rows] / self.lateral_scale)
        return np.concatenate(values), np.concatenate(slopes, axis=1).T


@dataclass(frozen=True, eq=False)
class Residuals:
    """Weighted differences of all modes as functions of a law.

    Attributes
    ----------
    parts : tuple of Part
    """

    parts: tuple

    def __call__(self, law, names) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate differences (m,) and derivatives (m, k) in the constants ``names``."""
        found = [part.evaluate(law, names) for part in self.parts]
        return np.concatenate([f[0] for f in found]), np.concatenate([f[1] for f in found])


def residuals(tests: MaterialTests, weighting: str = "relative", lateral: bool = False):
    """Build the ``Residuals`` of some data.

    Parameters
    ----------
    tests : MaterialTests
    weighting : {"relative", "absolute"}
    lateral : bool
        Whether measured lateral stretches are fitted as well.
    """
    if weighting not in WEIGHTINGS:
        raise ValueError(f"weighting must be one of {', '.join(WEIGHTINGS)}, got {weighting!r}")
    scales, parts = weighted_by(tests, weighting), []
    for name, data in tests.modes.items():
        # s_i sqrt(m): every mode has the weight of one reading
        root = np.sqrt(data.stretch.size)
        scale = scales[name] * root
        across = None
        if lateral:
            strain = data.lateral - 1.0
            largest = max(np.abs(strain).max(), LATERAL_FLOOR)
            across = np.maximum(_scale(strain, largest, weighting), LATERAL_FLOOR) * root
        parts.append(Part(MODES[name], data, scale, across))
    return Residuals(tuple(parts))


def weighted_by(tests: MaterialTests, weighting: str) -> dict[str, np.ndarray]:
    """Compute the scale of the stress residuals, kPa, for every reading of every mode."""
    largest = max(np.abs(data.stress).max() for data in tests.modes.values())
    return {name: _scale(data.stress, largest, weighting) for name, data in tests.modes.items()}


def _scale(values, largest, weighting):
    # absolute: the largest stress of all modes
    if weighting == "absolute":
        return np.full(values.shape, largest)
    # relative: |P_i|, at least the floor
    return np.maximum(share_of(values), 1e-6 * largest)


def share_of(readings: np.ndarray) -> np.ndarray:
    """Compute the reference of relative differences: |reading|, at least the floor."""
    size = np.abs(readings)
    return np.maximum(size, FLOOR * size.max())

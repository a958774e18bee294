"""Residuals of a fit: weighted differences of law and data.

- relative: (P - data) / max(|data|, floor), the same relative error of every reading. Seals work at
  moderate stretches, where stresses are small compared with those at the end of a tensile test.
- absolute: (P - data) / largest |data| of all, the same error in kPa everywhere.

The floor, a fraction of the largest stress of the mode, limits the weight of readings near zero, which
are noise. Differences are divided by the square root of the number of readings in their mode: a tensile
test of a thousand readings has the same weight as a biaxial one of ten.
"""

from collections.abc import Callable

import numpy as np

from seal_mdao.calibration.cycles import response_to
from seal_mdao.calibration.data import MaterialTests
from seal_mdao.calibration.loading_modes import MODES
from seal_mdao.values import one_of

WEIGHTINGS = ("relative", "absolute")
FLOOR = 0.02
"""Floor of the relative weighting, as a fraction of the largest stress of a mode."""
LATERAL_FLOOR = 0.01
"""Smallest lateral strain to which differences of lateral stretch are related."""


def residuals(tests: MaterialTests, weighting: str = "relative", lateral: bool = False) -> Callable:
    """Build the weighted differences of all modes as a function of a law.

    Parameters
    ----------
    tests : MaterialTests
    weighting : {"relative", "absolute"}
    lateral : bool
        Whether measured lateral stretches are fitted as well.

    Returns
    -------
    callable
        ``differences(law, names)`` returns differences (m,) and their derivatives (m, k) in the
        constants ``names``.
    """
    one_of("weighting", weighting, WEIGHTINGS)
    scales = stress_scales(tests, weighting)

    def differences(law, names):
        values, slopes = [], []
        # rows of the unknowns among the constants of the law
        rows = [law.names.index(name) for name in names]
        for name, data in tests.modes.items():
            found = response_to(law, MODES[name], data)
            columns = [(found.stress, data.stress, found.stress_rates, scales[name])]
            if lateral:
                scale = _lateral_scale(data.lateral - 1.0, weighting)
                columns.append((found.lateral, data.lateral, found.lateral_rates, scale))
            # r_i = (P(lambda_i) - P_i) / (s_i sqrt(m)): every mode has the weight of one reading
            root = np.sqrt(data.stretch.size)
            for computed, measured, rates, scale in columns:
                values.append((computed - measured) / (scale * root))
                slopes.append((rates[rows] / (scale * root)).T)
        return np.concatenate(values), np.concatenate(slopes)

    return differences


def mode_weights(tests: MaterialTests, lateral: bool = False) -> np.ndarray:
    """Compute the weight 1/m of the square of every difference of ``residuals``, with m readings in its
    mode."""
    columns = 2 if lateral else 1
    counts = [data.stretch.size for data in tests.modes.values()]
    return np.concatenate([np.full(columns * m, 1.0 / m) for m in counts])


def stress_scales(tests: MaterialTests, weighting: str) -> dict[str, np.ndarray]:
    """Compute the scale of the stress residuals, kPa, for every reading of every mode."""
    largest = max(np.abs(data.stress).max() for data in tests.modes.values())
    return {name: _scale(data.stress, largest, weighting) for name, data in tests.modes.items()}


def _lateral_scale(strain, weighting):
    # s of lateral strains: as of the stress, at least LATERAL_FLOOR
    largest = max(np.abs(strain).max(), LATERAL_FLOOR)
    return np.maximum(_scale(strain, largest, weighting), LATERAL_FLOOR)


def _scale(values, largest, weighting):
    # absolute: the largest stress of all modes
    if weighting == "absolute":
        return np.full(values.shape, largest)
    # relative: |P_i|, at least the floor
    return np.maximum(relative_to(values), 1e-6 * largest)


def relative_to(readings: np.ndarray) -> np.ndarray:
    """Compute the reference of relative differences: |reading|, at least the floor."""
    size = np.abs(readings)
    return np.maximum(size, FLOOR * size.max())

"""Errors of a fitted law: differences between computed and measured stress."""

from dataclasses import asdict, dataclass

import numpy as np

from seal_mdao.calibration.data import MaterialTests
from seal_mdao.calibration.modes import MODES, nominal_stress
from seal_mdao.calibration.residuals import share_of
from seal_mdao.materials.isotropic import Isotropic


@dataclass(frozen=True)
class FitErrors:
    """Errors of the nominal stress of a law.

    Attributes
    ----------
    readings : int
    rms_kPa, max_kPa : float
        Root of the mean square, and the largest.
    max_at_stretch : float
        Stretch of the largest error.
    rms_relative : float
        Root mean square of differences relative to the readings, with a floor of 2 % of the largest
        reading of the mode; NaN if all readings are zero.
    r2 : float
        Coefficient of determination; NaN if all readings are the same.
    """

    readings: int
    rms_kPa: float
    max_kPa: float
    max_at_stretch: float
    rms_relative: float
    r2: float

    def as_dict(self) -> dict:
        return asdict(self)


def errors_of(law: Isotropic, tests: MaterialTests) -> dict[str, FitErrors]:
    """Compute the errors of every mode, and of all readings together under ``"all"``."""
    found = {
        name: (
            data.stretch,
            data.stress,
            nominal_stress(law, MODES[name], data.stretch),
            share_of(data.stress),
        )
        for name, data in tests.modes.items()
    }
    out = {name: _errors(*columns) for name, columns in found.items()}
    out["all"] = _errors(*map(np.concatenate, zip(*found.values(), strict=True)))
    return out


def _errors(stretch, measured, computed, size) -> FitErrors:
    difference = computed - measured
    worst = int(np.argmax(np.abs(difference)))
    # r2 = 1 - sum (P - P_i)^2 / sum (P_i - mean P)^2
    spread = np.sum((measured - measured.mean()) ** 2)
    # relative errors, where the reference is not zero
    positive = size > 0.0
    relative = difference[positive] / size[positive]
    return FitErrors(
        readings=int(difference.size),
        rms_kPa=float(np.sqrt(np.mean(difference**2))),
        max_kPa=float(abs(difference[worst])),
        max_at_stretch=float(stretch[worst]),
        rms_relative=float(np.sqrt(np.mean(relative**2))) if relative.size else float("nan"),
        r2=float(1.0 - np.sum(difference**2) / spread) if spread > 0.0 else float("nan"),
    )

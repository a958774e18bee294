"""How far a law is from data."""

from dataclasses import asdict, dataclass

import numpy as np

from seal_mdao.calibration.data import MaterialTests
from seal_mdao.calibration.modes import MODES, nominal_stress
from seal_mdao.calibration.residuals import share_of
from seal_mdao.materials.isotropic import Isotropic


@dataclass(frozen=True)
class FitErrors:
    """Differences of nominal stress between a law and readings.

    Attributes
    ----------
    readings : int
    rms_kPa, max_kPa : float
        Root of the mean square, and the largest.
    max_at_stretch : float
        Where the largest one is.
    rms_relative : float
        Root of the mean square of differences over readings, which count as at least 2 % of the
        largest one of their mode; NaN where all readings are zero.
    r2 : float
        1 - sum of squares over that about the mean; NaN when all readings are the same.
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
    """Errors of every mode, and of all readings together under ``"all"``."""
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
    away = computed - measured
    worst = int(np.argmax(np.abs(away)))
    spread = np.sum((measured - measured.mean()) ** 2)
    there = size > 0.0
    share = away[there] / size[there]
    return FitErrors(
        readings=int(away.size),
        rms_kPa=float(np.sqrt(np.mean(away**2))),
        max_kPa=float(abs(away[worst])),
        max_at_stretch=float(stretch[worst]),
        rms_relative=float(np.sqrt(np.mean(share**2))) if share.size else float("nan"),
        r2=float(1.0 - np.sum(away**2) / spread) if spread > 0.0 else float("nan"),
    )

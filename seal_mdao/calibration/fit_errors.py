"""Differences between computed and measured stress of a fitted law: errors by mode, and a table of
all readings with detection of outliers."""

import csv
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

from seal_mdao.calibration.cycles import SoftenedLaw, stress_in
from seal_mdao.calibration.data import MaterialTests
from seal_mdao.calibration.loading_modes import MODES
from seal_mdao.calibration.residuals import relative_to, stress_scales
from seal_mdao.materials.isotropic import Isotropic

LIMIT = 3.5
"""Modified z-score (Iglewicz and Hoaglin, 1993) above which a reading is an outlier."""
LEAST_SPREAD = 1e-3
"""Smallest spread of weighted differences; below it there is only rounding."""


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


def errors_of(law: Isotropic | SoftenedLaw, tests: MaterialTests) -> dict[str, FitErrors]:
    """Compute the errors of every mode, and of all readings together under ``"all"``."""
    columns = {
        name: (data.stretch, data.stress, _computed(law, name, data), relative_to(data.stress))
        for name, data in tests.modes.items()
    }
    # readings of all modes in one column
    columns["all"] = tuple(map(np.concatenate, zip(*columns.values(), strict=True)))
    return {name: _errors(*own) for name, own in columns.items()}


def _computed(law, name, data) -> np.ndarray:
    return stress_in(law, MODES[name], data)


def _errors(stretch, measured, computed, reference) -> FitErrors:
    difference = computed - measured
    worst = int(np.argmax(np.abs(difference)))
    # r2 = 1 - sum (P - P_i)^2 / sum (P_i - mean P)^2
    spread = np.sum((measured - measured.mean()) ** 2)
    # relative errors, where the reference is not zero
    positive = reference > 0.0
    relative = difference[positive] / reference[positive]
    return FitErrors(
        readings=int(difference.size),
        rms_kPa=float(np.sqrt(np.mean(difference**2))),
        max_kPa=float(abs(difference[worst])),
        max_at_stretch=float(stretch[worst]),
        rms_relative=float(np.sqrt(np.mean(relative**2))) if relative.size else float("nan"),
        r2=float(1.0 - np.sum(difference**2) / spread) if spread > 0.0 else float("nan"),
    )


# ---- reading by reading ----


@dataclass(frozen=True)
class Reading:
    """One reading with the response of the law.

    Attributes
    ----------
    mode : str
    stretch : float
    measured_kPa, computed_kPa : float
        Nominal stress.
    difference_kPa : float
        Computed minus measured.
    weighted : float
        The difference weighted as in the fit: relative to the reading, or to the largest one.
    score : float
        Modified z-score: distance of ``weighted`` from the median of all readings, over 1.4826 times the
        median of these distances. It is a number of standard deviations that is robust to outliers.
    outlier : bool
        Whether the score is above 3.5.
    """

    mode: str
    stretch: float
    measured_kPa: float
    computed_kPa: float
    difference_kPa: float
    weighted: float
    score: float
    outlier: bool


def residual_table(found) -> list[Reading]:
    """Tabulate all readings of a ``Fit`` with their differences and scores, mode by mode."""
    # weighted as in the fit, but without the factor sqrt(m) of the modes
    scales, columns = stress_scales(found.tests, found.weighting), {}
    for name, data in found.tests.modes.items():
        computed = _computed(found.tested_law, name, data)
        difference = computed - data.stress
        weighted = difference / scales[name]
        columns[name] = data.stretch, data.stress, computed, difference, weighted
    every = np.concatenate([own[-1] for own in columns.values()])
    median = np.median(every)
    # z = |r - median r| / (1.4826 MAD), with 1.4826 MAD = standard deviation of normal errors
    spread = max(1.4826 * np.median(np.abs(every - median)), LEAST_SPREAD)
    return [
        Reading(name, *map(float, row), float(score), bool(score > LIMIT))
        for name, own in columns.items()
        for *row, score in zip(*own, np.abs(own[-1] - median) / spread, strict=True)
    ]


def write_residuals(rows: list[Reading], path) -> Path:
    """Write the table as CSV."""
    path = Path(path)
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, [own.name for own in fields(Reading)])
        table.writeheader()
        table.writerows(map(asdict, rows))
    return path

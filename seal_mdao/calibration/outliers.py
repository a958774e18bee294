"""Readings one by one: how far a fitted law is from each, and which do not go with the others."""

import csv
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

from seal_mdao.calibration.fit import Fit
from seal_mdao.calibration.modes import MODES, nominal_stress
from seal_mdao.calibration.residuals import weighted_by

LIMIT = 3.5
"""Modified z-score (Iglewicz and Hoaglin, 1993) above which a reading is an outlier."""
LEAST_SPREAD = 1e-3
"""Of weighted differences: those of data without scatter are rounding."""


@dataclass(frozen=True)
class Reading:
    """One reading beside the law.

    Attributes
    ----------
    mode : str
    stretch : float
    measured_kPa, computed_kPa : float
        Nominal stress.
    difference_kPa : float
        Computed less measured.
    weighted : float
        The difference as the fit weights it: over the reading, or over the largest one.
    score : float
        Distance of ``weighted`` from the median of all readings, over 1.4826 times the median of these
        distances: the number of standard deviations of normal errors, which no outlier changes.
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


def residual_table(found: Fit) -> list[Reading]:
    """All readings of a fit with their differences and scores, mode by mode."""
    computed = {
        name: nominal_stress(found.law, MODES[name], data.stretch)
        for name, data in found.tests.modes.items()
    }
    scales = weighted_by(found.tests, found.weighting)
    weighted = {
        name: (computed[name] - data.stress) / scales[name]
        for name, data in found.tests.modes.items()
    }
    every = np.concatenate(list(weighted.values()))
    middle = np.median(every)
    # 1.4826 MAD is the standard deviation of normal errors
    spread = max(1.4826 * np.median(np.abs(every - middle)), LEAST_SPREAD)
    rows = []
    for name, data in found.tests.modes.items():
        scores = np.abs(weighted[name] - middle) / spread
        columns = (
            data.stretch, data.stress, computed[name], computed[name] - data.stress,
            weighted[name], scores,
        )  # fmt: skip
        rows += [
            Reading(name, *map(float, row), bool(row[-1] > LIMIT))
            for row in zip(*columns, strict=True)
        ]
    return rows


def write_residuals(rows: list[Reading], path) -> Path:
    """Write the table as CSV."""
    path = Path(path)
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, [own.name for own in fields(Reading)])
        table.writeheader()
        table.writerows(map(asdict, rows))
    return path

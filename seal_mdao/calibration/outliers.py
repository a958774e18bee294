"""Table of residuals of a fit, reading by reading, with detection of outliers."""

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
"""Smallest spread of weighted differences; below it there is only rounding."""


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


def residual_table(found: Fit) -> list[Reading]:
    """Tabulate all readings of a fit with their differences and scores, mode by mode."""
    computed = {
        name: nominal_stress(found.law, MODES[name], data.stretch)
        for name, data in found.tests.modes.items()
    }
    # as in the fit, but without the factor sqrt(m) of the modes
    scales = weighted_by(found.tests, found.weighting)
    weighted = {
        name: (computed[name] - data.stress) / scales[name]
        for name, data in found.tests.modes.items()
    }
    every = np.concatenate(list(weighted.values()))
    median = np.median(every)
    # z = |r - median r| / (1.4826 MAD), with 1.4826 MAD = standard deviation of normal errors
    spread = max(1.4826 * np.median(np.abs(every - median)), LEAST_SPREAD)
    rows = []
    for name, data in found.tests.modes.items():
        scores = np.abs(weighted[name] - median) / spread
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

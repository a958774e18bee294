"""Data of material tests, and their CSV file.

    # comments begin with a hash
    mode,stretch,stress_kPa
    uniaxial,1.24,230
    planar,1.21,240
    equibiaxial,1.12,240

``mode`` is uniaxial, planar or equibiaxial; ``stretch`` is length over undeformed length, below 1 in
compression; ``stress_kPa`` is the nominal stress, force over undeformed area, negative in
compression. A fourth column ``lateral_stretch`` holds the stretch of the free directions, for
compressible laws. The order of the columns is free.

The order of the readings matters for cyclic tests alone: where the stretch of a mode goes back, its
readings stay in the order of the test.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seal_mdao.calibration.cycles import unloadings
from seal_mdao.calibration.loading_modes import MODES
from seal_mdao.calibration.measurement_files import MaterialDataError, read_rows

COLUMNS = ("mode", "stretch", "stress_kPa")
LATERAL = "lateral_stretch"
STRETCH_RANGE = (0.01, 20.0)
"""Range of stretches in a file; others indicate wrong units, for rubber breaks at 12 at most."""
LARGEST_STRESS = 1e9
"""Largest admissible stress, kPa."""
NEAR_ONE = 0.02
"""Distance from a stretch of 1 within which the sign of a stress is not checked."""


@dataclass(frozen=True, eq=False)
class ModeData:
    """Readings of one mode, sorted by stretch; those of a cyclic test in its order.

    Attributes
    ----------
    stretch, stress : ndarray, shape (m,)
        Stress in kPa.
    lateral : ndarray, shape (m,), or None
    unloadings : int
        Number of unloadings, 0 unless the test is cyclic; see ``cycles.unloadings``.
    """

    stretch: np.ndarray
    stress: np.ndarray
    lateral: np.ndarray | None = None
    unloadings: int = 0

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest stretch, the undeformed state included."""
        return min(1.0, *self.stretch), max(1.0, *self.stretch)

    def between(self, lower: float, upper: float) -> "ModeData":
        """Select the readings with a stretch from ``lower`` to ``upper``."""
        keep = (self.stretch >= lower) & (self.stretch <= upper)
        lateral = None if self.lateral is None else self.lateral[keep]
        return ModeData(self.stretch[keep], self.stress[keep], lateral)


@dataclass(frozen=True, eq=False)
class MaterialTests:
    """Readings of material tests by mode, and their source.

    Attributes
    ----------
    modes : dict of str to ModeData
        In the order of ``MODES``; only modes that were tested. Readings at a stretch of 1 are dropped:
        their stress is zero by definition.
    source : str
        Name of the file, for messages.
    """

    modes: dict
    source: str = "data"

    @property
    def count(self) -> int:
        """Number of readings."""
        return sum(data.stretch.size for data in self.modes.values())

    @property
    def cycles(self) -> str:
        """Description of a cyclic test for messages."""
        counts = [f"{d.unloadings} in {name}" for name, d in self.modes.items() if d.unloadings]
        return f"this is a cyclic test (unloadings: {', '.join(counts)})"

    @property
    def has_lateral(self) -> bool:
        """Whether lateral stretches were measured in every mode."""
        return all(data.lateral is not None for data in self.modes.values())

    @property
    def cyclic(self) -> bool:
        """Whether a mode has unloadings."""
        return any(data.unloadings for data in self.modes.values())

    def between(self, lower: float, upper: float) -> "MaterialTests":
        """Select the readings with a stretch from ``lower`` to ``upper``.

        Raises
        ------
        MaterialDataError
            If no reading remains, and for cyclic tests, whose history would be cut.
        """
        if self.cyclic:
            raise MaterialDataError(
                f"{self.source}: {self.cycles}; a range of stretches cannot be selected from a "
                "cyclic test, because the stress depends on the largest earlier stretch; leave out "
                "the range of stretches"
            )
        cut = {name: data.between(lower, upper) for name, data in self.modes.items()}
        cut = {name: data for name, data in cut.items() if data.stretch.size}
        if not cut:
            raise MaterialDataError(
                f"{self.source}: no reading has a stretch between {lower:g} and {upper:g}; widen "
                "the range of stretches"
            )
        return MaterialTests(cut, self.source)


def material_tests(readings: dict, source: str = "data") -> MaterialTests:
    """Build tests of arrays: ``{"uniaxial": (stretch, stress), "planar": (stretch, stress, lateral)}``.

    Raises
    ------
    MaterialDataError
        For an unknown mode, arrays that do not fit each other, values that cannot be readings.
    """
    rows = []
    for mode, columns in readings.items():
        # stretch, stress and perhaps lateral stretch, of one length
        arrays = [np.ravel(np.asarray(column, float)) for column in columns]
        if len(arrays) not in (2, 3) or len({array.size for array in arrays}) > 1:
            raise MaterialDataError(
                f"{source}: {mode} needs arrays of stretch, stress and optionally lateral stretch "
                f"of equal length, got lengths {[array.size for array in arrays]}"
            )
        for i, numbers in enumerate(zip(*arrays, strict=True)):
            _check(f"{source}, {mode}, reading {i + 1}", mode, *numbers)
            rows.append((mode, *numbers))
    return _collected(rows, source)


def read_tests(path) -> MaterialTests:
    """Read a CSV file as described at the top of this module.

    Raises
    ------
    MaterialDataError
        In one line: file, line, column, what is wrong and what is allowed.
    """
    path, rows = Path(path), []
    for where, found in read_rows(path, COLUMNS, (LATERAL,), ("mode",)):
        # in this order, whatever the order of the columns
        row = tuple(found[column] for column in (*COLUMNS, LATERAL) if column in found)
        _check(where, *row)
        rows.append(row)
    return _collected(rows, str(path))


def _check(where: str, mode: str, stretch: float, stress: float, lateral: float = 1.0) -> None:
    """Validate one reading."""
    low, high = STRETCH_RANGE
    checks = [
        (mode in MODES, "mode", f"unknown mode {mode[:40]!r}; allowed are {', '.join(MODES)}")
    ]
    for column, value in (("stretch", stretch), (LATERAL, lateral)):
        ratio, limits = (
            "a stretch is the deformed length over the undeformed length",
            f"{low:g} and {high:g}",
        )
        checks += [
            (np.isfinite(value), column, f"{value} is not a finite number"),
            (value > 0.0, column, f"{value:g} is not positive; {ratio}"),
            (low <= value <= high, column, f"{value:g} is not between {limits}; {ratio}"),
        ]
    # tension has lambda > 1 and P > 0, compression lambda < 1 and P < 0
    opposite = (stretch - 1.0) * stress < 0.0 and abs(stretch - 1.0) > NEAR_ONE
    checks += [
        (abs(stress) <= LARGEST_STRESS, "stress_kPa",
         f"{stress:g} is not a number between -{LARGEST_STRESS:g} and {LARGEST_STRESS:g} kPa"),
        (not opposite, "stretch",
         f"{stretch:g} has a stress of {stress:g} kPa with the wrong sign; compression is a stretch "
         "below 1 with a negative stress (is this a strain?)"),
    ]  # fmt: skip
    # the first rule that is broken is reported
    for valid, column, text in checks:
        if not valid:
            raise MaterialDataError(f"{where}, column {column}: {text}")


def _collected(rows, source: str) -> MaterialTests:
    modes = {}
    for name in MODES:
        every = [row[1:] for row in rows if row[0] == name]
        # at lambda = 1 there is no information but that of the order
        count = unloadings([row[0] for row in every])
        own = [row for row in every if row[0] != 1.0]
        if own:
            # sorted by stretch, unless the order is that of cycles
            columns = np.array(own if count else sorted(own)).T
            lateral = columns[2] if len(columns) > 2 else None
            modes[name] = ModeData(columns[0], columns[1], lateral, count)
            if not np.any(modes[name].stress):
                raise MaterialDataError(
                    f"{source}: every stress of the mode {name} is zero; correct or remove these "
                    "readings"
                )
    if not modes:
        raise MaterialDataError(
            f"{source}: every reading has the stretch 1, so there is nothing to fit; add readings "
            "at other stretches"
        )
    return MaterialTests(modes, source)

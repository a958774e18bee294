"""Data of relaxation tests, and their CSV file.

    # stress at a stretch held at 1.5; time counts from the start of loading
    time_s,stress_kPa,temperature_degC
    0.5,812,23
    1.0,790,23

``time_s`` is the time since the loading began. In place of ``stress_kPa`` a file may have ``force_N`` or
``ratio`` (of the force to an earlier one): the scale is not used. Optional columns are
``temperature_degC``, constant during a test, and ``test``, a name. Readings of one ``test`` share the
force of the long-term law at all temperatures, those of different tests (other specimens or other
strains) do not. Without the column every temperature is a test of its own.
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.calibration.measurement_files import MaterialDataError, read_rows
from seal_mdao.materials.viscoelastic import ABSOLUTE_ZERO
from seal_mdao.values import real

TIME, TEMPERATURE, TEST = "time_s", "temperature_degC", "test"
FORCES = ("stress_kPa", "force_N", "ratio")
LONGEST = 1e12
"""Largest time in a file, s: 30,000 years."""
LARGEST_FORCE = 1e12
HOTTEST = 1000.0
"""Largest temperature, degrees Celsius."""
LEAST_READINGS = 3
"""Smallest number of readings in a curve."""


@dataclass(frozen=True, eq=False)
class RelaxationCurve:
    """Readings of one test at one temperature, sorted by time.

    Attributes
    ----------
    test : str
        Empty in files without names.
    temperature : float or None
        Degrees Celsius.
    time, force : ndarray, shape (m,)
        Seconds since the loading began, and the magnitude of stress or force in the unit of the file.
    """

    test: str
    temperature: float | None
    time: np.ndarray
    force: np.ndarray

    @property
    def label(self) -> str:
        """Test and temperature for messages and legends."""
        degrees = "" if self.temperature is None else f"{self.temperature:g} °C"
        return ", ".join(part for part in (self.test, degrees) if part) or "data"


@dataclass(frozen=True, eq=False)
class RelaxationTests:
    """Relaxation curves and their source.

    Attributes
    ----------
    curves : tuple of RelaxationCurve
    ramp : float
        Duration of the loading at a constant rate, s; 0 for a step.
    source : str
        Name of the file, for messages.
    unused : int
        Number of readings that were left out: those during the ramp, or at time zero.
    """

    curves: tuple
    ramp: float = 0.0
    source: str = "data"
    unused: int = 0

    @property
    def count(self) -> int:
        """Number of readings."""
        return sum(curve.time.size for curve in self.curves)

    @property
    def temperatures(self) -> tuple[float, ...]:
        """Temperatures of the tests, in ascending order; empty where none was given."""
        return tuple(sorted({c.temperature for c in self.curves if c.temperature is not None}))

    @property
    def scales(self) -> list[int]:
        """Number of the test to which every curve belongs, from 0."""
        # without names, every temperature is a test of its own
        keys = [c.test or c.temperature for c in self.curves]
        distinct = list(dict.fromkeys(keys))
        return [distinct.index(key) for key in keys]


def relaxation_tests(curves, ramp: float = 0.0, source: str = "data") -> RelaxationTests:
    """Build tests of arrays.

    Parameters
    ----------
    curves : sequence of tuple
        ``(time, force)``, ``(time, force, temperature)`` or ``(time, force, temperature, test)``.
    ramp : float
        Duration of the loading, s.
    source : str

    Raises
    ------
    MaterialDataError
        For values that cannot be readings.
    ValueError
        For a ramp that is negative or not finite.
    """
    curves, rows = list(curves), []
    if len({tuple(own[2:3]) in ((), (None,)) for own in curves}) > 1:
        raise MaterialDataError(
            f"{source}: some relaxation curves have a temperature, others do not; give a "
            "temperature for all curves, or for none"
        )
    for i, (time, force, *more) in enumerate(curves, 1):
        temperature, test = (*more, None, "")[:2]
        arrays = [np.ravel(np.asarray(column, float)) for column in (time, force)]
        if arrays[0].size != arrays[1].size:
            raise MaterialDataError(
                f"{source}: curve {i} has {arrays[0].size} times but {arrays[1].size} forces; a "
                "relaxation curve needs one force for every time"
            )
        for k, (t, f) in enumerate(zip(*map(np.ndarray.tolist, arrays), strict=True), 1):
            row = {TIME: t, FORCES[1]: f, TEST: test or f"curve {i}"}
            row |= {} if temperature is None else {TEMPERATURE: float(temperature)}
            rows.append((f"{source}, curve {i}, reading {k}", row))
    return _collected(rows, ramp, source)


def read_relaxation(path, ramp: float = 0.0) -> RelaxationTests:
    """Read a CSV file as described at the top of this module.

    Parameters
    ----------
    path : path-like
    ramp : float
        Duration of the loading at a constant rate, s; earlier readings are left out.

    Raises
    ------
    MaterialDataError
        In one line: file, line, column, what is wrong and what is allowed.
    ValueError
        For a ramp that is negative or not finite.
    """
    rows = read_rows(path, (TIME, FORCES), (TEMPERATURE, TEST), (TEST,))
    return _collected(rows, ramp, str(path))


def _collected(rows, ramp: float, source: str) -> RelaxationTests:
    ramp = real("ramp", ramp, 0.0, LONGEST)
    (force,) = (name for name in FORCES if name in rows[0][1]) if rows else FORCES[:1]
    groups, unused = {}, 0
    for where, row in rows:
        _check(where, row, force)
        # in the ramp, or at time zero, the strain is not held yet
        if row[TIME] < ramp or row[TIME] == 0.0:
            unused += 1
            continue
        key = row.get(TEST, ""), row.get(TEMPERATURE)
        # a curve for every test and temperature
        groups.setdefault(key, []).append((row[TIME], row[force]))
    if not groups:
        raise MaterialDataError(
            f"{source}: no reading is later than the end of the loading ramp at {ramp:g} s; add "
            "later readings or give a shorter ramp"
        )
    curves = tuple(
        _curve(source, *key, np.array(own), force)
        for key, own in sorted(groups.items(), key=lambda item: (item[0][0], item[0][1] or 0.0))
    )
    return RelaxationTests(curves, ramp, source, unused)


def _check(where: str, row: dict, force: str) -> None:
    """Validate one reading."""
    time, temperature = row[TIME], row.get(TEMPERATURE, 0.0)
    checks = (
        (np.isfinite(time), TIME, f"{time} is not a finite number"),
        (time >= 0.0, TIME, f"{time:g} is negative; time counts from the start of the loading"),
        (time <= LONGEST, TIME, f"{time:g} s is longer than the limit of {LONGEST:g} s"),
        (abs(row[force]) <= LARGEST_FORCE, force,
         f"{row[force]:g} is not a number between -{LARGEST_FORCE:g} and {LARGEST_FORCE:g}"),
        (ABSOLUTE_ZERO < temperature <= HOTTEST, TEMPERATURE,
         f"{temperature:g} is not between {ABSOLUTE_ZERO:g} and {HOTTEST:g} degrees Celsius"),
        (row.get(TEST, "-") != "", TEST, "the name of the test is missing"),
    )  # fmt: skip
    # the first rule that is broken is reported
    for valid, column, text in checks:
        if not valid:
            raise MaterialDataError(f"{where}, column {column}: {text}")


def _curve(source, test, temperature, readings, force) -> RelaxationCurve:
    readings = readings[np.argsort(readings[:, 0], kind="stable")]
    time, values = readings.T
    sign = np.sign(np.median(values))
    found = RelaxationCurve(test, temperature, time, sign * values)
    where = f"{source}: {found.label}"
    if np.unique(time).size < LEAST_READINGS:
        raise MaterialDataError(
            f"{where}: {np.unique(time).size} different times are too few; a relaxation curve "
            f"needs at least {LEAST_READINGS}"
        )
    wrong = np.flatnonzero(found.force <= 0.0)
    if wrong.size or sign == 0.0:
        at = time[wrong[0]]
        raise MaterialDataError(
            f"{where}: {force} is zero or changes sign at {at:g} s; in a relaxation test at "
            "constant strain the force decreases but keeps its sign, so correct the zero point or "
            "remove the reading"
        )
    return found

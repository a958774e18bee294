"""What an OpenMDAO recorder file says about an optimisation."""

import re
import sqlite3
from dataclasses import dataclass, field

import numpy as np
import openmdao.api as om

from seal_mdao.recording import run_log
from seal_mdao.recording.plain_reading import reading
from seal_mdao.recording.seal_inputs import read_seals
from seal_mdao.recording.settings import open_cases, recorded_problem
from seal_mdao.seals.door.door_seal import DoorSeal

NO_LIMIT = 1e20
"""Limits from here on are OpenMDAO's way of saying that there is none."""
NAMES = {
    "gap_square_sum": "sum of squared gaps",
    "gap_square_integral": "integral of the squared gap",
    "stress_norm": "norm of all stresses",
    "patch_pressure": "contact pressure of patch",
    "reaction_curve": "vertical reaction along the path",
    "area": "area of the section",
    "boundary_offsets": "boundary offsets",
    "door_radius": "corner radius of the door",
}
"""Variables in words."""
DESIGN_UNITS = {"boundary_offsets": "mm", "door_radius": "mm"}
"""Units of inputs that a recorder leaves out unless it is told otherwise."""


@dataclass(frozen=True, eq=False)
class Constraint:
    """One scalar constraint along the history.

    Attributes
    ----------
    name : str
        Recorded name, with the entry in brackets for an array.
    values : ndarray, shape (n,)
    lower, upper : float
        Limits; infinite where there is none.
    units : str or None
    """

    name: str
    values: np.ndarray
    lower: float
    upper: float

    def violation(self) -> np.ndarray:
        """Relative excess over the nearer limit, 0 where satisfied, shape (n,)."""
        excess = np.zeros(len(self.values))
        for limit, over in ((self.upper, 1.0), (self.lower, -1.0)):
            if np.isfinite(limit):
                size = abs(limit) or 1.0
                excess = np.maximum(excess, over * (self.values - limit) / size)
        return excess

    def use(self) -> np.ndarray:
        """How far the limits are used up: 1 at the nearer one, more when it is violated, (n,).

        The distance to a limit is measured in units of the limit (of 1 when that is zero), so that
        for a positive upper limit this is value / limit.
        """
        uses = np.full(len(self.values), -np.inf)
        for limit, over in ((self.upper, 1.0), (self.lower, -1.0)):
            if np.isfinite(limit):
                uses = np.maximum(uses, 1.0 + over * (self.values - limit) / (abs(limit) or 1.0))
        return uses


def label(name: str) -> str:
    """A recorded variable in words; its entry counts from 1."""
    entry = re.fullmatch(r"(.*)\[(\d+)\]", name)
    if entry is None:
        return NAMES.get(_last(name), _last(name).replace("_", " "))
    base, number = label(entry[1]), int(entry[2]) + 1
    return f"stress {number}" if base == "von mises" else f"{base} {number}"


@dataclass(frozen=True, eq=False)
class RecordedOptimization:
    """Major iterations of an optimisation, the start first.

    Attributes
    ----------
    objective_name : str
    objective : ndarray, shape (n,)
    constraints : list of Constraint
    design : dict of str to ndarray
        Design variables along the history, (n, size) each.
    major : bool
        False when the file does not tell major iterations apart: then every evaluation is a point.
    evaluations : int
        Recorded model evaluations.
    seal : DoorSeal or None
        The seal that was optimised, when the file holds it.
    settings : dict
        Further arguments of ``seal_problem``, when the file holds them.
    runs : list of LoggedRun
        The runs that wrote the file, when it is that of a ``RestartRecorder``.
    units : dict of str to str
        Units of the recorded variables that have any.
    bounds : dict of str to (ndarray, ndarray)
        Lower and upper bounds of the design variables, infinite where there are none.
    seals : list of RecordedSeal
        Every ``SealGroup`` of the model with what it used at the points.
    kind : str
        "optimisation", "doe" (design of experiments), or "runs" of the model by another driver.
    failed : int
        Recorded evaluations that failed, or gave values that are not finite.
    analyses : ndarray, shape (n,)
        Number of the evaluation, from 1, that each point is.
    """

    objective_name: str
    objective: np.ndarray
    constraints: list
    design: dict
    major: bool
    evaluations: int
    seal: DoorSeal | None
    settings: dict = field(default_factory=dict)
    runs: list = field(default_factory=list)
    units: dict = field(default_factory=dict)
    bounds: dict = field(default_factory=dict)
    seals: list = field(default_factory=list)
    kind: str = "optimisation"
    failed: int = 0
    analyses: np.ndarray | None = None

    @property
    def cut_off(self) -> bool:
        """Whether the last run never came to its end, so that the last point is no result."""
        return bool(self.runs) and self.runs[-1].cut_off

    @property
    def objective_ratio(self) -> np.ndarray:
        """Objective over its start, shape (n,)."""
        return self.objective / self.objective[0]

    @property
    def max_violation(self) -> np.ndarray:
        """Largest relative constraint violation, shape (n,)."""
        none = np.zeros(len(self.objective))
        return np.max([none, *(c.violation() for c in self.constraints)], axis=0)

    def design_at(self, index: int) -> tuple[np.ndarray, dict]:
        """Boundary offsets (mm) and scalar parameters of one point of the first seal, as ``analyze``
        takes them.

        Raises
        ------
        ValueError
            When the file does not hold them.
        """
        offsets, parameters = self.seals[0].design(index) if self.seals else (None, {})
        if offsets is None:
            raise ValueError("the recorder file does not hold the boundary offsets of a seal")
        return offsets, parameters


def unit_of(history: RecordedOptimization, name: str) -> str:
    """Unit of a recorded variable, with a raised exponent; empty when it has none."""
    name = name.split("[")[0]
    text = history.units.get(name, DESIGN_UNITS.get(_last(name), ""))
    return re.sub(r"\*\*(\d)", lambda power: "⁰¹²³⁴⁵⁶⁷⁸⁹"[int(power[1])], text)


def read_optimization(path, given: dict | None = None) -> RecordedOptimization:
    """Read the history of an optimisation, or of another driver, from its ``SqliteRecorder`` file.

    The points are the major iterations when the driver's derivatives were recorded: each begins
    with a gradient. The last evaluation, or the case that the problem itself recorded at the end,
    closes the history, unless the run was cut off: then the last major iteration does. Values are in the
    units in which objective, constraints and design variables were declared.

    Parameters
    ----------
    path : str or Path
    given : dict of str to ndarray, optional
        Inputs of seals that are the same at all points and may not be in the file, by absolute names.

    Raises
    ------
    ValueError
        For a file that is not there, is no recorder file, is damaged, or holds no good driver case.
    """
    with reading(path):
        return _read(path, given)


def _read(path, given) -> RecordedOptimization:
    reader = open_cases(path)
    names = reader.list_cases("driver", recurse=False, out_stream=None)
    evaluated = [case for case in map(reader.get_case, names) if case.success and _finite(case)]
    if not evaluated:
        raise ValueError(f"{path} holds no case of a driver")
    if not dict(evaluated[0].get_objectives(scaled=False)):
        raise ValueError(f"{path} holds no objective, so there is nothing to follow")
    problem, runs = recorded_problem(reader), run_log.read(path)
    cases, major = _points(reader, path, evaluated, bool(runs) and runs[-1].cut_off)
    numbers = {case.counter: number for number, case in enumerate(evaluated, start=1)}
    objective = _stacked([case.get_objectives(scaled=False) for case in cases])
    objective_name = next(iter(objective))
    return RecordedOptimization(
        objective_name=objective_name,
        objective=objective[objective_name][:, 0],
        constraints=_constraints(reader, cases),
        design=_stacked([case.get_design_vars(scaled=False) for case in cases]),
        major=major,
        evaluations=len(names),
        seal=problem and problem.seal,
        seals=read_seals(reader, cases, given),
        kind=_kind(reader),
        failed=len(names) - len(evaluated),
        settings=problem.settings if problem else {},
        runs=runs,
        units=_units(reader, evaluated[0]),
        bounds=_bounds(reader, cases[0]),
        analyses=np.array([numbers.get(case.counter, len(names)) for case in cases]),
    )


def _points(reader: om.CaseReader, path, evaluated: list, cut_off: bool) -> tuple[list, bool]:
    """Cases that are points of the history, and whether they are the major iterations."""
    begun = _gradient_counters(path)
    cases = [case for case in evaluated if case.counter in begun]
    if not cases:
        return evaluated, False
    if not cut_off:
        cases.append(_final_case(reader, evaluated[-1].counter) or evaluated[-1])
    if len(cases) > 1 and _same_design(cases[-1], cases[-2]):
        cases.pop()
    return cases, True


def _bounds(reader: om.CaseReader, case) -> dict:
    bounds = {}
    for name, value in dict(case.get_design_vars(scaled=False)).items():
        settings = reader.problem_metadata["variables"][name] | {"equals": None}
        bounds[name] = tuple(_limit(settings, side, value.size) for side in ("lower", "upper"))
    return bounds


def _kind(reader: om.CaseReader) -> str:
    driver = reader.problem_metadata.get("driver") or {}
    if "DOE" in f"{driver.get('name')}{driver.get('type')}":
        return "doe"
    supports = driver.get("supports") or {}
    optimises = supports.get("optimization", {"val": True})
    return "optimisation" if optimises["val"] else "runs"


def _finite(case) -> bool:
    """Whether objective and constraints have values: OpenMDAO's DOEDriver marks failures as good."""
    values = {**case.get_objectives(scaled=False), **case.get_constraints(scaled=False)}
    return all(np.isfinite(value).all() for value in values.values())


def _last(name: str) -> str:
    """The variable's own name, without those of the groups it is in."""
    return name.rsplit(".", 1)[-1]


def _units(reader: om.CaseReader, case) -> dict[str, str]:
    """Units of the recorded variables; of those of the driver the units that they have there."""
    shown = {"units": True, "prom_name": True, "val": False, "out_stream": None}
    listed = [*case.list_inputs(**shown), *case.list_outputs(**shown)]
    units = {meta["prom_name"]: meta["units"] for _, meta in listed if meta["units"]}
    for name, settings in reader.problem_metadata["variables"].items():
        if isinstance(settings, dict) and settings.get("units"):
            units[name] = settings["units"]
    return units


def _gradient_counters(path) -> set:
    """Counters of the cases after which a gradient was recorded.

    The reader matches gradients by iteration coordinate, which the driver has advanced already;
    the counter is that of the case before.
    """
    connection = sqlite3.connect(path)
    try:
        return {row[0] for row in connection.execute("SELECT counter FROM driver_derivatives")}
    finally:
        connection.close()


def _final_case(reader: om.CaseReader, after: int):
    """The last case of the problem itself, when it is not older than the driver's last one."""
    names = reader.list_cases("problem", out_stream=None)
    case = reader.get_case(names[-1]) if len(names) else None
    return case if case is not None and case.counter > after else None


def _same_design(a, b) -> bool:
    first, second = dict(a.get_design_vars(scaled=False)), dict(b.get_design_vars(scaled=False))
    return all(np.array_equal(first[name], value) for name, value in second.items())


def _stacked(per_case: list) -> dict:
    return {name: np.array([values[name] for values in per_case]) for name in dict(per_case[0])}


def _constraints(reader: om.CaseReader, cases: list) -> list[Constraint]:
    found = []
    for name, values in _stacked([case.get_constraints(scaled=False) for case in cases]).items():
        settings = reader.problem_metadata["variables"][name]
        size = values.shape[1]
        lower, upper = (_limit(settings, side, size) for side in ("lower", "upper"))
        for i in range(size):
            label = name if size == 1 else f"{name}[{i}]"
            found.append(Constraint(label, values[:, i], lower[i], upper[i]))
    return found


def _limit(settings: dict, side: str, size: int) -> np.ndarray:
    """A limit as an array; infinite where the settings name none."""
    value = settings["equals"] if settings["equals"] is not None else settings[side]
    none = -np.inf if side == "lower" else np.inf
    limit = np.broadcast_to(np.asarray(none if value is None else value, float), size)
    return np.where(np.abs(limit) >= NO_LIMIT, none, limit)

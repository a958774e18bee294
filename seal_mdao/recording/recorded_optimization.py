"""What an OpenMDAO recorder file says about an optimisation."""

import re
from dataclasses import dataclass, field

import numpy as np

from seal_mdao.recording import run_log
from seal_mdao.recording.plain_reading import PlainDatabase, reading
from seal_mdao.recording.recorder_file import (
    CONSTRAINT,
    DESIGN,
    OBJECTIVE,
    Case,
    RecordedModel,
    read_driver_cases,
    read_gradient_counters,
    read_model,
    read_problem_case,
)
from seal_mdao.recording.seal_inputs import read_seals
from seal_mdao.recording.settings import recorded_settings
from seal_mdao.seals.seal import Seal

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
    seal : Seal or None
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
    seal: Seal | None
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
    return shown_unit(history.units.get(name, DESIGN_UNITS.get(_last(name), "")))


def shown_unit(unit: str | None) -> str:
    """A unit of OpenMDAO with a raised exponent; empty for none."""
    return re.sub(r"\*\*(\d)", lambda power: "⁰¹²³⁴⁵⁶⁷⁸⁹"[int(power[1])], unit or "")


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
    with reading(path), PlainDatabase(path) as database:
        return _read(database, path, given)


def _read(database: PlainDatabase, path, given) -> RecordedOptimization:
    model = read_model(database)
    recorded = [case for _, case in read_driver_cases(database)]
    evaluated = [case for case in recorded if not case.failure and _finite(model, case)]
    if not evaluated:
        raise ValueError(f"{path} holds no case of a driver")
    if not model.values(evaluated[0], OBJECTIVE):
        raise ValueError(f"{path} holds no objective, so there is nothing to follow")
    runs = run_log.read_runs(database)
    cases, major = _points(database, model, evaluated, bool(runs) and runs[-1].cut_off)
    seals = read_seals(model, cases, given)
    numbers = {case.counter: number for number, case in enumerate(evaluated, start=1)}
    objective = _stacked(model, cases, OBJECTIVE)
    objective_name = next(iter(objective))
    return RecordedOptimization(
        objective_name=objective_name,
        objective=objective[objective_name][:, 0],
        constraints=_constraints(model, cases),
        design=_stacked(model, cases, DESIGN),
        major=major,
        evaluations=len(recorded),
        seal=seals[0].seal if seals else None,
        seals=seals,
        kind=_kind(model),
        failed=len(recorded) - len(evaluated),
        settings=recorded_settings(model),
        runs=runs,
        units=_units(model, evaluated[0]),
        bounds=_bounds(model, cases[0]),
        analyses=np.array([numbers.get(case.counter, len(recorded)) for case in cases]),
    )


def _points(
    database: PlainDatabase, model: RecordedModel, evaluated: list, cut_off: bool
) -> tuple[list, bool]:
    """Cases that are points of the history, and whether they are the major iterations.

    OpenMDAO matches gradients by iteration coordinate, which the driver has advanced already; the
    counter is that of the case before.
    """
    begun = read_gradient_counters(database)
    cases = [case for case in evaluated if case.counter in begun]
    if not cases:
        return evaluated, False
    if not cut_off:
        final, last = read_problem_case(database), evaluated[-1]
        cases.append(final if final is not None and final.counter > last.counter else last)
    if len(cases) > 1 and _same_design(model, cases[-1], cases[-2]):
        cases.pop()
    return cases, True


def _bounds(model: RecordedModel, case: Case) -> dict:
    bounds = {}
    for name, value in model.values(case, DESIGN).items():
        settings = model.variables[name] | {"equals": None}
        bounds[name] = tuple(_limit(settings, side, value.size) for side in ("lower", "upper"))
    return bounds


def _kind(model: RecordedModel) -> str:
    driver = model.driver
    if "DOE" in f"{driver.get('name')}{driver.get('type')}":
        return "doe"
    supports = driver.get("supports") or {}
    optimises = supports.get("optimization", {"val": True})
    return "optimisation" if optimises["val"] else "runs"


def _finite(model: RecordedModel, case: Case) -> bool:
    """Whether objective and constraints have values: OpenMDAO's DOEDriver marks failures as good."""
    values = [*model.values(case, OBJECTIVE).values(), *model.values(case, CONSTRAINT).values()]
    return all(np.isfinite(value).all() for value in values)


def _last(name: str) -> str:
    """The variable's own name, without those of the groups it is in."""
    return name.rsplit(".", 1)[-1]


def _units(model: RecordedModel, case: Case) -> dict[str, str]:
    """Units of the recorded variables; of those of the driver the units that they have there."""
    recorded = [*case.inputs, *case.outputs]
    units = {model.promoted[name]: model.units[name] for name in recorded if model.units[name]}
    for name, settings in model.variables.items():
        if settings.get("units"):
            units[name] = settings["units"]
    return units


def _same_design(model: RecordedModel, a: Case, b: Case) -> bool:
    first, second = (model.values(case, DESIGN) for case in (a, b))
    return all(np.array_equal(first[name], value) for name, value in second.items())


def _stacked(model: RecordedModel, cases: list, kind: str) -> dict[str, np.ndarray]:
    rows = [model.values(case, kind) for case in cases]
    return {name: np.array([values[name] for values in rows]) for name in rows[0]}


def _constraints(model: RecordedModel, cases: list) -> list[Constraint]:
    found = []
    for name, values in _stacked(model, cases, CONSTRAINT).items():
        size = values.shape[1]
        lower, upper = (_limit(model.variables[name], side, size) for side in ("lower", "upper"))
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

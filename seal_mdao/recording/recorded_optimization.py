"""History of an optimisation from an OpenMDAO recorder file."""

import re
from dataclasses import dataclass, field

import numpy as np

from seal_mdao.recording import run_log
from seal_mdao.recording.plain_reading import PlainDatabase, reading
from seal_mdao.recording.recorded_seals import (
    has_failed_seal,
    own_name,
    read_seals,
    recorded_settings,
)
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
from seal_mdao.seals.seal import Seal

FEASIBLE = 1e-3
"""Largest violation of a limit, relative to it, that counts as satisfied."""
NO_LIMIT = 1e20
"""Limits of at least this size are absent; OpenMDAO stores 1e30."""
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
"""Descriptions of variables."""
DESIGN_UNITS = {"boundary_offsets": "mm", "door_radius": "mm"}
"""Units of inputs that a recorder omits by default."""
KINDS = {
    "optimisation": "optimisation", "doe": "design of experiments", "runs": "runs of a model",
}  # fmt: skip
"""Descriptions of what a driver does."""


@dataclass(frozen=True, eq=False)
class Constraint:
    """One scalar constraint along the history: recorded name, with the entry of an array in brackets,
    values (n,), and limits, infinite where there are none."""

    name: str
    values: np.ndarray
    lower: float
    upper: float

    def violation(self) -> np.ndarray:
        """Return the relative excess over the nearer limit, 0 where satisfied, shape (n,)."""
        return np.maximum(0.0, self._excess())

    def satisfied(self) -> np.ndarray:
        """Return where the limits are satisfied, up to rounding of the optimiser, bool (n,)."""
        return self.violation() <= FEASIBLE

    def use(self) -> np.ndarray:
        """Return the utilisation of the limits, (n,): 1 at the nearer one, more where it is violated.

        The distance to a limit is relative to the limit (to 1 if that is zero), so that for a positive
        upper limit the utilisation is value / limit.
        """
        return 1.0 + self._excess()

    def _excess(self) -> np.ndarray:
        # (c - upper) / |upper| and (lower - c) / |lower|, the larger one
        excess = np.full(len(self.values), -np.inf)
        for limit, sign in ((self.upper, 1.0), (self.lower, -1.0)):
            if np.isfinite(limit):
                size = abs(limit) or 1.0
                excess = np.maximum(excess, sign * (self.values - limit) / size)
        return excess


def label(name: str) -> str:
    """Describe a recorded variable; its entry counts from 1."""
    # name[3] is entry 4 of an array
    entry = re.fullmatch(r"(.*)\[(\d+)\]", name)
    if entry is None:
        return NAMES.get(own_name(name)) or _aggregate(own_name(name))
    base, number = label(entry[1]), int(entry[2]) + 1
    if base == "von mises":
        return f"stress {number}"
    # the entry of an aggregate is that of its measure
    measure, comma, aggregate = base.partition(", ")
    return f"{measure} {number}{comma}{aggregate}"


def _aggregate(name: str) -> str:
    """Describe a variable that may be an aggregate of a measure over scenarios."""
    parts = re.fullmatch(r"(.+)_(scenarios|mean|std|highest|lowest|q\d+(?:_\d+)?)", name)
    if parts is None:
        return name.replace("_", " ")
    # names of quantiles: q95, q97_5
    ending = parts[2].replace("std", "standard deviation")
    if ending.startswith("q"):
        ending = f"{ending[1:].replace('_', '.')} % quantile"
    return f"{label(parts[1])}, {ending}"


@dataclass(frozen=True, eq=False)
class RecordedOptimization:
    """Major iterations of an optimisation, the start first.

    Attributes
    ----------
    objective_name : str
        Empty for a design of experiments, or runs, without an objective.
    objective : ndarray, shape (n,)
        NaN without an objective.
    constraints : list of Constraint
    design : dict of str to ndarray
        Design variables along the history, (n, size) each.
    major : bool
        False if the file does not identify major iterations; then every evaluation is a point.
    evaluations : int
        Recorded model evaluations.
    seal : Seal or None
        The seal that was optimised, if the file contains it.
    settings : dict
        Further arguments of ``seal_problem``, if the file contains them.
    runs : list of LoggedRun
        The runs that wrote the file, if it is that of a ``RestartRecorder``.
    units : dict of str to str
        Units of the recorded variables.
    bounds : dict of str to (ndarray, ndarray)
        Lower and upper bounds of the design variables, infinite where there are none.
    seals : list of RecordedSeal
        Every ``SealGroup`` of the model with its inputs at the points.
    kind : str
        "optimisation", "doe" (design of experiments), or "runs" of the model by another driver.
    failed : int
        Recorded evaluations that failed, or gave values that are not finite.
    analyses : ndarray, shape (n,)
        Number of the evaluation of each point, from 1; failed evaluations count.
    run_starts : list of int
        First point of the second and every further run of the driver. A continued run is part of the run
        that it continues.
    maximized : bool
        Whether the objective is maximised: its scaling is negative.
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
    run_starts: list = field(default_factory=list)
    maximized: bool = False

    @property
    def cut_off(self) -> bool:
        """Whether the last run was not completed, so that the last point is no result."""
        return bool(self.runs) and self.runs[-1].cut_off

    @property
    def iterations(self) -> int:
        """Iterations of the last run as its optimiser counted them; where the file does not say, the
        number of points after the start.

        The points may be more: derivatives can be recorded at rejected designs, and the result of a run
        that was stopped is an earlier design.
        """
        counted = self.runs[-1].iterations if self.runs and not self.cut_off else None
        return len(self.objective) - 1 if counted is None else counted

    @property
    def objective_ratio(self) -> np.ndarray:
        """Objective over its start, shape (n,)."""
        return self.objective / self.objective[0]

    @property
    def max_violation(self) -> np.ndarray:
        """Largest relative constraint violation, shape (n,)."""
        none = np.zeros(len(self.objective))
        return np.max([none, *(c.violation() for c in self.constraints)], axis=0)

    @property
    def feasible(self) -> np.ndarray:
        """Where all constraints are satisfied, bool (n,)."""
        return self.max_violation <= FEASIBLE

    @property
    def best(self) -> int:
        """Index of the best point: that with the best objective among those that satisfy the
        constraints; if there is none, that with the smallest violation. It needs an objective."""
        if not self.feasible.any():
            return int(self.max_violation.argmin())
        cost = -self.objective if self.maximized else self.objective
        return int(np.where(self.feasible, cost, np.inf).argmin())

    def design_at(self, index: int) -> tuple[np.ndarray, dict]:
        """Return boundary offsets (mm) and scalar parameters of the first seal at a point, as arguments
        of ``analyze``.

        Raises
        ------
        ValueError
            If the file does not contain them.
        """
        offsets, parameters = self.seals[0].design(index) if self.seals else (None, {})
        if offsets is None:
            raise ValueError(
                "the recorder file does not contain the design parameters of a seal "
                "(boundary_offsets); record them with seal_mdao.RestartRecorder, or with "
                'driver.recording_options["includes"] = ["*"]'
            )
        return offsets, parameters


def unit_of(history: RecordedOptimization, name: str) -> str:
    """Return the unit of a recorded variable, with raised exponents; empty if it has none."""
    # all entries of an array have one unit
    name = name.split("[")[0]
    return shown_unit(history.units.get(name, DESIGN_UNITS.get(own_name(name), "")))


def shown_unit(unit: str | None) -> str:
    """Format a unit of OpenMDAO with raised exponents; empty for none."""
    return re.sub(r"\*\*(\d)", lambda power: "⁰¹²³⁴⁵⁶⁷⁸⁹"[int(power[1])], unit or "")


def read_optimization(path, given: dict | None = None) -> RecordedOptimization:
    """Read the history of an optimisation, or of another driver, from its ``SqliteRecorder`` file.

    The points are the major iterations if the driver's derivatives were recorded: each begins with a
    gradient. The history ends with the last evaluation, or with the case that the problem itself
    recorded at the end; that of a run that was cut off, with the last major iteration. Values are in the
    units in which objective, constraints and design variables were declared.

    Parameters
    ----------
    path : str or Path
    given : dict of str to ndarray, optional
        Inputs of seals that are the same at all points and may not be in the file, by absolute names.

    Raises
    ------
    ValueError
        For a file that does not exist, is no recorder file, is damaged, or has no successful case of a
        driver; for an optimisation without an objective.
    """
    with reading(path) as database:
        return _read(database, path, given)


def _read(database: PlainDatabase, path, given) -> RecordedOptimization:
    model = read_model(database)
    # successful cases of the driver, which counts all cases from 0 in every run
    numbered = read_driver_cases(database)
    recorded = [case for _, case in numbered]
    evaluated = [case for case in recorded if not case.failure and _finite(model, case)]
    if not evaluated:
        raise ValueError(f"{path} contains no driver iterations; attach the recorder to the driver")
    kind = _kind(model.driver)
    if kind == "optimisation" and not model.values(evaluated[0], OBJECTIVE):
        raise ValueError(
            f"{path} contains no objective; set record_objectives of the driver's "
            "recording_options to True"
        )
    # points of the history, and the seals at them
    runs = run_log.read_runs(database)
    cases, major = _points(database, model, evaluated, bool(runs) and runs[-1].cut_off)
    seals = read_seals(model, cases, given)
    numbers = {case.counter: number for number, case in enumerate(recorded, start=1)}
    at = [numbers.get(case.counter, len(recorded)) for case in cases]
    # the first of several objectives
    none = "", np.full((len(cases), 1), np.nan)
    objective_name, objective = next(iter(_stacked(model, cases, OBJECTIVE).items()), none)
    scaling = model.variables[objective_name].get("total_scaler") if objective_name else None
    design = _stacked(model, cases, DESIGN)
    return RecordedOptimization(
        objective_name=objective_name,
        objective=objective[:, 0],
        constraints=_constraints(model, cases),
        design=design,
        major=major,
        evaluations=len(recorded),
        seal=seals[0].seal if seals else None,
        seals=seals,
        kind=kind,
        failed=len(recorded) - len(evaluated),
        settings=recorded_settings(model),
        runs=runs,
        units=_units(model, evaluated[0]),
        bounds={
            name: _limits(model.variables[name] | {"equals": None}, values.shape[1])
            for name, values in design.items()
        },
        analyses=np.array(at),
        maximized=(scaling or 1.0) < 0.0,
        run_starts=_run_starts([count for count, _ in numbered], at),
    )


def _points(database, model, evaluated: list, cut_off: bool) -> tuple[list, bool]:
    """Return the cases that are points of the history, and whether they are the major iterations."""
    # by counter, that of the case before the gradient: OpenMDAO matches gradients by iteration
    # coordinate, which the driver has advanced already
    begun = read_gradient_counters(database)
    cases = [case for case in evaluated if case.counter in begun]
    if not cases:
        return evaluated, False
    # a run that was cut off has no end
    if not cut_off:
        final, last = read_problem_case(database), evaluated[-1]
        cases.append(final if final is not None and final.counter > last.counter else last)
    if len(cases) > 1:
        # the end may be the last major iteration itself
        before, end = (model.values(case, DESIGN) for case in cases[-2:])
        if all(np.array_equal(end[name], value) for name, value in before.items()):
            cases.pop()
    return cases, True


def _run_starts(counts, at) -> list[int]:
    """Return the first points of further runs, from the driver's counts of all evaluations and the
    numbers ``at`` of the evaluations of the points."""
    # run of every evaluation: k = sum over j <= i of [count_j <= count_{j-1}]
    run = np.cumsum(np.diff(counts, prepend=-1) <= 0)[np.array(at) - 1]
    return (1 + np.flatnonzero(np.diff(run))).tolist()


def _kind(driver: dict) -> str:
    if "DOE" in f"{driver.get('name')}{driver.get('type')}":
        return "doe"
    optimises = (driver.get("supports") or {}).get("optimization", {"val": True})
    return "optimisation" if optimises["val"] else "runs"


def _finite(model: RecordedModel, case: Case) -> bool:
    # OpenMDAO's DOEDriver marks failures as successes; their values are NaN, or those of the design
    # before if they are computed downstream of a seal, whose outputs are NaN
    values = [*model.values(case, OBJECTIVE).values(), *model.values(case, CONSTRAINT).values()]
    return all(np.isfinite(value).all() for value in values) and not has_failed_seal(model, case)


def _units(model: RecordedModel, case: Case) -> dict[str, str]:
    """Return the units of the recorded variables by promoted name."""
    recorded = [*case.inputs, *case.outputs]
    units = {model.promoted[name]: model.units[name] for name in recorded if model.units[name]}
    # variables of the driver have the units of their declaration
    return units | {n: own["units"] for n, own in model.variables.items() if own.get("units")}


def _stacked(model: RecordedModel, cases: list, kind: str) -> dict[str, np.ndarray]:
    rows = [model.values(case, kind) for case in cases]
    return {name: np.array([values[name] for values in rows]) for name in rows[0]}


def _constraints(model: RecordedModel, cases: list) -> list[Constraint]:
    found = []
    for name, values in _stacked(model, cases, CONSTRAINT).items():
        size = values.shape[1]
        lower, upper = _limits(model.variables[name], size)
        # one scalar constraint per entry of an array
        names = [name] if size == 1 else [f"{name}[{i}]" for i in range(size)]
        found += map(Constraint, names, values.T, lower, upper)
    return found


def _limits(settings: dict, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return lower and upper limits as arrays; infinite where there are none."""
    limits = []
    for side, none in (("lower", -np.inf), ("upper", np.inf)):
        # an equality constraint has both limits at its value
        value = settings["equals"] if settings["equals"] is not None else settings[side]
        limit = np.broadcast_to(np.asarray(none if value is None else value, float), size)
        limits.append(np.where(np.abs(limit) >= NO_LIMIT, none, limit))
    return tuple(limits)

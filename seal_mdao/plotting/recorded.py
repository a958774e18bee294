"""What an OpenMDAO recorder file says about an optimisation."""

import sqlite3
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import openmdao.api as om

from seal_mdao.model import SealModel
from seal_mdao.optimization import SETTINGS_OPTION, model_from_json

NO_LIMIT = 1e20
"""Limits from here on are OpenMDAO's way of saying that there is none."""


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
    model : SealModel or None
        The model that was optimised, when the file holds it.
    """

    objective_name: str
    objective: np.ndarray
    constraints: list
    design: dict
    major: bool
    evaluations: int
    model: SealModel | None

    @property
    def objective_ratio(self) -> np.ndarray:
        """Objective over its start, shape (n,)."""
        return self.objective / self.objective[0]

    @property
    def max_violation(self) -> np.ndarray:
        """Largest relative constraint violation, shape (n,)."""
        none = np.zeros(len(self.objective))
        return np.max([none, *(c.violation() for c in self.constraints)], axis=0)

    def design_at(self, index: int) -> tuple[np.ndarray, float]:
        """Boundary offsets and door radius (mm) of one point of the history.

        Raises
        ------
        ValueError
            When the file holds no design variable of that name.
        """
        try:
            offsets, radius = (self.design[name] for name in ("boundary_offsets", "door_radius"))
        except KeyError as missing:
            raise ValueError(f"the recorded problem has no design variable {missing}") from None
        return offsets[index], float(radius[index, 0])


def read_optimization(path) -> RecordedOptimization:
    """Read the history of an optimisation from a ``SqliteRecorder`` file of its driver.

    The points are the major iterations when the driver's derivatives were recorded: each begins
    with a gradient. The last evaluation, or the case that the problem itself recorded at the end,
    closes the history.

    Raises
    ------
    ValueError
        For a file that is not there, is no recorder file, or holds no driver case.
    """
    reader = _open(path)
    names = reader.list_cases("driver", recurse=False, out_stream=None)
    if len(names) == 0:
        raise ValueError(f"{path} holds no case of a driver")
    evaluated = [case for case in map(reader.get_case, names) if case.success]
    begun = _gradient_counters(path)
    cases = [case for case in evaluated if case.counter in begun] if begun else list(evaluated)
    cases += [_final_case(reader) or evaluated[-1]]
    if len(cases) > 1 and _same_design(cases[-1], cases[-2]):
        cases.pop()
    objective = [case.get_objectives(scaled=False) for case in cases]
    objective_name = next(iter(objective[0].keys()))
    return RecordedOptimization(
        objective_name=objective_name,
        objective=np.array([values[objective_name][0] for values in objective]),
        constraints=_constraints(reader, cases),
        design=_stacked([case.get_design_vars(scaled=False) for case in cases]),
        major=bool(begun),
        evaluations=len(names),
        model=_model(reader),
    )


def _open(path) -> om.CaseReader:
    if not Path(path).is_file():
        raise ValueError(f"{path} is not a file")
    try:
        return om.CaseReader(str(path))
    except (OSError, sqlite3.DatabaseError, KeyError) as error:
        raise ValueError(f"{path} is not a file of an OpenMDAO recorder ({error})") from error


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


def _final_case(reader: om.CaseReader):
    names = reader.list_cases("problem", out_stream=None)
    return reader.get_case(names[-1]) if len(names) else None


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


def _model(reader: om.CaseReader) -> SealModel | None:
    options = reader.list_model_options(out_stream=None).get("root", {})
    return model_from_json(options[SETTINGS_OPTION]) if SETTINGS_OPTION in options else None

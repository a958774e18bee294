"""Seals of a recorded model: their settings, and their inputs at each recorded point.

The inputs of a ``SealGroup`` or ``ScenarioGroup`` are found in the group's own units, wherever they come
from: recorded themselves (as ``RestartRecorder`` always does), or as the outputs connected to them.
"""

import json
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import openmdao.api as om
from openmdao.utils.array_utils import array_connection_compatible
from openmdao.utils.units import convert_units

from seal_mdao.recording.recorded_scenarios import RecordedScenarios, read_scenarios
from seal_mdao.recording.recorder_file import Case, RecordedModel
from seal_mdao.seals.seal import SETTINGS_OPTION, Seal
from seal_mdao.seals.settings import seal_of

PROBLEM_OPTION = "problem_settings"
"""Option of the recorded model with the other arguments of ``seal_problem`` that define the problem, as
JSON, from which a restart sets it up again."""
CONTACT, GEOMETRY = "contact.", "geometry."
"""Components of a ``SealGroup`` whose inputs are its design."""
SCENARIOS = "scenarios."
"""Component of a ``ScenarioGroup`` likewise."""
ARRAYS = {"particles": "mm", "boundary_offsets": "mm"}


class RecordedProblem(NamedTuple):
    """Arguments of ``seal_problem`` that set up a recorded problem again: seal and keywords."""

    seal: Seal
    settings: dict


@dataclass(frozen=True, eq=False)
class RecordedSeal:
    """One ``SealGroup`` or ``ScenarioGroup`` of a recorded model.

    Attributes
    ----------
    name : str
        Path of the group; empty for the model itself.
    seal : Seal or None
        None for a seal without settings in the file.
    values : list of dict
        Inputs at every point by their own names, in the component's units.
    assumed : tuple of str
        Inputs that are not in the file; those of the nominal seal replace them.
    measures : dict of str to ndarray
        Recorded values at every point of the seal's scalar measures.
    scenarios : RecordedScenarios or None
        Those of a ``ScenarioGroup``.
    """

    name: str
    seal: Seal | None
    values: list
    assumed: tuple
    measures: dict
    scenarios: RecordedScenarios | None = None

    @property
    def drawable(self) -> bool:
        """Whether the shapes of all points are known."""
        known = all({*ARRAYS} & {*values} for values in self.values)
        return self.seal is not None and known

    def design(self, index: int) -> tuple[np.ndarray | None, dict]:
        """Return boundary offsets (mm), None if only particles are known, and scalar parameters."""
        values = self.values[index]
        parameters = {n: float(np.ravel(v)[0]) for n, v in values.items() if n not in ARRAYS}
        return values.get("boundary_offsets"), parameters

    def particles(self, index: int) -> np.ndarray:
        """Return the undeformed particles of a point, shape (n, 2), mm."""
        values = self.values[index]
        # recorded, or moved with the offsets
        if "particles" in values:
            return np.reshape(values["particles"], self.seal.nominal_particles.shape)
        return self.seal.particles(values["boundary_offsets"])


# ---- settings in a recorder file ----


def recorded_problem(model: RecordedModel) -> RecordedProblem | None:
    """Return the problem of a recorder file; None if there is no seal in it.

    Raises
    ------
    ValueError
        If the settings are those of another version of the package.
    """
    texts = filter(None, _settings_by_path(model).values())
    return next((RecordedProblem(seal_of(t), recorded_settings(model)) for t in texts), None)


def recorded_settings(model: RecordedModel) -> dict:
    """Return the arguments that define the problem of a recorder file; empty if there are none.

    Raises
    ------
    ValueError
        If they are not a JSON object.
    """
    for options in model.options.values():
        if PROBLEM_OPTION in options:
            # JSON that is nested too deep is refused as well
            with suppress(RecursionError):
                found = json.loads(options[PROBLEM_OPTION])
                if isinstance(found, dict):
                    return found
            raise ValueError(
                f"the recorded option {PROBLEM_OPTION} is damaged, so the optimisation problem of "
                "the run is not known; give another recorder file, or begin a new run"
            )
    return {}


def _settings_by_path(model: RecordedModel) -> dict[str, str]:
    """Return the settings of all seals by path of their group; empty text where they are unknown."""
    options = model.options.items()
    return {path: own[SETTINGS_OPTION] for path, own in options if SETTINGS_OPTION in own}


# ---- variables of seals in a model ----


def inputs_of_seals(model) -> list[str]:
    """Return absolute names of the inputs of all seals of a model."""
    names = []
    for group in model.system_iter(include_self=True, recurse=True, typ=om.Group):
        # groups with a seal are those that have the option for its settings
        if SETTINGS_OPTION in group.options:
            path = f"{group.pathname}." if group.pathname else ""
            wanted = tuple(path + own for own in (CONTACT, GEOMETRY, SCENARIOS))
            names += [n for n, _ in group.abs_meta_iter("input") if n.startswith(wanted)]
    return names


def outputs_of_seals(model) -> list[str]:
    """Return absolute names of the outputs of all components with a seal, which are NaN after a failed
    analysis, be they in a group of a seal or not."""
    components = model.system_iter(recurse=True, typ=om.ExplicitComponent)
    return [
        name
        for component in components
        if "seal" in component.options
        for name, _ in component.abs_meta_iter("output")
    ]


def has_failed_seal(model: RecordedModel, case: Case) -> bool:
    """Return whether a recorded output of a ``SealGroup`` or ``ScenarioGroup`` is NaN, as after a failed
    analysis; rows of scenarios that were left out are no failure."""
    groups = tuple(f"{path}." if path else "" for path in _settings_by_path(model))
    return any(
        value.size > 0 and np.isnan(value).all()
        for name, value in case.outputs.items()
        if name.startswith(groups)
    )


# ---- inputs at recorded points ----


def read_seals(model: RecordedModel, cases: list, given: dict | None = None) -> list[RecordedSeal]:
    """Read all seals of a recorded model with their inputs at some cases.

    Parameters
    ----------
    model : RecordedModel
    cases : list of Case
    given : dict of str to ndarray, optional
        Inputs that are the same at all points and may be missing in the file, by absolute names.

    Raises
    ------
    ValueError
        If the settings are those of another version of the package.
    """
    seals = {name: seal_of(t) if t else None for name, t in _settings_by_path(model).items()}
    return [_recorded_seal(name, seal, model, cases, given or {}) for name, seal in seals.items()]


def _recorded_seal(name, seal, model, cases, given) -> RecordedSeal:
    # a seal without settings in the file has no known parameters
    path, known = f"{name}." if name else "", {} if seal is None else seal.scalars
    component, arrays = _design_inputs(path, model.sources)
    scalars = [component + own for own in known if component + own in model.sources]
    if seal is not None and not seal.n_offsets:
        # without design parameters there is no input of offsets: they are known to be none
        given = given | {t: np.zeros(0) for t in arrays if own_name(t) == "boundary_offsets"}
    units = ARRAYS | {own: scalar.units for own, scalar in known.items()}
    # inputs at every point by their own names, as far as they are known
    values = []
    for case in cases:
        found = {own_name(t): _value(case, t, model, units, given) for t in (*arrays, *scalars)}
        values.append({own: value for own, value in found.items() if _is_known(own, value, seal)})
    assumed = tuple(own_name(t) for t in scalars if any(own_name(t) not in v for v in values))
    # scalar measures that were recorded at all points
    measures = {}
    for measure in () if seal is None else seal.measures():
        rows = [case.outputs.get(f"{path}{CONTACT}{measure.name}") for case in cases]
        if all(row is not None and np.size(row) == 1 for row in rows):
            measures[measure.name] = np.array(rows).ravel()
    scenarios = read_scenarios(model, name, path + SCENARIOS, cases)
    return RecordedSeal(name, seal, values, assumed, measures, scenarios)


def _design_inputs(path: str, links: dict) -> tuple[str, list[str]]:
    """Return the component with the scalar inputs of a seal, and the inputs that define its shape."""
    component, of_scenarios = path + CONTACT, path + SCENARIOS
    # not by the offsets, which a seal without design parameters does not have
    if any(target.startswith(of_scenarios) for target in links):
        return of_scenarios, [f"{of_scenarios}boundary_offsets"]
    arrays = [f"{component}particles"]
    # particles from elsewhere: the offsets are not their design
    if links.get(arrays[0]) == f"{path}{GEOMETRY}particles":
        arrays.append(f"{path}{GEOMETRY}boundary_offsets")
    return component, arrays


def _value(case, target, model, units, given) -> np.ndarray | None:
    """Return an input in its own units; None if the file does not contain it."""
    # recorded, else the connected output, else one of the given constants
    source = model.sources.get(target)
    if target not in case.inputs and source not in case.outputs:
        return given.get(target)
    value = case.inputs.get(target)
    if value is None:
        value, shape = case.outputs[source], model.shapes.get(target)
        # OpenMDAO connects other shapes through src_indices only, which are not in the file
        if shape is None or not array_connection_compatible(value.shape, shape):
            return given.get(target)
        value = convert_units(value.reshape(shape), model.units[source], units[own_name(target)])
    return value


def _is_known(name: str, value, seal: Seal | None) -> bool:
    """Return whether the value of an input is known, with as many numbers as the seal has."""
    if value is None:
        return False
    if name not in ARRAYS:
        return value.size == 1
    if seal is None:
        return True
    sizes = {"particles": seal.nominal_particles.size, "boundary_offsets": seal.n_offsets}
    return value.size == sizes[name]


def own_name(name: str) -> str:
    """Return the name of a variable without those of the groups around it."""
    return name.rsplit(".", 1)[-1]

"""What the seals of a model really used at each recorded point.

The inputs of a ``SealGroup`` or ``ScenarioGroup`` in its own units, wherever they come from: recorded
as such (which ``RestartRecorder`` always does), or as the output to which OpenMDAO has connected them.
"""

from dataclasses import dataclass

import numpy as np
import openmdao.api as om
from openmdao.utils.units import convert_units

from seal_mdao.recording.recorder_file import RecordedModel
from seal_mdao.recording.settings import recorded_seals
from seal_mdao.seals.seal import SETTINGS_OPTION, Seal

CONTACT, GEOMETRY = "contact.", "geometry."
"""The components of a ``SealGroup`` whose inputs are its design."""
SCENARIOS = "scenarios."
"""That of a ``ScenarioGroup``."""
ARRAYS = {"particles": "mm", "boundary_offsets": "mm"}


@dataclass(frozen=True, eq=False)
class RecordedSeal:
    """One ``SealGroup`` or ``ScenarioGroup`` of a recorded model.

    Attributes
    ----------
    name : str
        Path of the group; empty for the model itself.
    seal : Seal or None
        None for a seal that no recorder file describes.
    values : list of dict
        Inputs at every point by their own names, in the component's units.
    assumed : tuple of str
        Inputs that the file does not tell; those of the drawn seal stand for them.
    measures : dict of str to ndarray
        The recorded values at every point of the seal's measures that are single numbers.
    """

    name: str
    seal: Seal | None
    values: list
    assumed: tuple
    measures: dict

    @property
    def drawable(self) -> bool:
        """Whether the shapes of all points are known."""
        known = all({*ARRAYS} & {*values} for values in self.values)
        return self.seal is not None and known

    def design(self, index: int) -> tuple[np.ndarray | None, dict]:
        """Boundary offsets (mm), None where only particles are known, and scalar parameters."""
        values = self.values[index]
        parameters = {n: float(np.ravel(v)[0]) for n, v in values.items() if n not in ARRAYS}
        return values.get("boundary_offsets"), parameters

    def particles(self, index: int) -> np.ndarray:
        """Undeformed particles of a point, shape (n, 2), mm."""
        values = self.values[index]
        if "particles" in values:
            return np.reshape(values["particles"], self.seal.drawn_particles.shape)
        return self.seal.particles(values["boundary_offsets"])


def inputs_of_seals(model) -> list[str]:
    """Absolute names of the inputs of all seals of a model."""
    return _of_seals(model, "input", (CONTACT, GEOMETRY, SCENARIOS))


def outputs_of_seals(model) -> list[str]:
    """Absolute names of the outputs of all seals of a model, but those of scenarios: there NaN may
    stand for a scenario that was left out."""
    return _of_seals(model, "output", (CONTACT, GEOMETRY))


def _of_seals(model, kind: str, components: tuple) -> list[str]:
    names = []
    for group in model.system_iter(include_self=True, recurse=True, typ=om.Group):
        if SETTINGS_OPTION in group.options:
            path = f"{group.pathname}." if group.pathname else ""
            wanted = tuple(path + own for own in components)
            names += [n for n, _ in group.abs_meta_iter(kind) if n.startswith(wanted)]
    return names


def read_seals(model: RecordedModel, cases: list, given: dict | None = None) -> list[RecordedSeal]:
    """All seals of a recorded model with their inputs at some cases.

    Parameters
    ----------
    model : RecordedModel
    cases : list of Case
    given : dict of str to ndarray, optional
        Inputs that are the same at all points and may not be in the file, by their absolute names.
    """
    return [
        _recorded_seal(name, seal, model, cases, given or {})
        for name, seal in recorded_seals(model).items()
    ]


def _recorded_seal(name, seal, model, cases, given) -> RecordedSeal:
    path, links = f"{name}." if name else "", model.sources
    component, shape = _design_inputs(path, links)
    known = {} if seal is None else seal.scalars
    scalars = [component + own for own in known if component + own in links]
    units = ARRAYS | {own: scalar.units for own, scalar in known.items()}
    values = []
    for case in cases:
        found = {t: _value(case, t, model, units, given) for t in (*shape, *scalars)}
        values.append({_own(t): value for t, value in found.items() if value is not None})
    assumed = tuple(_own(t) for t in scalars if any(_own(t) not in v for v in values))
    return RecordedSeal(name, seal, values, assumed, _measures(f"{path}{CONTACT}", seal, cases))


def _measures(component: str, seal, cases) -> dict:
    """Recorded values (n,) of a seal's measures that are single numbers."""
    found = {}
    for measure in () if seal is None else seal.measures():
        rows = [case.outputs.get(component + measure.name) for case in cases]
        if all(row is not None and np.size(row) == 1 for row in rows):
            found[measure.name] = np.array(rows).ravel()
    return found


def _design_inputs(path: str, links: dict) -> tuple[str, list[str]]:
    """The component that has the scalar inputs of a seal, and the inputs that are its shape."""
    component, of_scenarios = path + CONTACT, path + SCENARIOS
    if f"{of_scenarios}boundary_offsets" in links:
        return of_scenarios, [f"{of_scenarios}boundary_offsets"]
    shape = [f"{component}particles"]
    if links.get(shape[0]) == f"{path}{GEOMETRY}particles":  # else the offsets are not its design
        shape.append(f"{path}{GEOMETRY}boundary_offsets")
    return component, shape


def _value(case, target, model, units, given) -> np.ndarray | None:
    """An input in its own units; None when the file does not say."""
    source = model.sources.get(target)
    if target not in case.inputs and source not in case.outputs:
        return given.get(target)
    value = case.inputs.get(target)
    if value is None:
        value = convert_units(case.outputs[source], model.units[source], units[_own(target)])
    # which entry a scalar is of several is not in the file
    return value if _own(target) in ARRAYS or value.size == 1 else None


def _own(name: str) -> str:
    return name.rsplit(".", 1)[-1]

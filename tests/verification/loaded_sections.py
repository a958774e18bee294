"""Trapped air, fluid pressure, swelling, axial stretch and two bodies against finite elements.

The references are those of ``references/jax_sections.py``. Forces are in N/m, those of complete rings
in N.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.profiles import leading_motion
from seal_mdao.seals.result import SealResult, analyze

REFERENCES = Path(__file__).parent / "references"
MOVED = {"moved": "back"}
"""Labels of moved edges by the names of their forces in the references."""


class LoadedErrors(NamedTuple):
    """Errors of a section; the measures are those at the end.

    Attributes
    ----------
    force : float
        Largest difference of a component of a force at the end of a stage, over the largest force of
        that stage.
    energy : float
        Relative error of the strain energy.
    pressure : float
        Relative error of the gauge pressure of trapped air, 0 without air.
    uncertainty : float
        Largest relative change of a result by the last refinement of the finite elements or by three
        times their contact penalty.
    """

    force: float
    energy: float
    pressure: float
    uncertainty: float


def loaded_result(name: str, refinement: int = 1) -> SealResult:
    """Analyze a file without ``spacing``, at its default spacing divided by ``refinement``."""
    file = read_seal_file(REFERENCES / f"{name}.toml")
    seal = build_seal(file)
    if refinement > 1:
        finer = {"spacing": seal.spacing / refinement, "layers": 4 * refinement + 1}
        seal = build_seal(replace(file, section=replace(file.section, **finer)))
    result = analyze(seal)
    result.require_converged()
    return result


def loaded_errors(name: str, result: SealResult) -> LoadedErrors:
    """Compare a result with the finite elements."""
    known = json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))
    stages, force = known["stages"], 0.0
    ends = leading_motion(result.seal).ends
    for number, stage in enumerate(stages, 1):
        step = int(np.abs(ends - number).argmin())
        exact = {key[6:]: value for key, value in stage.items() if key.startswith("force_")}
        largest = max(np.linalg.norm(value) for value in exact.values())
        for own, value in exact.items():
            found = result.path.reaction(MOVED.get(own, own))[step]
            force = max(
                force, np.abs(found - value).max() / largest if largest else np.abs(found).max()
            )
    pressure = 0.0
    if stages[-1]["air_pressure"]:
        pressure = abs(result.value("cavity_pressure")[0] / stages[-1]["air_pressure"][0] - 1.0)
    energy = abs(result.value("strain_energy")[0] / stages[-1]["strain_energy"] - 1.0)
    changes = known["change_by_last_refinement"] + known["change_by_three_times_the_penalty"]
    return LoadedErrors(force, energy, pressure, max(changes))

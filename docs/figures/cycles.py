"""Hysteresis: the lip of the examples bent over a corner and let go, with friction and without, and a
half disc of rubber that softens."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import seal_mdao as sm
from figures.drawing import ROOT, captioned_files, curves
from figures.seal_files import example
from seal_mdao.measures.work import FrictionWork, ProfileWork
from seal_mdao.plotting import load_deflection, save
from seal_mdao.plotting.style import BLUE, GREY, VERMILION

FRICTIONS = {0.0: GREY, 0.15: BLUE, 0.3: VERMILION}


def make(out: Path, reduced: bool) -> dict:
    """The loops, and what friction takes from each."""
    file = example("lip", reduced)
    results = {friction: sm.analyze(sm.build_seal(cycle(file, friction))) for friction in FRICTIONS}
    for result in results.values():
        result.require_converged()
    with captioned_files(file):
        _loops(out / "hysteresis.png", results)
    softened = _softening(out / "softening.png", reduced)
    lost = [result.value(FrictionWork())[0] for result in results.values()]
    return {f"lost_{i}": f"{abs(value):.2g}" for i, value in enumerate(lost)} | softened


def _softening(path: Path, reduced: bool) -> dict:
    """Press and release the half disc of the verification twice; returns the loss of each cycle."""
    file = sm.read_seal_file(ROOT / "tests" / "verification" / "references" / "softening_disc.toml")
    plate = file.profiles[0]
    stages = tuple(replace(own, steps=4 if reduced else 3 * own.steps) for own in plate.stages)
    section = replace(file.section, spacing=1.0 if reduced else 0.6)
    file = replace(file, section=section, profiles=(replace(plate, stages=stages),))
    result = sm.analyze(sm.build_seal(file))
    result.require_converged()
    with captioned_files(file):
        save(load_deflection(result), path)
    losses = [result.value(ProfileWork("plate", stages=pair))[0] for pair in ((0, 2), (2, 4))]
    return {f"softening_{i}": f"{value:.3g}" for i, value in enumerate(losses, 1)}


def cycle(file, friction):
    """The file with the panel moved back to its start."""
    panel = file.profiles[0]
    there = panel.stages[0]
    back = replace(there, translate=tuple(-x for x in there.translate))
    return replace(file, profiles=(replace(panel, friction=friction, stages=(there, back)),))


def _loops(path: Path, results) -> None:
    """Force on the panel over its travel there and back."""
    lines = []
    for friction, result in results.items():
        motion, steps = result.term("panel").motion, len(result.path.nominal_steps)
        x = np.array([motion.pose(float(n)).position[0] for n in range(steps + 1)])
        travel, force = (
            np.abs(x - x[0]),
            np.append(0.0, np.abs(result.path.reaction("panel")[:, 0])),
        )
        half, color = steps // 2, FRICTIONS[friction]
        lines += [
            (travel[: half + 1], force[: half + 1], "-", color, f"friction {friction:g}"),
            (travel[half:], force[half:], "--", color, None),
        ]
    labels = "travel of the panel (mm)", "horizontal force (N/m)"
    curves(path, *labels, lines, (6.0, 3.6), {"title": "solid: closing, dashed: opening"})

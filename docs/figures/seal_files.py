"""The worked examples of seal files."""

import re
from dataclasses import replace
from pathlib import Path

import seal_mdao as sm
from seal_mdao.geometry.motion import Stage
from seal_mdao.plotting import deformed_shapes, load_deflection, save, section_cloud

FILES = sorted((Path(__file__).resolve().parents[2] / "examples").glob("*.toml"))
SHARE = 8
"""Of the steps and of the travel that is left in the reduced mode."""


def make(out: Path, reduced: bool) -> dict:
    """Section, deformed shapes and load-deflection of every example, and its measures."""
    numbers = {}
    for path in FILES:
        file = sm.read_seal_file(path)
        result = sm.analyze(sm.build_seal(begun(file) if reduced else file))
        result.require_converged()
        folder = out / "seal_files"
        save(section_cloud(result), folder / f"{path.stem}_section.png")
        save(deformed_shapes(result), folder / f"{path.stem}_shapes.png")
        save(load_deflection(result), folder / f"{path.stem}_load.png")
        numbers[path.stem] = {"particles": len(result.particles)} | {
            re.sub(r"\W", "_", measure.name): f"{result.value(measure)[0]:.4g}"
            for measure in result.measures()
            if measure.size(result.seal)
        }
    return numbers


def begun(file):
    """The file with the first part of every stage."""

    def short(stage):
        steps = max(1, stage.steps // SHARE)
        part = steps / stage.steps
        return Stage(steps, tuple(part * x for x in stage.translate), part * stage.rotate)

    profiles = [replace(p, stages=tuple(map(short, p.stages))) for p in file.profiles]
    return replace(file, profiles=tuple(profiles))

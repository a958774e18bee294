"""The worked examples of seal files, with load steps and penalties that ``verification.accuracy_study``
stores, and their optima, which ``verification.example_optima`` stores."""

import re
from dataclasses import replace
from math import nan
from pathlib import Path

import numpy as np
from verification import accuracy_study
from verification.example_optima import stored

import seal_mdao as sm
from figures import self_contact
from figures.drawing import ROOT
from figures.tables import power, table
from seal_mdao.file_optimization import design_bounds
from seal_mdao.plotting import (
    deformed_shapes,
    design_comparison,
    force_over_time,
    load_deflection,
    save,
    section_cloud,
)
from seal_mdao.plotting.captions import captioned, seal_text
from seal_mdao.recording.recorded_optimization import label, shown_unit
from seal_mdao.seals.profiles import path_stages
from seal_mdao.seals.result import SealResult

EXAMPLES = sorted(path.stem for path in (ROOT / "examples").glob("*.toml"))
FOLDED = "folded_lip"
"""Example on the page on self-contact."""
SHARE = 8
"""Of the steps and of the travel that is left in the reduced mode."""


def make(out: Path, reduced: bool) -> dict:
    """Section, deformed shapes, load-deflection and optimum of every example, and its measures."""
    numbers, rows, touching = {}, [], {}
    for name in EXAMPLES:
        file = example(name, reduced)
        with captioned({name: seal_text(file)}):
            result, row = _drawn(file, out / "seal_files" / name, reduced)
            if name == FOLDED:
                # analysed once for this page and that on self-contact
                touching = self_contact.draw(out / "self_contact.png", result)
        rows += row
        numbers[name] = {"particles": len(result.particles)} | {
            re.sub(r"\W", "_", measure.name): f"{result.value(measure)[0]:.4g}"
            for measure in result.measures()
            if measure.size(result.seal)
        }
    return {"examples": numbers, "optima": table(HEAD, rows)} | touching


def _drawn(file, stem: Path, reduced: bool) -> tuple[SealResult, list]:
    """Analyse and draw an example and its optimum, files named after ``stem``; a row if there is one."""
    seal = example_seal(file, reduced)
    result = sm.analyze(seal)
    result.require_converged()
    save(section_cloud(result), Path(f"{stem}_section.png"))
    save(deformed_shapes(result), Path(f"{stem}_shapes.png"))
    save(load_deflection(result), Path(f"{stem}_load.png"))
    if path_stages(seal) is not None:
        save(force_over_time(result), Path(f"{stem}_time.png"))
    if file.optimize is None:
        return result, []
    offsets, row = (sketched if reduced else optimised)(file, seal)
    best = sm.analyze(seal, offsets)
    best.require_converged()
    save(design_comparison(result, best), Path(f"{stem}_optimum.png"))
    return result, [[f"`{file.path.stem}`", *row]]


HEAD = (
    "example", "minimised", "before", "after", "iterations", "analyses", "largest violation",
    "optimality",
)  # fmt: skip


def optimised(file, seal) -> tuple[np.ndarray, list]:
    """The stored optimum of a file, and its row of the table."""
    own, aim = stored()[file.path.stem], file.optimize.minimize
    unit = shown_unit(next(m.units for m in seal.standard if m.name == aim))
    return np.array(own["offsets"]), [
        label(aim), *(f"{_short(own[when])} {unit}" for when in ("before", "after")),
        own["iterations"], own["analyses"], power(own["violation"]), power(own["optimality"]),
    ]  # fmt: skip


def _short(value: float) -> str:
    return f"{value:.4g}" if abs(value) >= 1e-3 else power(value)


def sketched(file, seal) -> tuple[np.ndarray, list]:
    """For the reduced mode: a placeholder design and its row."""
    aim, none = label(file.optimize.minimize), power(nan)
    return -0.1 * design_bounds(file, seal), [aim, *[none] * 6]


def example(name: str, reduced: bool):
    """Read an example; in the reduced mode the first part of its path."""
    file = sm.read_seal_file(ROOT / "examples" / f"{name}.toml")
    return begun(file) if reduced else file


def example_seal(file, reduced: bool) -> sm.Seal:
    """Build the seal of an example with the stored load steps and penalties, of a part with its own."""
    chosen = {} if reduced else accuracy_study.stored("example_choice", name=file.path.stem)
    return sm.build_seal(file, **chosen)


def begun(file):
    """The file with the first part of every stage."""

    def short(stage):
        if file.step_tolerance is not None:
            return replace(
                stage, steps=1, translate=tuple(x / SHARE for x in stage.translate),
                rotate=stage.rotate / SHARE,
            )  # fmt: skip
        steps = max(1, stage.steps // SHARE)
        part = steps / stage.steps
        return replace(
            stage, steps=steps, translate=tuple(part * x for x in stage.translate),
            rotate=part * stage.rotate,
        )  # fmt: skip

    profiles = [replace(p, stages=tuple(map(short, p.stages))) for p in file.profiles]
    fluids = [
        replace(f, steps=f.steps and max(1, f.steps // SHARE), pressure=f.pressure / SHARE)
        for f in file.fluids
    ]
    # measures at a travel: at the same fraction of it
    measures = [
        replace(m, travel=m.travel / SHARE) if getattr(m, "travel", None) is not None else m
        for m in file.measures
    ]
    return replace(file, profiles=tuple(profiles), fluids=tuple(fluids), measures=tuple(measures))

"""The worked examples of seal files, and their optima."""

import re
import tempfile
from dataclasses import replace
from math import nan
from pathlib import Path

import numpy as np

import seal_mdao as sm
from figures.drawing import ROOT
from figures.tables import power, table
from seal_mdao.drivers.optimality import measure_optimality
from seal_mdao.file_optimization import design_bounds, file_task
from seal_mdao.geometry.motion import Stage
from seal_mdao.optimization import RunOptions, major_iterations, optimization_problem
from seal_mdao.plotting import (
    deformed_shapes,
    design_comparison,
    load_deflection,
    save,
    section_cloud,
)
from seal_mdao.recording.recorded_optimization import label, shown_unit

EXAMPLES = sorted(path.stem for path in (ROOT / "examples").glob("*.toml"))
SHARE = 8
"""Of the steps and of the travel that is left in the reduced mode."""


def make(out: Path, reduced: bool) -> dict:
    """Section, deformed shapes, load-deflection and optimum of every example, and its measures."""
    numbers, rows = {}, []
    for name in EXAMPLES:
        file, folder = example(name, reduced), out / "seal_files"
        seal = sm.build_seal(file)
        result = sm.analyze(seal)
        result.require_converged()
        save(section_cloud(result), folder / f"{name}_section.png")
        save(deformed_shapes(result), folder / f"{name}_shapes.png")
        save(load_deflection(result), folder / f"{name}_load.png")
        if file.optimize is not None:
            offsets, row = (sketched if reduced else optimised)(file, seal)
            best = sm.analyze(seal, offsets)
            best.require_converged()
            save(design_comparison(result, best), folder / f"{name}_optimum.png")
            rows.append([f"`{name}`", *row])
        numbers[name] = {"particles": len(result.particles)} | {
            re.sub(r"\W", "_", measure.name): f"{result.value(measure)[0]:.4g}"
            for measure in result.measures()
            if measure.size(result.seal)
        }
    return {"examples": numbers, "optima": table(HEAD, rows)}


HEAD = (
    "example", "minimised", "before", "after", "iterations", "analyses", "largest violation",
    "optimality",
)  # fmt: skip


def optimised(file, seal) -> tuple[np.ndarray, list]:
    """The optimum that a file asks for, and its row of the table."""
    with tempfile.TemporaryDirectory() as folder:
        run = RunOptions(work_dir=folder)
        problem = optimization_problem(file_task(file, run.analyze(seal)), run)
        driver, aim = problem.driver, file.optimize.minimize
        problem.final_setup()
        problem.run_model()
        before = problem.get_val(aim)[0]
        if not problem.run_driver().success:
            raise RuntimeError(f"{file.path}: {driver.exit_message}")
        found = measure_optimality(driver)
        after, offsets = problem.get_val(aim)[0], problem.get_val("boundary_offsets").copy()
        iterations, analyses = major_iterations(problem), driver.result.model_evals
        problem.cleanup()
    unit = shown_unit(next(m.units for m in seal.standard if m.name == aim))
    conditions = max(found.stationarity, found.complementarity)
    return offsets, [
        label(aim), *(f"{_short(value)} {unit}" for value in (before, after)), iterations, analyses,
        power(found.infeasibility), power(conditions),
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


def begun(file):
    """The file with the first part of every stage."""

    def short(stage):
        if file.step_tolerance is not None:
            return Stage(1, tuple(x / SHARE for x in stage.translate), stage.rotate / SHARE)
        steps = max(1, stage.steps // SHARE)
        part = steps / stage.steps
        return Stage(steps, tuple(part * x for x in stage.translate), part * stage.rotate)

    profiles = [replace(p, stages=tuple(map(short, p.stages))) for p in file.profiles]
    fluids = [
        replace(f, steps=max(1, f.steps // SHARE), pressure=f.pressure / SHARE) for f in file.fluids
    ]
    # measures at a travel: at the same fraction of it
    measures = [
        replace(m, travel=m.travel / SHARE) if getattr(m, "travel", None) is not None else m
        for m in file.measures
    ]
    return replace(file, profiles=tuple(profiles), fluids=tuple(fluids), measures=tuple(measures))

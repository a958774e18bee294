"""The optima of the examples that have an ``[optimize]`` table, stored for the pages.

    python tests/verification/example_optima.py [EXAMPLE ...]

runs the optimisations, which take ten minutes of a processor, and writes ``references/optima.json``.
A long test optimises one again and continues from the others; a quick one analyses a stored design.
"""

import argparse
import json
import multiprocessing
import os
import tempfile
from dataclasses import replace
from pathlib import Path

import seal_mdao as sm
from seal_mdao.drivers.optimality import measure_optimality
from seal_mdao.file_optimization import file_task
from seal_mdao.optimization import (
    OPTIMALITY,
    TOLERANCE,
    RunOptions,
    major_iterations,
    optimization_problem,
)

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
OPTIMA = Path(__file__).parent / "references" / "optima.json"
OPTIMISED = [
    p.stem for p in sorted(EXAMPLES.glob("*.toml")) if "[optimize]" in p.read_text("utf-8")
]
"""Examples that ask for an optimisation."""
BLIND = "ten_year_seal, limit when closed"
LIMITED = {BLIND: ("ten_year_seal", "closing_force")}
"""For comparison: an example, and the measure to which its first limit applies, the only one."""
NAMES = [*OPTIMISED, *LIMITED]


def optimized_file(name: str) -> sm.SealFile:
    """Read the file of an optimum of ``NAMES``."""
    stem, measure = LIMITED.get(name, (name, None))
    file = sm.read_seal_file(EXAMPLES / f"{stem}.toml")
    if measure is None:
        return file
    limit = replace(file.optimize.constraints[0], measure=measure)
    return replace(file, optimize=replace(file.optimize, constraints=(limit,)))


def optimum(name: str, start=None) -> dict:
    """Optimise an example, or one of ``LIMITED``.

    Parameters
    ----------
    name : str
    start : array_like, optional
        Boundary offsets of the first design (mm); the nominal seal when left out.

    Returns
    -------
    dict
        Boundary offsets (mm), objective before and after, iterations, analyses, largest violation
        and the larger of stationarity and complementarity.

    Raises
    ------
    RuntimeError
        When the optimiser fails, or ends where the optimality conditions do not hold.
    """
    file = optimized_file(name)
    seal, aim = sm.build_seal(file), file.optimize.minimize
    with tempfile.TemporaryDirectory() as folder:
        run = RunOptions(work_dir=folder)
        problem = optimization_problem(file_task(file, run.analyze(seal)), run)
        problem.final_setup()
        problem.run_model()
        before = float(problem.get_val(aim)[0])
        if start is not None:
            problem.set_val("boundary_offsets", start)
        success = problem.run_driver().success
        found = measure_optimality(problem.driver)
        if not (success and found.satisfied(OPTIMALITY, TOLERANCE)):
            raise RuntimeError(f"{name}: {problem.driver.exit_message}, {found}")
        values = {
            "before": before,
            "after": float(problem.get_val(aim)[0]),
            "iterations": major_iterations(problem),
            "analyses": problem.driver.result.model_evals,
            "violation": float(found.infeasibility),
            "optimality": float(max(found.stationarity, found.complementarity)),
            "offsets": problem.get_val("boundary_offsets").tolist(),
        }
        problem.cleanup()
    return values


def stored() -> dict[str, dict]:
    """Optimum of every example by its name, as ``optimum`` returns it."""
    return json.loads(OPTIMA.read_text(encoding="utf-8")) if OPTIMA.exists() else {}


def main(arguments=None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE", help=", ".join(NAMES))
    names = parser.parse_args(arguments).examples or NAMES
    # spawned, for numba's threads do not survive a fork
    with multiprocessing.get_context("spawn").Pool(min(2, os.cpu_count() or 1)) as pool:
        found = stored() | dict(zip(names, pool.map(optimum, names, chunksize=1), strict=True))
    ordered = {name: found[name] for name in NAMES if name in found}
    # a line for every optimum keeps the file short
    lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(own)}" for name, own in ordered.items())
    OPTIMA.write_text(f"{{\n{lines}\n}}\n", encoding="utf-8")


if __name__ == "__main__":
    main()

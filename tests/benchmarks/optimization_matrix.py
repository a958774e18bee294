"""Solve problem (71) in a matrix of cases, each with every optimiser."""

import json
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from pathlib import Path

from matrix_cases import Case, combinations, drawn_cases, single_changes
from matrix_page import KKT, VIOLATION, converged, page
from tqdm import tqdm

import seal_mdao as sm
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli.arguments import parser, plain, positive_integer, run, write_summary
from seal_mdao.door_optimization import DoorProblem, door_task
from seal_mdao.drivers.optimality import measure_optimality
from seal_mdao.optimization import (
    OBJECTIVE_REF,
    OPTIMIZERS,
    RunOptions,
    major_iterations,
    optimization_problem,
)
from seal_mdao.recording.run_log import versions
from seal_mdao.seals.door.door_seal import DOOR
from seal_mdao.seals.gaps import largest_gap

NOTHING = dict.fromkeys(
    ("success", "iterations", "analyses", "cost", "largest_gap_mm", "violation", "optimality"), None
)
"""results of a run that was ended by an exception."""


def main(arguments) -> int:
    cases = [*single_changes(), *combinations(20), *drawn_cases()][: arguments.first]
    runs = [(case, name) for case in cases for name in arguments.optimizers]
    record = arguments.out / "runs.jsonl"
    rows = read_rows(record)
    missing = [entry for entry in runs if key(*entry, arguments.n_steps) not in rows]
    solve = partial(solve_case, n_steps=arguments.n_steps)
    with record.open("a", encoding="utf-8") as file:
        done = finished(solve, missing, arguments.workers)
        for row in tqdm(done, total=len(runs), initial=len(runs) - len(missing), unit="run"):
            rows[row["case"], row["optimizer"], row["n_steps"]] = row
            file.write(json.dumps(plain(row)) + "\n")
            file.flush()
    table = [rows[key(*entry, arguments.n_steps)] for entry in runs]
    write_page(arguments.page or arguments.out / "matrix.md", table)
    good = sum(map(converged, table))
    write_summary(arguments.out, {"runs": len(table), "converged": good, "table": table})
    print(f"{good} of {len(table)} runs converged; runs.jsonl and summary.json in {arguments.out}")
    return 0 if good == len(table) else 1


def key(case: Case, optimizer: str, n_steps: int) -> tuple:
    """What identifies a run."""
    return case.name, optimizer, n_steps


def read_rows(record: Path) -> dict:
    """The runs that an earlier call finished; a line cut off by a kill is left out."""
    rows = {}
    if record.exists():
        for line in record.read_text(encoding="utf-8").splitlines():
            try:
                row = json.loads(line)
            except ValueError:
                continue
            rows[row["case"], row["optimizer"], row["n_steps"]] = row
    return rows


def finished(solve, entries: list, workers: int) -> Iterator[dict]:
    """Rows as they come; with one worker from this process, else from that many others."""
    if workers == 1 or len(entries) < 2:
        yield from map(solve, entries)
        return
    compile_kernels()
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=spawn) as pool:
        for future in as_completed([pool.submit(solve, entry) for entry in entries]):
            yield future.result()


def compile_kernels() -> None:
    """Here and once, so that the workers find them in the cache."""
    short = sm.door_seal(depth=1.0, n_steps=2)
    sm.differentiate(sm.analyze(short, keep_factors=True), method="adjoint")


def solve_case(entry: tuple[Case, str], n_steps: int) -> dict:
    """One optimisation with the settings of ``seal_mdao.optimization``."""
    (case, optimizer), begun = entry, time.perf_counter()
    row = {"case": case.name, "optimizer": optimizer, "n_steps": n_steps}
    with tempfile.TemporaryDirectory() as folder:
        try:
            row |= solve(case, OPTIMIZERS[optimizer](), n_steps, folder)
        except Exception as error:  # the table names it
            row |= NOTHING | {"message": f"{type(error).__name__}: {error}"}
    return row | {"seconds": time.perf_counter() - begun, "versions": versions()}


def solve(case: Case, driver, n_steps: int, folder: str) -> dict:
    """Run a driver on a case, and measure its last point; ``cost`` is over that of the nominal seal."""
    seal, cache = case.seal(n_steps=n_steps), AnalysisCache()
    run = RunOptions(driver, cache=cache, work_dir=folder)
    task = door_task(run.analyze(seal), DoorProblem(**case.settings()))
    problem = optimization_problem(task, run)
    offsets, radius = case.design(seal)
    problem.set_val("boundary_offsets", offsets)
    problem.set_val("door_radius", radius)
    success = problem.run_driver().success
    (objective,) = driver.get_objective_values(driver_scaling=True).values()
    end = measure_optimality(driver)
    best = {"door_radius": float(problem.get_val("door_radius")[0])}
    last = cache.analyze(seal, problem.get_val("boundary_offsets"), best)
    return {
        "success": bool(success),
        "iterations": major_iterations(problem),
        "analyses": driver.result.model_evals,
        "cost": OBJECTIVE_REF * float(objective[0]),
        "largest_gap_mm": largest_gap(last, DOOR).size,
        "violation": end.infeasibility,
        "optimality": max(end.stationarity, end.complementarity),
        "message": str(driver.result.exit_status),
    }


def write_page(path: Path, table: list[dict]) -> None:
    """The page about the runs that there are."""
    drawn = {case.name for case in drawn_cases()}
    path.write_text(page(table, drawn), encoding="utf-8")
    print(f"wrote {path}")


def arguments_parser():
    made = parser(__doc__, "out/matrix")
    made.add_argument(
        "--optimizers", nargs="+", choices=list(OPTIMIZERS), default=list(OPTIMIZERS),
        help="methods",
    )  # fmt: skip
    made.add_argument(
        "--first", type=positive_integer, metavar="N", help="only the first cases; all if left out"
    )
    made.add_argument(
        "--workers", type=positive_integer, default=1, metavar="N", help="processes that solve"
    )
    made.add_argument(
        "--n-steps", type=positive_integer, default=sm.door_seal().n_steps, metavar="N",
        help="load steps",
    )  # fmt: skip
    made.add_argument(
        "--page", type=Path, metavar="FILE.md", help="page to write; matrix.md in DIR if left out"
    )
    made.epilog = (
        f"A run has converged when the optimiser says so, the optimality conditions hold to {KKT:g} "
        f"and the limits to {VIOLATION:g}. Runs that runs.jsonl in DIR holds are not repeated."
    )
    return made


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))

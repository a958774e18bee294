"""Solve problem (71) from everywhere: a matrix of variants, each with SLSQP and with IPOPT."""

import json
import multiprocessing
import sys
import tempfile
import time
from dataclasses import asdict
from functools import partial

from _common import parser, plain, run, write_summary
from _matrix_cases import Case, combinations, single_changes
from tqdm import tqdm

import seal_mdao as sm
from seal_mdao.drivers.optimality import measure_optimality
from seal_mdao.optimization import OPTIMALITY, OPTIMIZERS, seal_problem

FEASIBLE = 1e-3
"""Largest scaled constraint violation at the end of a run that counts as converged; its optimality
has to hold to the optimisers' own tolerance, measured in the same way for both."""


def main(arguments) -> int:
    cases = [*single_changes(), *combinations(arguments.combinations)]
    runs = [(case, name) for case in cases[: arguments.first] for name in arguments.optimizers]
    record = arguments.out / "runs.jsonl"
    rows = read_rows(record)
    missing = [entry for entry in runs if key(*entry) not in rows]
    solve = partial(solve_case, n_steps=arguments.n_steps)
    # a process for every run: whatever happens in one does not touch the others
    with (
        multiprocessing.get_context("spawn").Pool(arguments.jobs, maxtasksperchild=1) as pool,
        record.open("a", encoding="utf-8") as file,
    ):
        done = pool.imap_unordered(solve, missing)
        for row in tqdm(done, total=len(runs), initial=len(runs) - len(missing), unit="run"):
            rows[row["case"], row["optimizer"]] = row
            file.write(json.dumps(plain(row)) + "\n")
            file.flush()
    table = [rows[key(*entry)] for entry in runs]
    converged = sum(row["converged"] for row in table)
    worst = max(table, key=lambda row: (not row["converged"], row["iterations"]))
    (arguments.out / "matrix.md").write_text(markdown(table), encoding="utf-8")
    write_summary(
        arguments.out,
        {"runs": len(table), "converged": converged, "worst": worst, "table": table},
    )
    print(f"{converged} of {len(table)} runs converged; matrix.md, summary.json in {arguments.out}")
    print(f"worst: {worst['optimizer']}, {worst['case']}: {worst['iterations']} iterations")
    return 0 if converged == len(table) else 1


def key(case: Case, optimizer: str) -> tuple:
    """What identifies a run."""
    return case.name, optimizer


def read_rows(record) -> dict:
    """The runs that an earlier call finished; a line cut off by a kill is left out."""
    rows = {}
    if record.exists():
        for line in record.read_text(encoding="utf-8").splitlines():
            try:
                row = json.loads(line)
            except ValueError:
                continue
            rows[row["case"], row["optimizer"]] = row
    return rows


def solve_case(entry, n_steps) -> dict:
    """One optimisation with the default settings of ``seal_problem``'s drivers."""
    case, optimizer = entry
    model = case.model(n_steps=n_steps)
    start = sm.analyze(model).gap_square_sum
    driver, begun = OPTIMIZERS[optimizer](), time.perf_counter()
    row = {"case": case.name, "optimizer": optimizer, **asdict(case)}
    with tempfile.TemporaryDirectory() as folder:
        try:
            problem = seal_problem(model, driver=driver, work_dir=folder)
            offsets, radius = case.design(model)
            problem.set_val("boundary_offsets", offsets)
            problem.set_val("door_radius", radius)
            success = problem.run_driver().success
            message = str(driver.result.exit_status)
        except Exception as error:  # the table names it
            return row | {
                "converged": False, "iterations": -1, "analyses": -1, "cost": None,
                "violation": None, "optimality": None, "failed": -1,
                "seconds": time.perf_counter() - begun,
                "message": f"{type(error).__name__}: {error}",
            }  # fmt: skip
        end = measure_optimality(driver)
    optimality = max(end.stationarity, end.complementarity)
    return row | {
        "converged": bool(success and end.infeasibility <= FEASIBLE and optimality <= OPTIMALITY),
        "iterations": driver.result.iter_count,
        "analyses": driver.result.model_evals,
        "cost": float(problem.get_val("gap_square_sum")[0]) / start,
        "violation": end.infeasibility,
        "optimality": optimality,
        "failed": driver.failed_analyses,
        "seconds": time.perf_counter() - begun,
        "message": message,
    }


def markdown(table) -> str:
    """All runs, a line each case."""
    names = list(dict.fromkeys(row["optimizer"] for row in table))
    head = " | ".join(f"{name}: iterations (analyses), cost, KKT" for name in names)
    lines = [f"| case | {head} |", "|---" * (len(names) + 1) + "|"]
    for case in dict.fromkeys(row["case"] for row in table):
        cells = {row["optimizer"]: _cell(row) for row in table if row["case"] == case}
        lines.append(f"| {case} | " + " | ".join(cells[name] for name in names) + " |")
    return "\n".join(lines) + "\n"


def _cell(row) -> str:
    if row["cost"] is None:
        return row["message"]
    text = (
        f"{row['iterations']} ({row['analyses']}), {100 * row['cost']:.4f} %, "
        f"{row['optimality']:.0e}"
    )
    return text if row["converged"] else f"**not converged**: {text}"


def arguments_parser():
    made = parser(__doc__, "out/matrix")
    made.add_argument(
        "--optimizers", nargs="+", choices=sorted(OPTIMIZERS), default=[*OPTIMIZERS],
        help="methods",
    )  # fmt: skip
    made.add_argument(
        "--combinations", type=int, default=20, metavar="N",
        help="random combinations after the single changes",
    )  # fmt: skip
    made.add_argument(
        "--first", type=int, metavar="N", help="only the first cases; all if left out"
    )
    made.add_argument("--jobs", type=int, default=1, metavar="N", help="runs at a time")
    made.add_argument(
        "--n-steps", type=int, default=sm.door_seal().n_steps, metavar="N", help="load steps"
    )
    return made


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))

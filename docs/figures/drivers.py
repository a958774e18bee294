"""The optimisation drivers on the Hock-Schittkowski problems of the tests."""

import contextlib
import io
import os
import sys
import tempfile
from pathlib import Path

from figures.tables import power, table

PROBLEMS_OF_THE_TESTS = Path(__file__).resolve().parents[2] / "tests" / "drivers"
NBSP = "\N{NO-BREAK SPACE}"
FEW = (1, 6, 35, 71)
"""Problems of the reduced mode."""


def _constraints(problem) -> str:
    """How many, and of what kind."""
    if problem.c is None:
        return "bounds"
    equal = sum(low == high for low, high in zip(problem.c_lower, problem.c_upper, strict=True))
    count = len(problem.c_lower)
    return ", ".join(
        text for number, text in ((equal, f"{equal} ="), (count - equal, f"{count - equal} ≤"))
        if number
    )  # fmt: skip


def make(out: Path, reduced: bool) -> dict:
    """The table, and the largest error of each driver in units of its bound."""
    sys.path.append(str(PROBLEMS_OF_THE_TESTS))
    from hock_schittkowski import PROBLEMS, solve

    rows, solutions = [], {"Uno": [], "IPOPT": [], "SLSQP": []}
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        os.chdir(folder)
        try:
            for number in FEW if reduced else sorted(PROBLEMS):
                problem = PROBLEMS[number]
                row = [number, len(problem.start), _constraints(problem), f"{problem.optimum:.6g}"]
                for driver, found in solutions.items():
                    found.append(solve(number, driver))
                    row += _cells(found[-1])
                rows.append(row)
        finally:
            os.chdir(here)
    head = ["problem", "variables", "constraints", "known optimum"]
    for name in solutions:
        head += [f"{name}: error (bound)", "iterations / analyses"]
    converged = {name: sum(s.success for s in found) for name, found in solutions.items()}
    worst = {name: max(s.error / s.bound for s in found) for name, found in solutions.items()}
    return {
        "table": table(head, rows),
        "problems": len(rows),
        **{f"{name.lower()}_converged": count for name, count in converged.items()},
        **{f"{name.lower()}_error": f"{ratio:.1g}" for name, ratio in worst.items()},
    }


def _cells(solution) -> list[str]:
    """Error with its bound, and counts; SLSQP counts analyses only."""
    error, bound = (power(v, 0).replace(" ", NBSP) for v in (solution.error, solution.bound))
    counts = f"{solution.iterations}{NBSP}/{NBSP}{solution.model_evals}"
    if solution.driver == "SLSQP":
        counts = f"{solution.model_evals}"
    return [f"{error} ({bound})", counts if solution.success else f"not converged: {counts}"]

"""Both optimisation drivers on the Hock-Schittkowski problems of the tests."""

import contextlib
import io
import os
import sys
import tempfile
from pathlib import Path

from figures.tables import power, table

PROBLEMS_OF_THE_TESTS = Path(__file__).resolve().parents[2] / "tests" / "drivers"
SHORT = {
    "Optimal solution found": "optimal",
    "Optimization terminated successfully": "optimal",
}
NBSP = "\N{NO-BREAK SPACE}"
FEW = (1, 6, 35, 71)
"""Problems of the reduced mode."""


def _status(solution) -> str:
    """In a word where it is a success."""
    return next(
        (s for text, s in SHORT.items() if solution.status.startswith(text)), solution.status
    )


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
    """The table, and the largest errors.

    Raises
    ------
    RuntimeError
        When a driver fails.
    """
    sys.path.append(str(PROBLEMS_OF_THE_TESTS))
    from hock_schittkowski import PROBLEMS, solve

    rows, solutions = [], {"Ipopt": [], "Resilient": []}
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        os.chdir(folder)
        try:
            for number in FEW if reduced else sorted(PROBLEMS):
                problem = PROBLEMS[number]
                row = [number, len(problem.start), _constraints(problem), f"{problem.optimum:.6g}"]
                for driver, found in solutions.items():
                    s = solve(number, driver)
                    if not s.success:
                        raise RuntimeError(f"problem {number}, {driver}: {s.status}")
                    found.append(s)
                    row += [
                        power(s.error, 0).replace(" ", NBSP),
                        f"{_status(s)}: {s.iterations}{NBSP}/{NBSP}{s.model_evals}",
                    ]
                rows.append(row)
        finally:
            os.chdir(here)
    head = ["problem", "variables", "constraints", "known optimum"]
    for name in ("IPOPT", "SLSQP"):
        head += [f"{name}: error", "status: iterations / analyses"]
    return {
        "table": table(head, rows),
        "problems": len(rows),
        **{
            f"{name}_error": power(max(s.error for s in found), 0)
            for name, found in (("ipopt", solutions["Ipopt"]), ("slsqp", solutions["Resilient"]))
        },
    }

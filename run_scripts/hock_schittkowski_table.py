"""Solve Hock-Schittkowski problems with both drivers; write hock_schittkowski.md."""

import sys
from pathlib import Path

from _common import parser, run, write_summary

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "drivers"))

from hock_schittkowski import PROBLEMS, HSProblem, Solution, solve

DRIVERS = {"IpoptDriver": "Ipopt", "ResilientSLSQPDriver": "Resilient"}
"""Drivers of the table, and how the problems' module calls them."""

ACCURACY = 1e-6
"""Largest relative error of the objective, and violation, of a solved problem."""


def main(arguments) -> int:
    solved = {
        number: {driver: solve(number, name) for driver, name in DRIVERS.items()}
        for number in sorted(PROBLEMS)
    }
    text = markdown(solved)
    (arguments.out / "hock_schittkowski.md").write_text(text, encoding="utf-8")
    successes = {
        driver: sum(reached(solutions[driver]) for solutions in solved.values())
        for driver in DRIVERS
    }
    write_summary(arguments.out, {"problems": len(solved), "solved": successes})
    for driver, count in successes.items():
        print(f"{driver}: {count} of {len(solved)} problems solved")
    return 0 if set(successes.values()) == {len(solved)} else 1


def reached(solution: Solution) -> bool:
    """Whether the driver reports success and is right."""
    return solution.success and max(solution.error, solution.violation) < ACCURACY


def markdown(solved: dict) -> str:
    """All problems, a line each driver."""
    lines = [
        "| HS | variables | constraints | known optimum | driver | found optimum | evaluations "
        "(gradients) | iterations | status |",
        "|---:|---:|---:|---:|---|---:|---:|---:|---|",
    ]
    for number, solutions in solved.items():
        first = _problem_cells(PROBLEMS[number])
        for driver, solution in solutions.items():
            lines.append(f"| {first} | {driver} | {_solution_cells(solution)} |")
            first = " | ".join([""] * 4)
    return "\n".join(lines) + "\n"


def _problem_cells(problem: HSProblem) -> str:
    cells = (
        problem.number, len(problem.start), len(problem.c_lower), f"{problem.optimum:.7g}",
    )  # fmt: skip
    return " | ".join(map(str, cells))


def _solution_cells(solution: Solution) -> str:
    cells = (
        _number(solution.objective), f"{solution.model_evals} ({solution.deriv_evals})",
        solution.iterations, solution.status,
    )  # fmt: skip
    return " | ".join(map(str, cells))


def _number(value: float) -> str:
    """Seven digits; what is left of zero as zero."""
    return f"{0.0 if abs(value) < 1e-9 else value:.7g}"


def arguments_parser():
    return parser(__doc__, "out/hock_schittkowski")


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))

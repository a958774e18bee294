"""Print and draw a recorded design of experiments, or other cases that no optimiser has chosen."""

from pathlib import Path

import numpy as np

from seal_mdao import plotting
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli.arguments import penalty_table, write_summary
from seal_mdao.recording.recorded_optimization import (
    KINDS,
    RecordedOptimization,
    label,
    unit_of,
)

LISTED = 20
"""Cases that a line lists."""


def show_cases(history: RecordedOptimization, seal, cache: AnalysisCache, out: Path) -> int:
    """Print the range of every recorded quantity and the best case, and draw the objective, the
    constraints and the best design; without an objective the constraints only."""
    numbers, figures, warnings = case_numbers(history), {}, ()
    summary = numbers
    if history.objective_name:
        design = history.design_at(history.best)
        result = cache.analyze(seal, *design)
        warnings = result.warnings
        summary = (
            numbers
            | {"penalty_error": penalty_table(result), "warnings": warnings}
            | {"boundary_offsets": design[0], **design[1]}
        )
        figures["objective_cases"] = plotting.objective_history(history)
        figures["best"] = plotting.deformed_shapes(result)
    write_summary(out, summary)
    if history.constraints:
        figures["constraint_cases"] = plotting.constraint_history(history)
    for name, figure in figures.items():
        plotting.save(figure, out / f"{name}.png")
    for line in case_lines(history, numbers):
        print(line)
    for text in warnings:
        print(f"WARNING (case {numbers['best']['case']}): {text}")
    print(f"{'figures and ' if figures else ''}summary.json in {out}")
    return 0


def case_numbers(history: RecordedOptimization) -> dict:
    """Collect the ranges of all quantities, and the best case if there is an objective, for
    summary.json."""
    name, feasible = history.objective_name, history.feasible
    ranges = {name: _range(history, name, history.objective)} if name else {}
    for own in history.constraints:
        ranges[own.name] = _range(history, own.name, own.values) | {
            "lower": own.lower, "upper": own.upper,
            "satisfied": int(own.satisfied().sum()),
        }  # fmt: skip
    ranges |= {own: _range(history, own, values) for own, values in history.design.items()}
    numbers = {
        "kind": KINDS[history.kind],
        "cases": len(history.objective),
        "failed": history.failed,
        "feasible": int(feasible.sum()),
        "feasible_cases": history.analyses[feasible].tolist(),
        "ranges": ranges,
    }
    if not name:
        return numbers
    best = history.best
    return numbers | {
        "best": {
            "case": int(history.analyses[best]),
            "objective": history.objective[best],
            "max_constraint_violation": history.max_violation[best],
            "design": {own: values[best] for own, values in history.design.items()},
        },
    }


def _range(history: RecordedOptimization, name: str, values: np.ndarray) -> dict:
    return {"unit": unit_of(history, name), "lowest": values.min(), "highest": values.max()}


def case_lines(history: RecordedOptimization, numbers: dict) -> list[str]:
    """Describe all cases: their number, a line for each quantity, and the best case."""
    cases, feasible = numbers["cases"], numbers["feasible"]
    runs = f" in {len(history.run_starts) + 1} runs" if history.run_starts else ""
    lines = [
        f"{numbers['kind']}: {cases} case{'s' * (cases > 1)} with values{runs}, "
        f"{numbers['failed']} failed"
    ]
    for name, row in numbers["ranges"].items():
        size = history.design[name].shape[1] if name in history.design else 1
        ends = " to ".join(dict.fromkeys(f"{row[end]:.6g}" for end in ("lowest", "highest")))
        text = f"{label(name)}{f' ({size} values)' if size > 1 else ''}: {ends} {row['unit']}"
        lines.append(text.rstrip() + _satisfied(row, cases))
    if not history.objective_name:
        return lines + _feasible_cases(numbers) if history.constraints else lines
    best = numbers["best"]
    name, unit = label(history.objective_name), unit_of(history, history.objective_name)
    side = "highest" if history.maximized else "lowest"
    if not feasible:
        text = (
            f"no case satisfies all constraints; case {best['case']} has the smallest violation, "
            f"{best['max_constraint_violation']:.2%} of a limit"
        )
    elif feasible == 1:
        text = f"case {best['case']} is the only one that satisfies all constraints"
    else:
        text = (
            f"case {best['case']} has the {side} {name} "
            f"of the {feasible} that satisfy all constraints"
        )
    return [*lines, f"{text}: {name} {best['objective']:.6g} {unit}".rstrip()]


def _feasible_cases(numbers: dict) -> list[str]:
    """List the first cases that satisfy all constraints, and count the others."""
    found = numbers["feasible_cases"]
    if not found:
        return ["no case satisfies all constraints"]
    more = f" and {len(found) - LISTED} more" if len(found) > LISTED else ""
    text = f"{len(found)} of {numbers['cases']} satisfy all constraints: "
    return [text + f"case{'s' * (len(found) > 1)} {', '.join(map(str, found[:LISTED]))}{more}"]


def _satisfied(row: dict, cases: int) -> str:
    """Name the limits of a constraint and count the cases that satisfy them; empty without limits."""
    limits = [
        f"{sign} {row[side]:.6g}"
        for side, sign in (("lower", "≥"), ("upper", "≤"))
        if np.isfinite(row.get(side, np.inf))
    ]
    if not limits:
        return ""
    return f", {' and '.join(limits)}: satisfied by {row['satisfied']} of {cases}"

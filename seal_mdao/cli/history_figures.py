"""Figures and results of an optimisation, for the subcommands that run it or read its record."""

from pathlib import Path

import numpy as np

from seal_mdao import plotting
from seal_mdao.cli.arguments import penalty_table
from seal_mdao.plotting.style import scientific
from seal_mdao.recording.recorded_optimization import RecordedOptimization, label, unit_of
from seal_mdao.report.scenarios_table import NOMINAL
from seal_mdao.seals.door.door_seal import DOOR
from seal_mdao.seals.gaps import gaps_unmeasured_by, largest_gap
from seal_mdao.seals.result import SealResult


def draw_history(
    history: RecordedOptimization, initial: SealResult, final: SealResult, out: Path
) -> list[Path]:
    """Draw cost history, constraint history and both designs side by side; return the files."""
    figures = {
        "cost_history": plotting.cost_history(history),
        "designs": plotting.design_comparison(initial, final, gap_words(initial, final)),
    }
    _name_condition(history, figures["designs"])
    # only problems with constraints
    if history.constraints:
        particles = initial.measure("von_mises").points
        figures["constraint_history"] = plotting.constraint_history(history, particles)
    return [plotting.save(figure, out / f"{name}.png") for name, figure in figures.items()]


def _name_condition(history: RecordedOptimization, figure) -> None:
    """Write above a figure of designs that it shows the nominal condition, where there are scenarios."""
    if any(own.scenarios for own in history.seals):
        # a path that was not completed has a title
        parts = [text for text in (figure.get_suptitle(), NOMINAL) if text]
        figure.suptitle("; ".join(parts), fontsize=10.5)


def gap_words(*results) -> list[str]:
    """Format sum of squared gaps and vertical reaction of each design as captions."""
    return [
        f"$\\Sigma g_n^2$ = {scientific(r.gap_square_sum)} mm², "
        f"{r.reaction[-1, 1]:.1f} {r.seal.units.force}"
        for r in results
    ]


def history_rows(history: RecordedOptimization) -> list[dict]:
    """List objective ratio and largest relative violation of every major iteration."""
    pairs = zip(history.objective_ratio, history.max_violation, strict=True)
    return [
        {"iteration": i, "objective_ratio": ratio, "max_constraint_violation": violation}
        for i, (ratio, violation) in enumerate(pairs)
    ]


def end_numbers(history: RecordedOptimization, initial: SealResult, final: SealResult) -> dict:
    """Collect the results of the last design for summary.json."""
    # last design: boundary offsets and scalar parameters
    offsets, parameters = history.design_at(-1)
    start, end = (largest_gap(result, DOOR).size for result in (initial, final))
    return {
        "objective_ratio": history.objective_ratio[-1],
        "largest_gap_mm": {"start": start, "end": end},
        "max_constraint_violation": history.max_violation[-1],
        "area_mm2": final.area,
        "von_mises_kPa": final.von_mises,
        "reaction_ratio": final.reaction[-1, 1] / initial.reaction[-1, 1],
        "penalty_error": penalty_table(final),
        "warnings": [*final.warnings, *gap_warnings(history, final)],
        "boundary_offsets": offsets,
        # a recorder may omit it where it is no design variable
        "door_radius": final.seal.scalars["door_radius"].value,
        **parameters,
        "history": history_rows(history),
    }


def gap_warnings(history: RecordedOptimization, final: SealResult) -> tuple[str, ...]:
    """Warn where the largest gap of the last design is outside the range of the objective."""
    return gaps_unmeasured_by(final, history.objective_name.rsplit(".", 1)[-1])


def report_end(history: RecordedOptimization, numbers: dict) -> None:
    """Print three lines about the last design."""
    # without marks of major iterations, evaluations are counted
    kind = "gradients" if history.major else "evaluations"
    print(
        f"{len(history.objective) - 1} {kind}: objective at {100 * numbers['objective_ratio']:.4f} "
        "% of its initial value, largest constraint violation "
        f"{numbers['max_constraint_violation']:.1e}"
    )
    gap = numbers["largest_gap_mm"]
    print(f"largest gap between the contacts {gap['start']:.4f} -> {gap['end']:.4f} mm")
    print(
        f"area {numbers['area_mm2']:.2f} mm2, vertical reaction at "
        f"{100 * numbers['reaction_ratio']:.1f} % of its initial value, door radius "
        f"{numbers['door_radius']:.3f} mm"
    )


def limit_numbers(history: RecordedOptimization) -> dict:
    """Collect objective and constraints at first and last design for summary.json."""
    # in physical units, not in the scaling of the driver
    first, last = history.objective[[0, -1]]
    return {
        "objective": {
            "name": history.objective_name, "unit": unit_of(history, history.objective_name),
            "start": first, "end": last,
        },
        "constraints": {
            constraint.name: {
                "unit": unit_of(history, constraint.name),
                "start": constraint.values[0], "end": constraint.values[-1],
                "lower": constraint.lower, "upper": constraint.upper,
            }
            for constraint in history.constraints
        },
        "max_constraint_violation": history.max_violation[-1],
        "recorded_evaluations": history.evaluations,
    }  # fmt: skip


def draw_designs(history: RecordedOptimization, results, out: Path) -> None:
    """Draw histories, both designs side by side, and the deformed shapes of each."""
    name, unit = label(history.objective_name), unit_of(history, history.objective_name)
    words = [f"{name} {value:.4g} {unit}".rstrip() for value in history.objective[[0, -1]]]
    figures = {
        "objective_history": plotting.objective_history(history),
        "designs": plotting.design_comparison(*results, words),
        "start": plotting.deformed_shapes(results[0]),
        "optimum": plotting.deformed_shapes(results[1]),
    }
    for shown in ("designs", "start", "optimum"):
        _name_condition(history, figures[shown])
    # only problems with constraints
    if history.constraints:
        figures["constraint_history"] = plotting.constraint_history(history)
    for name, figure in figures.items():
        plotting.save(figure, out / f"{name}.png")


def report_limits(history: RecordedOptimization, ends: dict, kkt: dict | None) -> None:
    """Print objective and constraints, one per line, and the residuals of the optimality conditions."""
    # objective first
    rows = {ends["objective"]["name"]: ends["objective"]} | ends["constraints"]
    for name, row in rows.items():
        # only finite limits are printed
        limits = [f"{sign} {row[side]:.6g}" for side, sign in (("lower", "≥"), ("upper", "≤"))
                  if np.isfinite(row.get(side, np.inf))]  # fmt: skip
        text = f"{label(name)}: {row['start']:.6g} -> {row['end']:.6g} {row['unit']}".rstrip()
        print(f"{text}, {' and '.join(limits)}" if limits else text)
    if kkt is not None:
        # KKT residuals at the last design
        largest, sides = max(kkt["stationarity"], kkt["complementarity"]), kkt["sides_of_kink"]
        # at a kink the multipliers combine the gradients of several sides
        kink = f" with the derivatives of {sides} sides of a kink" if sides > 1 else ""
        print(
            f"optimality conditions hold to {largest:.1e}{kink}, largest violation of a constraint "
            f"{history.max_violation[-1]:.1e}"
        )

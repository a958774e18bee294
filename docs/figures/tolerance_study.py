"""Tolerances: the nominal and the robust optimum on samples, and what scenarios cost."""

import json
from pathlib import Path

import numpy as np

from figures.drawing import DOOR_SEAL, ROOT, curves
from seal_mdao.plotting import designs_compared, save
from seal_mdao.plotting.captions import captioned
from seal_mdao.plotting.style import BLUE, GREY, VERMILION

BENCHMARKS = ROOT / "docs" / "benchmarks"
LOOKS = {0: (GREY, "in line"), 1: (BLUE, "1 worker"), 2: (VERMILION, "2 workers")}


def make(out: Path, reduced: bool) -> dict:
    """Both figures from what was measured, and the numbers of the page."""
    found = json.loads((BENCHMARKS / "tolerances.json").read_text(encoding="utf-8"))
    costs = json.loads((BENCHMARKS / "scenario_costs.json").read_text(encoding="utf-8"))
    designs, robust = found["designs"], found["robust"]
    gaps = {f"{name} optimum": np.array(own["gap"]) for name, own in designs.items()}
    forces = {f"{name} optimum": np.array(own["reaction"]) for name, own in designs.items()}
    band = robust["reaction_band_N_per_m"]
    text = "reaction of the door (N/m)"
    figure = designs_compared(gaps, "gap integral", "mm**3", forces, band, text)
    with captioned(DOOR_SEAL, found["date"]):
        save(figure, out / "robust_comparison.png")
    rows = {n: [row for row in costs["rows"] if row["workers"] == n] for n in LOOKS}
    lines = [
        ([row["scenarios"] for row in own], [row["seconds"] for row in own], "o-", *LOOKS[n])
        for n, own in rows.items()
    ]
    labels, size = ("scenarios with gradients", "processor time, s"), (5.6, 3.6)
    with captioned(DOOR_SEAL, costs["date"]):
        curves(out / "scenario_costs.png", *labels, lines, size, xlim=(0, None), ylim=(0, None))
    return numbers(found, costs)


def numbers(found: dict, costs: dict) -> dict:
    """What the page quotes, as text."""
    robust, study = found["robust"], found["study"]
    made = {
        "ratio": f"{robust['ratio_of_95_percent_gaps']:.2g}",
        "samples": str(robust["samples"]), "scenarios": str(robust["scenarios"]),
        "evaluations": str(robust["model_evaluations"]),
        "low": f"{robust['reaction_band_N_per_m'][0]:.1f}",
        "high": f"{robust['reaction_band_N_per_m'][1]:.1f}",
        "floors": " and ".join(f"{value:.1f}" for value in robust["pressure_floor_kPa"]),
        "overhead": f"{costs['overhead_ms']:.2f}",
        "busy": f"{100 * min(own['both_busy'] for own in found['designs'].values()):.1f}",
    }  # fmt: skip
    for name in ("nominal", "robust"):
        own = robust["compared"][f"{name} optimum"]
        gap = own["gap_square_integral"]
        made |= {f"{name}_{key}": f"{gap[key]:.2g}" for key in ("q50", "mean", "q95", "highest")}
        made[f"{name}_band"] = f"{100 * own['share_in_reaction_band']:.1f}"
        made[f"{name}_floor"] = f"{100 * own['share_above_pressure_floor']:.0f}"
        made[f"{name}_failed"] = str(own["failed"])
    for name, key in (("gap", "gap_square_integral"), ("force", "reaction[1]"),
                      ("stress", "stress_norm"), ("patch", "patch_pressure[0]")):  # fmt: skip
        own = study[key]
        for kind in ("sampled", "first_order"):
            made |= {f"{name}_{kind}_{q}": f"{own[kind][q]:.3g}" for q in ("mean", "std", "q95")}
    last = max(costs["rows"], key=lambda row: (row["workers"], row["scenarios"]))
    alone = next(row for row in costs["rows"]
                 if row["workers"] == 0 and row["scenarios"] == last["scenarios"])  # fmt: skip
    made["efficiency"] = f"{alone['seconds'] / (last['workers'] * last['seconds']):.2f}"
    made["one"] = f"{alone['seconds'] / alone['scenarios']:.2f}"
    return made

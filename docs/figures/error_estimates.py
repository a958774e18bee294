"""Estimated errors by particles against actual ones, from ``tests/benchmarks/error_estimates.py``."""

import json
from pathlib import Path

import numpy as np

from figures.drawing import ROOT, picture
from figures.tables import table
from seal_mdao.plotting.style import CYCLE

STORED = ROOT / "docs" / "benchmarks" / "error_estimates.json"
CHOSEN = ROOT / "docs" / "benchmarks" / "chosen_particles.json"
"""Seals with chosen particles, from ``tests/benchmarks/chosen_particles.py``."""
SMALLEST = 1e-4
"""Relative error below which neither a table nor a figure needs it."""


def make(out: Path, reduced: bool) -> dict:
    """Figure and table of the page."""
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    rows = list(_rows(stored))
    _picture(out / "error_estimates.png", rows)
    estimated, actual, bars = np.array([row[2:] for row in rows]).T
    ratios, larger = estimated / actual, abs(actual) > 0.005
    within, covered = (ratios >= 0.5) & (ratios <= 2.0), bars >= 0.5 * abs(actual)
    times = [own["estimate_s"] / own["analysis_s"] for own in stored.values()]
    return {
        "table": table(
            ["example", "measure", "estimated error", "error bar", "actual error", "ratio"],
            [
                [name, measure, f"{100 * estimated:+.2g} %", f"{100 * bar:.2g} %",
                 f"{100 * actual:+.2g} %", f"{estimated / actual:.2f}"]
                for name, measure, estimated, actual, bar in rows
            ],
        ),
        "count": f"{within.sum()} of {len(rows)}",
        "count_larger": f"{(within & larger).sum()} of {larger.sum()}",
        "covered": f"{covered.sum()} of {len(rows)}",
        "covered_larger": f"{(covered & larger).sum()} of {larger.sum()}",
        **_chosen(json.loads(CHOSEN.read_text(encoding="utf-8"))),
        "times": f"{min(times):.1f} to {max(times):.1f}",
    }  # fmt: skip


def _chosen(stored: dict) -> dict:
    """Number of examples with chosen particles, and their largest difference from half the spacing."""
    away = [row["difference"] for own in stored.values() for row in own["errors"].values()]
    return {
        "chosen_seals": ", ".join(f"`{name}`" for name in stored),
        "chosen_difference": f"{100.0 * max(away):.2g} %",
    }


def _rows(stored: dict):
    """Every value with its estimated and actual error and its error bar by the particles, of actual
    errors above ``SMALLEST``."""
    for name, example in stored.items():
        for measure, errors in example["errors"].items():
            own = list(zip(errors["estimated"], errors["actual"], errors["bar"], strict=True))
            for number, (estimated, actual, bar) in enumerate(own):
                if abs(actual) > SMALLEST:
                    label = measure if len(own) == 1 else f"{measure}[{number}]"
                    yield name, label, estimated, actual, bar


def _picture(path: Path, rows) -> None:
    with picture(path, width=5.4, height=5.0) as axes:
        names = list(dict.fromkeys(row[0] for row in rows))
        markers = "o" * len(CYCLE) + "s" * len(CYCLE)
        for marker, colour, name in zip(markers, CYCLE * 2, names, strict=False):
            own = np.array([[abs(row[3]), abs(row[2])] for row in rows if row[0] == name])
            axes.loglog(*(100.0 * own.T), marker, color=colour, label=name, markersize=5)
        ends = np.array([100.0 * SMALLEST, 200.0])
        axes.plot(ends, ends, color="black", linewidth=0.8)
        axes.fill_between(ends, 0.5 * ends, 2.0 * ends, color="0.9", zorder=0)
        axes.set(xlabel="actual error (%)", ylabel="estimated error (%)", xlim=ends, ylim=ends)
        axes.legend(fontsize=7)

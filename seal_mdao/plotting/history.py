"""Cost and constraint histories of an optimisation (Figures 5 and 6)."""

import itertools
import re

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from seal_mdao.plotting.recorded import RecordedOptimization
from seal_mdao.plotting.style import BLACK, BLUE, CYCLE, GREY, MARKERS, VERMILION, styled, subplots

PAPER_RATIO = 0.0075
"""Cost over its start that Kim et al. (2000) reached."""
LOWEST_RATIO = 1e-8
"""Where the logarithmic axis ends when the gap closes completely."""


def _iteration_axis(axes: Axes, history: RecordedOptimization) -> None:
    axes.set_xlabel("major iteration" if history.major else "model evaluation")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))


@styled
def cost_history(history: RecordedOptimization) -> Figure:
    """Objective over its start on a logarithmic axis, infeasible points marked."""
    figure, axes = subplots(width=6.4, height=4.2)
    ratio = np.maximum(history.objective_ratio, LOWEST_RATIO)
    number = np.arange(len(ratio))
    feasible = history.max_violation <= 1e-3
    axes.axhline(PAPER_RATIO, color=GREY, linestyle="--", linewidth=1.0)
    axes.annotate(
        "0.75 %, Kim et al. (2000)", (1.0, PAPER_RATIO), xycoords=("axes fraction", "data"),
        xytext=(-2, 3), textcoords="offset points", ha="right", color=GREY, fontsize=9.0,
    )  # fmt: skip
    axes.plot(number, ratio, color=BLUE, zorder=2)
    for chosen, fill, label in (
        (feasible, BLUE, "all constraints satisfied"),
        (~feasible, "white", "a constraint violated by over 0.1 %"),
    ):
        if chosen.any():
            axes.plot(
                number[chosen], ratio[chosen], "o", markersize=7, markerfacecolor=fill,
                markeredgecolor=BLUE, label=label, zorder=3,
            )  # fmt: skip
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{100 * v:g} %"))
    axes.set_ylabel("cost / its start")
    _iteration_axis(axes, history)
    axes.legend(loc="lower left")
    return figure


@styled
def constraint_history(history: RecordedOptimization, particles=None) -> Figure:
    """Constraints over their limits; a feasible design lies on or below 1.

    Parameters
    ----------
    history : RecordedOptimization
    particles : sequence of int, optional
        Particles of the stresses, for the legend.

    Returns
    -------
    Figure
    """
    figure, axes = subplots(width=8.2, height=4.6)
    number, highest, lowest = np.arange(len(history.objective)), 1.0, 1.0
    coloured = itertools.cycle(zip(CYCLE, MARKERS, strict=True))
    dashed = itertools.cycle(["--", "-.", ":"])
    for label, share in _shares(history, particles):
        if label.startswith("stress"):
            color, marker = next(coloured)
            axes.plot(number, share, color=color, marker=marker, label=label)
        else:
            axes.plot(number, share, color=BLACK, linestyle=next(dashed), label=label)
        highest, lowest = max(highest, share.max()), min(lowest, share.min())
    axes.axhline(1.0, color=VERMILION, linewidth=1.4, zorder=1)
    top = highest + 0.08 * (highest - lowest) + 1e-3
    axes.axhspan(1.0, top, color=VERMILION, alpha=0.08, linewidth=0)
    axes.set_ylim(lowest - 0.05 * (highest - lowest) - 1e-3, top)
    axes.text(
        0.995, top, "violated", transform=axes.get_yaxis_transform(), ha="right", va="top",
        color=VERMILION, fontsize=9.0,
    )  # fmt: skip
    axes.set_ylabel("value / limit")
    _iteration_axis(axes, history)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _shares(history: RecordedOptimization, particles):
    """Label and use of its limit of every finite limit; a lower limit counts as limit / value."""
    for constraint in history.constraints:
        label = _label(constraint.name, particles)
        both = np.isfinite(constraint.upper) and np.isfinite(constraint.lower)
        if np.isfinite(constraint.upper):
            yield label + (" (upper)" if both else ""), constraint.values / constraint.upper
        if np.isfinite(constraint.lower):
            yield label + (" (lower)" if both else ""), constraint.lower / constraint.values


def _label(name: str, particles) -> str:
    entry = re.fullmatch(r"von_mises\[(\d+)\]", name)
    if entry is None:
        return {"reaction": "vertical reaction"}.get(name, name)
    number = int(entry[1])
    where = "" if particles is None else f", particle {particles[number]}"
    return f"stress {number + 1}{where}"

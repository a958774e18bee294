"""Figures of cost and constraint histories of an optimisation (Figures 5 and 6)."""

import itertools
import re

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from seal_mdao.plotting.style import BESIDE, BLUE, CYCLE, GREY, MARKERS, VERMILION, styled, subplots
from seal_mdao.recording.recorded_optimization import (
    Constraint,
    RecordedOptimization,
    label,
    unit_of,
)

PAPER_RATIO = 0.0075
"""Final over initial cost in Kim et al. (2000)."""
LOWEST_RATIO = 1e-8
"""Lower limit of the logarithmic axis, for gaps that close completely."""


@styled
def cost_history(history: RecordedOptimization) -> Figure:
    """Plot the cost of Eq. (71) over its initial value, logarithmic, infeasible points marked."""
    figure, axes = subplots(width=6.4, height=4.2)
    axes.axhline(PAPER_RATIO, color=GREY, linestyle="--", linewidth=1.0)
    axes.annotate(
        "0.75 %, Kim et al. (2000)", (1.0, PAPER_RATIO), xycoords=("axes fraction", "data"),
        xytext=(-2, 3), textcoords="offset points", ha="right", color=GREY, fontsize=9.0,
    )  # fmt: skip
    _draw_objective(axes, history, np.maximum(history.objective_ratio, LOWEST_RATIO))
    axes.set(yscale="log", ylabel="cost / initial cost")
    axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{100 * v:g} %"))
    axes.legend(loc="lower left")
    return figure


@styled
def objective_history(history: RecordedOptimization) -> Figure:
    """Plot the objective in its unit, infeasible points marked."""
    figure, axes = subplots(width=6.4, height=4.2)
    _draw_objective(axes, history, history.objective)
    name, unit = _words(history.objective_name), unit_of(history, history.objective_name)
    axes.set_ylabel(f"{name} ({unit})" if unit else name)
    axes.margins(y=0.12)
    axes.legend(loc="best")
    return figure


def _draw_objective(axes: Axes, history: RecordedOptimization, values: np.ndarray) -> None:
    """Plot values (n,) of the objective over the iterations."""
    number, feasible = _numbers(history, len(values)), history.feasible
    if history.kind == "optimisation":
        axes.plot(*_by_run(history, values), color=BLUE, zorder=2)
    for chosen, fill, text in (
        (feasible, BLUE, "all constraints satisfied"),
        (~feasible, "white", "a constraint violated by over 0.1 %"),
    ):
        if chosen.any():
            axes.plot(
                number[chosen], values[chosen], "o", markersize=7, markerfacecolor=fill,
                markeredgecolor=BLUE, label=text, zorder=3,
            )  # fmt: skip
    _iteration_axis(axes, history)


@styled
def constraint_history(history: RecordedOptimization, particles=None) -> Figure:
    """Plot the utilisation of constraints; a feasible design lies on or below 1.

    For a positive upper limit the curve is value / limit.

    Parameters
    ----------
    history : RecordedOptimization
    particles : sequence of int, optional
        Particles of the stresses, for the legend.
    """
    figure, axes = subplots(width=8.2, height=4.6)
    # g / limit for a positive upper limit, in general 1 + (g - limit) / |limit|
    uses = {_legend(c.name, particles): c.use() for c in history.constraints}
    uses = {text: use for text, use in uses.items() if np.isfinite(use).all()}  # there is a limit
    # colour and marker change with every curve, the dash after all colours are used
    looks = itertools.product(("-", "--", ":"), zip(CYCLE, MARKERS, strict=True))
    for (text, use), (dash, (color, marker)) in zip(uses.items(), looks, strict=False):
        dash = dash if history.kind == "optimisation" else ""
        axes.plot(*_by_run(history, use), color=color, marker=marker, linestyle=dash, label=text)
    for constraint in history.constraints if history.kind == "optimisation" else ():
        _name_violation(axes, history, constraint)
    _shade_violated(axes, np.concatenate([[1.0], *uses.values()]))
    axes.set_ylabel("utilisation of the limit (1: at the limit)")
    _iteration_axis(axes, history)
    axes.legend(**BESIDE)
    return figure


def _name_violation(axes: Axes, history: RecordedOptimization, own: Constraint) -> None:
    """Write "too soft" or "too stiff" at the last design whose force is outside its limits."""
    outside = np.flatnonzero(~own.satisfied())
    if not outside.size or unit_of(history, own.name) not in ("N/m", "N"):
        return
    at = outside[-1]
    # forces may count as negative: stiff is what has the larger one
    limit = own.lower if own.values[at] < own.lower else own.upper
    text = (
        "too soft: force below its limit"
        if abs(own.values[at]) < abs(limit)
        else "too stiff: force above its limit"
    )
    axes.annotate(
        text, (at, own.use()[at]), xytext=(4, 4), textcoords="offset points", color=VERMILION,
        fontsize=9.0,
    )  # fmt: skip


def _by_run(history: RecordedOptimization, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return numbers and values (n,) of the points, with NaN between runs of the driver."""
    pair = _numbers(history, len(values)), values
    return tuple(np.insert(own.astype(float), history.run_starts, np.nan) for own in pair)


def _numbers(history: RecordedOptimization, count: int) -> np.ndarray:
    """Return the abscissae of the points: iterations from 0, or numbers of the cases from 1."""
    return np.arange(count) if history.kind == "optimisation" else history.analyses


def _iteration_axis(axes: Axes, history: RecordedOptimization) -> None:
    """Label the axis of the points, and separate runs of the driver by dotted lines."""
    for run, start in enumerate(history.run_starts, 2):
        between = _numbers(history, len(history.objective))[start] - 0.5
        axes.axvline(between, color=GREY, linestyle=":", linewidth=1.0, zorder=1)
        axes.text(
            between, 0.99, f" run {run}", transform=axes.get_xaxis_transform(), va="top",
            color=GREY, fontsize=9.0,
        )  # fmt: skip
    kind = "major iteration" if history.major else "model evaluation"
    axes.set_xlabel(kind if history.kind == "optimisation" else "case")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))


def _shade_violated(axes: Axes, shown: np.ndarray) -> None:
    """Plot the limit 1 and shade the region above it, in a window around the values ``shown``."""
    low, high = shown.min(), shown.max()
    # margins of the window; 1e-3 for histories without any change
    top = high + 0.08 * (high - low) + 1e-3
    axes.axhline(1.0, color=VERMILION, linewidth=1.4, zorder=1)
    axes.axhspan(1.0, top, color=VERMILION, alpha=0.08, linewidth=0)
    axes.set_ylim(low - 0.05 * (high - low) - 1e-3, top)
    axes.text(
        0.995, top, "violated", transform=axes.get_yaxis_transform(), ha="right", va="top",
        color=VERMILION, fontsize=9.0,
    )  # fmt: skip


def _legend(name: str, particles) -> str:
    # entry k of the vector ``von_mises`` belongs to particle ``particles[k]``
    entry = re.fullmatch(r"von_mises\[(\d+)\]", name)
    where = f", particle {particles[int(entry[1])]}" if entry and particles is not None else ""
    return _words(name) + where


def _words(name: str) -> str:
    """Format the name of a recorded variable, with $ escaped for matplotlib."""
    return label(name).replace("$", r"\$")

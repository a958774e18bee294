"""Figure of test data, a fitted law and their differences."""

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.calibration.data import ModeData
from seal_mdao.calibration.fit import Fit
from seal_mdao.calibration.modes import MODES, is_compressible, lateral_stretch, nominal_stress
from seal_mdao.calibration.residuals import share_of
from seal_mdao.calibration.stability import widened
from seal_mdao.plotting.style import BLUE, CYCLE, MARKERS, VERMILION, styled, subplots

CURVE_POINTS = 200


@styled
def material_fit(fit: Fit, others: dict | None = None) -> Figure:
    """Plot nominal stress against stretch and the differences for every mode.

    Parameters
    ----------
    fit : Fit
    others : dict of str to Isotropic, optional
        Further laws by the label that the legend gives them.

    Returns
    -------
    Figure
        A column for every mode. Differences relative to the readings, or in kPa if the fit was absolute;
        a third row with the lateral stretch where it was measured and the law is compressible.
    """
    label = fit.name.replace("_", "-").capitalize()
    laws = {f"{label}, fitted": fit.law, **(others or {})}
    # the lateral stretch of incompressible laws follows from the stretch: nothing to compare
    across = is_compressible(fit.law) and fit.tests.has_lateral
    heights = [2.2, 1.0, 1.2][: 3 if across else 2]
    columns = len(fit.tests.modes)
    figure, grid = subplots(
        len(heights), columns, width=1.2 + 2.9 * columns, height=1.45 * sum(heights) + 0.3,
        squeeze=False, sharex="col", gridspec_kw={"height_ratios": heights},
    )  # fmt: skip
    # differences of all modes on one scale
    for axes in grid[1, 1:]:
        axes.sharey(grid[1, 0])
    for column, (name, data) in zip(grid.T, fit.tests.modes.items(), strict=True):
        _stress(column[0], fit, name, data, laws)
        _differences(column[1], fit, name, data, laws)
        if across:
            _lateral(column[2], name, data, laws)
        column[-1].set_xlabel("stretch")
    grid[0, 0].set_ylabel("nominal stress (kPa)")
    relative = fit.weighting == "relative"
    grid[1, 0].set_ylabel("difference (%)" if relative else "difference (kPa)")
    if across:
        grid[2, 0].set_ylabel("lateral stretch")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.align_ylabels(grid[:, 0])
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def _look(number: int) -> dict:
    # the fitted law blue and solid, others dashed; vermilion is for the data
    color = (BLUE, *[c for c in CYCLE if c not in (BLUE, VERMILION)])[number % 6]
    return {"color": color, "linestyle": "-" if number == 0 else "--"}


def _stretches(data: ModeData, margin: float = 0.0):
    lower, upper = widened(*data.range, margin)
    return np.linspace(lower, upper, CURVE_POINTS)


def _stress(axes, fit, name, data, laws):
    error = fit.errors[name]
    stretch = _stretches(data)
    for i, (label, law) in enumerate(laws.items()):
        axes.plot(stretch, nominal_stress(law, MODES[name], stretch), label=label, **_look(i))
    axes.plot(
        data.stretch, data.stress, MARKERS[0], color=VERMILION, markerfacecolor="none", label="data"
    )
    axes.set_title(name)
    text = f"RMS {error.rms_kPa:.3g} kPa\n$R^2$ {error.r2:.4f}"
    axes.text(0.97, 0.05, text, transform=axes.transAxes, ha="right", va="bottom", fontsize=9.0)


def _differences(axes, fit, name, data, laws):
    axes.axhline(0.0, color="black", linewidth=0.8)
    for i, law in enumerate(laws.values()):
        away = nominal_stress(law, MODES[name], data.stretch) - data.stress
        if fit.weighting == "relative":
            # percent of the reading, bounded below near zero stress as in the fit
            away = 100.0 * away / share_of(data.stress)
        look = _look(i)
        filled = look["color"] if i == 0 else "none"
        axes.plot(
            data.stretch,
            away,
            MARKERS[i],
            markerfacecolor=filled,
            markersize=4,
            linewidth=0.8,
            **look,
        )


def _lateral(axes, name, data, laws):
    stretch = _stretches(data)
    for i, law in enumerate(laws.values()):
        if is_compressible(law):
            axes.plot(stretch, lateral_stretch(law, MODES[name], stretch), **_look(i))
    axes.plot(data.stretch, data.lateral, MARKERS[0], color=VERMILION, markerfacecolor="none")

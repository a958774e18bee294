"""Figures of constants from tests: of a material, and of a seal's compression-load-deflection curve."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from seal_mdao.calibration.law_fit import Fit
from seal_mdao.calibration.loading_modes import (
    MODES,
    is_compressible,
    lateral_stretch,
    nominal_stress,
)
from seal_mdao.calibration.residuals import relative_to
from seal_mdao.plotting.style import BLUE, CYCLE, GREEN, GREY, MARKERS, VERMILION, styled, subplots

CURVE_POINTS = 200
HOLLOW = {"color": VERMILION, "markerfacecolor": "none"}
"""Look of measured values."""
ELLIPSES = ((1.5152, "68 % of cases", "-"), (2.4477, "95 %", "--"))
"""Radii r in standard deviations of confidence ellipses, and their probability 1 - exp(-r^2 / 2)."""


# ---- material tests ----


@styled
def material_fit(fit: Fit, others: dict | None = None) -> Figure:
    """Plot nominal stress against stretch and the differences, a column for every mode.

    Differences are relative to the readings, or in kPa if the fit was absolute. A third row shows the
    lateral stretch where it was measured and the law is compressible.

    Parameters
    ----------
    fit : Fit
    others : dict of str to Isotropic, optional
        Further laws by the label that the legend gives them.
    """
    label = fit.name.replace("_", "-").capitalize()
    laws = [(f"{label}, fitted", fit.law), *(others or {}).items()]
    # the lateral stretch of incompressible laws follows from the stretch: nothing to compare
    across = is_compressible(fit.law) and fit.tests.has_lateral
    heights, columns = [2.2, 1.0, 1.2][: 3 if across else 2], len(fit.tests.modes)
    figure, grid = subplots(
        len(heights), columns, width=1.2 + 2.9 * columns, height=1.45 * sum(heights) + 0.3,
        squeeze=False, sharex="col", gridspec_kw={"height_ratios": heights},
    )  # fmt: skip
    # differences of all modes on one scale
    for axes in grid[1, 1:]:
        axes.sharey(grid[1, 0])
    for column, (name, data) in zip(grid.T, fit.tests.modes.items(), strict=True):
        stretch = np.linspace(*data.range, CURVE_POINTS)
        for i, (text, law) in enumerate(laws):
            stress = nominal_stress(law, MODES[name], stretch)
            column[0].plot(stretch, stress, label=text, **_look(i))
            if across and is_compressible(law):
                column[2].plot(stretch, lateral_stretch(law, MODES[name], stretch), **_look(i))
        column[0].plot(data.stretch, data.stress, MARKERS[0], label="data", **HOLLOW)
        if across:
            column[2].plot(data.stretch, data.lateral, MARKERS[0], **HOLLOW)
        _draw_differences(column[1], fit, name, laws)
        error = fit.errors[name]
        text = f"RMS {error.rms_kPa:.3g} kPa\n$R^2$ {error.r2:.4f}"
        corner = {"transform": column[0].transAxes, "ha": "right", "va": "bottom"}
        column[0].text(0.97, 0.05, text, fontsize=9.0, **corner)
        column[0].set_title(name)
        column[-1].set_xlabel("stretch")
    unit = "%" if fit.weighting == "relative" else "kPa"
    rows = ("nominal stress (kPa)", f"difference ({unit})", "lateral stretch")
    for axes, text in zip(grid[:, 0], rows, strict=False):
        axes.set_ylabel(text)
    figure.align_ylabels(grid[:, 0])
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def _look(number: int) -> dict:
    # the fitted law blue and solid, others dashed; vermilion is for the data
    color = (BLUE, *[c for c in CYCLE if c not in (BLUE, VERMILION)])[number % 6]
    return {"color": color, "linestyle": "-" if number == 0 else "--"}


def _draw_differences(axes, fit, name, laws) -> None:
    """Plot computed less measured stress of one mode."""
    data = fit.tests.modes[name]
    axes.axhline(0.0, color="black", linewidth=0.8)
    for i, (_, law) in enumerate(laws):
        away = nominal_stress(law, MODES[name], data.stretch) - data.stress
        if fit.weighting == "relative":
            # percent of the reading, bounded below near zero stress as in the fit
            away = 100.0 * away / relative_to(data.stress)
        look = {"markersize": 4, "linewidth": 0.8, **_look(i)}
        look["markerfacecolor"] = "none" if i else look["color"]
        axes.plot(data.stretch, away, MARKERS[i], **look)


# ---- curve of a seal ----


@styled
def calibration_figure(travel, measured, curves: dict, found, true: dict, noise: float) -> Figure:
    """Plot force over travel, hysteresis, differences and the confidence region of two constants.

    Parameters
    ----------
    travel, measured : ndarray, shape (m,)
        mm and N/m; readings while opening at the same travels as while closing, in reverse order.
    curves : dict of str to ndarray, shape (m,)
        Computed force by label: at the start of the search, and last the calibrated one.
    found
        With ``names``, ``values`` (2,), ``covariance`` (2, 2) of two constants.
    true : dict of str to float
        Constants with which the measurement was made.
    noise : float
        Standard deviation of the readings, N/m.
    """
    figure, ((force, loss), (away, region)) = subplots(2, 2, width=9.4, height=7.2)
    turn = int(np.argmax(travel))

    def hysteresis(force):
        # reading turn - 1 - k while closing is at the travel of reading turn + 1 + k while opening
        return force[:turn] - force[turn + 1 :][::-1]

    looks = {"color": GREY, "linestyle": "--"}, {"color": BLUE}
    for (label, own), look in zip(curves.items(), looks, strict=True):
        force.plot(travel, own, label=label, **look)
        loss.plot(travel[:turn], hysteresis(own), label=label, **look)
    # half of the readings, so that the curves stay visible below them
    some = slice(None, None, 2)
    label = "measured (every second)"
    force.plot(travel[some], measured[some], "o", markersize=4, label=label, **HOLLOW)
    loss.plot(travel[:turn], hysteresis(measured), "o", markersize=4, label="measured", **HOLLOW)
    for axes, text in ((force, "force on the profile (N/m)"), (loss, "closing less opening (N/m)")):
        axes.set(xlabel="travel (mm)", ylabel=text)
        axes.legend(loc="upper left")
    _draw_residuals(away, travel, list(curves.values())[-1] - measured, noise)
    _draw_region(region, found, true)
    return figure


def _draw_residuals(axes, travel, away, noise) -> None:
    """Plot the difference of calibrated and measured force, with a band of the noise."""
    turn = int(np.argmax(travel)) + 1
    # differences within two standard deviations of the noise are no evidence of a wrong law
    axes.axhspan(-2.0 * noise, 2.0 * noise, color=GREY, alpha=0.15, linewidth=0.0)
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.plot(travel[:turn], away[:turn], "o", color=BLUE, markersize=4, label="closing")
    hollow = {"color": GREEN, "markersize": 4, "markerfacecolor": "none"}
    axes.plot(travel[turn:], away[turn:], "s", label="opening", **hollow)
    axes.set(xlabel="travel (mm)", ylabel="calibrated − measured (N/m)", ymargin=0.2)
    axes.set_title("grey: scatter of the data (two standard deviations)")
    axes.legend(loc="upper left", ncols=2)


def _draw_region(axes, found, true) -> None:
    """Plot confidence ellipses around the constants."""
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    # p + r L (cos a, sin a) with the covariance C = L L^T: all points of Mahalanobis distance r
    circle = np.linalg.cholesky(found.covariance) @ np.array([np.cos(angle), np.sin(angle)])
    for radius, label, style in ELLIPSES:
        ellipse = found.values[:, None] + radius * circle
        axes.plot(*ellipse, color=BLUE, linestyle=style, label=label)
    axes.plot(*found.values, "o", color=BLUE, label="found")
    cross = {"color": VERMILION, "markersize": 8, "markeredgewidth": 2.0}
    axes.plot(*(true[name] for name in found.names), "x", label="true", **cross)
    axes.set(xlabel=f"{found.names[0]} (kPa)", ylabel=f"{found.names[1]} coefficient")
    axes.set_title("confidence regions of the constants")
    axes.margins(0.12)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    # the corner that the ellipse leaves free
    axes.legend(loc="lower left" if found.covariance[0, 1] < 0.0 else "lower right")

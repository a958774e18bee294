"""Figure of a Prony series fitted to relaxation tests."""

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.calibration.relaxation_result import RelaxationFit
from seal_mdao.plotting.style import BLUE, CYCLE, GREY, MARKERS, VERMILION, styled, subplots

CURVE_POINTS = 300
BAND = 1.96
"""Half-width of a confidence band of 95 %, in standard errors."""
LN10 = np.log(10.0)


@styled
def relaxation_fit(fit: RelaxationFit) -> Figure:
    """Plot relaxed modulus and differences over time, and the shift over temperature.

    Readings are divided by the fitted instantaneous force of their test and plotted at their time at
    the reference temperature (master curve). The band has 95 % confidence for independent scatter.

    Parameters
    ----------
    fit : RelaxationFit
    """
    columns = 1 if fit.shift is None else 2
    figure, grid = subplots(
        2, columns, width=6.6 if columns == 1 else 10.0, height=6.2, squeeze=False,
        gridspec_kw={"height_ratios": [2.2, 1.0], "width_ratios": [2.0, 1.0][:columns]},
    )  # fmt: skip
    upper, lower = grid[:, 0]
    lower.sharex(upper)
    low, high = fit.time_range
    time = np.geomspace(min(low, fit.tau[0] / 10.0), high, CURVE_POINTS)
    # R(t) with 95 % confidence
    curve, error = fit.relaxed(time), BAND * fit.relaxed_error(time)
    upper.plot(time, curve, color=BLUE, label=f"Prony series, {fit.g.size} terms")
    if np.isfinite(error).all():
        upper.fill_between(time, curve - error, curve + error, color=BLUE, alpha=0.2, linewidth=0.0)
    upper.plot(fit.tau, fit.relaxed(fit.tau), "|", color="black", markersize=14, label="τ")
    _draw_readings(upper, lower, fit)
    lower.axhline(0.0, color="black", linewidth=0.8)
    upper.set_xscale("log")
    upper.set_ylabel("modulus over instantaneous one")
    degrees = "" if fit.reference is None else f" at {fit.reference:g} °C"
    lower.set(xlabel=f"time{degrees} (s)", ylabel="difference (%)")
    upper.legend(loc="best")
    if fit.shift is not None:
        _draw_shift(grid[0, 1], fit)
        grid[1, 1].set_visible(False)
    figure.align_ylabels(grid[:, 0])
    return figure


def _draw_readings(upper, lower, fit) -> None:
    """Plot readings of every curve over the reduced time, and their differences in per cent of the
    instantaneous force."""
    model, away, reduced = fit.model, fit.differences(), fit.reduced_time()
    e, _, _, ratios = model.split(fit.unknowns)
    scale = np.append(1.0, ratios)[np.array(fit.tests.scales)] * model.modulus_factors() * e.sum()
    # computed force over the instantaneous one, plus the difference
    colors = [color for color in CYCLE if color != BLUE]
    for k, own in enumerate(fit.tests.curves):
        mine = model.curve == k
        look = {
            "color": VERMILION if len(fit.tests.curves) == 1 else colors[k % len(colors)],
            "marker": MARKERS[k % len(MARKERS)], "linestyle": "none", "markersize": 4,
            "markerfacecolor": "none",
        }  # fmt: skip
        # after a ramp a reading is not the response to a step: show the step response plus difference
        shown = fit.relaxed(reduced[mine]) - away[mine] / scale[k]
        upper.plot(reduced[mine], shown, label=own.label, **look)
        lower.plot(reduced[mine], 100.0 * away[mine] / scale[k], **look)


def _draw_shift(axes, fit) -> None:
    """Plot log10 of the shift factors of single temperatures, with the shift function."""
    degrees = np.array(list(fit.factors))
    # log10 a = ln a / ln 10
    values, errors = np.array(list(fit.factors.values())).T / LN10
    bars = np.where(np.isfinite(errors), BAND * errors, 0.0)
    axes.errorbar(
        degrees, values, bars, fmt="o", color=VERMILION, markerfacecolor="none",
        label="single temperatures",
    )  # fmt: skip
    line = np.linspace(degrees.min(), degrees.max(), CURVE_POINTS)
    shift = np.array([fit.shift.log_factor(t)[0] for t in line]) / LN10
    name = {"wlf": "WLF", "arrhenius": "Arrhenius"}[fit.shift.name]
    axes.plot(line, shift, color=BLUE, label=name)
    axes.axvline(fit.reference, color=GREY, linewidth=0.8, linestyle=":")
    axes.set(xlabel="temperature (°C)", ylabel=r"$\log_{10} a$")
    axes.legend(loc="best")

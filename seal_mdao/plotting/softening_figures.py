"""Figure of a law with softening fitted to cyclic tests."""

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.calibration.cycles import stress_in
from seal_mdao.calibration.data import ModeData
from seal_mdao.calibration.law_fit import Fit
from seal_mdao.calibration.loading_modes import MODES, nominal_stress
from seal_mdao.calibration.residuals import relative_to
from seal_mdao.plotting.style import BLUE, GREY, VERMILION, styled, subplots

BETWEEN = 12
"""Points of the curve from one reading to the next."""
HOLLOW = {"color": VERMILION, "markerfacecolor": "none", "markersize": 4, "linestyle": "none"}


@styled
def softening_fit(fit: Fit) -> Figure:
    """Plot measured and fitted cycles, the first loading, and the differences, a column for every mode.

    Differences are relative to the readings, or in kPa if the fit was absolute.

    Parameters
    ----------
    fit : Fit
        With ``softening``.
    """
    columns = len(fit.tests.modes)
    figure, grid = subplots(
        2, columns, width=2.4 + 3.6 * columns, height=6.0, squeeze=False, sharex="col", sharey="row",
        gridspec_kw={"height_ratios": [2.2, 1.0]},
    )  # fmt: skip
    text = f"{fit.name.replace('_', '-').capitalize()} with softening, fitted"
    for (upper, lower), (name, data) in zip(grid.T, fit.tests.modes.items(), strict=True):
        path, mode = _path(data), MODES[name]
        upper.plot(data.stretch, data.stress, "o", label="data", **HOLLOW)
        first = np.linspace(*data.range, 200)
        look = {"color": GREY, "alpha": 0.4, "linewidth": 6.0, "label": "first loading"}
        upper.plot(first, nominal_stress(fit.law, mode, first), **look)
        upper.plot(path.stretch, stress_in(fit.tested_law, mode, path), color=BLUE, label=text)
        stress = stress_in(fit.tested_law, mode, data)
        away, below = stress - data.stress, stress != nominal_stress(fit.law, mode, data.stretch)
        if fit.weighting == "relative":
            # percent of the reading, bounded below near zero stress as in the fit
            away = 100.0 * away / relative_to(data.stress)
        lower.axhline(0.0, color="black", linewidth=0.8)
        for own, filled, label in ((~below, BLUE, "first loading"), (below, "none", "softened")):
            look = {"color": BLUE, "markersize": 4, "markerfacecolor": filled, "label": label}
            lower.plot(data.stretch[own], away[own], "o", **look)
        error = fit.errors[name]
        corner = {"transform": upper.transAxes, "ha": "right", "va": "bottom", "fontsize": 9.0}
        upper.text(0.97, 0.05, f"RMS {error.rms_kPa:.3g} kPa\n$R^2$ {error.r2:.4f}", **corner)
        upper.set_title(name)
        lower.set_xlabel("stretch")
    grid[1, 0].legend(loc="best", ncols=2, fontsize=9.0)
    grid[0, 0].set_ylabel("nominal stress (kPa)")
    grid[1, 0].set_ylabel(f"difference ({'%' if fit.weighting == 'relative' else 'kPa'})")
    figure.align_ylabels(grid[:, 0])
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def _path(data: ModeData) -> ModeData:
    """Refine the stretches of a test, from the undeformed state on in its order if it is cyclic."""
    ends = np.append(1.0, data.stretch) if data.unloadings else data.stretch
    at = np.arange(ends.size)
    fine = np.linspace(0.0, at[-1], BETWEEN * at[-1] + 1)
    stretch = np.interp(fine, at, ends)
    return ModeData(stretch, np.zeros_like(stretch), None, data.unloadings)

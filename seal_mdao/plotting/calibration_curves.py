"""Figure of a force computed before and after a calibration, over the measured one."""

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.force_calibration import ForceCalibration
from seal_mdao.plotting.style import BLUE, GREY, VERMILION, styled, subplots


@styled
def force_calibration(found: ForceCalibration, along, over_time: bool, unit: str) -> Figure:
    """Plot measured and computed forces over travel or the logarithm of time, and their differences.

    Parameters
    ----------
    found : ForceCalibration
    along : array_like, shape (n,)
        Travel (mm) or time (s) of every reading.
    over_time : bool
    unit : str
        Of the forces.
    """
    order = np.argsort(along, kind="stable")
    x = np.asarray(along, float)[order]
    figure, (upper, lower) = subplots(
        2, 1, width=6.6, height=6.2, sharex=True, gridspec_kw={"height_ratios": [2.2, 1.0]}
    )
    upper.plot(x, found.before[order], "--", color=GREY, label="first values")
    upper.plot(x, found.after[order], color=BLUE, label="calibrated")
    look = {"linestyle": "none", "marker": "o", "markersize": 4, "markerfacecolor": "none"}
    upper.plot(x, found.measured[order], color=VERMILION, label="measured", **look)
    # in per cent of the largest measured force
    away = 100.0 * (found.after - found.measured)[order] / found.largest
    lower.plot(x, away, color=VERMILION, **look)
    lower.axhline(0.0, color="black", linewidth=0.8)
    if over_time:
        lower.set_xscale("log")
    upper.set_ylabel(f"force ({unit})")
    lower.set(
        xlabel="time (s)" if over_time else "travel (mm)",
        ylabel="computed − measured\n(% of the largest)",
    )
    upper.legend(loc="best")
    figure.align_ylabels([upper, lower])
    return figure

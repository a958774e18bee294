"""Constants calibrated to a measured compression-load-deflection curve."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from seal_mdao.plotting.style import BLUE, GREEN, GREY, VERMILION, styled, subplots

ELLIPSES = ((1.5152, "68 % of cases"), (2.4477, "95 %"))
"""Radii r in standard deviations of confidence ellipses, and their probability 1 - exp(-r^2 / 2)."""


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
    _forces(force, travel, measured, curves)
    _losses(loss, travel, measured, curves)
    _differences(away, travel, measured, list(curves.values())[-1], noise)
    _region(region, found, true)
    return figure


LOOKS = ({"color": GREY, "linestyle": "--"}, {"color": BLUE})
"""Line styles of the curve at the start and of the calibrated one."""


def _losses(axes, travel, measured, curves):
    """Plot the force while closing less that while opening."""
    turn = int(np.argmax(travel))

    def loss(force):
        # reading turn - 1 - k while closing is at the travel of reading turn + 1 + k while opening
        return force[:turn] - force[turn + 1 :][::-1]

    for (label, force), look in zip(curves.items(), LOOKS, strict=True):
        axes.plot(travel[:turn], loss(force), label=label, **look)
    axes.plot(
        travel[:turn], loss(measured), "o", color=VERMILION, markerfacecolor="none", markersize=4,
        label="measured",
    )  # fmt: skip
    axes.set_xlabel("travel (mm)")
    axes.set_ylabel("closing less opening (N/m)")
    axes.legend(loc="upper left")


def _forces(axes, travel, measured, curves):
    for (label, force), look in zip(curves.items(), LOOKS, strict=True):
        axes.plot(travel, force, label=label, **look)
    # half of the readings, so that the curves stay visible below them
    every = slice(None, None, 2)
    axes.plot(
        travel[every], measured[every], "o", color=VERMILION, markerfacecolor="none",
        markersize=4, label="measured (every second)",
    )  # fmt: skip
    axes.set_xlabel("travel (mm)")
    axes.set_ylabel("force on the door (N/m)")
    axes.legend(loc="upper left")


def _differences(axes, travel, measured, force, noise):
    turn = int(np.argmax(travel)) + 1
    # differences within two standard deviations of the noise are no evidence of a wrong law
    axes.axhspan(-2.0 * noise, 2.0 * noise, color=GREY, alpha=0.15, linewidth=0.0)
    axes.axhline(0.0, color="black", linewidth=0.8)
    away = force - measured
    axes.plot(travel[:turn], away[:turn], "o", color=BLUE, markersize=4, label="closing")
    axes.plot(
        travel[turn:], away[turn:], "s", color=GREEN, markersize=4, markerfacecolor="none",
        label="opening",
    )  # fmt: skip
    axes.set_xlabel("travel (mm)")
    axes.set_ylabel("calibrated less measured (N/m)")
    axes.set_title("band: two standard deviations of the noise")
    axes.set_ymargin(0.2)
    axes.legend(loc="upper left", ncols=2)


def _region(axes, found, true):
    """Plot confidence ellipses around the constants."""
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    # p + r L (cos a, sin a) with the covariance C = L L^T: all points of Mahalanobis distance r
    circle = np.linalg.cholesky(found.covariance) @ np.array([np.cos(angle), np.sin(angle)])
    for (radius, label), style in zip(ELLIPSES, ("-", "--"), strict=True):
        x, y = found.values[:, None] + radius * circle
        axes.plot(x, y, color=BLUE, linestyle=style, label=label)
    axes.plot(*found.values, "o", color=BLUE, label="found")
    axes.plot(*(true[name] for name in found.names), "x", color=VERMILION, markersize=8,
              markeredgewidth=2.0, label="true")  # fmt: skip
    axes.set_xlabel(f"{found.names[0]} (kPa)")
    axes.set_ylabel(f"{found.names[1]} coefficient")
    axes.set_title("from the Gauss-Newton Hessian")
    axes.margins(0.12)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    # the corner that the ellipse leaves free
    axes.legend(loc="lower left" if found.covariance[0, 1] < 0.0 else "lower right")

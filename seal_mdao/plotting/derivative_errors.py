"""Figures of the verification of analytic sensitivities by finite differences."""

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from seal_mdao.plotting.style import BESIDE, BLUE, CYCLE, GREY, MARKERS, VERMILION, styled, subplots

LOWEST, HIGHEST = 1e-12, 1e-3
"""Range of the colour scale of relative errors."""


@styled
def sensitivity_errors(errors: np.ndarray, measures, parameters, judged, one_sided) -> Figure:
    """Plot the relative error of every derivative as a heat map.

    Parameters
    ----------
    errors : ndarray, shape (m, P)
        Relative differences between finite differences and analytic values.
    measures, parameters : sequence of str
        Names of the rows and columns.
    judged : ndarray of bool, shape (P,)
        False for parameters whose perturbed runs have another contact sequence.
    one_sided : ndarray of bool, shape (P,)
        Parameters for which the difference is one-sided.
    """
    m, count = errors.shape
    figure, axes = subplots(width=max(6.0, 2.6 + 0.33 * count), height=1.7 + 0.3 * m)
    # errors of zero have no logarithm: clipped to the colour scale; NaN stays blank
    shown = np.where(np.isfinite(errors), np.clip(errors, LOWEST, HIGHEST), np.nan)
    picture = axes.imshow(shown, norm=LogNorm(LOWEST, HIGHEST), cmap="cividis", aspect="auto")
    axes.grid(False)
    for line in np.arange(1, max(m, count)) - 0.5:
        axes.axhline(line, color="white", linewidth=0.4)
        axes.axvline(line, color="white", linewidth=0.4)
    axes.set(xlim=(-0.5, count - 0.5), ylim=(m - 0.5, -0.5), xlabel="parameter")
    axes.set_xticks(range(count), parameters, rotation=90, fontsize=8.5)
    axes.set_yticks(range(m), measures, fontsize=8.5)
    # marks above the columns: 1 one-sided difference, x not judged
    for marked, text, color, size in (
        (one_sided & judged, "1", BLUE, 9.0), (~np.asarray(judged), "×", VERMILION, 11.0),
    ):  # fmt: skip
        for column in np.flatnonzero(marked):
            axes.text(column, -0.62, text, ha="center", va="bottom", color=color, fontsize=size)
    axes.set_title(_summary(errors, measures, judged, one_sided), loc="left", pad=18, fontsize=9.5)
    label = "relative error"
    figure.colorbar(picture, ax=axes, pad=0.015, aspect=30, extend="both", label=label)
    return figure


def _summary(errors, measures, judged, one_sided) -> str:
    text = "relative error of all derivatives"
    if np.any(judged):
        # worst error over judged parameters only
        part = np.where(judged, errors, 0.0)
        row, _ = np.unravel_index(np.nanargmax(part), part.shape)
        text += f"; worst {np.nanmax(part):.1e} ({measures[row]})"
    if np.any(one_sided):
        text += "; 1: one-sided difference"
    if not np.all(judged):
        text += "; ×: the contact sequence changes, not judged"
    return text


@styled
def step_study(steps: np.ndarray, groups: dict) -> Figure:
    """Plot the relative error of difference quotients against the step size: medians as lines, the
    10 % to 90 % quantiles as bands.

    Parameters
    ----------
    steps : ndarray, shape (n,)
        Steps, mm.
    groups : dict of str to ndarray
        For every group of measures the relative errors of its derivatives, (number, n) each; nan
        where a quotient cannot be judged.
    """
    figure, axes = subplots(width=7.4, height=4.6)
    for (name, errors), color, marker in zip(groups.items(), CYCLE, MARKERS, strict=False):
        # steps at which at least one derivative of the group can be judged
        usable = np.isfinite(errors).any(axis=0)
        low, middle, high = np.maximum(
            np.nanquantile(errors[:, usable], [0.1, 0.5, 0.9], axis=0), LOWEST
        )
        at = np.asarray(steps)[usable]
        axes.fill_between(at, low, high, color=color, alpha=0.12, linewidth=0)
        axes.plot(at, middle, color=color, marker=marker, label=name)
    axes.set(xscale="log", yscale="log", ylabel="relative error")
    axes.set_xlabel("step of the difference quotient (mm), smaller to the right")
    axes.set_title("median over the derivatives, bands: middle 80 %", loc="left", fontsize=9.5)
    # clearance for the words below at the top, and the smallest step on the right
    axes.set_ylim(top=10.0 * axes.get_ylim()[1])
    axes.invert_xaxis()
    for x, text, side in ((0.01, "truncation", "left"), (0.99, "rounding", "right")):
        axes.text(x, 0.97, text, transform=axes.transAxes, ha=side, va="top", color=GREY)
    axes.legend(**BESIDE)
    return figure

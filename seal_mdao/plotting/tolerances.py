"""Figures of scattered measures: distributions, correlations, comparison of designs."""

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.plotting.style import BLUE, GREY, VERMILION, styled, subplots

BINS = 30
MOST_COLUMNS = 3
SMALLEST = 1e-4
"""Lower limit of the cost axis over the largest cost."""
SIGNED_MAP = "RdBu_r"
LOUD = 0.6
"""Correlation above which numbers are white."""


@styled
def distributions(values, names, units, linear=None) -> Figure:
    """Plot a histogram of every measure.

    Parameters
    ----------
    values : ndarray, shape (S, M)
        Values of the completed samples.
    names, units : sequence of str
        Of the measures.
    linear : ndarray, shape (S, M), optional
        First-order estimate for the same samples.
    """
    count = values.shape[1]
    columns = min(count, MOST_COLUMNS)
    rows = -(-count // columns)
    figure, grid = subplots(
        rows, columns, width=3.4 * columns, height=2.7 * rows + 0.4, squeeze=False
    )
    for axes in grid.ravel()[count:]:
        axes.set_visible(False)
    for number, axes in enumerate(grid.ravel()[:count]):
        own = values[:, number]
        # bins common to both histograms, so that their heights compare
        both = own if linear is None else np.concatenate([own, linear[:, number]])
        edges = np.histogram_bin_edges(both, BINS)
        axes.hist(own, edges, color=BLUE, alpha=0.55, label="sampled")
        if linear is not None:
            axes.hist(
                linear[:, number], edges, histtype="step", color=VERMILION, linewidth=1.4,
                label="first order",
            )  # fmt: skip
        for level, style in ((0.5, "-"), (0.95, "--")):
            axes.axvline(np.quantile(own, level), color=GREY, linestyle=style, linewidth=1.1)
        axes.set_xlabel(_labelled(names[number], units[number]))
        axes.locator_params(axis="x", nbins=5)
    for axes in grid[:, 0]:
        axes.set_ylabel("samples")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    # the two vertical lines, median and 95 % quantile, are the last lines of the axes
    handles += grid[0, 0].get_lines()[-2:]
    figure.legend(handles, [*labels, "median", "95 %"], loc="outside upper center", ncols=4)
    return figure


def _labelled(name: str, unit: str | None) -> str:
    text = name.replace("_", " ")
    return f"{text} ({unit.replace('**2', '²').replace('**3', '³')})" if unit else text


@styled
def correlations(table, measures, inputs) -> Figure:
    """Plot rank correlations (M, K) of measures with the varied inputs as a map."""
    wide = len(inputs) > 12
    figure, axes = subplots(
        width=2.6 + (0.3 if wide else 0.75) * len(inputs), height=1.9 + 0.34 * len(measures)
    )
    image = axes.imshow(table, cmap=SIGNED_MAP, vmin=-1.0, vmax=1.0, aspect="auto")
    axes.set_xticks(
        range(len(inputs)),
        [_labelled(name, None) for name in inputs],
        rotation=90 if wide else 30,
        ha="center" if wide else "right",
    )
    axes.set_yticks(range(len(measures)), [_labelled(name, None) for name in measures])
    axes.grid(False)
    # numbers in the cells as long as they are legible
    if not wide:
        for (row, column), value in np.ndenumerate(table):
            color = "white" if abs(value) > LOUD else "black"
            axes.text(
                column, row, _rounded(value), ha="center", va="center",
                color=color, fontsize=8.5,
            )  # fmt: skip
    figure.colorbar(image, ax=axes, label="rank correlation", pad=0.02)
    return figure


def _rounded(value: float) -> str:
    """Format with two digits, without a minus sign before zero."""
    return f"{round(value, 2) + 0.0:.2f}".replace("-", "\u2212")


LOOKS = ((GREY, "-"), (BLUE, "-"), (VERMILION, "-"))


@styled
def designs_compared(
    samples: dict, name: str, unit: str, limited: dict | None = None, band=(None, None),
    text: str = "reaction of the door (N/m)",
) -> Figure:  # fmt: skip
    """Cumulative distributions of a cost, and a measure between its limits, for several designs.

    Parameters
    ----------
    samples : dict of str to ndarray, shape (S,)
        The cost by the label of the design.
    name, unit : str
        Of the cost.
    limited : dict of str to ndarray, shape (S,), optional
        A measure with limits by the label.
    band : pair of float, optional
        Its limits; None where there is none.
    text : str
        What it is, with its unit.
    """
    count = 1 if limited is None else 2
    figure, grid = subplots(1, count, width=4.6 * count, height=3.7, squeeze=False)
    cost = grid[0, 0]
    # a closed gap has none: what is far below the largest is drawn at the left end
    least = SMALLEST * max(values.max() for values in samples.values())
    for (label, values), (color, style) in zip(
        samples.items(), LOOKS[-len(samples) :], strict=True
    ):
        share = (np.arange(values.size) + 0.5) / values.size
        shown = np.sort(values) if values.min() < 0.0 else np.maximum(np.sort(values), least)
        cost.plot(shown, 100.0 * share, color=color, linestyle=style, label=label)
        cost.plot(max(np.quantile(values, 0.95), least), 95.0, "o", color=color)
    cost.axhline(95.0, color=GREY, linewidth=0.8, linestyle=":")
    cost.set_xlabel(_labelled(name, unit))
    cost.set_ylabel("fraction of samples below (%)")
    cost.set_ylim(0.0, 100.0)
    if least > 0.0 and min(values.min() for values in samples.values()) >= 0.0:
        cost.set_xscale("log")
        cost.set_xlim(left=least)
    cost.legend(loc="lower right")
    if limited is not None:
        _draw_limited(grid[0, 1], limited, band, text)
    return figure


def _draw_limited(axes, limited: dict, band, text: str) -> None:
    """Histograms of a measure by the label of the design, and the band that it keeps to."""
    edges = np.histogram_bin_edges(np.concatenate([*limited.values()]), BINS)
    for (label, values), (color, style) in zip(
        limited.items(), LOOKS[-len(limited) :], strict=True
    ):
        axes.hist(
            values, edges, histtype="step", color=color, linestyle=style, linewidth=1.5, label=label
        )
    low, high = axes.get_xlim()
    low = low if band[0] is None else band[0]
    axes.axvspan(low, high if band[1] is None else band[1], color=GREY, alpha=0.15, linewidth=0.0)
    axes.set_xlabel(text)
    axes.set_ylabel("samples")
    axes.set_title("grey: what is asked for")

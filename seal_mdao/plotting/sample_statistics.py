"""Figures of samples of measures: distributions, correlations, comparison of designs."""

from math import ceil, sqrt

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.plotting.style import BLUE, GREY, VERMILION, panels, signed, styled, subplots
from seal_mdao.tolerances.statistics import quantiles

BINS, FEWEST = 30, 5
"""Most and fewest bins of a histogram: the root of the number of samples lies between them."""
EQUAL = 1e-9
"""Relative difference of samples that is rounding."""
CONSTANT = 1e-6
"""Relative range of samples below which their histogram would show the tolerance of the solver."""
SMALLEST = 1e-4
"""Lower limit of the cost axis over the largest cost."""
DECADES = 1e-2
"""Smallest over largest cost below which its axis is logarithmic."""
STRONG = 0.6
"""Correlation above which numbers are white."""
DESIGN_COLOURS = (GREY, BLUE, VERMILION)
"""Of up to three designs; of two the last ones."""


def _labelled(name: str, unit: str | None = None) -> str:
    text = name.replace("_", " ")
    return f"{text} ({unit.replace('**2', '²').replace('**3', '³')})" if unit else text


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
    size = lambda rows, columns: (3.4 * columns, 2.7 * rows + 0.4)  # noqa: E731
    figure, panel = panels(values.shape[1], 3, size)
    for number, axes in enumerate(panel):
        own, infinite = values[:, number], int(np.isinf(values[:, number]).sum())
        # median and 95 % quantile of all samples; not drawn where they are infinite
        lines = [level if np.isfinite(level) else np.nan for level in quantiles(own, (0.5, 0.95))]
        estimate = own[:0] if linear is None else linear[:, number]
        own, estimate = own[np.isfinite(own)], estimate[np.isfinite(estimate)]
        # bins common to both histograms, so that their heights compare
        both = np.concatenate([own, estimate]) if own.size or estimate.size else np.zeros(1)
        edges = _bin_edges(own, both)
        axes.hist(own, edges, color=BLUE, alpha=0.55, label="sampled")
        if linear is not None:
            outlined = {"histtype": "step", "color": VERMILION, "linewidth": 1.4}
            axes.hist(estimate, edges, label="first order", **outlined)
        for line, style in zip(lines, ("-", "--"), strict=True):
            axes.axvline(line, color=GREY, linestyle=style, linewidth=1.1)
        left_out = f", infinite in {infinite}" if infinite else ""
        axes.set_xlabel(_labelled(names[number], units[number]) + left_out)
        axes.locator_params(axis="x", nbins=5)
        if axes.get_subplotspec().is_first_col():
            axes.set_ylabel("samples")
    handles, labels = panel[0].get_legend_handles_labels()
    # the two vertical lines, median and 95 % quantile, are the last lines of the axes
    handles += panel[0].get_lines()[-2:]
    figure.legend(handles, [*labels, "median", "95 %"], loc="outside upper center", ncols=4)
    return figure


@styled
def correlations(table, measures, inputs) -> Figure:
    """Plot rank correlations (M, K) of measures with the varied inputs as a map."""
    wide = len(inputs) > 12
    figure, axes = subplots(
        width=2.6 + (0.3 if wide else 0.75) * len(inputs), height=1.9 + 0.34 * len(measures)
    )
    image = axes.imshow(table, cmap="RdBu_r", vmin=-1.0, vmax=1.0, aspect="auto")
    turned = {"rotation": 90, "ha": "center"} if wide else {"rotation": 30, "ha": "right"}
    axes.set_xticks(range(len(inputs)), map(_labelled, inputs), **turned)
    axes.set_yticks(range(len(measures)), map(_labelled, measures))
    axes.grid(False)
    # numbers in the cells as long as they are legible
    if not wide:
        for (row, column), value in np.ndenumerate(table):
            look = {"color": "white" if abs(value) > STRONG else "black", "fontsize": 8.5}
            axes.text(column, row, signed(value, 2), ha="center", va="center", **look)
    figure.colorbar(image, ax=axes, label="rank correlation", pad=0.02)
    return figure


@styled
def designs_compared(
    samples: dict, name: str, unit: str, limited: dict | None = None, band=(None, None),
    text: str = "vertical force (N/m)",
) -> Figure:  # fmt: skip
    """Plot cumulative distributions of a cost, and of a measure with limits, for several designs.

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
    _draw_cumulative(grid[0, 0], samples)
    grid[0, 0].set_xlabel(_labelled(name, unit))
    if limited is not None:
        _draw_limited(grid[0, 1], limited, band)
        grid[0, 1].set_xlabel(text)
    return figure


def _draw_cumulative(axes, samples: dict) -> None:
    """Plot the fraction of samples below a cost for every design, with the 95 % quantile."""
    # a logarithmic axis for costs of several decades, such as a gap that nearly closes
    lowest, largest = (end(np.concatenate([*samples.values()])) for end in (np.min, np.max))
    decades = 0.0 <= lowest < DECADES * largest
    # a closed gap has cost zero: costs far below the largest are drawn at the left end
    least = SMALLEST * largest if decades else -np.inf
    for (label, values), color in zip(
        samples.items(), DESIGN_COLOURS[-len(samples) :], strict=True
    ):
        # i-th smallest of S samples: fraction (i - 1/2) / S below
        fraction = (np.arange(values.size) + 0.5) / values.size
        axes.plot(np.maximum(np.sort(values), least), 100.0 * fraction, color=color, label=label)
        axes.plot(max(np.quantile(values, 0.95), least), 95.0, "o", color=color)
    axes.axhline(95.0, color=GREY, linewidth=0.8, linestyle=":")
    axes.set(ylabel="fraction of samples below (%)", ylim=(0.0, 100.0))
    if decades:
        axes.set_xscale("log")
        axes.set_xlim(left=least)
    axes.legend(loc="lower right" if decades else "lower center")


def _bin_edges(sample: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the edges of equal bins over all ``values``: for a ``sample`` of S values sqrt(S) bins,
    at least ``FEWEST`` and at most ``BINS``; of values that are equal to ``CONSTANT``, those of an odd
    number within 10 % of them, so that they are one bar in the middle."""
    low, high = values.min(), values.max()
    count = min(max(FEWEST, ceil(sqrt(sample.size))), BINS)
    # a little wider than the values, so that rounding leaves none out
    middle, half = 0.5 * (low + high), 0.5 * (1.0 + EQUAL) * (high - low)
    if half <= CONSTANT * abs(middle) or half == 0.0:
        return middle + (0.1 * abs(middle) or 0.5) * np.linspace(-1.0, 1.0, BINS + 2)
    return middle + half * np.linspace(-1.0, 1.0, count + 1)


def _draw_limited(axes, limited: dict, band) -> None:
    """Plot histograms of a measure for every design, and the band between its limits."""
    edges = _bin_edges(next(iter(limited.values())), np.concatenate([*limited.values()]))
    for (label, values), color in zip(
        limited.items(), DESIGN_COLOURS[-len(limited) :], strict=True
    ):
        axes.hist(values, edges, histtype="step", color=color, linewidth=1.5, label=label)
    ends = [
        own if given is None else given for own, given in zip(axes.get_xlim(), band, strict=True)
    ]
    axes.axvspan(*ends, color=GREY, alpha=0.15, linewidth=0.0)
    axes.set(ylabel="samples", title="grey: required range")

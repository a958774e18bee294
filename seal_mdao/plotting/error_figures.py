"""Figure of the estimated errors of measures."""

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.plotting.style import BLUE, GREY, VERMILION, styled, subplots

COLOURS = {"particles": BLUE, "load_steps": VERMILION, "penalties": GREY}
"""Colour of every part of an error."""


@styled
def error_parts(estimates: dict) -> Figure:
    """Plot the parts of the estimated errors of measures, in per cent of their values.

    Parameters
    ----------
    estimates : dict of str to ErrorEstimate
        As of ``accuracy.error_estimate.estimate_errors``; the value with the largest error bar of a
        measure with several. Parts that are not known are marked; measures without a known part are left
        out.
    """
    rows = []
    for name, found in estimates.items():
        known = {part: own for part, own in found.parts.items() if own is not None}
        if not known or not found.scale > 0.0:
            continue
        at = int(np.abs(list(known.values())).sum(axis=0).argmax())
        label = name if found.value.size == 1 else f"{name}[{at}]"
        rows.append((label, {part: 100.0 * own[at] / found.scale for part, own in known.items()}))
    figure, axes = subplots(width=6.6, height=1.6 + 0.42 * max(len(rows), 1))
    height = 0.8 / len(COLOURS)
    for number, (part, colour) in enumerate(COLOURS.items()):
        # one group of bars a measure, a bar a part
        places = [k + (number - 1) * height for k in range(len(rows))]
        sizes = [parts.get(part, np.nan) for _, parts in rows]
        unknown = [k for k, size in enumerate(sizes) if np.isnan(size)]
        label = part.replace("_", " ")
        if rows and len(unknown) == len(rows):
            label += " (not estimated)"
        axes.barh(places, sizes, height, color=colour, label=label)
        for k in unknown:
            # a missing bar is no error of zero
            axes.annotate(
                "not estimated", (0.0, places[k]), xytext=(4, 0), textcoords="offset points",
                va="center", fontsize=7.5, color=colour,
            )  # fmt: skip
    axes.axvline(0.0, color="black", linewidth=0.8)
    axes.set_yticks(range(len(rows)), [label for label, _ in rows])
    axes.invert_yaxis()
    axes.set_xlabel("estimated error, computed − exact value (% of the value)")
    axes.legend(loc="best")
    return figure

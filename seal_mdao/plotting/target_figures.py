"""Load-deflection curves with the targets and bounds of an optimisation."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from seal_mdao.measures.load_deflection import ForceTarget
from seal_mdao.plotting.style import BLUE, GREY, SKY, VERMILION, styled, subplots
from seal_mdao.plotting.travel_curves import add_length_axis
from seal_mdao.seals.result import SealResult

BAR = {"linestyle": "none", "color": VERMILION, "markersize": 9.0, "zorder": 5}
"""Marks of targets and bounds."""


@styled
def force_targets(results: Mapping[str, SealResult], targets: Sequence[ForceTarget]) -> Figure:
    """Plot the load-deflection curves of designs with targets and bounds of the force.

    Parameters
    ----------
    results : mapping of str to SealResult
        By the text of the legend; the last one is drawn strongest.
    targets : sequence of ForceTarget
        A panel for each.

    Raises
    ------
    ValueError
        Without targets.
    """
    if not targets:
        raise ValueError(
            "the seal has no measure with target forces (load_deflection_error) to draw"
        )
    figure, panels = subplots(
        len(targets), width=7.4, height=0.6 + 3.4 * len(targets), squeeze=False
    )
    for (axes,), own in zip(panels, targets, strict=True):
        for number, (name, result) in enumerate(results.items(), 1):
            last = number == len(results)
            axes.plot(*own.reaction.curve(result), color=BLUE if last else GREY, label=name)
        _draw_target(axes, own)
        if result.seal.units.is_ring_force(own.reaction.units):
            add_length_axis(axes, result.seal.units)
        axes.axhline(0.0, color="black", linewidth=0.8)
        axes.set_xlim(left=0.0)
        axes.set_xlabel("travel (mm)")
        axes.set_ylabel(
            f"force on {own.reaction.profile} ({result.seal.units.of(own.reaction.units)})"
        )
        axes.set_title(own.name.replace("_", " "), loc="left", fontsize=9.5)
        axes.legend(loc="best")
    return figure


def _draw_target(axes, own: ForceTarget) -> None:
    """Mark targets by crosses, bounds by ticks, with the band between two of them filled."""
    travels = own.reaction.travels
    if own.target is not None:
        axes.plot(travels, own.target, marker="x", label="target", **BAR)
    for values, marker, name in ((own.lower, "^", "lower bound"), (own.upper, "v", "upper bound")):
        if values is not None:
            axes.plot(travels, values, marker=marker, label=name, **BAR)
    if own.lower is not None and own.upper is not None:
        axes.fill_between(travels, own.lower, own.upper, color=SKY, alpha=0.25, linewidth=0.0)

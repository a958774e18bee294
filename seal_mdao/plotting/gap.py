"""Normal gap along the contact with a profile at the end of the path."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from seal_mdao.contact.friction import OPEN, SLIP
from seal_mdao.measures.boundary_line import is_closed
from seal_mdao.measures.selection import opened_points
from seal_mdao.plotting.contact import arc_length
from seal_mdao.plotting.style import BLUE, GREY, ORANGE, SKY, VERMILION, styled, subplots
from seal_mdao.seals.profiles import leading_contact
from seal_mdao.seals.result import SealResult

NEIGHBOURS = 3
"""Open points shown beyond either end of the contact."""
LEAST_SCALE = 0.02
"""Least upper limit of the vertical axis, mm."""


@styled
def gap_profile(result: SealResult, earlier=(), profile: str | None = None) -> Figure:
    """Normal gap of the contact points around the contact, open stretch shaded.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.
    earlier : sequence of float
        Travels (mm) at which the gap is drawn as a thin line as well.
    profile : str, optional
        Its label; the leading profile when left out.

    Returns
    -------
    Figure
    """
    figure, axes = subplots(width=7.6, height=4.2)
    label = leading_contact(result.seal).label if profile is None else profile
    s, end = arc_length(result, label), result.path.at_nominal(label)[-1]
    shown = _shown_points(end.state)
    opened = opened_points(end.state, is_closed(result.term(label).where))
    _shade_open(axes, s, opened)
    for number, travel in enumerate(earlier):
        _earlier_line(axes, result, label, travel, (":", "-.", "--")[number % 3])
    axes.plot(s[shown], end.gap[shown], color=GREY, linewidth=1.2, zorder=3)
    _draw_states(axes, s, end, shown)
    axes.axhline(0.0, color="black", linewidth=1.0, zorder=2)
    # scale by the gaps between contacts, not by the far larger ones beyond the contact
    highest = max([LEAST_SCALE, *end.gap[opened]])
    axes.set_ylim(-0.18 * highest, 1.45 * highest)
    axes.set_xlim(s[shown].min() - 0.5, s[shown].max() + 0.5)
    axes.xaxis.set_major_locator(MultipleLocator(2.0))
    axes.set_xlabel(f"undeformed arc length along the contact with {label} (mm)")
    axes.set_ylabel(f"normal gap to {label} (mm)")
    at_end = f"{result.caption(len(result.travel) - 1)}: {_summary(end, opened)}"
    axes.set_title(at_end, loc="left", fontsize=9.5)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _shown_points(state: np.ndarray) -> np.ndarray:
    touching = np.flatnonzero(state != OPEN)
    if touching.size == 0:
        return np.arange(state.size)
    # from the first to the last contact point, and NEIGHBOURS open points beyond
    first = max(touching[0] - NEIGHBOURS, 0)
    return np.arange(first, min(touching[-1] + NEIGHBOURS + 1, state.size))


def _shade_open(axes: Axes, s: np.ndarray, opened: np.ndarray) -> None:
    """Shade every stretch of neighbouring open points, half a spacing beyond its ends."""
    for run in np.split(opened, np.flatnonzero(np.diff(opened) != 1) + 1):
        if run.size:
            before, after = max(run[0] - 1, 0), min(run[-1] + 1, s.size - 1)
            ends = 0.5 * (s[before] + s[run[0]]), 0.5 * (s[run[-1]] + s[after])
            axes.axvspan(min(ends), max(ends), color=SKY, alpha=0.22, linewidth=0, zorder=0)


def _earlier_line(axes: Axes, result: SealResult, profile: str, travel: float, style) -> None:
    step = int(np.argmin(np.abs(result.travel - travel)))
    s, gap = arc_length(result, profile), result.path.at_nominal(profile)[step].gap
    axes.plot(
        s, gap, color=GREY, linewidth=1.0, linestyle=style, zorder=1,
        label=result.caption(step),
    )  # fmt: skip


def _draw_states(axes: Axes, s: np.ndarray, end, shown: np.ndarray) -> None:
    state = end.state[shown]
    groups = (
        (state == OPEN, "open", "o", "white", BLUE),
        ((state != OPEN) & (state != SLIP), "stick", "s", BLUE, BLUE),
        (state == SLIP, "slip", "^", ORANGE, VERMILION),
    )
    for chosen, label, marker, fill, edge in groups:
        if chosen.any():
            axes.plot(
                s[shown][chosen], end.gap[shown][chosen], linestyle="none", marker=marker,
                markersize=7, markerfacecolor=fill, markeredgecolor=edge, label=label, zorder=4,
            )  # fmt: skip


def _summary(end, opened: np.ndarray) -> str:
    # mm to micrometres; g_n < 0 is penetration
    penetration = 1e3 * max(0.0, -end.gap.min())
    if opened.size == 0:
        return f"no gap region, deepest penetration {penetration:.1f} µm"
    plural = "s" if opened.size > 1 else ""
    return (
        f"{opened.size} open point{plural} (shaded), largest gap {end.gap[opened].max():.3f} mm, "
        f"deepest penetration {penetration:.1f} µm"
    )

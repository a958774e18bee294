"""Figures of contact: pressure along the edges, width and peak pressure over travel."""

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.contact.friction import OPEN, SLIP
from seal_mdao.plotting.courses import course_panels, with_start
from seal_mdao.plotting.style import (
    BLUE,
    CYCLE,
    GREY,
    ORANGE,
    VERMILION,
    styled,
    subplots,
)
from seal_mdao.seals.profiles import contacts, nominal_pressure, side_lengths, true_pressure
from seal_mdao.seals.result import SealResult

BESIDE = 2
"""Open points shown beyond either end of the contact."""


def arc_length(result: SealResult, label: str) -> np.ndarray:
    """Compute the undeformed arc length of the contact points from the first one, shape (k,), mm."""
    return np.concatenate([[0.0], np.cumsum(side_lengths(result, label))])


@styled
def contact_pressure(result: SealResult, steps=None) -> Figure:
    """Plot the true contact pressure along the contact edges of every profile, and the nominal one at
    the end.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.
    steps : sequence of int, optional
        Nominal steps, from 0; ``result.key_steps()`` when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        For a result without profiles or without any converged step.
    """
    steps = result.key_steps() if steps is None else steps
    profiles = contacts(result.seal)
    if not profiles or not len(steps):
        raise ValueError("the result has no profile, or no converged load step to draw")
    figure, grid = subplots(
        len(profiles), 1, width=8.2, height=0.4 + 3.6 * len(profiles), squeeze=False
    )
    for contact, axes in zip(profiles, grid[:, 0], strict=True):
        _draw_pressures(axes, result, contact, steps)
    return figure


def _draw_pressures(axes, result, contact, steps) -> None:
    s, responses = arc_length(result, contact.label), result.path.at_nominal(contact.label)
    # touched: points with pressure at any of the steps, for the range of the axis
    touched = np.zeros(len(s), bool)
    for number, step in enumerate(steps):
        values, last = true_pressure(result, contact, step), number == len(steps) - 1
        touched |= values > 0.0
        axes.plot(
            s, values, color=BLUE if last else CYCLE[1:][number % (len(CYCLE) - 1)],
            linewidth=1.8 if last else 1.1, linestyle="-" if last else (":", "--", "-.")[number % 3],
            label=result.caption(step), zorder=3 if last else 2,
        )  # fmt: skip
    axes.plot(
        s, nominal_pressure(contact, responses[steps[-1]]), color=GREY, linewidth=1.1,
        label="nominal, at the end", zorder=2,
    )  # fmt: skip
    # contact state at the last step, marked on its curve (``values`` of the last pass above)
    state = responses[steps[-1]].state
    for text, marker, fill, chosen in (
        ("stick", "s", BLUE, (state != OPEN) & (state != SLIP)), ("slip", "^", ORANGE, state == SLIP),
    ):  # fmt: skip
        if chosen.any():
            axes.plot(
                s[chosen], values[chosen], linestyle="none", marker=marker, markersize=5.5,
                markerfacecolor=fill, markeredgecolor=VERMILION if fill == ORANGE else BLUE,
                label=f"{text}, at the end", zorder=4,
            )  # fmt: skip
    axes.axhline(0.0, color="black", linewidth=0.8)
    # range of the axis: the contact and BESIDE points on either side of it
    at = np.flatnonzero(touched)
    if at.size:
        first, last = max(at[0] - BESIDE, 0), min(at[-1] + BESIDE, len(s) - 1)
        axes.set_xlim(s[first], s[last])
    else:
        axes.set_title("no contact", fontsize=9.5, color=GREY)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel(f"undeformed arc length along the contact with {contact.label} (mm)")
    axes.set_ylabel("true contact pressure (kPa)")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


@styled
def contact_width(result: SealResult) -> Figure:
    """Plot deformed contact width and peak true pressure of every profile against its travel.

    Thin lines are the nominal values.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        For a result without profiles or without any converged step.
    """
    figure, panels = course_panels(result, "width in contact with {} (mm)")
    for history, course, axes, last in panels:
        # width on the left axis, peak pressure on a second one, labelled in the last column only
        right = axes.twinx()
        right.spines["right"].set_visible(last)
        right.grid(False)
        lines = _both(axes, course, history.width, history.nominal_width, BLUE, "-")
        lines += _both(right, course, history.peak, history.nominal_peak, VERMILION, "--")
        if last:
            right.set_ylabel("peak pressure (kPa)", color=VERMILION)
        else:
            right.tick_params(right=False, labelright=False)
    words = ["deformed width", "nominal width", "true peak pressure", "nominal peak pressure"]
    panels[0][2].legend(lines, words, loc="best")
    return figure


def _both(axes, course, true, nominal, color, style) -> list:
    """Plot the true values of a load-unload segment and, as a thin line, the nominal ones."""
    # dotted thin line: nominal; the axis starts at zero and leaves 12 % for the legend
    lines = axes.plot(*with_start(course, true), color=color, linestyle=style, zorder=3)
    thin = {"linewidth": 0.8, "alpha": 0.7, "zorder": 2}
    lines += axes.plot(*with_start(course, nominal), color=color, linestyle=":", **thin)
    axes.set_ylim(0.0, 1.12 * max(true.max(), nominal.max(), 1e-3))
    return lines

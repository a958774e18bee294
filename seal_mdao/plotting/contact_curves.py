"""Curves along the contact: pressure, and normal gap at the end of the path."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from seal_mdao.contact.friction import OPEN, SLIP, STICK
from seal_mdao.measures.boundary_line import is_closed
from seal_mdao.measures.selection import contact_range
from seal_mdao.plotting.style import (
    BESIDE,
    BLUE,
    CYCLE,
    GREY,
    ORANGE,
    SKY,
    VERMILION,
    styled,
    subplots,
)
from seal_mdao.seals.gaps import open_between
from seal_mdao.seals.profiles import (
    arc_length,
    contact_positions,
    contacts,
    leading_contact,
    nominal_pressure,
    true_pressure,
)
from seal_mdao.seals.result import SealResult

STATES = (
    (OPEN, "open", "o", "white", BLUE), (STICK, "stick", "s", BLUE, BLUE),
    (SLIP, "slip", "^", ORANGE, VERMILION),
)  # fmt: skip
"""Contact states with their names, markers and colours."""
PRESSURE_BEYOND, GAP_BEYOND = 2, 3
"""Open points shown beyond either end of the contact."""
LEAST_SCALE = 0.02
"""Least upper limit of the axis of gaps, mm."""
ARC_LENGTH = "undeformed arc length along the contact with {} (mm)"


def _shown(touching: np.ndarray, beyond: int) -> slice:
    """Points from the first to the last contact and ``beyond`` more, all without contact."""
    at = np.flatnonzero(touching)
    return slice(max(at[0] - beyond, 0), at[-1] + beyond + 1) if at.size else slice(None)


def along_contact(result: SealResult, label: str, touching: np.ndarray):
    """Order the contact points of a profile along the boundary for a curve over the arc length.

    A closed boundary whose beginning lies in the contact is cut in the middle of its longest open part
    in place of there; arc lengths before its beginning are negative.

    Returns
    -------
    order : ndarray of int, shape (n,)
    s : ndarray, shape (n,)
        Arc length in this order, mm, of the undeformed boundary.
    """
    s, size = arc_length(result, label), touching.size
    inside = contact_range(touching, is_closed(result.term(label).where))
    if not inside.size or inside[0] <= inside[-1]:
        return np.arange(size), s
    first = inside[0] - (size - inside.size) // 2
    order = np.arange(first, first + size) % size
    # s - L of the points before the beginning, with the length L of the closed boundary
    points = contact_positions(result, label)
    length = s[-1] + np.linalg.norm(points[0] - points[-1])
    return order, s[order] - np.where(order >= first, length, 0.0)


def _mark_states(axes: Axes, s, values, state, states, markersize, suffix="") -> None:
    """Mark points (k,) by their contact states."""
    for own, name, marker, fill, edge in states:
        at = state == own
        if at.any():
            axes.plot(
                s[at], values[at], linestyle="none", marker=marker, markersize=markersize,
                markerfacecolor=fill, markeredgecolor=edge, label=name + suffix, zorder=4,
            )  # fmt: skip


# ---- pressure ----


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

    Raises
    ------
    ValueError
        For a result without profiles or without any converged step.
    """
    steps = result.key_steps() if steps is None else steps
    profiles = contacts(result.seal)
    if not profiles or not len(steps):
        raise ValueError(
            "the result has no rigid profile, or no converged load step to draw (result.failure "
            "gives the cause)"
        )
    count = len(profiles)
    figure, grid = subplots(count, 1, width=8.2, height=0.4 + 3.6 * count, squeeze=False)
    for contact, axes in zip(profiles, grid[:, 0], strict=True):
        _draw_pressures(axes, result, contact, steps)
    return figure


def _draw_pressures(axes, result, contact, steps) -> None:
    end = result.path.at_nominal(contact.label)[steps[-1]]
    pressures = [true_pressure(result, contact, step) for step in steps]
    touched = np.any(pressures, axis=0)
    order, s = along_contact(result, contact.label, touched)
    for number, (step, values) in enumerate(zip(steps, pressures, strict=True)):
        look = {"color": BLUE, "linewidth": 1.8, "zorder": 3}
        if number < len(steps) - 1:
            color, style = CYCLE[1:][number % (len(CYCLE) - 1)], (":", "--", "-.")[number % 3]
            look = {"color": color, "linestyle": style, "linewidth": 1.1, "zorder": 2}
        axes.plot(s, values[order], label=result.caption(step), **look)
    # nominal pressure w_n |g_n| of the last step, per undeformed length
    nominal = nominal_pressure(contact, end)
    axes.plot(s, nominal[order], color=GREY, linewidth=1.1, label="nominal, at the end", zorder=2)
    _mark_states(axes, s, pressures[-1][order], end.state[order], STATES[1:], 5.5, ", at the end")
    axes.axhline(0.0, color="black", linewidth=0.8)
    # range of the axis: points with pressure at any of the steps
    if touched.any():
        axes.set_xlim(*s[_shown(touched[order], PRESSURE_BEYOND)][[0, -1]])
    else:
        axes.set_title("no contact", fontsize=9.5, color=GREY)
    axes.set_ylim(bottom=0.0)
    axes.set(xlabel=ARC_LENGTH.format(contact.label), ylabel="true contact pressure (kPa)")
    axes.legend(**BESIDE)


# ---- gap ----


@styled
def gap_profile(result: SealResult, earlier=(), profile: str | None = None) -> Figure:
    """Plot the normal gap of the contact points around the contact, gap regions shaded.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.
    earlier : sequence of float
        Travels (mm) at which the gap is drawn as a thin line as well.
    profile : str, optional
        Its label; the leading profile when left out.
    """
    figure, axes = subplots(width=7.6, height=4.2)
    label = leading_contact(result.seal).label if profile is None else profile
    s, gap = result.gap_profile(label)
    state = result.path.at_nominal(label)[-1].state
    # points of gap regions, open between contacts or between a contact and its mirror image
    opened = open_between(result, label)
    parts = state != OPEN
    parts[opened] = True
    shown = _shown(parts, GAP_BEYOND)
    _shade_gaps(axes, s, opened)
    for number, travel in enumerate(earlier):
        step = int(np.argmin(np.abs(result.travel - travel)))
        axes.plot(
            *result.gap_profile(label, step), color=GREY, linewidth=1.0, zorder=1,
            label=result.caption(step), linestyle=(":", "-.", "--")[number % 3],
        )  # fmt: skip
    axes.plot(s[shown], gap[shown], color=GREY, linewidth=1.2, zorder=3)
    _mark_states(axes, s[shown], gap[shown], state[shown], STATES, 7)
    axes.axhline(0.0, color="black", linewidth=1.0, zorder=2)
    # scale by the gaps between contacts, not by the far larger ones beyond the contact
    highest = max([LEAST_SCALE, *gap[opened]])
    axes.set(ylim=(-0.18 * highest, 1.45 * highest))
    axes.set(xlim=(s[shown].min() - 0.5, s[shown].max() + 0.5))
    axes.set(xlabel=ARC_LENGTH.format(label), ylabel=f"normal gap to {label} (mm)")
    axes.xaxis.set_major_locator(MultipleLocator(2.0))
    caption = result.caption(len(result.travel) - 1)
    axes.set_title(f"{caption}: {_summary(gap, opened)}", loc="left", fontsize=9.5)
    axes.legend(**BESIDE)
    return figure


def _shade_gaps(axes: Axes, s: np.ndarray, opened: np.ndarray) -> None:
    """Shade every region of neighbouring open points, half a spacing beyond its ends."""
    for run in np.split(opened, np.flatnonzero(np.diff(opened) != 1) + 1):
        if run.size:
            before, after = max(run[0] - 1, 0), min(run[-1] + 1, s.size - 1)
            ends = 0.5 * (s[before] + s[run[0]]), 0.5 * (s[run[-1]] + s[after])
            axes.axvspan(min(ends), max(ends), color=SKY, alpha=0.22, linewidth=0, zorder=0)


def _summary(gap: np.ndarray, opened: np.ndarray) -> str:
    # mm to micrometres; g_n < 0 is penetration
    deepest = f"deepest penetration {1e3 * max(0.0, -gap.min()):.1f} µm"
    if opened.size == 0:
        return f"no gap region, {deepest}"
    points = f"{opened.size} open point{'s' if opened.size > 1 else ''} (shaded)"
    return f"{points}, largest gap {gap[opened].max():.3f} mm, {deepest}"

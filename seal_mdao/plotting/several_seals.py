"""Figures of several analysed seals side by side: load-deflection, contact pressure, sections."""

from collections.abc import Mapping
from itertools import cycle

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.measures.reaction import travel_direction
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.contact_curves import along_contact
from seal_mdao.plotting.field import fine_grid
from seal_mdao.plotting.style import CYCLE, styled, subplots
from seal_mdao.plotting.travel_curves import add_length_axis
from seal_mdao.seals.profiles import (
    PARALLEL,
    contacts,
    leading_contact,
    leading_part,
    moving_histories,
    true_pressure,
)
from seal_mdao.seals.result import SealResult

MOST_SECTIONS = 6
"""Sections that are drawn below the curves."""
LONGEST_LABEL = 40
"""Letters of the label of a force in one line."""
LEAST_HEIGHT = 3.4
"""Height of the row of sections, for the label of the colour bar, inches."""
SAME_SCALE = 3.0
"""Ratio of the sizes of sections up to which they are drawn in one scale of length."""


@styled
def load_deflection_of(results: Mapping[str, SealResult], title: str = "") -> Figure:
    """Plot the force on the leading profile against its travel, a curve for every seal.

    Parameters
    ----------
    results : mapping of str to SealResult
        By the text of the legend; complete, or up to where the path ended.
    title : str
        Of the legend.

    Returns
    -------
    Figure
        Component of the force against the travel of each stage; a panel for N/m, one for N.
    """
    groups, colors = _by_unit(results), _colors(results)
    figure, panels = subplots(1, len(groups), width=7.4 * len(groups), height=4.6, squeeze=False)
    for axes, group in zip(panels[0], groups, strict=True):
        draw_forces(axes, group, colors)
        axes.legend(loc="best", title=title or None)
    return figure


def _by_unit(results) -> list[dict]:
    """Divide results by the unit of their forces, N/m of strips and N of rings."""
    groups = {}
    for name, result in results.items():
        groups.setdefault(result.seal.units.force, {})[name] = result
    return list(groups.values())


def _colors(results) -> dict[str, str]:
    """Choose a colour for every seal."""
    return dict(zip(results, cycle(CYCLE), strict=False))


def draw_forces(axes, results, colors) -> None:
    """Plot the force on the leading profile, or moved edges, against the travel of each stage over its
    path length from the start, for every seal with its colour; the larger component where it only
    turns."""
    labels = {}
    axes.axhline(0.0, color="black", linewidth=0.8)
    for name, result in results.items():
        travel, force, _, words = force_against_travel(result)
        labels[f"{words} ({result.seal.units.force})"] = None
        axes.plot(travel, force, color=colors[name], label=name)
        if not result.converged:
            axes.plot(travel[-1], force[-1], "x", color=colors[name])
    profiles = all(contacts(result.seal) for result in results.values())
    axes.set_xlabel("travel of the profile (mm)" if profiles else "travel (mm)")
    # a long label in two lines, so that it is no longer than the axis
    broken = (
        own.replace(" against", "\nagainst") if len(own) > LONGEST_LABEL else own for own in labels
    )
    axes.set_ylabel("\nor ".join(broken))
    # rings of one circumference
    ring, *others = {result.seal.units for result in results.values()}
    if ring.radius is not None and not others:
        add_length_axis(axes, ring)


def force_against_travel(result: SealResult) -> tuple[np.ndarray, np.ndarray, np.ndarray, str]:
    """Compute the force on the leading profile, or without profiles on moved edges, against the travel
    of each stage over the path length.

    Where the travel turns to another line the curve has a jump: two points at one travel. If all travel
    is along one line, forwards and backwards, the force is that against the first travel.

    Parameters
    ----------
    result : SealResult
        With a profile or moved edges.

    Returns
    -------
    travel, force : ndarray, shape (m,)
        Path length from the start, mm; force, N/m or N, positive where the seal resists.
    ends : ndarray of int, shape (n + 1,)
        Indices of the points at the start and at the ends of the n nominal steps.
    words : str
        Name of the force.
    """
    part = leading_part(result.seal)
    history = next(h for h in moving_histories(result) if h.label == part.label)
    against, words = against_travel(part.motion, history, result.seal.units)
    # path length s_k = sum |x_i - x_{i-1}|: loading and unloading stages follow each other
    start = np.array(part.motion.coordinates(0.0))[:2]
    points = np.vstack([start, history.place[:, :2]])
    travel = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    # F_k . e_k with e_k opposite to the travel in step k, of F_0 in the first
    initial = np.sum(history.initial_force * against[:1])
    force = np.append(initial, np.sum(history.force * against, axis=1))
    # F_k . e_(k+1) is the second value at the end of a step after which the direction changes
    turns = 1 + np.flatnonzero(np.abs(np.diff(against, axis=0)).max(axis=1, initial=0.0) > PARALLEL)
    jumped = np.sum(history.force[turns - 1] * against[turns], axis=1)
    ends = np.arange(len(force))
    ends += np.searchsorted(turns, ends)
    return (
        np.insert(travel, turns + 1, travel[turns]), np.insert(force, turns + 1, jumped), ends, words
    )  # fmt: skip


def against_travel(motion, history, units) -> tuple[np.ndarray, str]:
    """Return the unit vectors (n, 2) against the travel of a motion in the n steps of a history, and
    words for the force along them; of a motion along one line all against the first travel."""
    count = len(history.force)
    if not motion.travel > 0.0:
        component = history.main_component
        fixed = np.broadcast_to(np.eye(2)[component], (count, 2))
        return fixed, f"{units.directions[component]} force on {history.label}"
    # the direction of a measure "reaction" with direction = "travel"
    travels = motion.travels[1 : count + 1]
    against = np.array([-travel_direction(motion, travel)[0] for travel in travels]).reshape(-1, 2)
    words = f"force on {history.label} against its travel"
    first = against[:1]
    # |e_k . e_1| = 1: loading and unloading along one line is one curve, without a change of sign
    if (np.abs(against @ first.T) > 1.0 - PARALLEL).all() and (against @ first.T < 0.0).any():
        against = np.broadcast_to(first, against.shape)
        words = f"force on {history.label} against its first travel"
    # where all travel is along an axis, the force has the name of the component
    along = np.flatnonzero((np.abs(against) > 1.0 - PARALLEL).all(axis=0))
    direction = f"{units.directions[along[0]]} " if count and along.size else ""
    return against, f"{direction}{words}"


def draw_pressures(axes, results, colors) -> None:
    """Plot the true contact pressure at the end against arc length, from the middle of the contact."""
    for number, (name, result) in enumerate(results.items()):
        if not contacts(result.seal):
            continue
        contact = leading_contact(result.seal)
        pressure = true_pressure(result, contact)
        if not pressure.any():
            continue
        order, s = along_contact(result, contact.label, pressure > 0.0)
        pressure = pressure[order]
        # centre of pressure at zero, so that sections of different size lie above each other
        s = s - np.average(s, weights=pressure)
        axes.plot(s, pressure, color=colors[name], label=name)
        touched = s[pressure > 0.0]
        low, high = axes.dataLim.intervalx if number == 0 else axes.get_xlim()
        border = max(0.15 * np.ptp(touched), 2.0 * np.diff(s).max())
        ends = touched[0] - border, touched[-1] + border
        axes.set_xlim(ends if number == 0 else (min(low, ends[0]), max(high, ends[1])))
    axes.set_xlabel("undeformed arc length from the centre of pressure (mm)")
    axes.set_ylabel("true contact pressure (kPa)")
    axes.set_ylim(bottom=0.0)


@styled
def seals_compared(results: Mapping[str, SealResult]) -> Figure:
    """Plot load-deflection curves and final contact pressures of several seals, and their sections.

    Parameters
    ----------
    results : mapping of str to SealResult
        By name; with at least one converged load step each.

    Returns
    -------
    Figure
        Curves above, with a panel for N/m and one for N; the sections at the end of the path below, in
        one scale of stress and, unless they differ by more than ``SAME_SCALE``, one scale of length.

    Raises
    ------
    ValueError
        For a seal without any converged step, or where nothing moves.
    """
    for name, result in results.items():
        if not len(result.path.nominal_steps):
            raise ValueError(f"the analysis of {name} has no converged load step to draw")
    shown = dict(list(results.items())[:MOST_SECTIONS])
    fine = {name: fine_grid(result) for name, result in shown.items()}
    scale = section.stress_scale(own.von_mises(-1) for own in fine.values())
    windows = _windows(
        [section.window([own.deformed(-1)], 0.15, own.result.seal) for own in fine.values()]
    )
    sizes = [section.panel_size(*window) for window in windows]
    width, height = (0.8 * max(own) for own in zip(*sizes, strict=True))
    groups, colors = _by_unit(results), _colors(results)
    columns, height = len(shown), max(height + 0.6, LEAST_HEIGHT)
    # no panel of pressures for seals without profiles
    curves = len(groups) + any(contacts(result.seal) for result in results.values())
    across = max(5.0 * curves, (width + 0.5) * columns + section.BAR_WIDTH)
    figure, _ = subplots(width=across, height=4.2 + height)
    figure.clear()
    upper, lower = figure.add_gridspec(2, 1, height_ratios=(4.2, height))
    above = upper.subgridspec(1, curves).subplots(squeeze=False)[0]
    for axes, group in zip(above, groups, strict=False):
        draw_forces(axes, group, colors)
        axes.legend(loc="best")
    if curves > len(groups):
        draw_pressures(above[-1], results, colors)
    panels = lower.subgridspec(1, columns).subplots(squeeze=False)[0]
    for axes, (name, result), window in zip(panels, shown.items(), windows, strict=True):
        last = len(result.path.nominal_steps) - 1
        (contours,) = section.draw_stress(axes, fine[name], last, [scale])
        section.frame(axes, *window, result.seal)
        axes.set_title(name, color=colors[name])
    bar = figure.colorbar(contours, ax=list(panels), shrink=0.9, pad=0.02)
    bar.set_label(section.stress_label(bar))
    return figure


def _windows(windows) -> list[tuple[np.ndarray, np.ndarray]]:
    """Extend windows to one size around their middles, unless the largest is more than ``SAME_SCALE``
    times as large as the smallest."""
    sizes = np.array([high - low for low, high in windows])
    larger = sizes.max(axis=1)
    if larger.max() > SAME_SCALE * larger.min():
        return windows
    half = 0.5 * sizes.max(axis=0)
    middles = [0.5 * (low + high) for low, high in windows]
    return [(middle - half, middle + half) for middle in middles]

"""Figures of several analysed seals side by side: load-deflection, contact pressure, sections."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.measures.reaction import travel_direction
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.contact_curves import along_contact
from seal_mdao.plotting.field import fine_grid
from seal_mdao.plotting.style import CYCLE, styled, subplots
from seal_mdao.plotting.travel_curves import add_length_axis
from seal_mdao.seals.profiles import PARALLEL, leading_contact, profile_histories, true_pressure
from seal_mdao.seals.result import SealResult

MOST_SECTIONS = 6
"""Sections that are drawn beside the curves."""


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
        Component of the force against the travel of each stage, N/m or N.
    """
    figure, axes = subplots(width=7.4, height=4.6)
    draw_forces(axes, results)
    axes.legend(loc="best", title=title or None)
    return figure


def draw_forces(axes, results) -> None:
    """Plot the force on the leading profile against the travel of each stage over its path length from
    the start, for every seal; of a profile that only turns the larger component."""
    labels = {}
    axes.axhline(0.0, color="black", linewidth=0.8)
    for number, (name, result) in enumerate(results.items()):
        travel, force, _, words = force_against_travel(result)
        labels[f"{words} ({result.seal.units.force})"] = None
        axes.plot(travel, force, color=CYCLE[number % len(CYCLE)], label=name)
        if not result.converged:
            axes.plot(travel[-1], force[-1], "x", color=CYCLE[number % len(CYCLE)])
    axes.set_xlabel("travel of the profile (mm)")
    axes.set_ylabel("\nor ".join(labels))
    # rings of one circumference
    ring, *others = {result.seal.units for result in results.values()}
    if ring.radius is not None and not others:
        add_length_axis(axes, ring)


def force_against_travel(result: SealResult) -> tuple[np.ndarray, np.ndarray, np.ndarray, str]:
    """Compute the force on the leading profile against the travel of each stage over the path length.

    Where the direction of the travel changes the curve has a jump: two points at one travel.

    Parameters
    ----------
    result : SealResult
        With a profile.

    Returns
    -------
    travel, force : ndarray, shape (m,)
        Path length from the start, mm; force, N/m or N, positive where the seal resists.
    ends : ndarray of int, shape (n + 1,)
        Indices of the points at the start and at the ends of the n nominal steps.
    words : str
        Name of the force.
    """
    contact = leading_contact(result.seal)
    history = next(h for h in profile_histories(result) if h.label == contact.label)
    against, words = against_travel(contact.motion, history, result.seal.units)
    # path length s_k = sum |x_i - x_{i-1}|: loading and unloading stages follow each other
    start = np.array(contact.motion.coordinates(0.0))[:2]
    points = np.vstack([start, history.place[:, :2]])
    travel = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    # F_k . e_k with e_k opposite to the travel in step k, F_0 = 0
    force = np.append(0.0, np.sum(history.force * against, axis=1))
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
    words for the force along them."""
    count = len(history.force)
    if not motion.travel > 0.0:
        component = history.main_component
        fixed = np.broadcast_to(np.eye(2)[component], (count, 2))
        return fixed, f"{units.directions[component]} force on {history.label}"
    # the direction of a measure "reaction" with direction = "travel"
    travels = motion.travels[1 : count + 1]
    against = np.array([-travel_direction(motion, travel)[0] for travel in travels]).reshape(-1, 2)
    # where all travel is along an axis, the force has the name of the component
    along = np.flatnonzero((np.abs(against) > 1.0 - PARALLEL).all(axis=0))
    direction = f"{units.directions[along[0]]} " if count and along.size else ""
    return against, f"{direction}force on {history.label} against its travel"


def draw_pressures(axes, results) -> None:
    """Plot the true contact pressure at the end against arc length, from the middle of the contact."""
    for number, (name, result) in enumerate(results.items()):
        contact = leading_contact(result.seal)
        pressure = true_pressure(result, contact)
        if not pressure.any():
            continue
        order, s = along_contact(result, contact.label, pressure > 0.0)
        pressure = pressure[order]
        # centre of pressure at zero, so that sections of different size lie above each other
        s = s - np.average(s, weights=pressure)
        axes.plot(s, pressure, color=CYCLE[number % len(CYCLE)], label=name)
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
        Curves above, the sections at the end of the path below, in one scale of stress.

    Raises
    ------
    ValueError
        For a seal without profiles, or without any converged step.
    """
    for name, result in results.items():
        if not len(result.path.nominal_steps):
            raise ValueError(f"the analysis of {name} has no converged load step to draw")
    shown = dict(list(results.items())[:MOST_SECTIONS])
    fine = {name: fine_grid(result) for name, result in shown.items()}
    scale = section.stress_scale(own.von_mises(-1) for own in fine.values())
    windows = [section.window([own.deformed(-1)], 0.15, own.result.seal) for own in fine.values()]
    # one scale of length for all sections
    low = np.min([w[0] for w in windows], axis=0)
    high = np.max([w[1] for w in windows], axis=0)
    width, height = section.panel_size(low, high)
    columns = max(2, len(shown))
    figure, _ = subplots(width=max(10.0, 0.8 * width * columns), height=4.2 + 0.8 * height)
    figure.clear()
    grid = figure.add_gridspec(2, 2 * columns, height_ratios=(4.0, max(0.8 * height, 2.5)))
    curves = figure.add_subplot(grid[0, :columns])
    draw_forces(curves, results)
    curves.legend(loc="best")
    pressures = figure.add_subplot(grid[0, columns:])
    draw_pressures(pressures, results)
    panels = []
    for number, (name, result) in enumerate(shown.items()):
        axes = figure.add_subplot(grid[1, 2 * number : 2 * number + 2])
        last = len(result.path.nominal_steps) - 1
        (contours,) = section.draw_stress(axes, fine[name], last, [scale])
        section.frame(axes, low, high, result.seal)
        axes.set_title(name, color=CYCLE[number % len(CYCLE)])
        panels.append(axes)
    bar = figure.colorbar(contours, ax=panels, shrink=0.8, pad=0.02)
    bar.set_label(section.stress_label(bar))
    return figure

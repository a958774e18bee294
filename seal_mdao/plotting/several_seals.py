"""Figures of several analysed seals side by side: load-deflection, contact pressure, sections."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.contact_curves import along_contact
from seal_mdao.plotting.field import fine_grid
from seal_mdao.plotting.style import CYCLE, styled, subplots
from seal_mdao.plotting.travel_curves import add_length_axis
from seal_mdao.seals.profiles import leading_contact, profile_histories, true_pressure
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
        Magnitude of the force, N/m.
    """
    figure, axes = subplots(width=7.4, height=4.6)
    draw_forces(axes, results)
    axes.legend(loc="best", title=title or None)
    return figure


def draw_forces(axes, results) -> None:
    """Plot |F| of the leading profile against its path length from the start, for every seal."""
    for number, (name, result) in enumerate(results.items()):
        label = leading_contact(result.seal).label
        history = next(h for h in profile_histories(result) if h.label == label)
        # path length s_k = sum |x_i - x_{i-1}|: loading and unloading stages follow each other
        start = np.array(leading_contact(result.seal).motion.coordinates(0.0))[:2]
        points = np.vstack([start, history.place[:, :2]])
        travel = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
        force = np.append(0.0, np.hypot(*history.force.T))
        axes.plot(travel, force, color=CYCLE[number % len(CYCLE)], label=name)
        if not result.converged:
            axes.plot(travel[-1], force[-1], "x", color=CYCLE[number % len(CYCLE)])
    axes.set_xlabel("travel of the profile (mm)")
    units = dict.fromkeys(result.seal.units.force for result in results.values())
    axes.set_ylabel(f"force ({' or '.join(units)})")
    axes.set_ylim(bottom=0.0)
    # rings of one circumference
    ring, *others = {result.seal.units for result in results.values()}
    if ring.radius is not None and not others:
        add_length_axis(axes, ring)


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
            raise ValueError(f"{name} has no converged load step to draw")
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
    figure.colorbar(contours, ax=panels, shrink=0.8, pad=0.02).set_label(section.STRESS)
    return figure

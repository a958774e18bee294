"""Curves over travel: forces on every profile, contact width and peak pressure.

A row of panels for each profile, a column for each load-unload segment.
"""

from itertools import cycle

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.analysis.cost import duration
from seal_mdao.plotting.style import (
    BLUE,
    CYCLE,
    GREY,
    VERMILION,
    mark_failure,
    signed,
    styled,
    subplots,
)
from seal_mdao.seals.cavities import cavity_pressures
from seal_mdao.seals.profiles import moving_histories, path_stages, profile_histories
from seal_mdao.seals.result import SealResult

WIDTHS = (6.6, 9.0, 11.0)
"""Widths of figures with one, two or three and more columns, inches."""
VISIBLE = 0.05
"""Part of the forces of a panel below which the change in a dwell has no label, and above which the
label of a force is clear of the zero line."""
COMPONENTS = ((1, BLUE, "-"), (0, VERMILION, "--"))


@styled
def load_deflection(result: SealResult) -> Figure:
    """Plot compression-load-deflection curves: force on every profile against its travel, in N/m on
    the left axis, in N per 100 mm of seal on the right one, of a ring in N and in N per mm of its
    circumference; and below, where the seal has cavities, the excess pressure of their air.

    Loading and unloading along one line share a panel.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.

    Raises
    ------
    ValueError
        For a result without profiles or without any converged step.
    """
    histories, cavities = moving_histories(result), cavity_pressures(result)
    rows = [(own, f"force on {own.label} ({result.seal.units.force})") for own in histories]
    # the air is drawn over the travel of the first profile
    rows += [(own, "pressure of the air (kPa)") for own in histories[:1] if cavities]
    figure, panels = _segment_panels(rows, result)
    if cavities:
        n_forces = len(panels) - len(histories[0].load_segments)
        _draw_air(panels[n_forces:], cavities)
        panels = panels[:n_forces]
    for history, segment, axes, last in panels:
        travel, force = _with_start(segment, history.force, history.initial_force)
        axes.axhline(0.0, color="black", linewidth=0.8)
        names = result.seal.units.directions
        for component, color, style in COMPONENTS:
            own, name = force[:, component], names[component]
            axes.plot(travel, own, color=color, linestyle=style, label=name)
            axes.plot(travel[-1], own[-1], "o", color=color)
            axes.annotate(
                signed(own[-1]), (travel[-1], own[-1]), xytext=(6, 0), textcoords="offset points",
                va=_off_zero(own[-1], np.ptp(force)), color=color,
            )  # fmt: skip
        _label_dwells(
            axes, path_stages(result.seal), segment, travel, force[:, history.main_component]
        )
        _mark_critical(axes, result, segment, travel, force[:, history.main_component])
        if last:
            add_length_axis(axes, result.seal.units)
    panels[0][2].legend(loc="best", title="component")
    return figure


def _off_zero(value: float, span: float) -> str:
    """Choose the vertical alignment of the label of a value, so that the zero line does not cross it."""
    if value > VISIBLE * span:
        return "center"
    return "bottom" if value > 0.0 else "top"


def _label_dwells(axes, stages, segment, travel: np.ndarray, force: np.ndarray) -> None:
    """Write the durations of the stages of a segment in which nothing moves beside their vertical lines,
    with ``stages`` as of ``path_stages``."""
    for number in segment.stages if stages is not None else ():
        begin, end = np.minimum(stages.steps[number - 1 : number + 1], segment.steps.stop)
        first, last = begin - segment.steps.start, end - segment.steps.start
        # a line of no visible length has no label
        if stages.moves[number - 1] or abs(force[last] - force[first]) < VISIBLE * np.ptp(force):
            continue
        axes.annotate(
            duration(stages.durations[number - 1]),
            (travel[last], 0.5 * (force[first] + force[last])), xytext=(6, 0), gid="dwell",
            textcoords="offset points", va="center", color=GREY, fontsize=8.5,
        )  # fmt: skip


def add_length_axis(axes, units, location: str | float = "right") -> None:
    """Add an axis on the right for forces of a seal with ``ResultUnits`` per length along it, or at a
    ``location`` in widths of the axes."""
    factor, text = units.per_100_mm, "N per 100 mm of seal"
    if units.radius is not None:
        factor, text = units.per_mm, f"N {units.along}".replace(" at", "\nat")
    right = axes.secondary_yaxis(location, functions=(lambda f: f * factor, lambda f: f / factor))
    right.set_ylabel(text)


def _draw_air(panels, cavities) -> None:
    """Plot the excess pressure of the air of every cavity over the load-unload segments of a profile."""
    for history, segment, axes, last in panels:
        axes.axhline(0.0, color="black", linewidth=0.8)
        for color, (label, pressure) in zip(cycle(CYCLE), cavities.items(), strict=False):
            travel, own = _with_start(segment, pressure, _unknown(history))
            axes.plot(travel, own, color=color, label=label)
            axes.annotate(
                signed(own[-1]), (travel[-1], own[-1]), xytext=(6, 0), textcoords="offset points",
                va="center", color=color,
            )  # fmt: skip
        if last and len(cavities) > 1:
            axes.legend(loc="best")


def _mark_critical(axes, result, segment, travel: np.ndarray, force: np.ndarray) -> None:
    """Mark the losses of stability within a load-unload segment."""
    # path parameters at the start and the step ends of the segment
    ends = np.arange(segment.steps.start, segment.steps.stop + 1)
    fractions = [point.fraction for point in result.critical_points]
    fractions = [fraction for fraction in fractions if ends[0] < fraction <= ends[-1]]
    if fractions:
        # the force before a jump, that of the step end before the critical point
        before = np.clip(np.searchsorted(ends, fractions) - 1, 0, len(ends) - 1)
        axes.plot(
            np.interp(fractions, ends, travel), force[before], linestyle="none", marker="D",
            markerfacecolor="white", markeredgecolor="black", markersize=5.0, zorder=5,
            label="stability lost",
        )  # fmt: skip


@styled
def contact_width(result: SealResult) -> Figure:
    """Plot deformed contact width and peak true pressure of every profile against its travel.

    Thin lines are the nominal values.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.

    Raises
    ------
    ValueError
        For a result without profiles or without any converged step.
    """
    rows = [(own, f"width in contact with {own.label} (mm)") for own in profile_histories(result)]
    figure, panels = _segment_panels(rows, result)
    for history, segment, axes, last in panels:
        # width on the left axis, peak pressure on a second one, labelled in the last column only
        right = axes.twinx()
        right.spines["right"].set_visible(last)
        right.grid(False)
        start = _unknown(history)
        lines = _true_and_nominal(
            axes, segment, history.width, history.nominal_width, start, BLUE, "-"
        )
        lines += _true_and_nominal(
            right, segment, history.peak, history.nominal_peak, start, VERMILION, "--"
        )
        if last:
            right.set_ylabel("peak pressure (kPa)", color=VERMILION)
        else:
            right.tick_params(right=False, labelright=False)
    words = ["deformed width", "nominal width", "true peak pressure", "nominal peak pressure"]
    figure.legend(lines, words, loc="outside upper center", ncols=2)
    return figure


def _true_and_nominal(axes, segment, true, nominal, start, color, style) -> list:
    """Plot the true values of a segment and, as a thin dotted line, the nominal ones."""
    lines = axes.plot(*_with_start(segment, true, start), color=color, linestyle=style, zorder=3)
    thin = {"linewidth": 0.8, "alpha": 0.7, "zorder": 2}
    lines += axes.plot(*_with_start(segment, nominal, start), color=color, linestyle=":", **thin)
    # the axis starts at zero
    axes.set_ylim(0.0, 1.05 * max(true.max(), nominal.max(), 1e-3))
    return lines


def _segment_panels(rows, result: SealResult):
    """Create a figure with axes for every load-unload segment of every row.

    Parameters
    ----------
    rows : list of (ProfileHistory, str)
        Profile along whose travel the row is, label of its vertical axis.

    Returns
    -------
    figure : Figure
    panels : list of (ProfileHistory, Course, Axes, bool)
        The flag marks the last axes of a row.
    """
    if not rows or not len(rows[0][0].stage):
        raise ValueError(
            "the result has no rigid profile, or no converged load step to draw (result.failure "
            "gives the cause)"
        )
    # one grid for all rows: as many columns as the longest one needs
    columns, n_rows = max(len(history.load_segments) for history, _ in rows), len(rows)
    # wider for more segments
    width = WIDTHS[min(columns, len(WIDTHS)) - 1]
    figure, grid = subplots(
        n_rows, columns, width=width, height=0.6 + 3.4 * n_rows, squeeze=False, sharey="row"
    )
    panels = []
    for (history, text), row in zip(rows, grid, strict=True):
        row[0].set_ylabel(text)
        for axes in row[len(history.load_segments) :]:
            axes.set_visible(False)
        for segment, axes in zip(history.load_segments, row, strict=False):
            _label(axes, history, segment)
            panels.append((history, segment, axes, segment is history.load_segments[-1]))
    mark_failure(figure, result)
    return figure, panels


def _label(axes, history, segment) -> None:
    """Label the axis of travel, with 20 % of it free at its end and, after unloading, its beginning."""
    axes.set_xlabel(segment.axis)
    several = len(segment.stages) > 1
    if len(history.load_segments) > 1 or several:
        numbers = ", ".join(map(str, segment.stages))
        axes.set_title(f"stage{'s' if several else ''} {numbers}", fontsize=9.5)
    margin = 0.2 * (np.ptp(segment.along) or 1.0)
    low, high = min(segment.begin, segment.along.min()), max(0.0, segment.along.max())
    axes.set_xlim(low - margin * (low < segment.begin), high + margin)


def _unknown(history) -> float:
    """Return the start of values that are zero without contact: not known, and not drawn, with contact
    at the start."""
    return np.nan if history.initial_force.any() else 0.0


def _with_start(segment, values: np.ndarray, start) -> tuple[np.ndarray, np.ndarray]:
    """Return travel (k + 1,) and values (k + 1, ...) of a load-unload segment with its initial state,
    from the values (n, ...) at every nominal step and those at the ``start`` of the first."""
    # before[k]: values at the beginning of step k; the segment begins at the end of the step before it
    before = np.concatenate([np.broadcast_to(start, values[:1].shape), values])
    begun = slice(segment.steps.start, segment.steps.stop + 1)
    return np.append(segment.begin, segment.along), before[begun]

"""Figure of critical points: critical modes, and shapes before and after."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seal_mdao.plotting import field, section
from seal_mdao.plotting.deformation import panel_size
from seal_mdao.plotting.style import BLUE, LIGHT_GREY, VERMILION, styled, subplots
from seal_mdao.seals.result import SealResult

MOST = 6
"""Largest number of panels; of more points those with the largest displacement."""
SCALE = 0.08
"""Largest displacement of a plotted mode, over the size of the section."""


@styled
def critical_modes(result: SealResult) -> Figure:
    """Plot the shape before every critical point, the critical mode, and the shape after.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.

    Raises
    ------
    ValueError
        For a path that did not lose its stability.
    """
    points = result.critical_points
    if not points:
        raise ValueError("the path has no critical point to draw")
    if len(points) > MOST:
        limit = sorted((point.moved for point in points), reverse=True)[MOST - 1]
        points = [point for point in points if point.moved >= limit][:MOST]
    body, last = result.seal.body, len(result.path.nominal_steps) - 1
    # boundary by particles: two points a side of a cell, its corners
    loops = field.boundary_loops(body.cells, body.cells[:, [[0, 3], [1, 2]]])
    # nominal step k, from 0, ends at the path parameter k + 1
    before = [min(max(int(point.fraction) - 1, 0), last) for point in points]
    shapes = [result.deformed(step) for k in before for step in (k, min(k + 1, last))]
    low, high = section.window(shapes)
    width, height = panel_size(low, high)
    columns = min(len(points), 3)
    rows = -(-len(points) // columns)
    figure, axes = subplots(
        rows, columns, width=max(0.75 * width * columns + 1.0, 4.5),
        height=rows * (0.75 * height + 0.7) + 0.7, squeeze=False, sharex=True, sharey=True,
    )  # fmt: skip
    for axis, point, k in zip(axes.flat, points, before, strict=False):
        _draw(axis, result, point, k, min(k + 1, last), loops)
        section.frame(axis, low, high)
        axis.label_outer()
    for axis in axes.flat[len(points) :]:
        axis.set_visible(False)
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _draw(axes: Axes, result, point, before: int, after: int, loops) -> None:
    shape = result.deformed(before)
    section.fill_outline(axes, shape, loops, facecolor=LIGHT_GREY, edgecolor="black", linewidth=0.8)
    # a filled patch has no line for the legend: an empty line stands for its edge
    axes.plot([], [], color="black", linewidth=0.8, label="last load step before")
    # x + SCALE L phi: the mode has its largest component 1
    mode = shape + SCALE * section.size_of(result) * point.mode
    section.draw_outline(
        axes, mode, loops, color=VERMILION, linestyle="--", linewidth=1.2, label="critical mode"
    )
    section.draw_outline(
        axes,
        result.deformed(after),
        loops,
        color=BLUE,
        linewidth=1.4,
        label="first load step after",
    )
    section.draw_held(axes, result)
    section.draw_profiles(axes, result, result.path.nominal_steps[after].fraction)
    # the travel is NaN where the profiles have none in common
    where = f"travel {point.travel:.2f} mm" if point.travel == point.travel else ""
    axes.set_title(f"{where}: {point.kind}, {_energy(point.released)}", fontsize=9.0)


def _energy(released: float) -> str:
    if np.isnan(released):
        return "energy unknown"
    return f"{released:.2g} mJ/m" if abs(released) >= 1e-3 else "< 0.001 mJ/m"

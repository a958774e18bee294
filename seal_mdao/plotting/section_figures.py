"""Figures of the section: cloud, deformed shapes with stress, critical modes, two designs.

``deformed_shapes`` is Figure 4 of Kim et al. (2000), ``design_comparison`` their Figure 7.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from shapely import box, get_parts, polygons, union_all
from shapely.ops import polylabel

from seal_mdao.geometry.motion import BEFORE
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.field import cell_loops, fine_grid
from seal_mdao.plotting.style import (
    BESIDE,
    BLUE,
    CELL_GREY,
    CYCLE,
    DASHES,
    GREY,
    LIGHT_GREY,
    VERMILION,
    mark_failure,
    panels,
    styled,
    subplots,
)
from seal_mdao.seals.profiles import contacts, moved_edges
from seal_mdao.seals.result import SealResult

MOST_POINTS = 6
"""Largest number of critical points in a figure; of more those with the largest displacement."""
NAME = {
    "ha": "center", "va": "center", "zorder": 6,
    "bbox": {"facecolor": "white", "edgecolor": "none", "pad": 2.0},
}  # fmt: skip
"""Text of a name in the figure of a section."""
MODE_SIZE = 0.08
"""Largest displacement of a plotted mode, over the size of the section."""


# ---- cloud ----


def _error_lines(seal, estimates: dict) -> list[str]:
    """List the estimated errors of the measures of a seal in per cent, the largest of each."""
    lines = []
    for measure in seal.standard:
        relative = estimates[measure.name].relative if measure.name in estimates else None
        if relative is not None:
            error = 100.0 * relative.max()
            lines.append(f"{measure.name.replace('_', ' ')} ± {error:.2g} % (estimated)")
    return lines


@styled
def section_cloud(result: SealResult, estimates: dict | None = None) -> Figure:
    """Plot particles, background cells, edges and materials by name, and the profiles at the start.

    Parameters
    ----------
    result : SealResult
        Its undeformed section is plotted.
    estimates : dict of str to ErrorEstimate, optional
        As of ``accuracy.error_estimate.estimate_errors``; error bars of the measures of the seal are
        below the number of particles.
    """
    seal, particles = result.seal, result.particles
    # larger than a panel of shapes: cells and names must be legible
    low, high = _cloud_window(result)
    width, height = section.panel_size(low, high)
    figure, axes = subplots(width=1.35 * width + 2.2, height=1.35 * height + 0.6)
    section.draw_cells(axes, particles, seal.body.cells, color=CELL_GREY, linewidth=0.5, zorder=2)
    section.fill_outline(
        axes, particles, cell_loops(seal.body), facecolor=LIGHT_GREY, alpha=0.25, lw=0
    )
    # smaller dots for more particles
    size = float(np.clip(60.0 / np.sqrt(len(particles)), 0.8, 3.0))
    axes.plot(*particles.T, "o", color="#777777", markersize=size, zorder=3)
    for number, (name, edge) in enumerate(seal.body.edges.items()):
        ring = np.append(edge.particles, edge.particles[:1]) if edge.closed else edge.particles
        # after all colours the dash changes, so that no two of 21 edges look the same
        dashes, color = divmod(number, len(CYCLE))
        axes.plot(
            *particles[ring].T, color=CYCLE[color], linestyle=DASHES[dashes % len(DASHES)],
            linewidth=2.4, label=name, zorder=4,
        )  # fmt: skip
    moved = np.isin(
        np.arange(len(particles)), [i for own in moved_edges(seal) for i in own.particles]
    )
    fixed = seal.body.fixed.any(axis=1) & ~moved
    if fixed.any():
        axes.plot(*particles[fixed].T, "s", color="black", markersize=3.5, zorder=5, label="fixed")
    if moved.any():
        marker = {"color": "black", "markerfacecolor": "white", "markersize": 3.5}
        axes.plot(*particles[moved].T, "s", **marker, zorder=5, label="moved")
    section.draw_surroundings(axes, result, BEFORE)
    _name_profiles(axes, result, low, high)
    _name_materials(axes, result)
    section.frame(axes, low, high, seal)
    title = [f"{len(particles)} particles, {len(seal.body.cells)} cells"]
    title += _error_lines(seal, estimates or {})
    # y = 1: automatic positions measure the ticks once more
    axes.set_title("\n".join(title), loc="left", y=1.0)
    axes.legend(**BESIDE, title="edges", alignment="left")
    return figure


def _name_profiles(axes, result, low, high) -> None:
    """Write the name of each profile inside its visible part, at a ring on the right of the axis."""
    left = max(low[0], 0.0) if result.seal.body.axisymmetric else low[0]
    for contact in contacts(result.seal):
        # buffer(0) makes the polygon valid for the intersection with the window
        body = (
            section.profile_body(result, contact, 0.0)
            .buffer(0.0)
            .intersection(box(left, low[1], *high))
        )
        if not body.is_empty:
            axes.text(*body.representative_point().coords[0], contact.label, **NAME)


def _name_materials(axes, result) -> None:
    """Write the name of every material into its part of the section, and draw the lines between them."""
    seal, regions = result.seal, result.seal.definitions[0].regions
    if len(regions) == 1:
        return
    corners, shapes = result.particles[seal.body.cells], []
    for region in regions:
        shapes.append(union_all(polygons(corners[region.cells])))
        # where there is most room, and not in an insert
        largest = max(get_parts(shapes[-1]), key=lambda part: part.area)
        place = polylabel(largest, tolerance=0.01 * np.sqrt(largest.area))
        axes.text(*place.coords[0], region.name, **NAME)
    # sides that two materials share; bodies apart have none
    for number, shape in enumerate(shapes[:-1], 1):
        shared = shape.boundary.intersection(union_all(shapes[number:]).boundary)
        for line in getattr(shared, "geoms", [shared]):
            axes.plot(*np.array(line.coords).reshape(-1, 2).T, color="black", lw=1.2, zorder=4)


def _cloud_window(result):
    """Compute the window around the section and nearby parts of the profiles."""
    low, high = section.window([result.particles], 0.2, result.seal)
    faces = [section.profile_face(result, contact, 0.0) for contact in contacts(result.seal)]
    # profiles extend far beyond the section: only their points within 20 % of its size count
    near = [face[((face >= low) & (face <= high)).all(axis=1)] for face in faces]
    return section.window([result.particles, *near], 0.1, result.seal)


# ---- along the path ----


@styled
def deformed_shapes(result: SealResult, steps=None) -> Figure:
    """Plot deformed shapes with von Mises contours, a scale per material, and the rigid profiles.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.
    steps : sequence of int, optional
        Nominal steps, from 0; ``result.key_steps()`` when left out.

    Raises
    ------
    ValueError
        For a result without any converged step.
    """
    if len(result.path.nominal_steps) == 0:
        raise ValueError(
            "the result has no converged load step to draw; result.failure gives the cause"
        )
    steps = result.key_steps() if steps is None else steps
    # shape functions on the fine grid are evaluated once for all steps (Lagrangian)
    fine = fine_grid(result)
    scales = section.stress_scales([fine], steps)
    shapes = [fine.undeformed(), *map(fine.deformed, steps)]
    low, high = section.window(shapes, seal=result.seal)
    width, height = section.panel_size(low, high)
    bars = section.BAR_WIDTH * len(scales)
    figure, panel = panels(
        len(steps), 2 if width > 3.0 else 3, sharex=True, sharey=True,
        size=lambda rows, columns: (max(width * columns + bars, 5.0), rows * (height + 0.45) + 0.4),
    )  # fmt: skip
    every = list(figure.axes)
    for axes, step in zip(panel, steps, strict=True):
        contours = section.draw_stress(axes, fine, step, scales)
        section.frame(axes, low, high, result.seal)
        # y = 1: automatic positions measure the ticks once more
        axes.set_title(result.caption(step), y=1.0)
        axes.label_outer()
    mark_failure(figure, result)
    figure.legend(*panel[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    section.draw_colorbars(figure, every, contours, fine, shrink=0.7, aspect=30, pad=0.02)
    return figure


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
    points, last = result.critical_points, len(result.path.nominal_steps) - 1
    if not points:
        raise ValueError("the analysis has no critical point (buckling or snap-through) to draw")
    limit = sorted((point.moved for point in points), reverse=True)[:MOST_POINTS][-1]
    points = [point for point in points if point.moved >= limit][:MOST_POINTS]
    # nominal step k, from 0, ends at the path parameter k + 1
    before = [min(max(int(point.fraction) - 1, 0), last) for point in points]
    steps = [(k, min(k + 1, last)) for k in before]
    shapes = [result.deformed(step) for pair in steps for step in pair]
    low, high = section.window(shapes, seal=result.seal)
    width, height = section.panel_size(low, high)
    figure, panel = panels(
        len(points), 3, sharex=True, sharey=True,
        size=lambda rows, columns: (
            max(0.75 * width * columns + 1.0, 4.5), rows * (0.75 * height + 0.7) + 0.7
        ),
    )  # fmt: skip
    loops = cell_loops(result.seal.body)
    for axes, point, pair in zip(panel, points, steps, strict=True):
        _draw_mode(axes, result, point, *pair, loops)
        section.frame(axes, low, high, result.seal)
        axes.label_outer()
    figure.legend(*panel[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _draw_mode(axes: Axes, result, point, before: int, after: int, loops) -> None:
    shape = result.deformed(before)
    section.fill_outline(axes, shape, loops, facecolor=LIGHT_GREY, edgecolor="black", linewidth=0.8)
    # a filled patch has no line for the legend: an empty line stands for its edge
    axes.plot([], [], color="black", linewidth=0.8, label="last load step before")
    # x + MODE_SIZE L phi: the mode has its largest component 1
    mode = shape + MODE_SIZE * section.size_of(result) * point.mode
    for x, label, look in (
        (mode, "critical mode", {"color": VERMILION, "linestyle": "--", "linewidth": 1.2}),
        (result.deformed(after), "first load step after", {"color": BLUE, "linewidth": 1.4}),
    ):
        section.draw_outline(axes, x, loops, label=label, **look)
    section.draw_surroundings(axes, result, result.path.nominal_steps[after].fraction)
    # the travel is NaN where the profiles have none in common
    where = f"travel {point.travel:.2f} mm" if point.travel == point.travel else ""
    where = point.position if point.travel == 0.0 else where
    axes.set_title(
        f"{where}: {point.kind}, {_energy(point.released, result.seal.units.energy)}", fontsize=9.0
    )


def _energy(released: float, unit: str) -> str:
    if np.isnan(released):
        return "energy unknown"
    return f"{released:.2g} {unit}" if abs(released) >= 1e-3 else f"< 0.001 {unit}"


# ---- two designs ----


@styled
def design_comparison(initial: SealResult, optimised: SealResult, numbers=("", "")) -> Figure:
    """Plot both undeformed sections in one panel, and the deformed ones with the same colour scales.

    Parameters
    ----------
    initial, optimised : SealResult
        Completed analyses of two designs of one model.
    numbers : pair of str
        Text in the titles of both.
    """
    fines = fine_grid(initial), fine_grid(optimised)
    # the same scales and one window for both designs, so that colours and sizes compare
    scales = section.stress_scales(fines)
    shapes = [x for fine in fines for x in (fine.deformed(), fine.undeformed())]
    low, high = section.window(shapes, seal=initial.seal)
    width, height = section.panel_size(low, high)
    across = 3 * width + 0.3 + section.BAR_WIDTH * len(scales)
    figure, panel = subplots(1, 3, width=across, height=height + 1.2, sharey=True)
    # left panel: both undeformed shapes; right panels: deformed shapes with stress
    _draw_undeformed(panel[0], *fines)
    section.frame(panel[0], low, high, initial.seal)
    panel[0].set_title("undeformed")
    names = ("initial", "optimised")
    for axes, fine, name, text in zip(panel[1:], fines, names, numbers, strict=True):
        contours = section.draw_stress(axes, fine, -1, scales)
        section.frame(axes, low, high, initial.seal)
        axes.set(title=f"{name}: {text}" if text else name, ylabel="")
    # one legend for all panels: shapes of the first, contact points of the second
    shapes, points = (axes.get_legend_handles_labels() for axes in panel[:2])
    entries = [both[0] + both[1] for both in zip(shapes, points, strict=True)]
    figure.legend(*entries, loc="outside lower center", ncols=6)
    section.draw_colorbars(figure, panel, contours, fines[0], shrink=0.85, aspect=28, pad=0.01)
    return figure


def _draw_undeformed(axes: Axes, initial, optimised) -> None:
    section.draw_fixed(axes, initial.result)
    section.fill_outline(
        axes, optimised.undeformed(), optimised.loops, color=BLUE, alpha=0.12, lw=0
    )
    for fine, name, width, look in (
        (initial, "initial", 1.2, {"color": GREY, "linestyle": "--"}),
        (optimised, "optimised", 1.6, {"color": BLUE, "linestyle": "-"}),
    ):
        section.draw_outline(
            axes, fine.undeformed(), fine.loops, linewidth=width, label=name, **look
        )
        for contact in contacts(fine.result.seal):
            # profiles with parameters, such as a radius, show their values in the legend
            text = ", ".join(
                f"{key.replace('_', ' ')} {getattr(contact.shape, key):.2f} mm"
                for key in contact.shape.names
            )
            face = section.profile_face(fine.result, contact, 0.0)
            axes.plot(*face.T, linewidth=1.2, label=text or None, **look)

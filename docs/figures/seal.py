"""The drawn seal: geometry, path, deformed shapes."""

from functools import cache
from pathlib import Path

import numpy as np
from matplotlib.ticker import MaxNLocator

import seal_mdao as sm
from seal_mdao.plotting import deformed_shapes, section
from seal_mdao.plotting.style import BLUE, CYCLE, GREY, VERMILION, save, styled, subplots
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.result import SealResult
from seal_mdao.seals.wall_grid import ray_directions


@cache
def drawn(**changes) -> SealResult:
    """The drawn seal's path, with factors; computed once."""
    return sm.analyze(sm.door_seal(**changes), keep_factors=True)


def make(out: Path, reduced: bool) -> dict:
    """Pictures of the drawn seal and its headline numbers."""
    result = drawn()
    save(geometry(result), out / "geometry.png")
    save(newton(result), out / "newton.png")
    save(deformed_shapes(result), out / "deformed_shapes.png")
    return {
        "gap_square_sum": f"{result.gap_square_sum:.4f}",
        "max_gap": f"{result.gap.max():.3f}",
        "force": f"{result.reaction[-1, 1]:.2f}",
    }


def _spline_places(seal):
    """Ray angles at which the control values of the outer and inner spline act most."""
    angle = np.linspace(0, 2 * np.pi, 7201)[:-1]
    outer = angle[np.argmax(options_of(seal).splines.outer_basis(angle), axis=0)]
    inner = angle[np.argmax(options_of(seal).splines.inner_basis(angle), axis=0)]
    return outer, inner


def _rings(axes, seal, **line):
    angle = np.linspace(0, 2 * np.pi, 721)
    for radius in (options_of(seal).section.inner(angle), options_of(seal).section.outer(angle)):
        axes.plot(*(radius[:, None] * ray_directions(angle)).T, **line)


@styled
def geometry(result: SealResult):
    seal, axes_style = result.seal, {"color": "black", "linewidth": 1.0, "zorder": 3}
    figure, (left, right) = subplots(1, 2, width=10.0, height=4.9, sharey=True)
    corners = seal.drawn_particles[options_of(seal).grid.cells]
    closed = np.concatenate([corners, corners[:, :1]], axis=1)
    left.plot(*closed.transpose(2, 1, 0), color="#C9C9C9", linewidth=0.5, zorder=2)
    left.plot(*seal.drawn_particles.T, "o", color=BLUE, markersize=2.6, zorder=4)
    base = seal.drawn_particles[options_of(seal).grid.base]
    left.plot(*base.T, "s", color=VERMILION, markersize=4, zorder=5, label="fixed")
    left.legend(loc="center")
    for number, places in enumerate(_spline_places(seal)):
        radius = (options_of(seal).section.outer, options_of(seal).section.inner)[number](places)
        points = radius[:, None] * ray_directions(places)
        way = (0.9, -0.9)[number] * ray_directions(places)
        right.quiver(
            *points.T, *way.T, angles="xy", scale_units="xy", scale=1.0, width=0.005,
            color=(VERMILION, BLUE)[number], zorder=4,
        )  # fmt: skip
        first = (1, 1 + options_of(seal).outer_parameters)[number]
        for i, (x, y) in enumerate(points + 1.75 * way):
            right.text(x, y, f"$u_{{{first + i}}}$", ha="center", va="center", fontsize=8.5)
    right.text(6.6, 12.2, "$u_{26}$: radius", fontsize=9.5, va="center", ha="left", zorder=6)
    for axes in (left, right):
        _rings(axes, seal, **axes_style)
        section.draw_held(axes, result)
        section.draw_profiles(axes, result, 0.0)
        section.frame(axes, (-13.0, -12.0), (13.0, 15.5))
    right.set_ylabel("")
    return figure


@styled
def newton(result: SealResult):
    figure, (left, right) = subplots(1, 2, width=9.6, height=3.5)
    travel = result.travel
    left.bar(travel, result.newton_iterations, width=0.09, color=BLUE)
    left.set_xlabel("door travel from first touch (mm)")
    left.set_ylabel("Newton iterations")
    left.set_title(f"{result.newton_iterations.sum()} in all, {result.step_cuts} cuts", fontsize=10)
    steps = result.path.nominal_steps
    for number, color in zip(np.linspace(8, len(steps) - 1, 5).astype(int), CYCLE, strict=False):
        residuals = np.array(steps[number].residuals)
        right.semilogy(residuals, "o-", color=color, label=f"{travel[number]:.1f} mm")
    right.xaxis.set_major_locator(MaxNLocator(integer=True))
    right.axhline(result.seal.newton.tolerance, color=GREY, linestyle="--", linewidth=1.0)
    right.set_xlabel("iteration")
    right.set_ylabel("relative residual")
    right.legend(title="door travel", title_fontsize=9)
    return figure

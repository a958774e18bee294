"""The nominal seal: geometry, path, deformed shapes."""

from pathlib import Path

import numpy as np
from matplotlib.ticker import MaxNLocator

import seal_mdao as sm
from figures.drawing import DOOR_SEAL, picture
from seal_mdao.plotting import deformed_shapes
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.captions import captioned
from seal_mdao.plotting.style import BLUE, CELL_GREY, CYCLE, GREY, VERMILION, save
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.result import SealResult
from seal_mdao.seals.wall_grid import ray_directions


@captioned(DOOR_SEAL)
def make(out: Path, reduced: bool) -> dict:
    """Pictures of the nominal seal and its headline numbers."""
    result = sm.analyze(sm.door_seal())
    _geometry(out / "geometry.png", result)
    _newton(out / "newton.png", result)
    save(deformed_shapes(result), out / "deformed_shapes.png")
    return {
        "gap_square_sum": f"{result.gap_square_sum:.4f}",
        "max_gap": f"{result.gap.max():.3f}",
        "force": f"{result.reaction[-1, 1]:.2f}",
    }


def _geometry(path: Path, result: SealResult) -> None:
    """The cloud, and the design parameters at the control points of the splines."""
    door, angle = options_of(result.seal), np.linspace(0, 2 * np.pi, 721)
    particles, cells = result.seal.nominal_particles, door.grid.cells
    with picture(path, 1, 2, width=10.0, height=4.9, sharey=True) as (left, right):
        section.draw_cells(left, particles, cells, color=CELL_GREY, linewidth=0.5, zorder=2)
        left.plot(*particles.T, "o", color=BLUE, markersize=2.6, zorder=4)
        base = particles[door.grid.base]
        left.plot(*base.T, "s", color=VERMILION, markersize=4, zorder=5, label="fixed")
        left.legend(loc="center")
        outer, inner = door.section.outer, door.section.inner
        _offsets(right, outer, door.splines.outer_basis, 1, 0.9, VERMILION)
        _offsets(right, inner, door.splines.inner_basis, 1 + door.outer_parameters, -0.9, BLUE)
        right.text(6.6, 12.2, "$u_{26}$: radius", fontsize=9.5, va="center", ha="left", zorder=6)
        for axes in (left, right):
            for radius in (inner(angle), outer(angle)):
                ring = radius[:, None] * ray_directions(angle)
                axes.plot(*ring.T, color="black", linewidth=1.0, zorder=3)
            section.draw_surroundings(axes, result, 0.0)
            section.frame(axes, (-13.0, -12.0), (13.0, 15.5))
        right.set_ylabel("")


def _offsets(axes, radius, basis, first, length, color) -> None:
    """Arrows of the offsets of one boundary, numbered from ``first``."""
    # ray angles at which the control values act most
    angle = np.linspace(0, 2 * np.pi, 7201)[:-1]
    at = angle[np.argmax(basis(angle), axis=0)]
    points, arrows = radius(at)[:, None] * ray_directions(at), length * ray_directions(at)
    axes.quiver(
        *points.T, *arrows.T, angles="xy", scale_units="xy", scale=1.0, width=0.005, color=color,
        zorder=4,
    )  # fmt: skip
    for i, (x, y) in enumerate(points + 1.75 * arrows):
        axes.text(x, y, f"$u_{{{first + i}}}$", ha="center", va="center", fontsize=8.5)


def _newton(path: Path, result: SealResult) -> None:
    """Iterations of all steps, and residuals of some."""
    travel, steps = result.travel, result.path.nominal_steps
    with picture(path, 1, 2, width=9.6, height=3.5) as (left, right):
        left.bar(travel, result.newton_iterations, width=0.09, color=BLUE)
        left.set(xlabel="door travel from first contact (mm)", ylabel="Newton iterations")
        iterations = result.newton_iterations.sum()
        left.set_title(f"{iterations} iterations, {result.step_cuts} cut steps", fontsize=10)
        shown = np.linspace(8, len(steps) - 1, 5).astype(int)
        for number, color in zip(shown, CYCLE, strict=False):
            residuals = np.array(steps[number].residuals)
            right.semilogy(residuals, "o-", color=color, label=f"{travel[number]:.1f} mm")
        right.xaxis.set_major_locator(MaxNLocator(integer=True))
        right.axhline(result.seal.newton.tolerance, color=GREY, linestyle="--", linewidth=1.0)
        right.set(xlabel="iteration", ylabel="relative residual")
        right.legend(title="door travel", title_fontsize=9)

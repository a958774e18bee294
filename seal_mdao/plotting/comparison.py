"""Initial and optimised design side by side (Figure 7)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seal_mdao.plotting import field, section
from seal_mdao.plotting.style import BLUE, GREY, scientific, styled, subplots
from seal_mdao.seals.door.result import DoorSealResult


@styled
def design_comparison(initial: DoorSealResult, optimised: DoorSealResult) -> Figure:
    """Undeformed sections on top of each other, and both deformed ones in one colour scale.

    Parameters
    ----------
    initial, optimised : DoorSealResult
        Completed analyses of two designs of one model.

    Returns
    -------
    Figure
    """
    results = initial, optimised
    fines = [field.fine_grid(result) for result in results]
    shapes = [field.deformed(r, fine) for r, fine in zip(results, fines, strict=True)]
    drawn = [field.undeformed(r, fine) for r, fine in zip(results, fines, strict=True)]
    highest = max(field.von_mises(r, f).max() for r, f in zip(results, fines, strict=True))
    levels = section.stress_levels(highest)
    low, high = section.window(shapes + drawn, initial.seal.section.outer_radius + 2.0)
    width, height = high - low
    panel = 4.1
    figure, axes = subplots(
        1, 3, width=3 * panel + 1.2, height=panel * height / width + 0.75, sharey=True
    )
    _draw_shapes(axes[0], initial, optimised, drawn)
    section.frame(axes[0], low, high)
    axes[0].set_title("undeformed shape and door")
    for axis, result, fine, name in zip(
        axes[1:], results, fines, ("initial", "optimised"), strict=True
    ):
        contours = section.draw_stress(axis, result, fine, -1, levels)
        section.frame(axis, low, high)
        axis.set_title(f"{name}: {_numbers(result)}")
        axis.set_ylabel("")
    axes[1].legend(loc="lower left", bbox_to_anchor=(0.0, 0.6), title="points of the boundary")
    bar = figure.colorbar(contours, ax=axes, shrink=0.85, aspect=28, pad=0.01)
    bar.set_label("von Mises stress (kPa)")
    return figure


def _numbers(result: DoorSealResult) -> str:
    cost, force = scientific(result.gap_square_sum), result.reaction[-1, 1]
    return f"$\\Sigma g_n^2$ = {cost} mm², {force:.1f} N/m"


def _draw_shapes(axes: Axes, initial: DoorSealResult, optimised: DoorSealResult, drawn) -> None:
    section.draw_base(axes, initial)
    ring = np.vstack([drawn[1], drawn[1][:1]])
    axes.fill(*np.vstack([ring[:, -1], ring[::-1, 0]]).T, color=BLUE, alpha=0.12, lw=0)
    section.draw_outline(axes, drawn[0], color=GREY, linestyle="--", linewidth=1.2, label="initial")
    section.draw_outline(axes, drawn[1], color=BLUE, linewidth=1.6, label="optimised")
    for result, color, style in ((initial, GREY, "--"), (optimised, BLUE, "-")):
        x, y = section.door_outline(result, (0.0, result.seal.start)).T
        radius = f"door radius {result.door_radius:.2f} mm"
        axes.plot(x[:-2], y[:-2], color=color, linestyle=style, linewidth=1.2, label=radius)
    axes.legend(loc="center")

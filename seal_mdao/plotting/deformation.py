"""Deformed shapes with stress at several depths of the door (Figure 4)."""

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.plotting import field, section
from seal_mdao.plotting.style import styled, subplots
from seal_mdao.seals.door.result import DoorSealResult


def steps_at(result: DoorSealResult, depths) -> list[int]:
    """Nominal steps whose door travel is nearest to ``depths`` (mm), each once, in order."""
    travel = result.door_travel
    return sorted({int(np.argmin(np.abs(travel - depth))) for depth in depths})


def spread_depths(result: DoorSealResult, count: int = 4) -> np.ndarray:
    """``count`` depths that share out the travel reached, the last one included, mm."""
    return result.door_travel[-1] * np.arange(1, count + 1) / count


@styled
def deformed_shapes(result: DoorSealResult, depths=None) -> Figure:
    """Deformed shapes with von Mises contours in one colour scale, and the rigid door.

    Parameters
    ----------
    result : DoorSealResult
        Complete, or up to the step at which the path ended.
    depths : sequence of float, optional
        Door travel from the first touch of the drawn seal, mm; four equal parts when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        For a result without any converged step.
    """
    if len(result.path.nominal_steps) == 0:
        raise ValueError("the result has no converged load step to draw")
    steps = steps_at(result, spread_depths(result) if depths is None else depths)
    fine = field.fine_grid(result)
    shapes = [field.deformed(result, fine, step) for step in steps]
    levels = section.stress_levels(max(field.von_mises(result, fine, s).max() for s in steps))
    columns = min(len(steps), 2)
    rows = -(-len(steps) // columns)
    low, high = section.window(shapes, result.seal.section.outer_radius + 1.0)
    width, height = high - low
    panel = 4.4
    figure, axes = subplots(
        rows, columns, width=panel * columns + 1.1, height=rows * (panel * height / width + 0.45),
        squeeze=False, sharex=True, sharey=True,
    )  # fmt: skip
    for axis, step in zip(axes.flat, steps, strict=False):
        contours = section.draw_stress(axis, result, fine, step, levels)
        section.frame(axis, low, high)
        axis.set_title(f"door travel {result.door_travel[step]:.1f} mm")
        axis.label_outer()
    for axis in axes.flat[len(steps) :]:
        axis.set_visible(False)
    axes.flat[0].legend(loc="center", title="points of the outer boundary", title_fontsize=9.0)
    bar = figure.colorbar(contours, ax=axes, shrink=0.7, aspect=30, pad=0.02)
    bar.set_label("von Mises stress (kPa)")
    return figure

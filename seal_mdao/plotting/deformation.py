"""Deformed shapes with stress along the path (Figure 4)."""

from matplotlib.figure import Figure

from seal_mdao.plotting import field, section
from seal_mdao.plotting.style import styled, subplots
from seal_mdao.seals.result import SealResult

AREA = 16.0
"""Area of the panel of one shape, square inches; its aspect ratio is that of the section."""


@styled
def deformed_shapes(result: SealResult, steps=None) -> Figure:
    """Plot deformed shapes with von Mises contours in one colour scale, and the rigid profiles.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.
    steps : sequence of int, optional
        Nominal steps, from 0; ``result.key_steps()`` when left out.

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
    steps = result.key_steps() if steps is None else steps
    # shape functions on the fine grid are evaluated once for all steps (Lagrangian)
    fine = field.fine_grid(result)
    shapes = [field.deformed(result, fine, step) for step in steps]
    scale = section.stress_scale(field.von_mises(result, fine, step) for step in steps)
    low, high = section.window([field.undeformed(result, fine), *shapes])
    width, height = panel_size(low, high)
    columns = min(len(steps), 2 if width > 3.0 else 3)
    # rounded up
    rows = -(-len(steps) // columns)
    figure, axes = subplots(
        rows, columns, width=max(width * columns + 1.3, 5.0), height=rows * (height + 0.45) + 0.4,
        squeeze=False, sharex=True, sharey=True,
    )  # fmt: skip
    for axis, step in zip(axes.flat, steps, strict=False):
        contours = section.draw_stress(axis, result, fine, step, scale)
        section.frame(axis, low, high)
        axis.set_title(result.caption(step))
        axis.label_outer()
    for axis in axes.flat[len(steps) :]:
        axis.set_visible(False)
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, title_fontsize=9.0)
    bar = figure.colorbar(contours, ax=axes, shrink=0.7, aspect=30, pad=0.02)
    bar.set_label("von Mises stress (kPa)")
    return figure


def panel_size(low, high) -> tuple[float, float]:
    """Compute width and height of the panel of a window, inches."""
    width, height = high - low
    # equal area for all aspect ratios, at most 6 by 5 inches
    scale = (AREA / (width * height)) ** 0.5
    scale = min(scale, 6.0 / width, 5.0 / height)
    return scale * width, scale * height

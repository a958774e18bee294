"""Figures of reactions against travel: compression-load-deflection curves."""

import numpy as np
from matplotlib.figure import Figure

from seal_mdao.plotting.courses import course_panels, with_start
from seal_mdao.plotting.style import BLUE, VERMILION, signed, styled
from seal_mdao.seals.profiles import profile_histories
from seal_mdao.seals.result import SealResult

UNIT_SEAL = 0.1
"""Reference length of seal for forces in N per 100 mm, m."""
COMPONENTS = ((1, "vertical", BLUE, "-"), (0, "horizontal", VERMILION, "--"))


@styled
def load_deflection(result: SealResult) -> Figure:
    """Plot compression-load-deflection curves: force on every profile against its travel.

    Loading and unloading along one line share a panel.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.

    Returns
    -------
    Figure
        N/m on the left axis, N per 100 mm of seal on the right one; a row for every profile.

    Raises
    ------
    ValueError
        For a result without profiles or without any converged step.
    """
    figure, panels = course_panels(result, "force on {} (N/m)")
    for history, course, axes, last in panels:
        along, force = with_start(course, history.force)
        draw_forces(axes, along, force)
        # path parameters at the start and the step ends of the segment; critical points within it
        ends = np.arange(course.steps.start, course.steps.stop + 1)
        inside = [point.fraction for point in result.critical_points]
        inside = [fraction for fraction in inside if ends[0] < fraction <= ends[-1]]
        mark_critical(axes, inside, ends, along, force)
        if last:
            unit_seal_axis(axes)
    panels[0][2].legend(loc="best", title="component")
    return figure


def draw_forces(axes, travel: np.ndarray, force: np.ndarray) -> None:
    """Plot both components of a force (n, 2) against travel (n,), final values annotated."""
    axes.axhline(0.0, color="black", linewidth=0.8)
    for component, name, color, style in COMPONENTS:
        axes.plot(travel, force[:, component], color=color, linestyle=style, label=name)
        if len(travel):
            _mark_end(axes, travel[-1], force[-1, component], color)


def mark_critical(axes, fractions, ends, travel: np.ndarray, force: np.ndarray) -> None:
    """Mark loss of stability at path parameters ``fractions``, between the ``ends`` (n,) of steps."""
    if not len(fractions) or not len(travel):
        return
    # the force before a jump, that of the step end before the critical point
    before = np.clip(np.searchsorted(ends, fractions) - 1, 0, len(ends) - 1)
    axes.plot(
        np.interp(fractions, ends, travel), force[before, 1], linestyle="none", marker="D",
        markerfacecolor="white", markeredgecolor="black", markersize=5.0, zorder=5,
        label="stability lost",
    )  # fmt: skip


def unit_seal_axis(axes) -> None:
    """Add an axis in N per 100 mm of seal on the right."""
    right = axes.secondary_yaxis(
        "right", functions=(lambda f: f * UNIT_SEAL, lambda f: f / UNIT_SEAL)
    )
    right.set_ylabel("N per 100 mm of seal")


def _mark_end(axes, x: float, y: float, color) -> None:
    axes.plot(x, y, "o", color=color)
    align = "center" if y > 0.0 else "top"  # keep off the zero line
    axes.annotate(
        signed(y), (x, y), xytext=(6, 0), textcoords="offset points", va=align, color=color
    )


def travel_table(result: SealResult) -> np.ndarray:
    """Travel of the leading profile (mm) and both components of the force on it (N/m) of every step,
    shape (n_steps, 3)."""
    return np.column_stack([np.round(result.travel, 12), result.reaction])


def reaction_tables(result: SealResult) -> dict[str, list]:
    """Tabulate stage (from 1), travel in it (mm), Fx, Fy (N/m) of every step for every profile."""
    return {
        history.label: [
            [int(stage), round(float(travel), 12), *map(float, force)]
            for stage, travel, force in zip(
                history.stage, history.travel, history.force, strict=True
            )
        ]
        for history in profile_histories(result)
    }

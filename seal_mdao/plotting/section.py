"""Drawing of one section: stressed body, outline, rigid door, fixed base."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.ticker import MultipleLocator

from seal_mdao.contact.friction import OPEN
from seal_mdao.geometry.profile import trace
from seal_mdao.measures.selection import opened_points
from seal_mdao.plotting import field
from seal_mdao.plotting.style import GREY, LIGHT_GREY, ORANGE, STRESS_MAP
from seal_mdao.seals.door.result import DoorSealResult

REACH = 40.0
LEVELS = 20


def stress_levels(highest: float) -> np.ndarray:
    """Contour levels of a scale shared by several pictures, from 0 to ``highest`` or above, kPa."""
    raw = max(highest, 1e-9) / LEVELS
    decade = 10.0 ** np.floor(np.log10(raw))
    step = decade * next(m for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * decade >= raw)
    return step * np.arange(int(np.ceil(highest / step)) + 1)


def door_outline(result: DoorSealResult, position) -> np.ndarray:
    """Closed polygon of the rigid door moved to ``position``, shape (n, 2), mm."""
    face = trace(result.seal.profile, 0.05, REACH)
    lid = [[face[-1, 0], REACH], [face[0, 0], REACH]]
    return np.vstack([face, lid]) + np.asarray(position)


def door_position(result: DoorSealResult, step: int) -> np.ndarray:
    """Where the door is after a nominal step, shape (2,), mm."""
    return result.seal.motion.pose(result.path.nominal_steps[step].fraction).position


def draw_door(axes: Axes, result: DoorSealResult, position) -> None:
    """The rigid door as a hatched body."""
    x, y = door_outline(result, position).T
    axes.fill(x, y, facecolor=LIGHT_GREY, edgecolor=GREY, hatch="////", linewidth=0.0, zorder=1)
    axes.plot(x[:-2], y[:-2], color="black", linewidth=1.4, zorder=4)


def draw_base(axes: Axes, result: DoorSealResult) -> None:
    """The rigid base to which the seal is fixed, hatched."""
    base = result.seal.drawn_particles[result.seal.grid.base]
    left, right, y = base[:, 0].min() - 1.0, base[:, 0].max() + 1.0, base[:, 1].min()
    axes.fill(
        [left, right, right, left], [y, y, y - 0.8, y - 0.8],
        facecolor="white", edgecolor=GREY, hatch="\\\\\\\\", linewidth=0.0, zorder=1,
    )  # fmt: skip
    axes.plot([left, right], [y, y], color="black", linewidth=1.0, zorder=2)


def draw_outline(axes: Axes, coordinates: np.ndarray, **line) -> None:
    """Inner and outer boundary of the fine grid (around, across, 2)."""
    label = line.pop("label", None)
    for across in (0, -1):
        x, y = np.vstack([coordinates[:, across], coordinates[:1, across]]).T
        axes.plot(x, y, label=label if across else None, **line)


def draw_stress(axes: Axes, result: DoorSealResult, fine: field.FineGrid, step: int, levels):
    """Deformed body with filled von Mises contours, and the door above it.

    Returns
    -------
    contours : ContourSet
        For the colour bar.
    """
    coordinates = field.deformed(result, fine, step)
    stress = np.clip(field.von_mises(result, fine, step), levels[0], levels[-1])
    contours = axes.tricontourf(
        field.triangulation(coordinates, fine), stress, levels=levels, cmap=STRESS_MAP,
        norm=Normalize(levels[0], levels[-1]), zorder=2,
    )  # fmt: skip
    draw_outline(axes, coordinates, color="black", linewidth=0.8, zorder=3)
    draw_base(axes, result)
    draw_door(axes, result, door_position(result, step))
    draw_contact(axes, result, step)
    return contours


def draw_contact(axes: Axes, result: DoorSealResult, step: int) -> None:
    """Contact points that touch the door, and those that stand open between them."""
    contact = result.response("door", result.path.nominal_steps[step])
    touching = np.flatnonzero(contact.state != OPEN)
    for which, fill, label in (
        (touching, ORANGE, "in contact"),
        (opened_points(contact.state), "white", "open between contacts"),
    ):
        axes.plot(
            *contact.x[which].T, linestyle="none", marker="o", markersize=4.2, zorder=5,
            markerfacecolor=fill, markeredgecolor="black", markeredgewidth=0.7, label=label,
        )  # fmt: skip


def frame(axes: Axes, low, high) -> None:
    """Equal aspect, fixed window, units."""
    axes.set_aspect("equal")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.grid(False)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MultipleLocator(5.0))
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")


def window(shapes, top: float, margin: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corner that hold all ``shapes`` (n, 2) and reach up to ``top``."""
    points = np.vstack([np.reshape(shape, (-1, 2)) for shape in shapes])
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    return low, np.array([high[0], max(high[1], top)])

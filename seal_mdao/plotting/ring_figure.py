"""View of a deformed ring in space, cut open: stress on the cuts, the surface shaded."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.field import FineGrid, fine_grid
from seal_mdao.plotting.style import mark_failure, styled, subplots
from seal_mdao.seals.result import SealResult

SWEEP = 1.5 * np.pi
"""Angle of the ring that is shown, radians."""
LONGEST = 30.0
"""Largest length of the arc that is shown, over the size of the section: of wide rings less is shown."""
FACET = np.deg2rad(3.0)
"""Angle of one piece of the surface, radians."""
ELEVATION, AZIMUTH = np.deg2rad(30.0), np.deg2rad(-62.0)
"""Angles of the direction to the viewer."""
OPENING = AZIMUTH + np.deg2rad(12.0)
"""Angle of the middle of the opening: one cut is seen more from the front than the other."""
RUBBER = np.array(to_rgb("#A3ABB3"))
"""Colour of the surface in full light."""
AXIS = 0.12
"""Length of the axis above the ring, over the width of the picture."""
DARK, SHINE = 0.3, 0.25
"""Brightness of the surface without light, and of the reflected light."""


@styled
def ring_view(result: SealResult, step: int = -1) -> Figure:
    """Plot three quarters of a deformed ring in space, with the von Mises stress on its cuts.

    Of a ring that is wide beside its section a shorter arc is shown.

    Parameters
    ----------
    result : SealResult
        Of a body of revolution; complete, or up to the step at which the path ended.
    step : int
        Nominal step.

    Raises
    ------
    ValueError
        For a seal in plane strain, or a result without any converged step.
    """
    if not result.seal.body.axisymmetric:
        raise ValueError(
            'the three-dimensional figure needs a body of revolution, kinematics = "axisymmetric" '
            "in [model]"
        )
    steps = len(result.path.nominal_steps)
    if steps == 0:
        raise ValueError(
            "the result has no converged load step to draw; result.failure gives the cause"
        )
    step, fine = range(steps)[step], fine_grid(result)
    x, scales = fine.deformed(step), section.stress_scales([fine], (step,))
    sweep = min(SWEEP, LONGEST * section.size_of(result) / x[:, 0].max())
    ends = OPENING + np.pi + 0.5 * sweep * np.array([-1.0, 1.0])
    parts = [_surface(x, fine.loops, ends), *_cuts(fine, x, step, scales, ends)]
    corners, colors = (np.concatenate(own) for own in zip(*parts, strict=True))
    # pieces near to the viewer are drawn last
    order = np.argsort(corners.mean(axis=1) @ VIEWER, kind="stable")
    seen, colors = _seen(corners[order]), colors[order]
    low, high = seen.min(axis=(0, 1)), seen.max(axis=(0, 1))
    if sweep == SWEEP:
        # the axis above the ring, where nothing hides it
        top = x[:, 1].max()
        axis = _seen(np.array([[0.0, 0.0, top], [0.0, 0.0, top + AXIS * (high[0] - low[0])]]))
        high = np.maximum(high, axis[1])
    low, high = low - 0.01 * (high - low), high + 0.01 * (high - low)
    width, height = high - low
    figure, axes = subplots(width=7.6, height=0.9 + 6.0 * height / width)
    # lines in the colours of the pieces close the seams between them
    axes.add_collection(PolyCollection(seen, facecolors=colors, edgecolors=colors, linewidths=0.6))
    for end in ends:
        for loop in fine.loops:
            outline = _seen(_turned(x[np.append(loop, loop[0])], end))
            axes.plot(*outline.T, color="black", linewidth=0.7)
    if sweep == SWEEP:
        axes.plot(*axis.T, color="black", linewidth=0.8, linestyle="-.")
    axes.set(aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.set_axis_off()
    axes.set_title(f"{np.rad2deg(sweep):.0f}° of the ring, {result.caption(step)}")
    mark_failure(figure, result)
    shown = [ScalarMappable(own["norm"], own["cmap"]) for own in scales]
    section.draw_colorbars(figure, axes, shown, fine, shrink=0.8, aspect=25, pad=0.02)
    return figure


def _direction(azimuth: float, elevation: float) -> np.ndarray:
    """Unit vector with angles in the plane of the ring and above it, radians."""
    across = np.cos(elevation)
    return np.array([across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation)])


VIEWER, LIGHT = _direction(AZIMUTH, ELEVATION), _direction(AZIMUTH + 0.6, ELEVATION + 0.5)


def _seen(points: np.ndarray) -> np.ndarray:
    """Project points (..., 3) on the plane across the direction to the viewer, shape (..., 2)."""
    right = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
    return points @ np.column_stack([right, np.cross(VIEWER, right)])


def _turned(section_points: np.ndarray, angles) -> np.ndarray:
    """Coordinates (..., 3) of points (..., 2) of the section turned by angles (...) about the axis."""
    r, y = section_points[..., 0], section_points[..., 1]
    return np.stack(np.broadcast_arrays(r * np.cos(angles), r * np.sin(angles), y), axis=-1)


def _surface(x: np.ndarray, loops, ends) -> tuple[np.ndarray, np.ndarray]:
    """Corners (k, 4, 3) and colours (k, 3) of the pieces of the surface that face the viewer."""
    first = np.concatenate(loops)
    second = np.concatenate([np.roll(loop, -1) for loop in loops])
    # no surface along the axis
    off = (x[first, 0] > 0.0) | (x[second, 0] > 0.0)
    a, b = x[first[off]], x[second[off]]
    angles = np.linspace(*ends, 1 + round(np.ptp(ends) / FACET))
    low, high = angles[:-1, None], angles[1:, None]
    corners = np.stack([_turned(a, low), _turned(b, low), _turned(b, high), _turned(a, high)], 2)
    # the body is on the left of t = b - a: outward normal n = (t_y, -t_r), turned to the middle
    normal = (b - a)[:, ::-1] * [1.0, -1.0] / np.linalg.norm(b - a, axis=1, keepdims=True)
    normal = _turned(normal, 0.5 * (low + high))
    seen = normal @ VIEWER > 0.0
    # Blinn-Phong: dark + (1 - dark) n . l  and, reflected, (n . h)^16 with h between light and viewer
    between = (LIGHT + VIEWER) / np.linalg.norm(LIGHT + VIEWER)
    bright = DARK + (1.0 - DARK) * np.maximum(normal[seen] @ LIGHT, 0.0)
    shine = SHINE * np.maximum(normal[seen] @ between, 0.0) ** 16
    return corners[seen], np.minimum(bright[:, None] * RUBBER + shine[:, None], 1.0)


def _cuts(fine: FineGrid, x: np.ndarray, step: int, scales, ends):
    """Corners and colours, as of ``_surface``, of the section at both ends."""
    stress = np.maximum(fine.von_mises(step), 0.0)
    # one scale for every material
    colors = np.empty((len(fine.quads), 3))
    for number, scale in enumerate(scales):
        own = fine.region[fine.quads[:, 0]] == number
        mean = stress[fine.quads[own]].mean(axis=1)
        colors[own] = ScalarMappable(scale["norm"], scale["cmap"]).to_rgba(mean)[:, :3]
    for end in ends:
        yield _turned(x[fine.quads], end), colors

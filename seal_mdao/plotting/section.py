"""Plotting of one section: stress contours, outline, rigid profiles, fixed boundaries."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator
from shapely import MultiPolygon, Polygon, area, polygons, union_all

from seal_mdao.contact.friction import OPEN
from seal_mdao.geometry.curve import LINE, curve_point
from seal_mdao.geometry.profile import RigidProfile, trace
from seal_mdao.measures.selection import opened_points
from seal_mdao.plotting import field
from seal_mdao.plotting.style import GREY, LIGHT_GREY, ORANGE, STRESS_MAP
from seal_mdao.seals.profiles import contacts, self_contacts
from seal_mdao.seals.result import SealResult

LEVELS = 20
USUAL, PEAK = 0.99, 2.0
"""Quantile of the stresses, and the multiple of it at which the colour scale ends at most."""
FAR = 10.0
"""Length by which open profiles are extended beyond their ends, over the size of the section."""
DEPTH, HELD_DEPTH = 0.16, 0.04
"""Depth of the hatched sides of profiles and of fixed boundaries, over the size of the section."""
SMOOTH = 0.004
"""Distance of points along curved profiles, over the size of the section."""


def stress_levels(highest: float) -> np.ndarray:
    """Choose contour levels from 0 to ``highest`` or above for several panels, kPa."""
    highest = max(highest, 1e-9)
    raw = highest / LEVELS
    # the next larger of 1, 2, 2.5, 5, 10 times a power of ten
    decade = 10.0 ** np.floor(np.log10(raw))
    step = decade * next(m for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * decade >= raw)
    return step * np.arange(int(np.ceil(highest / step)) + 1)


class Scale(NamedTuple):
    """Stress scale shared by several panels.

    Attributes
    ----------
    levels : ndarray
        kPa.
    extend : str
        Option of ``tricontourf``: "max" if single points, as at corners, exceed the levels.
    """

    levels: np.ndarray
    extend: str


def stress_scale(stresses) -> Scale:
    """Choose the scale for panels with stresses (k,) each, kPa."""
    stresses = list(stresses)
    highest = max(stress.max() for stress in stresses)
    # single peaks at corners must not stretch the colour scale
    usual = PEAK * max(np.quantile(stress, USUAL) for stress in stresses)
    levels = stress_levels(min(highest, usual))
    return Scale(levels, "max" if highest > levels[-1] else "neither")


def size_of(result: SealResult) -> float:
    """Compute the larger side of the bounding box of the nominal section, mm."""
    return float(np.ptp(result.seal.drawn_particles, axis=0).max())


def profile_face(result: SealResult, contact, fraction: float) -> np.ndarray:
    """Points along a profile after ``fraction`` nominal steps, shape (n, 2), mm."""
    face = face_of(contact.shape.profile(), size_of(result))
    return contact.motion.pose(fraction).places(face)


def face_of(profile: RigidProfile, size: float) -> np.ndarray:
    """Points along a profile in its own frame beside a section of a ``size`` (mm), shape (n, 2), mm.

    A closed one ends at its first point; an open one is extended where it ends in lines.
    """
    far = FAR * size
    # bound of the extent of the profile in its own coordinates
    around = float(
        np.abs(profile.origin).max() + profile.length.max() + np.abs(profile.radius).max()
    )
    face = trace(profile, SMOOTH * size, 2.0 * (around + far))
    # open profile: points on end lines at natural coordinates beyond their ends by ``far``
    if profile.period == 0.0:
        ends = (0, profile.start[0] - far), (-1, profile.start[-1] + profile.length[-1] + far)
        first, last = (
            [curve_point(profile, piece % len(profile.kind), xi)[0]]
            if profile.kind[piece] == LINE
            else np.empty((0, 2))
            for piece, xi in ends
        )
        face = np.vstack([first, face, last])
    return face


def profile_body(result: SealResult, contact, fraction: float):
    """The rigid side of a profile as far as it is drawn: a shapely polygon, or several."""
    face = profile_face(result, contact, fraction)
    return rigid_side(contact.shape.profile(), face, size_of(result))


def rigid_side(profile: RigidProfile, face: np.ndarray, size: float):
    """The rigid side of a profile with the points ``face`` (n, 2), in any frame, as ``profile_body``."""
    depth = DEPTH * size
    if profile.period == 0.0:
        return left_of(face, depth)
    # closed: counter-clockwise is a solid body, clockwise a hole in a rigid body around it
    inside = Polygon(face)
    if inside.exterior.is_ccw:
        return inside
    return inside.buffer(depth) - inside


def left_of(line: np.ndarray, depth: float):
    """Build the region on the left of a line (k, 2) up to ``depth``.

    One rectangle for each segment, and a triangle where the line turns to the right.
    """
    # drop segments of rounding length, which have no direction
    line = line[np.append(True, np.hypot(*np.diff(line, axis=0).T) > 1e-6 * depth)]
    along = np.diff(line, axis=0)
    # depth times the left normals n = (-t_y, t_x) of the segments
    beside = depth * np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
    a, b = line[:-1], line[1:]
    pieces = polygons(np.stack([a, b, b + beside, a + beside], axis=1))
    corner = line[1:-1]
    # triangles fill the gaps between adjacent rectangles at right turns; at left turns they overlap
    wedges = polygons(np.stack([corner, corner + beside[1:], corner + beside[:-1]], axis=1))
    return union_all([*pieces, *wedges[area(wedges) > 1e-9 * depth**2]])


def draw_profiles(axes: Axes, result: SealResult, fraction: float) -> None:
    """Plot all rigid profiles after ``fraction`` nominal steps as hatched bodies."""
    for contact in contacts(result.seal):
        _hatch(axes, profile_body(result, contact, fraction), LIGHT_GREY, "////")
        face = profile_face(result, contact, fraction)
        axes.plot(*face.T, color="black", linewidth=1.4, zorder=4)


def outlines(body) -> list[np.ndarray]:
    """Closed lines (k, 2) around a shapely polygon, or several, and around their holes."""
    parts = body.geoms if isinstance(body, MultiPolygon) else [body]
    return [np.asarray(ring.coords) for part in parts for ring in (part.exterior, *part.interiors)]


def _hatch(axes, body, face, hatch) -> None:
    rings = [Path(ring, closed=True) for ring in outlines(body)]
    patch = PathPatch(
        Path.make_compound_path(*rings), facecolor=face, edgecolor=GREY, hatch=hatch, linewidth=0.0,
        zorder=1,
    )  # fmt: skip
    axes.add_patch(patch)


def held_lines(result: SealResult) -> list[np.ndarray]:
    """List the fixed lines of the nominal boundary, the body on the left, shapes (k, 2), mm."""
    body, found = result.seal.body, []
    fixed = body.fixed.all(axis=1)
    for loop in field.boundary_loops(body.cells, body.cells[:, [[0, 3], [1, 2]]]):
        free = np.flatnonzero(~fixed[loop])
        # start at a free particle, so that no fixed line crosses the end of the list
        ring = np.append(loop, loop[0]) if free.size == 0 else np.roll(loop, -free[0])
        runs = np.split(ring, np.flatnonzero(np.diff(fixed[ring])) + 1)
        found += [result.seal.drawn_particles[r] for r in runs if fixed[r[0]] and r.size > 1]
    return found


def draw_held(axes: Axes, result: SealResult) -> None:
    """Plot the fixed boundary of the section with hatched ground."""
    depth = HELD_DEPTH * size_of(result)
    for line in held_lines(result):
        _hatch(axes, left_of(line[::-1], depth), "white", "\\\\\\\\")
        axes.plot(*line.T, color="black", linewidth=1.6, zorder=3)


def draw_outline(axes: Axes, coordinates: np.ndarray, loops, **line) -> None:
    """Plot boundary loops of the points ``coordinates`` (k, 2)."""
    label = line.pop("label", None)
    for number, loop in enumerate(loops):
        x, y = coordinates[np.append(loop, loop[0])].T
        axes.plot(x, y, label=None if number else label, **line)


def fill_outline(axes: Axes, coordinates: np.ndarray, loops, **patch) -> None:
    """Fill the section between boundary loops of the points ``coordinates`` (k, 2)."""
    rings = [Path(coordinates[np.append(loop, loop[0])], closed=True) for loop in loops]
    axes.add_patch(PathPatch(Path.make_compound_path(*rings), **patch))


def draw_stress(axes: Axes, result: SealResult, fine: field.FineGrid, step: int, scale: Scale):
    """Plot the deformed body with filled von Mises contours, and the profiles around it.

    Returns
    -------
    contours : ContourSet
        For the colour bar.
    """
    coordinates = field.deformed(result, fine, step)
    stress, levels = field.von_mises(result, fine, step), scale.levels
    contours = axes.tricontourf(
        field.triangulation(coordinates, fine), np.maximum(stress, 0.0), levels=levels,
        cmap=STRESS_MAP, norm=Normalize(levels[0], levels[-1]), extend=scale.extend, zorder=2,
    )  # fmt: skip
    draw_outline(axes, coordinates, fine.loops, color="black", linewidth=0.8, zorder=3)
    draw_held(axes, result)
    draw_profiles(axes, result, result.path.nominal_steps[step].fraction)
    draw_contact(axes, result, step)
    return contours


def draw_contact(axes: Axes, result: SealResult, step: int) -> None:
    """Plot points in contact with a profile or another wall, and open points between contacts."""

    def responses(terms):
        return [result.path.at_nominal(term.label)[step] for term in terms]

    rigid, folded = responses(contacts(result.seal)), responses(self_contacts(result.seal))
    touching = [own.x[own.branch != OPEN] for own in (*rigid, *folded)]
    opened = [own.x[opened_points(own.branch)] for own in rigid]
    for fill, label, points in (
        (ORANGE, "in contact", touching), ("white", "open between contacts", opened),
    ):  # fmt: skip
        axes.plot(
            *np.concatenate([np.empty((0, 2)), *points]).T, linestyle="none", marker="o",
            markersize=4.2, zorder=5, markerfacecolor=fill, markeredgecolor="black",
            markeredgewidth=0.7, label=label,
        )  # fmt: skip


def frame(axes: Axes, low, high) -> None:
    """Set equal aspect, window and axis labels."""
    axes.set_aspect("equal")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.grid(False)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")


def window(shapes, margin: float = 0.08) -> tuple[np.ndarray, np.ndarray]:
    """Compute lower left and upper right corner around all ``shapes`` (n, 2).

    With a margin as a fraction of the larger side.
    """
    points = np.vstack([np.reshape(shape, (-1, 2)) for shape in shapes])
    border = margin * np.ptp(points, axis=0).max()
    return points.min(axis=0) - border, points.max(axis=0) + border

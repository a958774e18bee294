"""Plotting of one section: stress contours, outline, rigid profiles, fixed boundaries."""

import itertools
from copy import copy

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D
from matplotlib.tri import Triangulation
from shapely import MultiPolygon, Polygon, area, polygons, union_all

from seal_mdao.contact.friction import OPEN
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.curve import LINE, curve_point
from seal_mdao.geometry.profile import RigidProfile, trace
from seal_mdao.plotting.field import FineGrid, cell_loops
from seal_mdao.plotting.style import GREY, LIGHT_GREY, ORANGE, STRESS_MAP, STRESS_MAPS
from seal_mdao.seals.gaps import open_between
from seal_mdao.seals.profiles import contacts, moved_edges, self_contacts
from seal_mdao.seals.result import SealResult

STRESS = "von Mises stress (kPa)"
LEVELS = 20
USUAL, PEAK = 0.99, 1.25
"""Quantile of the stresses, and the multiple of it at which the colour scale ends at most."""
FAR = 10.0
"""Length by which open profiles are extended beyond their ends, over the size of the section."""
DEPTH, FIXED_DEPTH = 0.16, 0.04
"""Depth of the hatched sides of profiles and of fixed boundaries, over the size of the section."""
SMOOTH = 0.004
"""Distance of points along curved profiles, over the size of the section."""
HATCHED = {"edgecolor": GREY, "linewidth": 0.0, "zorder": 1}
NARROW = 1.0
"""Inner radius of a ring over the size of its section, up to which pictures show both halves: the
section keeps a quarter of their width."""
VEIL = 0.55
"""Opacity of the white over the mirror image."""
BAR_WIDTH = 1.3
"""Width of a colour bar with its label, inches."""
PANEL_AREA = 16.0
"""Area of the panel of one shape, square inches; its aspect ratio is that of the section."""


def stress_levels(highest: float) -> np.ndarray:
    """Choose contour levels from 0 to ``highest`` or above for several panels, kPa."""
    highest = max(highest, 1e-9)
    raw = highest / LEVELS
    # the next larger of 1, 2, 2.5, 5, 10 times a power of ten
    decade = 10.0 ** np.floor(np.log10(raw))
    step = decade * next(m for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * decade >= raw)
    return step * np.arange(int(np.ceil(highest / step)) + 1)


def stress_scale(stresses, colors: str = STRESS_MAP) -> dict:
    """Choose the colour scale for panels with stresses (k,) each, kPa, as options of ``tricontourf``."""
    stresses = list(stresses)
    highest = max(stress.max() for stress in stresses)
    # single peaks at corners must not stretch the colour scale
    usual = PEAK * max(np.quantile(stress, USUAL) for stress in stresses)
    levels = stress_levels(min(highest, usual))
    extend = "max" if highest > levels[-1] else "neither"
    norm = Normalize(levels[0], levels[-1])
    return {"levels": levels, "norm": norm, "extend": extend, "cmap": colors}


def stress_scales(fines, steps=(-1,)) -> list[dict]:
    """Choose a colour scale for every material of one or more designs of a seal after some steps.

    Between a soft and a hard rubber one scale would leave the soft one in its darkest colour.
    """
    shown = [(fine.region, fine.von_mises(step)) for fine in fines for step in steps]
    count = 1 + max(int(region.max()) for region, _ in shown)
    return [
        stress_scale([stress[region == n] for region, stress in shown], colors)
        for n, colors in zip(range(count), itertools.cycle(STRESS_MAPS))
    ]


def size_of(result: SealResult) -> float:
    """Compute the larger side of the bounding box of the nominal section, mm."""
    return float(np.ptp(result.seal.nominal_particles, axis=0).max())


def profile_face(result: SealResult, contact, fraction: float) -> np.ndarray:
    """Compute points along a profile after ``fraction`` nominal steps, shape (n, 2), mm."""
    face = face_of(contact.shape.profile(), size_of(result))
    return contact.motion.pose(fraction).places(face)


def face_of(profile: RigidProfile, size: float) -> np.ndarray:
    """Compute points along a profile in its own frame beside a section of a ``size`` (mm), shape
    (n, 2), mm.

    A closed one ends at its first point; an open one is extended where it ends in lines.
    """
    far = FAR * size
    # bound of the extent of the profile in its own coordinates
    around = np.abs(profile.origin).max() + profile.length.max() + np.abs(profile.radius).max()
    face = trace(profile, SMOOTH * size, 2.0 * (float(around) + far))
    if profile.period == 0.0:
        # open profile: points on end lines at natural coordinates beyond their ends by ``far``
        first, last = 0, len(profile.kind) - 1
        if profile.kind[first] == LINE:
            face = np.vstack([curve_point(profile, first, profile.start[first] - far)[0], face])
        if profile.kind[last] == LINE:
            end = profile.start[last] + profile.length[last] + far
            face = np.vstack([face, curve_point(profile, last, end)[0]])
    return face


def profile_body(result: SealResult, contact, fraction: float):
    """Build the drawn part of the rigid side of a profile: a shapely polygon, or several."""
    face = profile_face(result, contact, fraction)
    return rigid_side(contact.shape.profile(), face, size_of(result))


def rigid_side(profile: RigidProfile, face: np.ndarray, size: float):
    """Build the rigid side of a profile with the points ``face`` (n, 2), in any frame, as
    ``profile_body``."""
    depth = DEPTH * size
    if profile.period == 0.0:
        return left_of(face, depth)
    # closed: counter-clockwise is a solid body, clockwise a hole in a rigid body around it
    inside = Polygon(face)
    return inside if inside.exterior.is_ccw else inside.buffer(depth) - inside


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


def outlines(body) -> list[np.ndarray]:
    """Return closed lines (k, 2) around a shapely polygon, or several, and around their holes."""
    parts = body.geoms if isinstance(body, MultiPolygon) else [body]
    return [np.asarray(ring.coords) for part in parts for ring in (part.exterior, *part.interiors)]


def fixed_lines(result: SealResult) -> list[np.ndarray]:
    """List the lines of the nominal boundary that are fixed and do not move, the body on the left,
    shapes (k, 2), mm."""
    moved = {int(i) for own in moved_edges(result.seal) for i in own.particles}
    fixed = result.seal.body.fixed.all(axis=1)
    fixed[list(moved)] = False
    return _lines(result, fixed, result.seal.nominal_particles)


def moved_lines(result: SealResult, fraction: float) -> list[np.ndarray]:
    """List the lines of moved edges after ``fraction`` nominal steps, shapes (k, 2), mm."""
    found, imposed = [], result.path.problem.imposed
    for own in moved_edges(result.seal):
        mask = np.isin(np.arange(len(result.particles)), own.particles)
        found += _lines(result, mask, result.particles + imposed.at(fraction))
    return found


def _lines(result: SealResult, fixed: np.ndarray, particles: np.ndarray) -> list[np.ndarray]:
    """List the lines of the boundary along particles of a mask (n,), at ``particles`` (n, 2)."""
    body, found = result.seal.body, []
    for loop in cell_loops(body):
        free = np.flatnonzero(~fixed[loop])
        # start at a free particle, so that no fixed line crosses the end of the list
        ring = np.append(loop, loop[0]) if free.size == 0 else np.roll(loop, -free[0])
        runs = np.split(ring, np.flatnonzero(np.diff(fixed[ring])) + 1)
        found += [particles[r] for r in runs if fixed[r[0]] and r.size > 1]
    return found


# ---- drawing ----


def draw_cells(axes: Axes, particles: np.ndarray, cells: np.ndarray, color, **line) -> None:
    """Plot the outline of every cell (m, 4)."""
    axes.add_collection(PolyCollection(particles[cells], edgecolor=color, facecolor="none", **line))


def _fill(axes: Axes, rings, **patch) -> None:
    """Fill the region between closed lines (k, 2)."""
    paths = [Path(ring, closed=True) for ring in rings]
    axes.add_patch(PathPatch(Path.make_compound_path(*paths), **patch))


def fill_outline(axes: Axes, coordinates: np.ndarray, loops, **patch) -> None:
    """Fill the section between boundary loops of the points ``coordinates`` (k, 2)."""
    _fill(axes, [coordinates[np.append(loop, loop[0])] for loop in loops], **patch)


def draw_outline(axes: Axes, coordinates: np.ndarray, loops, label=None, **line) -> None:
    """Plot boundary loops of the points ``coordinates`` (k, 2)."""
    for number, loop in enumerate(loops):
        ring = coordinates[np.append(loop, loop[0])]
        axes.plot(*ring.T, label=None if number else label, **line)


def draw_fixed(axes: Axes, result: SealResult, fraction: float = 0.0) -> None:
    """Plot the fixed boundary of the section, and moved edges after ``fraction`` nominal steps, with
    hatched ground."""
    for line in (*fixed_lines(result), *moved_lines(result, fraction)):
        ground = left_of(line[::-1], FIXED_DEPTH * size_of(result))
        _fill(axes, outlines(ground), facecolor="white", hatch="\\\\\\\\", **HATCHED)
        axes.plot(*line.T, color="black", linewidth=1.6, zorder=3)


def draw_surroundings(axes: Axes, result: SealResult, fraction: float) -> None:
    """Plot the fixed boundary, and all rigid profiles after ``fraction`` nominal steps, hatched."""
    draw_fixed(axes, result, fraction)
    for contact in contacts(result.seal):
        body = profile_body(result, contact, fraction)
        _fill(axes, outlines(body), facecolor=LIGHT_GREY, hatch="////", **HATCHED)
        face = profile_face(result, contact, fraction)
        axes.plot(*face.T, color="black", linewidth=1.4, zorder=4)


def draw_section(axes: Axes, fine: FineGrid, step: int, **patch) -> None:
    """Fill the deformed section after a nominal step, with the fixed boundary and the profiles."""
    fill_outline(axes, fine.deformed(step), fine.loops, **patch)
    draw_surroundings(axes, fine.result, fine.result.path.nominal_steps[step].fraction)


def draw_stress(axes: Axes, fine: FineGrid, step: int, scales: list[dict]) -> list:
    """Plot the deformed body with filled von Mises contours, and the profiles around it.

    Parameters
    ----------
    scales : list of dict
        Colour scale of every material, or one of all.

    Returns
    -------
    list of ContourSet
        One for every scale, for the colour bars.
    """
    coordinates, stress = fine.deformed(step), np.maximum(fine.von_mises(step), 0.0)
    # the points of a triangle belong to one material, for those between two materials lie twice
    material = fine.region[fine.triangles[:, 0]] if len(scales) > 1 else 0
    contours = []
    for number, scale in enumerate(scales):
        triangles = fine.triangles[np.broadcast_to(material == number, len(fine.triangles))]
        shown = Triangulation(*coordinates.T, triangles)
        contours.append(axes.tricontourf(shown, stress, zorder=2, **scale))
    draw_outline(axes, coordinates, fine.loops, color="black", linewidth=0.8, zorder=3)
    draw_surroundings(axes, fine.result, fine.result.path.nominal_steps[step].fraction)
    draw_contact(axes, fine.result, step)
    return contours


def stress_label(bar) -> str:
    """Describe the stress of a colour bar, and say that its scale is cut if it is."""
    return f"{STRESS}\n(arrow: higher at single points)" if bar.extend == "max" else STRESS


def draw_colorbars(figure: Figure, axes, contours: list, fine: FineGrid, **options) -> None:
    """Add a colour bar of the stress beside ``axes`` for every scale, with the name of its material."""
    regions = fine.result.seal.definitions[0].regions
    for own, region in zip(contours, regions, strict=False):
        name = f"{region.name}: " if len(contours) > 1 else ""
        bar = figure.colorbar(own, ax=axes, **options)
        bar.set_label(f"{name}{stress_label(bar)}")
        # the layout measures a bar once for each of its axes: the widest number is enough
        numbers = bar.ax.get_yticklabels()
        widest = max(numbers, key=lambda own: len(own.get_text()))
        for own in numbers:
            own.set_in_layout(own is widest)


def draw_contact(axes: Axes, result: SealResult, step: int) -> None:
    """Plot points in contact with a profile or another wall, and open points between contacts."""
    touching, opened = [np.empty((0, 2))], [np.empty((0, 2))]
    for term in (*contacts(result.seal), *self_contacts(result.seal)):
        own = result.path.at_nominal(term.label)[step]
        touching.append(own.x[own.branch != OPEN])
        # with itself a wall has no order of points, hence no region between contacts
        if isinstance(term, RigidContact):
            opened.append(own.x[open_between(result, term.label, step)])
    for fill, label, points in (
        (ORANGE, "in contact", touching), ("white", "open between contacts", opened),
    ):  # fmt: skip
        axes.plot(
            *np.concatenate(points).T, linestyle="none", marker="o", markersize=4.2, zorder=5,
            markerfacecolor=fill, markeredgecolor="black", markeredgewidth=0.7, label=label,
        )  # fmt: skip


def near_axis(seal) -> bool:
    """Whether pictures of a ring show both halves, because its inner radius is at most ``NARROW``
    times the size of its section."""
    particles = seal.nominal_particles
    size = np.ptp(particles, axis=0).max()
    return bool(seal.body.axisymmetric and particles[:, 0].min() <= NARROW * size)


def frame(axes: Axes, low, high, seal=None) -> None:
    """Set equal aspect, window and axis labels after all else is drawn. For a ``seal`` that is a
    ring, x is the radius; its axis is drawn and, near it, the mirror image in a lighter tone."""
    axes.set(aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    ring = seal is not None and seal.body.axisymmetric
    across = "radius" if ring else "x"
    axes.set(xlabel=f"{across} (mm)", ylabel="y (mm)")
    axes.grid(False)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    if ring and near_axis(seal):
        _add_mirror_image(axes, low, high)
        axes.xaxis.set_major_formatter(lambda x, _: f"{abs(x):g}")
    if ring:
        axes.axvline(0.0, color="black", linewidth=0.8, linestyle="-.", zorder=8)


def _add_mirror_image(axes: Axes, low, high) -> None:
    """Copy all that is drawn at x > 0 to the other side of the axis, below a veil."""
    (_, bottom), (right, top) = low, high
    half = Path([(0.0, bottom), (right, bottom), (right, top), (0.0, top)])
    mirrored = Affine2D().scale(-1.0, 1.0) + axes.transData
    for artist in (*axes.patches, *axes.collections, *axes.lines):
        # profiles may extend across the axis
        artist.set_clip_path(half, axes.transData)
        image = copy(artist)
        image.set(transform=mirrored, label="_mirror")
        image.set_clip_path(half, mirrored)
        axes.add_artist(image)
    axes.axvspan(low[0], 0.0, color="white", alpha=VEIL, linewidth=0.0, zorder=7)


def window(shapes, margin: float = 0.08, seal=None) -> tuple[np.ndarray, np.ndarray]:
    """Compute lower left and upper right corner around all ``shapes`` (n, 2), with a margin as a
    fraction of the larger side; of a ``seal`` that is ``near_axis`` with their mirror image."""
    points = np.vstack([np.reshape(shape, (-1, 2)) for shape in shapes])
    if seal is not None and near_axis(seal):
        points = np.vstack([points, points * [-1.0, 1.0]])
    border = margin * np.ptp(points, axis=0).max()
    return points.min(axis=0) - border, points.max(axis=0) + border


def panel_size(low, high) -> tuple[float, float]:
    """Compute width and height of the panel of a window, inches."""
    width, height = high - low
    # equal area for all aspect ratios, at most 6 by 5 inches
    scale = min((PANEL_AREA / (width * height)) ** 0.5, 6.0 / width, 5.0 / height)
    return scale * width, scale * height

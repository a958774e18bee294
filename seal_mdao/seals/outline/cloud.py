"""Particles and background cells inside any section."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.rkpm.cells import cell_map, quadrature_weights
from seal_mdao.seals.outline.crossings import nearest_around
from seal_mdao.seals.outline.mesher import triangulate
from seal_mdao.seals.outline.quadrilaterals import halved, paired

SLOPE = 0.25
"""Growth of the spacing over the distance from where a wall is thin, or sides are short."""

FINEST = 1.0 / 6.0
"""Least spacing over the largest one."""

LAYERS = 3
"""Of particles across a wall, at least."""

LONGEST = 1.25
"""Longest side of a cell over the spacing that is content."""

SHARES = (1.0, 0.85, 0.7, 0.6)
"""Of the spacing, tried one after the other until sides are short enough."""

DENSE = 0.125
"""Distance of the points by which walls are measured, over the spacing."""


class OutlineCloud(NamedTuple):
    """A cloud of particles for a section.

    Attributes
    ----------
    particles : ndarray, shape (n, 2)
        Those of the boundary first, loop after loop.
    cells : ndarray of int, shape (m, 4)
        Background cells, counter-clockwise.
    loops : tuple of ndarray of int
        Boundary particles of every loop in order, the material on the left.
    parts : ndarray of int, shape (m,)
        Number of the part of every cell, into which cuts divide the section.
    first_places : ndarray, shape (n, 2), or None
        Where the particles were when their kernels were chosen; None for where they are.
    support_radius : ndarray, shape (n,), or None
        Chosen then; None for one by the cells.
    support_axes : ndarray, shape (n, 2, 2), or None
        Of product kernels, chosen then.
    """

    particles: np.ndarray
    cells: np.ndarray
    loops: tuple
    parts: np.ndarray
    first_places: np.ndarray | None = None
    support_radius: np.ndarray | None = None
    support_axes: np.ndarray | None = None

    @property
    def n_boundary(self) -> int:
        """Particles on the boundary."""
        return sum(len(loop) for loop in self.loops)


def cloud(loops, spacing: float, cuts=()) -> OutlineCloud:
    """Particles and cells between closed loops of boundary points.

    Parameters
    ----------
    loops : sequence of ndarray, shape (2 k, 2)
        Points in order, the material on the left: outsides counter-clockwise, holes clockwise. Corners
        of the section have even numbers, see ``boundary.doubled``.
    spacing : float
        Wanted distance of particles inside, mm. Where the loops are finer the inside is finer too.
    cuts : sequence of ndarray, shape (k, 2)
        Straight sides from one point of even number to another, on which sides of cells lie.

    Raises
    ------
    GeometryError
        For loops that cannot be filled with cells.
    ValueError
        For loops or a spacing that cannot be meant.
    """
    loops = [np.asarray(loop, float) for loop in loops]
    for number, loop in enumerate(loops):
        if loop.ndim != 2 or loop.shape[1] != 2 or len(loop) < 6 or len(loop) % 2:
            raise ValueError(
                f"loop {number} must have shape (2 k, 2) with k of at least 3, got {loop.shape}"
            )
        if not np.isfinite(loop).all():
            raise ValueError(f"loop {number} has a coordinate that is not a finite number")
    for number, (loop, around) in enumerate(zip(loops, nearest_around(loops), strict=True)):
        hole = around is not None and polygon_area(loops[around])[0] > 0.0
        if (polygon_area(loop)[0] > 0.0) == hole:
            raise ValueError(
                f"loop {number} is walked the wrong way: the material must lie on the left"
            )
    if not (np.isfinite(spacing) and spacing > 0.0):
        raise ValueError(f"spacing must be a positive number, got {spacing!r}")
    points, triangles, parts = triangulate([loop[::2] for loop in loops], 2.0 * spacing, cuts)
    whole, parts = paired(points, triangles, parts)
    particles, cells = halved(points, whole, loops)
    corners = np.where(whole[:, 2] == whole[:, 3], 3, 4)
    try:
        quadrature_weights(cell_map(cells), particles)
    except GeometryError as error:
        raise GeometryError(
            f"the boundary bends too much for its spacing ({error}); use a smaller spacing"
        ) from error
    ends = np.cumsum([0, *(len(loop) for loop in loops)])
    around = tuple(np.arange(a, b) for a, b in pairwise(ends))
    return OutlineCloud(particles, cells, around, np.repeat(parts, corners))


def graded(sample, spacing: float, cuts=(), layers: int = LAYERS) -> tuple[list, float]:
    """Boundaries graded by wall thickness, and the spacing for ``cloud``.

    No wall has fewer than ``layers`` particles across, where the spacing stays above ``FINEST`` of the
    largest. From sides that have to
    be short, as round a fillet, the spacing grows as slowly as it does from thin walls. Where walls are
    such that its cells are long and more do not fit, the spacing is taken smaller.

    Parameters
    ----------
    sample : callable
        Boundaries for a function that gives the largest distance of points at places (k, 2); they
        have the attribute ``points`` and an even number of sides between corners.
    spacing : float
        Largest distance of particles, mm; sides of cells inside are up to a quarter longer.
    cuts
        As of ``cloud``.
    layers : int
        Of particles across a wall, at least 2; cells come in pairs.

    Raises
    ------
    GeometryError
        For a section that cannot be filled.
    """
    dense = [b.points for b in sample(lambda x: np.full(len(x), DENSE * spacing))]
    for share in SHARES:
        at = wall_spacing(dense, share * spacing, layers)
        boundaries = sample(_beside_short(sample(at), at))
        filled = cloud([boundary.points for boundary in boundaries], share * spacing, cuts)
        if longest_side(filled.cells, filled.particles) <= LONGEST * spacing:
            break
    return boundaries, share * spacing


def _beside_short(boundaries, at):
    """The spacing ``at``, grown from the sides that boundaries sampled with it have."""
    starts = [boundary.points for boundary in boundaries]
    ends = [np.roll(points, -1, axis=0) for points in starts]
    start, end = np.concatenate(starts), np.concatenate(ends)
    return _grown(0.5 * (start + end), np.hypot(*(end - start).T), at)


def longest_side(cells: np.ndarray, particles: np.ndarray) -> float:
    """Longest side of all cells, mm."""
    sides = np.roll(particles[cells], -1, axis=1) - particles[cells]
    return float(np.hypot(sides[..., 0], sides[..., 1]).max())


def wall_thickness(loops) -> list[np.ndarray]:
    """Thickness of the material behind every boundary point, mm, shape (k,) for each loop.

    Along the inward normal to a part of the boundary that faces the point within 60 degrees;
    infinite where there is none.
    """
    start = np.concatenate(loops)
    end = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    side = end - start
    facing = np.column_stack([side[:, 1], -side[:, 0]]) / np.hypot(*side.T)[:, None]
    found = []
    for loop in loops:
        normal = _normals(loop)
        to = start - loop[:, None]
        # loop - t normal = start + u side
        across = _cross(normal[:, None], side)
        with np.errstate(divide="ignore", invalid="ignore"):
            t, u = _cross(side, to) / across, _cross(to, normal[:, None]) / across
        size = np.hypot(*np.ptp(start, axis=0))
        hit = (u >= 0.0) & (u <= 1.0) & (t > 1e-9 * size) & (normal @ facing.T < -0.5)
        found.append(np.where(hit, t, np.inf).min(axis=1))
    return found


def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _normals(loop):
    """Outward unit normals at the points of a loop, shape (k, 2)."""
    along = np.roll(loop, -1, axis=0) - np.roll(loop, 1, axis=0)
    return np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]


def wall_spacing(loops, spacing: float, layers: int = LAYERS):
    """Spacing by wall thickness, as a function of places (k, 2): cells about as long as wide where
    ``layers - 1`` of them, or one more, fill the wall.

    Parameters
    ----------
    loops : sequence of ndarray, shape (k, 2)
        Boundary points, dense enough to see every wall.
    spacing : float
        Largest value, mm.
    """
    points, across = np.concatenate(loops), 2 * (layers // 2)
    local = np.clip(np.concatenate(wall_thickness(loops)) / across, FINEST * spacing, spacing)
    thin = local < spacing
    return _grown(points[thin], local[thin], lambda places: np.full(len(places), float(spacing)))


def _grown(points, local, most):
    """Spacing that grows from ``local`` (k,) at points (k, 2) up to what ``most(places)`` allows."""

    def at(places):
        places = np.atleast_2d(places)
        away = np.hypot(*np.moveaxis(places[:, None] - points, -1, 0))
        return np.minimum(most(places), (local + SLOPE * away).min(axis=1, initial=np.inf))

    return at

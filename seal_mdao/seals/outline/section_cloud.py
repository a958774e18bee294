"""Particles and background cells inside any section."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.rkpm.cells import cell_map, quadrature_weights
from seal_mdao.seals.outline.crossings import nearest_around
from seal_mdao.seals.outline.mesher import triangulate
from seal_mdao.seals.outline.notches import notch_places
from seal_mdao.seals.outline.quadrilaterals import halved, paired

SLOPE = 0.25
"""Gradient of the spacing with the distance from thin walls, short sides and narrow notches."""

FINEST = 1.0 / 6.0
"""Least spacing over the largest one."""

AT_NOTCHES = (1.0 / 16.0, 1.0 / 4.0)
"""Spacing at the vertices of narrow notches over the largest one; the second one where the section
cannot be filled with the first."""

LAYERS = 3
"""Least number of layers of particles across a wall."""

LONGEST = 1.25
"""Longest accepted side of a cell over the spacing."""

FRACTIONS = (1.0, 0.85, 0.7, 0.6)
"""Fractions of the spacing, tried in this order until no cell is folded and sides are short enough."""

DENSE = 0.125
"""Distance of the points at which wall thickness is measured, over the spacing."""


@dataclass(frozen=True)
class Kernels:
    """Kernels, basis, pressure and integration of a cloud.

    The defaults are for clouds with a spacing: the least error per second of the variants tried on
    many sections (page on accuracy).

    Attributes
    ----------
    support : float, or pair of float
        Support radius over the longest side of a cell at a particle; of product kernels the half-widths
        along the cells' two directions over their sides.
    basis_order : int
        1 (linear) or 2 (quadratic).
    column : int
        Cells in succession through which the pressure is continuous and linear; 1 for one value a cell.
    n_gauss : int, or pair of int
        Gauss points along both directions of a cell, or along each.
    """

    support: float | tuple = 2.2
    basis_order: int = 1
    column: int = 1
    n_gauss: int | tuple[int, int] = 2


@dataclass(frozen=True, eq=False)
class OutlineCloud:
    """A cloud of particles for a section, filled or read from a file.

    Attributes
    ----------
    particles : ndarray, shape (n, 2)
        Those of the boundary first, loop after loop.
    cells : ndarray of int, shape (m, 4)
        Background cells, counter-clockwise.
    loops : tuple of ndarray of int
        Boundary particles of every loop in order, the material on the left.
    parts : ndarray of int, shape (m,)
        Index of the part, into which cuts divide the section, of every cell.
    first_indices : ndarray, shape (n, 2), or None
        Particles when their kernels were chosen; None for the present ones.
    support_radius : ndarray, shape (n,), or None
        Kernel supports chosen then; None to choose them by the cells.
    support_axes : ndarray, shape (n, 2, 2), or None
        Axes of product kernels chosen then.
    boundaries : tuple of Boundary
        Of a cloud from a file: its points along the contours of the section.
    kernels : Kernels or None
        Those of the file; supports are those chosen then.
    """

    particles: np.ndarray
    cells: np.ndarray
    loops: tuple
    parts: np.ndarray
    first_indices: np.ndarray | None = None
    support_radius: np.ndarray | None = None
    support_axes: np.ndarray | None = None
    boundaries: tuple = ()
    kernels: Kernels | None = None

    @property
    def n_boundary(self) -> int:
        """Number of particles on the boundary."""
        return sum(len(loop) for loop in self.loops)

    def part_at(self, point) -> int:
        """Find the index of the part of the section that contains a point.

        Raises
        ------
        ValueError
            For a point outside of the section.
        """
        corners = self.particles[self.cells]
        side, to = np.roll(corners, -1, axis=1) - corners, np.asarray(point, float) - corners
        # inside a convex counter-clockwise cell: on the left of all its sides, s x (p - a) >= 0
        inside = (_cross(side, to) >= 0.0).all(axis=1)
        if not inside.any():
            raise ValueError(
                f"the point at = ({point[0]:.4g}, {point[1]:.4g}) of a region is outside of the "
                "section; give a point inside the region"
            )
        return int(self.parts[np.flatnonzero(inside)[0]])


def cloud(loops, spacing: float, cuts=()) -> OutlineCloud:
    """Fill closed loops of boundary points with particles and background cells.

    Parameters
    ----------
    loops : sequence of ndarray, shape (2 k, 2)
        Points in order, the material on the left: outsides counter-clockwise, holes clockwise. Corners
        of the section have even numbers, see ``boundary.doubled``.
    spacing : float
        Target distance of particles inside, mm; smaller where the points of the loops are closer.
    cuts : sequence of ndarray, shape (k, 2)
        Straight sides from one point of even number to another, or closed, on which sides of cells lie.

    Raises
    ------
    GeometryError
        For loops that cannot be filled with cells.
    ValueError
        For invalid loops or an invalid spacing.
    """
    loops = [np.asarray(loop, float) for loop in loops]
    _check_loops(loops)
    if not (np.isfinite(spacing) and spacing > 0.0):
        raise ValueError(f"the particle spacing must be a positive number, got {spacing!r}")
    # triangles on every other boundary point, of twice the size: halving the cells restores it
    points, triangles, parts = triangulate([loop[::2] for loop in loops], 2.0 * spacing, cuts)
    coarse, parts = paired(points, triangles, parts)
    particles, cells = halved(points, coarse, loops)
    # a cell of k corners is divided into k quadrilaterals of its part
    corners = np.where(coarse[:, 2] == coarse[:, 3], 3, 4)
    try:
        quadrature_weights(cell_map(cells), particles)
    except GeometryError as error:
        raise GeometryError(
            f"the particle spacing is too large for the curvature of the boundary ({error}); use a "
            "smaller spacing or edge_spacing"
        ) from error
    ends = np.cumsum([0, *(len(loop) for loop in loops)])
    around = tuple(np.arange(a, b) for a, b in pairwise(ends))
    return OutlineCloud(particles, cells, around, np.repeat(parts, corners))


def _check_loops(loops) -> None:
    """Refuse loops of odd or few points, or with the material on the right."""
    for number, loop in enumerate(loops):
        if loop.ndim != 2 or loop.shape[1] != 2 or len(loop) < 6 or len(loop) % 2:
            raise ValueError(
                f"the closed boundary (loop) {number} must have shape (2 k, 2) with k of at least "
                f"3, got {loop.shape}"
            )
        if not np.isfinite(loop).all():
            raise ValueError(
                f"the closed boundary (loop) {number} has a coordinate that is not finite"
            )
    for number, (loop, around) in enumerate(zip(loops, nearest_around(loops), strict=True)):
        # a loop directly inside a body is a hole (area < 0), every other one a body (area > 0)
        hole = around is not None and polygon_area(loops[around])[0] > 0.0
        if (polygon_area(loop)[0] > 0.0) == hole:
            raise ValueError(
                f"the closed boundary (loop) {number} has the wrong direction; reverse its points, "
                "so that the material lies on the left"
            )


def graded(sample, spacing: float, cuts=(), layers: int = LAYERS) -> tuple[list, float]:
    """Grade boundary points by wall thickness, and choose the spacing for ``cloud``.

    No wall has fewer than ``layers`` particles across, where the spacing stays above ``FINEST`` of the
    largest. The spacing grows with the same gradient from short sides, as along a fillet, and from the
    vertices of narrow notches, as from thin walls. It is reduced where cells would be too long for it or
    folded at a curved boundary.

    Parameters
    ----------
    sample : callable
        Returns boundaries for the largest distance of points, a function of points (k, 2); they have an
        even number of sides between corners.
    spacing : float
        Largest distance of particles, mm; sides of cells inside are up to a quarter longer.
    cuts, layers
        As of ``cloud``; particles across a wall, at least 2: cells come in pairs.

    Raises
    ------
    GeometryError
        For a section that cannot be filled.
    """
    dense = sample(lambda x: np.full(len(x), DENSE * spacing))
    notches, walls = notch_places(dense), [boundary.points for boundary in dense]
    for finest in AT_NOTCHES if len(notches) else ():
        try:
            return _graded(sample, spacing, cuts, layers, walls, notches, finest)
        except GeometryError:
            continue
    return _graded(sample, spacing, cuts, layers, walls, notches, 1.0)


def _graded(sample, spacing, cuts, layers, walls, notches, finest):
    """Choose points and spacing as ``graded``, by dense points of walls and by the vertices of notches,
    at which the spacing is ``finest`` times the largest one."""
    found = failure = None
    for fraction in FRACTIONS:
        at = wall_spacing(walls, fraction * spacing, layers)
        # sampled twice: short sides of the first sampling refine the spacing of the second
        at = _beside_short(sample(at), at)
        at = _beside_cuts(cuts, fraction * spacing, at)
        if finest < 1.0:
            at = _grown(notches, np.full(len(notches), finest * fraction * spacing), at)
        boundaries = sample(at)
        try:
            filled = cloud([boundary.points for boundary in boundaries], fraction * spacing, cuts)
        except GeometryError as error:
            # cells are folded where the boundary is curved, which depends on the spacing
            failure = failure or error
            continue
        found = boundaries, fraction * spacing
        if longest_side(filled.cells, filled.particles) <= LONGEST * spacing:
            break
    if found is None:
        raise failure
    return found


def _beside_short(boundaries, at):
    """Limit the spacing ``at`` by growth from the sides of boundaries sampled with it."""
    starts = [boundary.points for boundary in boundaries]
    ends = [np.roll(points, -1, axis=0) for points in starts]
    start, end = np.concatenate(starts), np.concatenate(ends)
    return _grown(0.5 * (start + end), np.hypot(*(end - start).T), at)


def _beside_cuts(cuts, spacing, at):
    """Limit the spacing ``at`` by growth from the sides of cuts, which cells halve, where they are
    short for ``spacing``."""
    ends = [np.stack([cut[:-1], cut[1:]]) for cut in cuts]
    start, end = np.concatenate(ends, axis=1) if ends else np.empty((2, 0, 2))
    local = np.maximum(0.5 * np.hypot(*(end - start).T), FINEST * spacing)
    short = local < spacing
    return _grown(0.5 * (start + end)[short], local[short], at)


def longest_side(cells: np.ndarray, particles: np.ndarray) -> float:
    """Compute the longest side of all cells, mm."""
    sides = np.roll(particles[cells], -1, axis=1) - particles[cells]
    return float(np.hypot(sides[..., 0], sides[..., 1]).max())


def wall_thickness(loops) -> list[np.ndarray]:
    """Measure the wall thickness behind every boundary point, mm, shape (k,) for each loop.

    Along the inward normal to a part of the boundary that faces the point within 60 degrees;
    infinite where there is none.
    """
    start = np.concatenate(loops)
    end = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    side = end - start
    # outward unit normals of all sides
    facing = np.column_stack([side[:, 1], -side[:, 0]]) / np.hypot(*side.T)[:, None]
    found = []
    for loop in loops:
        normal = _normals(loop)
        to = start - loop[:, None]
        # ray x - t n against side a + u s:  t = s x (a - x) / (n x s),  u = (a - x) x n / (n x s)
        across = _cross(normal[:, None], side)
        with np.errstate(divide="ignore", invalid="ignore"):
            t, u = _cross(side, to) / across, _cross(to, normal[:, None]) / across
        size = np.hypot(*np.ptp(start, axis=0))
        # inside the side, beyond the point itself, and normals opposed within 60 degrees (cos < -1/2)
        hit = (u >= 0.0) & (u <= 1.0) & (t > 1e-9 * size) & (normal @ facing.T < -0.5)
        found.append(np.where(hit, t, np.inf).min(axis=1))
    return found


def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _normals(loop):
    """Compute outward unit normals at the points of a loop by central differences, shape (k, 2)."""
    along = np.roll(loop, -1, axis=0) - np.roll(loop, 1, axis=0)
    return np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]


def wall_spacing(loops, spacing: float, layers: int = LAYERS):
    """Build the spacing by wall thickness, a function of points (k, 2).

    Cells are about square where ``layers - 1`` of them, or one more, fill the wall.

    Parameters
    ----------
    loops : sequence of ndarray, shape (k, 2)
        Boundary points, dense enough to see every wall.
    spacing : float
        Largest value, mm.
    """
    # cells come in pairs across a wall: h = thickness / (2 floor(layers / 2)), within bounds
    points, across = np.concatenate(loops), 2 * (layers // 2)
    local = np.clip(np.concatenate(wall_thickness(loops)) / across, FINEST * spacing, spacing)
    thin = local < spacing
    return _grown(points[thin], local[thin], lambda x: np.full(len(x), float(spacing)))


def _grown(points, local, most):
    """Build the spacing that grows from ``local`` (k,) at points (k, 2) up to ``most(x)``."""

    def at(x):
        x = np.atleast_2d(x)
        # h(x) = min(h_max(x), min_k (h_k + SLOPE |x - x_k|))
        away = np.hypot(*np.moveaxis(x[:, None] - points, -1, 0))
        return np.minimum(most(x), (local + SLOPE * away).min(axis=1, initial=np.inf))

    return at

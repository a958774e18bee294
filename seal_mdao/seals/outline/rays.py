"""Structured clouds: particles on radial rows through an annular wall, linear between boundaries."""

from dataclasses import dataclass

import numpy as np
import scipy

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.contours import JOIN, SAGITTA, Boundary, Outline
from seal_mdao.seals.outline.section_cloud import Kernels, OutlineCloud
from seal_mdao.seals.wall_grid import WALL_SCHEMES, WallGrid

BACK = 1e-9
"""Largest decrease of the polar angle along a contour, radians."""


@dataclass(frozen=True)
class Rays(WallGrid):
    """Radial rows of particles that fill a wall between two contours.

    Attributes
    ----------
    centre : pair of float
        Common origin of the rays, mm.
    accuracy : str
        Name of the wall's scheme (``wall_grid.WALL_SCHEMES``); contact points are chosen by the caller.
    """

    centre: tuple = (0.0, 0.0)
    accuracy: str = "engineering"

    @property
    def kernels(self) -> Kernels:
        """Kernels of the door seal with this accuracy."""
        own = WALL_SCHEMES[self.accuracy]
        return Kernels(
            self.along_cells(own.support), own.basis_order, self.column(own.pressure),
            self.along_cells(own.n_gauss),
        )  # fmt: skip

    def across(self, inner: np.ndarray, outer: np.ndarray) -> np.ndarray:
        """Interpolate values (..., rays, 2) of the two boundaries to all particles (..., n, 2)."""
        t = self.fractions[:, None]
        # v(t) = (1 - t) v_inner + t v_outer at the fractions t of the layers
        values = inner[..., None, :] * (1.0 - t) + outer[..., None, :] * t
        return values.reshape(*values.shape[:-3], self.rays * self.layers, 2)


def ray_boundaries(outline: Outline, rays: Rays) -> list:
    """Intersect a section of two contours with the rays.

    ``arc_length`` of the points is the angle and their tangents are normal to the rays, so that a design
    moves them along the rays by B-splines of the angle.

    Raises
    ------
    GeometryError
        For a section of another kind, a contour that a ray meets twice, an end of a segment between
        two rays.
    """
    # an annular wall: one outer contour and one hole
    if len(outline.holes) != 1:
        raise GeometryError(
            "radial rows of particles (rays) need a section with exactly one hole, but the section "
            f"has {len(outline.holes)}; use spacing instead of rays"
        )
    if outline.others:
        raise GeometryError(
            "radial rows of particles (rays) need a section with a single body, but the section "
            "has several; use spacing instead of rays"
        )
    return [_boundary(contour, rays, i) for i, contour in enumerate(outline.contours)]


def _boundary(contour, rays, hole) -> Boundary:
    # the outer contour runs counter-clockwise (+1), the hole clockwise (-1)
    turn = -1.0 if hole else 1.0
    found = [_on_rays(segment, rays, turn) for segment in contour.segments]
    number = np.concatenate([[i] * len(own) for i, own in enumerate(found)])
    ray = np.concatenate([[r for r, _ in own] for own in found]).astype(int)
    radius = np.concatenate([[x for _, x in own] for own in found])
    if sorted(ray % rays.rays) != list(range(rays.rays)):
        raise GeometryError(
            f"every radial row of particles (ray) from ({rays.centre[0]:.4g}, "
            f"{rays.centre[1]:.4g}) must meet every contour once, but this does not hold for the "
            f"contour with the edge {contour.edge_names[0]!r}; move the centre of the rays, or use "
            "spacing"
        )
    directions = rays.directions[ray % rays.rays]
    along = turn * np.column_stack([-directions[:, 1], directions[:, 0]])
    angle = turn * 2.0 * np.pi / rays.rays * (ray - ray[0])
    return Boundary(
        np.asarray(rays.centre) + radius[:, None] * directions,
        np.array([segment.edge for segment in contour.segments])[number],
        number,
        np.concatenate([[True], number[1:] != number[:-1]]),
        np.mod(angle, 2.0 * np.pi),
        2.0 * np.pi,
        np.stack([along, along], axis=1),
    )


def _on_rays(segment, rays, turn) -> list:
    """List the rays that meet a segment, without its end, in order, with the radii there."""
    s = segment.chords(SAGITTA * segment.length)
    to = segment.points(s) - rays.centre
    # angle from the downward direction; ray k lies at 2 pi k / rays
    angle = np.unwrap(np.arctan2(to[:, 0], -to[:, 1]))
    unit = 2.0 * np.pi / rays.rays
    radius = np.hypot(*to.T)
    ends = np.round(angle[[0, -1]] / unit).astype(int)
    away = np.abs(angle[[0, -1]] - ends * unit) * radius[[0, -1]]
    if away.max() > JOIN:
        x, y = segment.points(np.array([0.0, 1.0]))[int(away.argmax())]
        raise GeometryError(
            f"a segment of the edge {segment.edge!r} ends at ({x:.4g}, {y:.4g}), which lies "
            "between two radial rows of particles (rays); change the number of rays, or use spacing"
        )
    if (turn * np.diff(angle) <= -BACK).any():
        raise GeometryError(
            f"a radial row of particles (ray) meets the edge {segment.edge!r} twice; move the "
            "centre of the rays, or use spacing"
        )
    found = [(ends[0], radius[0])]
    for ray in range(ends[0] + int(turn), ends[1], int(turn)):
        # the chord k - 1, k brackets the ray
        k = int(np.searchsorted(turn * angle, turn * ray * unit))
        found.append((ray, _radius(segment, rays, ray, s[k - 1], s[k])))
    return found


def _radius(segment, rays, ray, low, high) -> float:
    """Compute the radius at which a ray meets a segment between two fractions of its length."""
    along = rays.directions[ray % rays.rays]

    # root of e x (x(s) - c): distance of the curve from the ray
    def off(s):
        x, y = segment.points(np.array([s]))[0] - rays.centre
        return along[0] * y - along[1] * x

    if off(low) * off(high) < 0.0:
        s = scipy.optimize.brentq(off, low, high, xtol=1e-16)
    else:  # an end of the chord is on the ray
        s = min(low, high, key=lambda end: abs(off(end)))
    return float((segment.points(np.array([s]))[0] - rays.centre) @ along)


def ray_cloud(boundaries, rays: Rays) -> OutlineCloud:
    """Build particles and cells of a wall from its ``ray_boundaries``."""
    # boundary points by their rays: ray k lies at the angle 2 pi k / rays from straight down
    unit = 2.0 * np.pi / rays.rays
    loops, ordered = [], []
    # the outer contour is the last layer, the hole the first
    for boundary, layer in zip(boundaries, (rays.layers - 1, 0), strict=True):
        to = boundary.points - rays.centre
        ray = np.round(np.arctan2(to[:, 0], -to[:, 1]) / unit).astype(int) % rays.rays
        loops.append(rays.particle(ray, layer))
        ordered.append(boundary.points[np.argsort(ray)])
    particles = rays.across(ordered[1], ordered[0])
    cells = rays.cells
    return OutlineCloud(particles, cells, tuple(loops), np.zeros(len(cells), int))


def through_wall(filled: OutlineCloud, velocity: np.ndarray, rays: Rays) -> np.ndarray:
    """Interpolate the boundary velocity (P, k, 2) linearly to all particles (P, n, 2)."""
    around = len(filled.loops[0])
    inner, outer = np.empty((2, len(velocity), rays.rays, 2))
    # particle = ray * layers + layer, so the ray is particle // layers
    outer[:, filled.loops[0] // rays.layers] = velocity[:, :around]
    inner[:, filled.loops[1] // rays.layers] = velocity[:, around:]
    return rays.across(inner, outer)

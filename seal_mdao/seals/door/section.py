"""The nominal section of the door seal: radii of its two boundaries over the ray angle.

Polar about the origin. D is the angle from straight down, positive counter-clockwise (to the right).
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao import values
from seal_mdao.seals.wall_grid import WallGrid

SMALLEST, LARGEST = 0.1, 50.0
"""Bounds of the outer radius, mm."""
HOLE = (0.4, 0.98)
"""Bounds of the inner radius over the outer one: the wall of a ring."""


@dataclass(frozen=True)
class Section:
    """Nominal section of the door seal (lengths in mm).

    Attributes
    ----------
    inner_radius, outer_radius : float
        Radii of the two circles; the outer one from 0.1 to 50, the inner one 0.4 to 0.98 of it.
    base_angle : float
        D0: the flat base spans |D| <= D0, the straight flanks D0 <= |D| <= 2 D0. It ends at a ray of
        the seal: a multiple of 2 pi / rays.
    """

    inner_radius: float = 7.5
    outer_radius: float = 9.5
    base_angle: float = 3 * (2 * np.pi / 58)

    def __post_init__(self):
        for name, low, high in (
            ("inner_radius", 0.0, None), ("outer_radius", SMALLEST, LARGEST),
            ("base_angle", 0.0, np.pi / 4),
        ):  # fmt: skip
            value = values.real(name, getattr(self, name), above=low, below=high)
            object.__setattr__(self, name, value)
        thick, thin = (share * self.outer_radius for share in HOLE)
        if not thick <= self.inner_radius <= thin:
            raise ValueError(
                f"inner_radius must lie between {thick:.4g} and {thin:.4g}, {HOLE[0]} and {HOLE[1]} of "
                f"outer_radius, got {self.inner_radius}"
            )

    def inner(self, angle: np.ndarray) -> np.ndarray:
        """Radius of the nominal inner boundary."""
        return np.full(np.shape(angle), self.inner_radius)

    def outer(self, angle: np.ndarray) -> np.ndarray:
        """Radius of the nominal outer boundary: flat base, straight flanks, circle."""
        # |D| in [0, pi]
        d = np.abs((np.asarray(angle) + np.pi) % (2 * np.pi) - np.pi)
        # r = R / cos(D) on the base, R / cos(2 D0 - D) on the flanks, tangent to the circle r = R
        tilt = np.where(d <= self.base_angle, d, 2 * self.base_angle - d)
        return self.outer_radius / np.cos(np.where(d < 2 * self.base_angle, tilt, 0.0))


UPPER = 20 / 58
"""Fraction of the ring that the door presses: 62 degrees to either side of straight up."""


def _upper(rays: int) -> int:
    """Return the number of intervals of an even ring that are refined."""
    return round(UPPER * rays)


@dataclass(frozen=True)
class RingGrid(WallGrid):
    """Particles of the wall of the door seal.

    Attributes
    ----------
    base_columns : int
        Rays on either side of straight down whose outer particle lies on the flat base.
    refinement : int
        Number of parts of every interval in the upper part of an even ring; ``rays`` counts all rays.
    """

    base_columns: int
    refinement: int = 1

    @classmethod
    def refined(cls, rays: int, layers: int, base_columns: int, refinement: int) -> "RingGrid":
        """Build the grid from ``rays`` evenly spaced rays, and refine its upper part."""
        return cls(rays + (refinement - 1) * _upper(rays), layers, base_columns, refinement)

    @property
    def angles(self) -> np.ndarray:
        # rays of the even ring before the refinement
        even = round(self.rays / (1.0 + (self.refinement - 1) * UPPER))
        # even intervals below, divided ones above
        middle, half = even // 2, _upper(even) // 2
        before, after = np.arange(middle - half), np.arange(middle + half, even)
        above = middle - half + np.arange(2 * half * self.refinement) / self.refinement
        return 2 * np.pi * np.concatenate([before, above, after]) / even

    @property
    def base(self) -> np.ndarray:
        """Outer particles on the flat base."""
        # rays symmetric about straight down, outermost layer
        columns = np.arange(-self.base_columns, self.base_columns + 1)
        return self.particle(columns, self.layers - 1)

    @property
    def free_rays(self) -> np.ndarray:
        """Rays whose outer particle is free, counter-clockwise from the right base corner to the
        left one."""
        return np.arange(self.base_columns + 1, self.rays - self.base_columns)

    @property
    def free_outer(self) -> np.ndarray:
        """Outer particles that may touch the door."""
        return self.particle(self.free_rays, self.layers - 1)

    def positions(self, inner: np.ndarray, outer: np.ndarray) -> np.ndarray:
        """Particles from boundary radii on every ray, (..., rays) each, shape (..., n, 2)."""
        t = self.fractions
        # r = (1 - t) r_inner + t r_outer,  X = r (sin D, -cos D)
        radius = inner[..., :, None] * (1 - t) + outer[..., :, None] * t
        xy = radius[..., None] * self.directions[:, None]
        return xy.reshape(*xy.shape[:-3], -1, 2)

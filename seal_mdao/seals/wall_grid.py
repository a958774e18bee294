"""Particles of a wall on radial rows, in layers: numbering, cells, discretisation schemes."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class WallScheme(NamedTuple):
    """Discretisation of a wall: kernels, pressure, integration and contact points.

    Attributes
    ----------
    support : float or pair of float
        Of round kernels over the sides of the cells, or of product kernels around and across the wall.
    basis_order : int
        1 (linear) or 2 (quadratic).
    n_gauss : int or pair of int
        Gauss points of a cell in both directions, or around and across the wall.
    pressure : {"cell", "wall"}
        One value in every cell, or continuous and piecewise linear across the wall.
    contact_points : {"particles", "edges"}
        Contact at the particles, or in the middle of every straight edge between two of them.
    """

    support: float | tuple[float, float]
    basis_order: int
    n_gauss: int | tuple[int, int]
    pressure: str
    contact_points: str


WALL_SCHEMES = {
    "paper": WallScheme(2.0, 1, 2, "cell", "particles"),
    "engineering": WallScheme((2.0, 3.15), 2, 2, "wall", "edges"),
    "fine": WallScheme((1.8, 4.0), 2, (2, 3), "wall", "edges"),
}
"""By the name of the accuracy (page on accuracy)."""


@dataclass(frozen=True)
class WallGrid:
    """Rays × layers of particles across a wall, numbered ray by ray from the inner boundary.

    Attributes
    ----------
    rays, layers : int
        Particles around and across the wall. The first ray points straight down.
    """

    rays: int
    layers: int

    @property
    def angles(self) -> np.ndarray:
        """Angles of the rays from straight down, counter-clockwise, shape (rays,)."""
        return 2 * np.pi * np.arange(self.rays) / self.rays

    @property
    def directions(self) -> np.ndarray:
        """Unit vectors along the rays, shape (rays, 2)."""
        return ray_directions(self.angles)

    @property
    def fractions(self) -> np.ndarray:
        """Isoparametric coordinate across the wall of every layer, 0 inner, 1 outer."""
        return np.linspace(0.0, 1.0, self.layers)

    def particle(self, ray, layer) -> np.ndarray:
        """Particle number of a ray (any integer, periodic) and layer."""
        return (np.asarray(ray) % self.rays) * self.layers + layer

    @property
    def cells(self) -> np.ndarray:
        """Background cells between neighbouring rays and layers, counter-clockwise, (n, 4)."""
        ray, layer = (
            a.ravel()
            for a in np.meshgrid(np.arange(self.rays), np.arange(self.layers - 1), indexing="ij")
        )
        corners = [(ray, layer), (ray, layer + 1), (ray + 1, layer + 1), (ray + 1, layer)]
        return np.column_stack([self.particle(r, k) for r, k in corners])

    def column(self, pressure: str) -> int:
        """Cells in succession through which a ``WallScheme.pressure`` is continuous."""
        return self.layers - 1 if pressure == "wall" else 1

    @staticmethod
    def along_cells(pair):
        """Of one number for both directions nothing changes; of two, around and across the wall, the
        order is that of the cells' directions, across first."""
        return pair if np.ndim(pair) == 0 else tuple(pair[::-1])


def ray_directions(angle: np.ndarray) -> np.ndarray:
    """Unit vectors along rays, shape (..., 2); angle 0 points straight down."""
    return np.stack([np.sin(angle), -np.cos(angle)], axis=-1)

"""Particles of a wall on rays, layer by layer across it: numbers and cells."""

from dataclasses import dataclass

import numpy as np

SUPPORTS = {"paper": 2.0, "engineering": (2.0, 3.15)}
"""Supports of a wall's particles over the sides of their cells by the name of the accuracy: of round
kernels, or of product kernels around and across the wall."""


@dataclass(frozen=True)
class WallGrid:
    """Rays x layers of particles across a wall, numbered ray by ray from the inner boundary.

    Attributes
    ----------
    rays, layers : int
        Particles around and across the wall. The first ray points straight down.
    """

    rays: int
    layers: int

    @property
    def angles(self) -> np.ndarray:
        """Of the rays, from straight down, counter-clockwise, shape (rays,)."""
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

    @staticmethod
    def along_cells(pair):
        """Of one number for both directions nothing changes; of two, around and across the wall, the
        order is that of the cells' directions, across first."""
        return pair if np.ndim(pair) == 0 else tuple(pair[::-1])


def ray_directions(angle: np.ndarray) -> np.ndarray:
    """Unit vectors along rays, shape (..., 2); angle 0 points straight down."""
    return np.stack([np.sin(angle), -np.cos(angle)], axis=-1)

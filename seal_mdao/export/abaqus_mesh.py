"""Quadratic triangles of a section for Abaqus, made from the background cells of a seal."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class QuadraticMesh:
    """Triangles of six nodes.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Particles first, then the middles of the sides, mm.
    triangles : ndarray of int, shape (m, 6)
        Corners counter-clockwise, then the middles of the sides 1-2, 2-3, 3-1.
    regions : ndarray of int, shape (m,)
        Index of the material of every triangle.
    """

    points: np.ndarray
    triangles: np.ndarray
    regions: np.ndarray

    @cached_property
    def _sides(self) -> dict:
        """Triangle, number of the side and middle node by the corners of every side, in order."""
        return {
            (int(own[side]), int(own[(side + 1) % 3])): (number, side, int(own[3 + side]))
            for number, own in enumerate(self.triangles)
            for side in range(3)
        }

    def nodes(self, sides: np.ndarray) -> np.ndarray:
        """List the nodes on sides of the boundary, given by their corners (k, 2), each once."""
        every = [node for a, b in sides.tolist() for node in (a, self._sides[a, b][2], b)]
        return np.array(list(dict.fromkeys(every)), int)

    def faces(self, sides: np.ndarray) -> list[tuple[int, int]]:
        """List triangle and side (0, 1, 2) of sides of the boundary, given by their corners (k, 2)."""
        return [self._sides[a, b][:2] for a, b in sides.tolist()]


def quadratic_mesh(points: np.ndarray, cells: np.ndarray, regions: np.ndarray) -> QuadraticMesh:
    """Divide cells into quadratic triangles with straight sides.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
    cells : ndarray of int, shape (c, 4)
        Corners counter-clockwise; a triangle repeats one.
    regions : ndarray of int, shape (c,)
    """
    corners, parts = [], []
    for cell, region in zip(cells.tolist(), regions.tolist(), strict=True):
        own = list(dict.fromkeys(cell))
        corners += [own] if len(own) == 3 else _halves(own, points)
        parts += [region] * (len(own) - 2)
    triangles, middles = np.array(corners, int), {}
    # one node in the middle of every side, shared by the triangles on both sides of it
    further = np.empty((len(triangles), 3), int)
    for number, own in enumerate(triangles.tolist()):
        for side in range(3):
            ends = tuple(sorted((own[side], own[(side + 1) % 3])))
            further[number, side] = middles.setdefault(ends, len(points) + len(middles))
    # x_ab = (x_a + x_b) / 2
    between = points[np.array(list(middles), int)].mean(axis=1)
    return QuadraticMesh(
        np.concatenate([points, between]), np.hstack([triangles, further]), np.array(parts, int)
    )


def _halves(corners: list, points: np.ndarray) -> list[list[int]]:
    """Divide a quadrilateral along its shorter diagonal."""
    a, b, c, d = corners
    if np.hypot(*(points[a] - points[c])) <= np.hypot(*(points[b] - points[d])):
        return [[a, b, c], [a, c, d]]
    return [[a, b, d], [b, c, d]]

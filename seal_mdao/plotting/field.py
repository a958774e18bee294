"""The meshless fields between the particles: deformed position and stress on a fine grid."""

from dataclasses import dataclass

import numpy as np
from matplotlib.tri import Triangulation

from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.rkpm.tables import build_table
from seal_mdao.seals.door.result import DoorSealResult
from seal_mdao.structure.particle_stress import deformation_gradients
from seal_mdao.terms.point_assembly import interpolate

ALONG, ACROSS = 5, 4
"""Intervals into which a background cell is divided along and across the wall."""


@dataclass(frozen=True, eq=False)
class FineGrid:
    """Points between the particles with the shape functions of one design.

    Attributes
    ----------
    shape : tuple of int
        Points around and across the wall.
    points : PointSet
        Bilinear in the corners of the background cells.
    table : ShapeTable
        Shape functions at the points.
    """

    shape: tuple
    points: PointSet
    table: object

    @property
    def triangles(self) -> np.ndarray:
        """Triangles between neighbouring points, shape (m, 3), counter-clockwise undeformed."""
        around, across = self.shape
        i, j = (a.ravel() for a in np.meshgrid(np.arange(around), np.arange(across - 1)))
        here, there = i * across + j, ((i + 1) % around) * across + j
        lower = np.column_stack([here, here + 1, there + 1])
        return np.vstack([lower, np.column_stack([here, there + 1, there])])


def _bilinear_points(rays: int, layers: int, along: int, across: int) -> tuple[tuple, PointSet]:
    """Corner particles and bilinear weights of a refined ring of ``rays`` x ``layers`` particles."""
    shape = (rays * along, (layers - 1) * across + 1)
    i, j = (a.ravel() for a in np.meshgrid(*map(np.arange, shape), indexing="ij"))
    ray, layer = i // along, np.minimum(j // across, layers - 2)
    s, t = i / along - ray, j / across - layer
    ahead = (ray + 1) % rays
    corners = np.column_stack(
        [ray * layers + layer, ray * layers + layer + 1, ahead * layers + layer,
         ahead * layers + layer + 1]
    )  # fmt: skip
    weights = np.column_stack([(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t])
    return shape, PointSet(corners, weights, 1)


def fine_grid(result: DoorSealResult, along: int = ALONG, across: int = ACROSS) -> FineGrid:
    """Shape functions of a result's design on a grid finer than its particles."""
    grid, disc = result.seal.grid, result.path.discretization
    shape, points = _bilinear_points(grid.rays, grid.layers, along, across)
    table = build_table(disc.cloud, points, disc.transformation).table
    return FineGrid(shape, points, table)


def undeformed(result: DoorSealResult, fine: FineGrid) -> np.ndarray:
    """Undeformed coordinates of the fine grid, shape (around, across, 2), mm."""
    return fine.points.at(result.particles).reshape(*fine.shape, 2)


def deformed(result: DoorSealResult, fine: FineGrid, step: int = -1) -> np.ndarray:
    """Deformed coordinates of the fine grid after a nominal step, (around, across, 2), mm."""
    u = np.empty((np.prod(fine.shape), 2))
    interpolate(fine.table, result.path.nominal_steps[step].d, u)
    return undeformed(result, fine) + u.reshape(*fine.shape, 2)


def von_mises(result: DoorSealResult, fine: FineGrid, step: int = -1) -> np.ndarray:
    """Von Mises stress on the fine grid after a nominal step, shape (around * across,), kPa."""
    f = deformation_gradients(fine.table, result.path.nominal_steps[step].d)
    return result.seal.material.von_mises((f[:, :4] ** 2).sum(axis=1), 1.0 + f[:, 4])[0]


def triangulation(coordinates: np.ndarray, fine: FineGrid) -> Triangulation:
    """Triangulation of the fine grid at the given coordinates (around, across, 2)."""
    x, y = coordinates.reshape(-1, 2).T
    return Triangulation(x, y, fine.triangles)

"""The fine grid of the report: rows around the ring of the door seal, as the page's script has them."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.rkpm.tables import PointTable, build_table
from seal_mdao.seals.result import SealResult


@dataclass(frozen=True, eq=False)
class RingGrid:
    """Points between the particles of a door seal, for the fields of ``plotting.field``.

    Attributes
    ----------
    shape : tuple of int
        Points around and across the wall.
    table : PointTable
        Bilinear in the corners of the background cells.
    """

    shape: tuple
    table: PointTable

    @property
    def points(self) -> PointSet:
        return self.table.points

    @property
    def region(self) -> np.ndarray:
        """One material."""
        return np.zeros(len(self.points.anchors), int)


def ring_grid(result: SealResult, along: int, across: int) -> RingGrid:
    """Shape functions of a door seal's design with ``along`` x ``across`` intervals in each cell."""
    grid, disc = result.seal.grid, result.path.discretization
    shape, points = _bilinear_points(grid.rays, grid.layers, along, across)
    return RingGrid(shape, build_table(disc.cloud, points, disc.transformation))


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

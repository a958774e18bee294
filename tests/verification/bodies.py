"""Bodies of the benchmarks: mapped grids of particles with their background cells."""

from typing import NamedTuple

import numpy as np

from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.rkpm.cells import kernel_supports
from seal_mdao.terms.points import MaterialPoints, boundary_particles, edge_points


class Grid(NamedTuple):
    """(nx + 1) x (ny + 1) particles of a mapped rectangle, numbered column by column from below.

    Attributes
    ----------
    nx, ny : int
        Background cells along the first and the second direction.
    """

    nx: int
    ny: int

    @property
    def n_particles(self) -> int:
        return (self.nx + 1) * (self.ny + 1)

    def particle(self, i, j) -> np.ndarray:
        """Particle number of column ``i`` and row ``j``."""
        return np.asarray(i) * (self.ny + 1) + j

    @property
    def reference(self) -> np.ndarray:
        """Places on the unit square, shape (n, 2)."""
        i, j = np.divmod(np.arange(self.n_particles), self.ny + 1)
        return np.column_stack([i / self.nx, j / self.ny])

    @property
    def cells(self) -> np.ndarray:
        """Corners counter-clockwise, shape (nx ny, 4)."""
        i, j = (a.ravel() for a in np.mgrid[: self.nx, : self.ny])
        corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
        return np.column_stack([self.particle(a, b) for a, b in corners])

    @property
    def left(self) -> np.ndarray:
        return self.particle(0, np.arange(self.ny + 1))

    @property
    def right(self) -> np.ndarray:
        return self.particle(self.nx, np.arange(self.ny + 1))

    @property
    def bottom(self) -> np.ndarray:
        return self.particle(np.arange(self.nx + 1), 0)

    @property
    def top(self) -> np.ndarray:
        return self.particle(np.arange(self.nx + 1), self.ny)

    @property
    def boundary(self) -> np.ndarray:
        """All particles on the boundary, sorted."""
        return np.unique(np.concatenate([self.left, self.right, self.bottom, self.top]))


def row_gauss_points(row: np.ndarray, n_gauss: int) -> MaterialPoints:
    """Gauss points of the edges between consecutive particles of a boundary row."""
    return edge_points(Edge(row, False).sides, n_gauss)


def fixed_components(n: int, x=(), y=()) -> np.ndarray:
    """Mask (n, 2) of imposed components: particles ``x`` horizontally, ``y`` vertically."""
    fixed = np.zeros((n, 2), bool)
    fixed[np.asarray(x, int), 0] = True
    fixed[np.asarray(y, int), 1] = True
    return fixed


def grid_body(grid: Grid, particles: np.ndarray, fixed: np.ndarray, support=2.0, **options) -> Body:
    """A body on ``grid``; ``support`` is the kernel radius over the longest edge at a particle.

    Two of them are the half-widths of product kernels along the first and the second direction.
    """
    radius, axes = kernel_supports(grid.cells, particles, support)
    return Body(grid.cells, radius, fixed, support_axes=axes, **options)


def row_points(row: np.ndarray, n_ends: int = 0) -> MaterialPoints:
    """Boundary particles in a row, with half the edges at each; the first and last ``n_ends`` are
    neighbours only.

    The end particles of the row have one edge only, so it counts once.
    """
    inside = slice(n_ends, len(row) - n_ends)
    return boundary_particles(row[inside], Edge(row, False).neighbours[inside])


def scattered(grid: Grid, share: float, seed: int) -> np.ndarray:
    """Unit-square particles moved by up to ``share`` of the spacing; boundaries stay straight."""
    h = 1.0 / np.array([grid.nx, grid.ny])
    shift = np.random.default_rng(seed).uniform(-share, share, (grid.n_particles, 2)) * h
    shift[np.concatenate([grid.left, grid.right]), 0] = 0.0
    shift[np.concatenate([grid.bottom, grid.top]), 1] = 0.0
    return grid.reference + shift

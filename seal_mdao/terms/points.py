"""Material points of a boundary at which terms act, with the lengths they stand for."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.rkpm.averages import EdgeAverages
from seal_mdao.rkpm.scatter import scatter_add
from seal_mdao.rkpm.shape_functions import PointSet

CONTACT_POINTS = ("particles", "edges", "averages")
"""Where a body may be touched: at its particles, in the middle of the edges between two of them, or at
particles that move as the mean of the edges beside them."""


@dataclass(frozen=True, eq=False)
class MaterialPoints:
    """Points that move with the particles, and the measure (length, ...) that each stands for.

    Attributes
    ----------
    points : PointSet
        One point a group.
    fixed : ndarray, shape (k,)
        The part of the measure that no design changes.
    edges : ndarray of int, shape (k, e, 2)
        Particles at the ends of the boundary edges that belong to a point.
    fractions : ndarray, shape (k, e)
        Share of the length of each edge.
    averages : EdgeAverages or None
        Means over the edges beside the points, by which they move in place of their own.
    """

    points: PointSet
    fixed: np.ndarray
    edges: np.ndarray
    fractions: np.ndarray
    averages: EdgeAverages | None = None

    def __len__(self) -> int:
        return len(self.fixed)

    @property
    def moving(self) -> PointSet | EdgeAverages:
        """What moves: the points, or the means over the edges beside them."""
        return self.points if self.averages is None else self.averages

    @property
    def at_particles(self) -> np.ndarray:
        """The particle at every point, shape (k,).

        Raises
        ------
        ValueError
            Where points lie between particles, or move as the mean of the edges there.
        """
        if self.averages is not None or self.points.anchors.shape[1] != 1:
            raise ValueError(
                "these points lie between particles, or move as the mean of edges; the work of a "
                "profile that turns, trapped air, fluids and contact of the body with itself want "
                "contact at particles (Body.edge_points)"
            )
        return self.points.anchors[:, 0]

    def mean_at_particles(self, values: np.ndarray, n_particles: int) -> np.ndarray:
        """At every particle the mean of the ``values`` (k,) of the points beside it, zero elsewhere."""
        anchors, weights = self.points.anchors.ravel(), self.points.weights
        # sum of weight v over sum of weight
        total = np.bincount(anchors, weights.ravel(), n_particles)
        summed = np.bincount(anchors, (weights * values[:, None]).ravel(), n_particles)
        return summed / np.where(total > 0.0, total, 1.0)

    def lengths(self, particles: np.ndarray) -> np.ndarray:
        """Measure of every point, shape (k,)."""
        # l = sum_e fraction |X_b - X_a|
        edge = particles[self.edges[..., 1]] - particles[self.edges[..., 0]]
        return self.fixed + (self.fractions * np.hypot(edge[..., 0], edge[..., 1])).sum(axis=1)

    def _pulls(self, particles) -> np.ndarray:
        """d(measure) / d(second end of an edge), shape (k, e, 2)."""
        edge = particles[self.edges[..., 1]] - particles[self.edges[..., 0]]
        # dl/dX_b = fraction (X_b - X_a) / |X_b - X_a|
        size = np.linalg.norm(edge, axis=2, keepdims=True)
        return self.fractions[..., None] * edge / np.where(size > 0.0, size, 1.0)

    def length_rates(self, particles: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Rates along design velocities (P, n, 2), shape (k, P)."""
        # l' = dl/dX_b . (V_b - V_a)
        motion = velocity[:, self.edges[..., 1]] - velocity[:, self.edges[..., 0]]
        return np.einsum("kei,pkei->kp", self._pulls(particles), motion)

    def add_length_seeds(self, particles, length_bar, x_bar) -> None:
        """Transpose of ``length_rates``: seeds (k, M) added to ``x_bar`` (n, 2, M)."""
        # X_b_bar += dl/dX_b l_bar,  X_a_bar -= the same
        pull = self._pulls(particles)[..., None] * length_bar[:, None, None]
        scatter_add(x_bar, self.edges[..., 1], pull)
        scatter_add(x_bar, self.edges[..., 0], -pull)


def single_points(which: np.ndarray) -> PointSet:
    """Point set of the particles ``which`` themselves, one a group."""
    which = np.asarray(which, int).reshape(-1, 1)
    return PointSet(which, np.ones(which.shape), 1)


def boundary_particles(which: np.ndarray, neighbours: np.ndarray) -> MaterialPoints:
    """Boundary particles with half the length of the edges at each.

    Parameters
    ----------
    which : ndarray of int, shape (k,)
    neighbours : ndarray of int, shape (k, 2)
        The particles before and after along the boundary; the particle itself where there is none.
    """
    which, neighbours = np.asarray(which, int), np.asarray(neighbours, int)
    edges = np.stack([np.broadcast_to(which[:, None], neighbours.shape), neighbours], axis=2)
    return MaterialPoints(
        single_points(which), np.zeros(len(which)), edges, np.full(neighbours.shape, 0.5)
    )


def edge_points(edges: np.ndarray, n_gauss: int = 3) -> MaterialPoints:
    """Gauss points of straight boundary edges (m, 2), with their weights times the edges' lengths."""
    g, w = np.polynomial.legendre.leggauss(n_gauss)
    # X = (1 - g)/2 X_a + (1 + g)/2 X_b, length w/2 |X_b - X_a|
    between = np.column_stack([0.5 * (1 - g), 0.5 * (1 + g)])
    anchors = np.repeat(np.asarray(edges, int), n_gauss, axis=0)
    return MaterialPoints(
        PointSet(anchors, np.tile(between, (len(edges), 1)), 1), np.zeros(len(anchors)),
        anchors[:, None], np.tile(0.5 * w, len(edges))[:, None],
    )  # fmt: skip


def fixed_points(points: PointSet, measure: np.ndarray) -> MaterialPoints:
    """Points whose measure no design changes, one a group."""
    k = len(points.anchors)
    return MaterialPoints(
        PointSet(points.anchors, points.weights, 1), np.broadcast_to(measure, (k,)).astype(float),
        np.empty((k, 0, 2), int), np.empty((k, 0)),
    )  # fmt: skip

"""Material points of a boundary at which terms act, with their tributary lengths."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.rkpm.averages import EdgeAverages
from seal_mdao.rkpm.axisymmetry import add_circumference_seeds, edge_circumferences
from seal_mdao.rkpm.scatter import scatter_add
from seal_mdao.rkpm.shape_functions import PointSet

CONTACT_POINTS = ("particles", "edges", "averages")
"""Where a body may be touched: at its particles, in the middle of the edges between two of them, or at
particles that move as the mean of the edges beside them."""


@dataclass(frozen=True, eq=False)
class MaterialPoints:
    """Points that move with the particles, and the measure (length, ...) that each represents.

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
    radial : ndarray, shape (k, e, 2), or None
        In a body of revolution, weights of both ends of an edge in the radius at which its share is
        turned about the axis; None in plane strain.
    """

    points: PointSet
    fixed: np.ndarray
    edges: np.ndarray
    fractions: np.ndarray
    averages: EdgeAverages | None = None
    radial: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.fixed)

    @property
    def moving(self) -> PointSet | EdgeAverages:
        """What moves: the points, or the means over the edges beside them."""
        return self.points if self.averages is None else self.averages

    @property
    def at_particles(self) -> np.ndarray:
        """Particle at every point, shape (k,).

        Raises
        ------
        ValueError
            Where points lie between particles, or move as the mean of the edges there.
        """
        if self.averages is not None or self.points.anchors.shape[1] != 1:
            raise ValueError(
                "contact points between particles, or averaged over edges, are not supported for "
                "the work of a rotating profile, trapped air and fluids; use contact points at the "
                "particles (Body.edge_points)"
            )
        return self.points.anchors[:, 0]

    @property
    def of_particles(self) -> np.ndarray:
        """Particle of every point that is not between particles, shape (k,): where it is, or whose
        edges it is the mean of; the same one for two points at a sharp corner."""
        return self.points.anchors[:, 0]

    def mean_at_particles(self, values: np.ndarray, n_particles: int) -> np.ndarray:
        """At every particle the mean of the ``values`` (k,) of the points beside it, the larger one of
        two points at a sharp corner, zero elsewhere."""
        anchors, weights = self.points.anchors.ravel(), self.points.weights
        if self.points.anchors.shape[1] == 1:
            largest = np.full(n_particles, -np.inf)
            np.maximum.at(largest, anchors, values)
            return np.where(largest > -np.inf, largest, 0.0)
        # sum of weight v over sum of weight
        total = np.bincount(anchors, weights.ravel(), n_particles)
        summed = np.bincount(anchors, (weights * values[:, None]).ravel(), n_particles)
        return summed / np.where(total > 0.0, total, 1.0)

    def lengths(self, particles: np.ndarray) -> np.ndarray:
        """Tributary length of each point along the section, shape (k,)."""
        # l = sum_e fraction |X_b - X_a|
        return self.fixed + self._edge_lengths(particles).sum(axis=1)

    def measures(self, particles: np.ndarray) -> np.ndarray:
        """Tributary length of each point; in a body of revolution the area per mm of section, mm m,
        shape (k,)."""
        if self.radial is None:
            return self.lengths(particles)
        # sum_e fraction |X_b - X_a| c_e,  c = 2 pi R
        return (self._edge_lengths(particles) * self._circumferences(particles)).sum(axis=1)

    def _edge_lengths(self, particles) -> np.ndarray:
        """Share of the length of every edge, shape (k, e)."""
        edge = particles[self.edges[..., 1]] - particles[self.edges[..., 0]]
        return self.fractions * np.hypot(edge[..., 0], edge[..., 1])

    def _circumferences(self, vectors) -> np.ndarray:
        """c = 2 pi R of every edge, m, of particles or velocities (..., n, 2), shape (..., k, e)."""
        return edge_circumferences(self.edges, self.radial, vectors)

    def _pulls(self, particles) -> np.ndarray:
        """d(length) / d(second end of an edge), shape (k, e, 2)."""
        edge = particles[self.edges[..., 1]] - particles[self.edges[..., 0]]
        # dl/dX_b = fraction (X_b - X_a) / |X_b - X_a|
        size = np.linalg.norm(edge, axis=2, keepdims=True)
        return self.fractions[..., None] * edge / np.where(size > 0.0, size, 1.0)

    def measure_rates(self, particles: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Rates of ``measures`` along design velocities (P, n, 2), shape (k, P)."""
        motion = velocity[:, self.edges[..., 1]] - velocity[:, self.edges[..., 0]]
        pulls = self._pulls(particles)
        if self.radial is None:
            # l' = dl/dX_b . (V_b - V_a)
            return np.einsum("kei,pkei->kp", pulls, motion)
        # (c l)' = c l' + c' l, c being linear in the particles
        pulls = pulls * self._circumferences(particles)[..., None]
        around = self._circumferences(velocity) * self._edge_lengths(particles)
        return np.einsum("kei,pkei->kp", pulls, motion) + around.sum(axis=-1).T

    def add_measure_seeds(self, particles, measure_bar, x_bar) -> None:
        """Transpose of ``measure_rates``: seeds (k, M) added to ``x_bar`` (n, 2, M)."""
        pulls = self._pulls(particles)
        if self.radial is not None:
            pulls = pulls * self._circumferences(particles)[..., None]
            # c_bar = l (c l)_bar
            on_around = self._edge_lengths(particles)[..., None] * measure_bar[:, None]
            add_circumference_seeds(self.edges, self.radial, on_around, x_bar)
        # X_b_bar += dl/dX_b l_bar,  X_a_bar -= the same
        pull = pulls[..., None] * measure_bar[:, None, None]
        scatter_add(x_bar, self.edges[..., 1], pull)
        scatter_add(x_bar, self.edges[..., 0], -pull)

    def add_length_seeds(self, particles, length_bar, x_bar) -> None:
        """Transpose of the rates of ``lengths``: seeds (k, M) added to ``x_bar`` (n, 2, M)."""
        replace(self, radial=None).add_measure_seeds(particles, length_bar, x_bar)

    def around_axis(self) -> "MaterialPoints":
        """The points on a body of revolution: shares of edges are turned about the axis.

        The share that a point has of an edge is that of the linear function of its particle, so that
        its radius is int R N ds / int N ds = 2/3 R_a + 1/3 R_b; at a point between the particles it is
        the radius of the point.
        """
        anchors, weights = self.points.anchors, self.points.weights
        if anchors.shape[1] == 1:
            own = self.edges == anchors[:, :, None]
            radial = np.where(own, 2.0, 1.0) / 3.0
        else:
            radial = weights[:, None]
        return replace(self, radial=radial)


def single_points(which: np.ndarray) -> PointSet:
    """Create points at the particles ``which``, one a group."""
    which = np.asarray(which, int).reshape(-1, 1)
    return PointSet(which, np.ones(which.shape), 1)


def boundary_particles(which: np.ndarray, neighbours: np.ndarray) -> MaterialPoints:
    """Create points at boundary particles, with half the length of the adjacent edges.

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
    """Create Gauss points of straight boundary edges (m, 2), with weights times edge lengths."""
    g, w = np.polynomial.legendre.leggauss(n_gauss)
    # X = (1 - g)/2 X_a + (1 + g)/2 X_b, length w/2 |X_b - X_a|
    between = np.column_stack([0.5 * (1 - g), 0.5 * (1 + g)])
    anchors = np.repeat(np.asarray(edges, int), n_gauss, axis=0)
    return MaterialPoints(
        PointSet(anchors, np.tile(between, (len(edges), 1)), 1), np.zeros(len(anchors)),
        anchors[:, None], np.tile(0.5 * w, len(edges))[:, None],
    )  # fmt: skip


def fixed_points(points: PointSet, measure: np.ndarray) -> MaterialPoints:
    """Create points whose measure does not depend on the design, one a group."""
    k = len(points.anchors)
    return MaterialPoints(
        PointSet(points.anchors, points.weights, 1), np.broadcast_to(measure, (k,)).astype(float),
        np.empty((k, 0, 2), int), np.empty((k, 0)),
    )  # fmt: skip

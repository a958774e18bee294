"""Reproducing kernel shape functions Phi_I(x) and their gradients, Eqs. (10)-(13).

Arrays are ragged and flat. Points come in groups that share one list of neighbours (the quadrature
points of a background cell, or a single particle). With ``n`` neighbours and ``q`` points a group,

    phi  is stored as (group, point, neighbour),
    grad is stored as (group, point, component, neighbour),

the neighbour running fastest. That order is kept everywhere in the package.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, inlined
from seal_mdao.rkpm.moment import (
    clear_hidden,
    correction_polynomials,
    gathered,
    invert_moment,
    moment_matrices,
    n_monomials,
    neighbour_terms,
    polynomial_value,
)
from seal_mdao.rkpm.scatter import scatter_add

NOTHING_HIDDEN = np.empty((0, 2), int)
NO_INTERFACE = np.empty((0, 0), bool)


class Cloud(NamedTuple):
    """Particles of one design with their kernels.

    Attributes
    ----------
    particles : ndarray, shape (n_particles, 2)
        Undeformed coordinates X_I (the kernel is Lagrangian).
    radius : ndarray, shape (n_particles,)
        Support radius a of every particle, decided once for the nominal body; of product kernels the
        radius of the circle around the support.
    scale : float
        Length that makes the monomials dimensionless.
    n_basis : int
        3 for the linear, 6 for the quadratic basis.
    hidden_pairs : ndarray of int, shape (m, 2)
        Pairs of particles that are not visible from each other, see ``visibility``.
    in_parts : ndarray of bool, shape (n_particles, n_parts), or empty
        Parts that every particle is in; empty for a single one. Particles in several are on interfaces,
        along which displacements are linear from one to the next.
    axes : ndarray, shape (n_particles, 2, 2), or None for round kernels
        Rows: inverse half-widths of every particle's product kernel along its two directions.
    """

    particles: np.ndarray
    radius: np.ndarray
    scale: float
    n_basis: int
    hidden_pairs: np.ndarray = NOTHING_HIDDEN
    in_parts: np.ndarray = NO_INTERFACE
    axes: np.ndarray | None = None


class PointSet(NamedTuple):
    """Points that move with the particles: x = sum_k weights[:, k] X[anchors[:, k]].

    Attributes
    ----------
    anchors : ndarray of int, shape (n_points, k)
    weights : ndarray, shape (n_points, k)
    group_size : int
        Points in a group; consecutive points share one neighbour list.
    valued, sloped : bool
        Whether values, and whether gradients are tabulated; arrays not needed are empty.
    hooped : bool
        Whether the gradients have the third row of a body of revolution.
    ends : int or None
        Number of anchors, the first ones, between which a point lies, where others bend its edge; None
        for all. A point sees the particles that these see.
    parts : ndarray of int, shape (n_points,), or None
        Part that every point belongs to, of whose particles alone its shape functions are; None for
        points that belong to all parts of their anchors.
    """

    anchors: np.ndarray
    weights: np.ndarray
    group_size: int
    valued: bool = True
    sloped: bool = True
    hooped: bool = False
    ends: int | None = None
    parts: np.ndarray | None = None

    def at(self, particles):
        """Compute coordinates of the points, shape (n_points, 2), length unit of ``particles``."""
        # x = sum_k w_k X_k, of any field (n, ...) at the particles
        return np.einsum("pk,pk...->p...", self.weights, particles[self.anchors])

    def rates(self, particles, velocity) -> np.ndarray:
        """Differentiate the coordinates along design velocities (P, n, 2), shape (n_points, 2, P)."""
        # V = sum_k w_k V_k, wherever the particles are
        at = np.einsum("pk,vpki->piv", self.weights, velocity[:, self.anchors])
        return np.ascontiguousarray(at)

    def add_seeds(self, particles, point_bar, x_bar) -> None:
        """Transpose of ``rates``: seeds (n_points, 2, M) added to ``x_bar`` (n, 2, M)."""
        for k in range(self.anchors.shape[1]):
            # X_k_bar += w_k x_bar
            weighted = point_bar * self.weights[:, k, None, None]
            scatter_add(x_bar, self.anchors[:, k], weighted)


class ShapeTable(NamedTuple):
    """Shape functions of all groups of a point set.

    Attributes
    ----------
    start : ndarray of int, shape (n_groups + 1,)
        ``neighbours[start[g]:start[g + 1]]`` are the particles that group g sees.
    neighbours : ndarray of int
    phi : ndarray
        Flat (group, point, neighbour), dimensionless.
    grad : ndarray
        Flat (group, point, component, neighbour), per length; in a body of revolution with Phi / R as a
        third component (``axisymmetry``). Arrays that are not needed are empty.
    group_size : int
    """

    start: np.ndarray
    neighbours: np.ndarray
    phi: np.ndarray
    grad: np.ndarray
    group_size: int

    @property
    def n_groups(self):
        return self.start.size - 1


@inlined
def grad_rows(table):
    """Rows of ``grad`` of a point: 2, or 3 with the hoop row of a body of revolution."""
    return table.grad.size // max(1, table.neighbours.size * table.group_size)


@compiled
def evaluate_shape_functions(cloud, points, start, neighbours, hidden, phi, grad, inverses):
    """Evaluate shape functions and gradients at all points, Eqs. (10)-(13) with unit weights.

    ``hidden``, flat (group, point, neighbour) or empty, marks neighbours of the group that a point does
    not see. Fills ``phi`` and ``grad``, where they are not empty, and M^-1 of every point, ``inverses``
    (n_points, m, m); returns the first point with a singular moment matrix, or -1."""
    m, rows = cloud.n_basis, 3 if grad.size > 0 else 1
    n_groups = start.size - 1
    group_size = points.shape[0] // n_groups
    moments, b = np.empty((rows, m, m)), np.empty((rows, m))
    for g in range(n_groups):
        s0, n = start[g], start[g + 1] - start[g]
        near = gathered(cloud.particles, cloud.radius, cloud.axes, neighbours[s0 : s0 + n])
        h, k = np.empty((n_monomials(m), n)), np.empty((6, n))
        for q in range(group_size):
            point = g * group_size + q
            inverse, at = inverses[point], s0 * group_size + q * n
            # H(x - X_I), phi_a(x - X_I) with derivatives
            neighbour_terms(points[point], near, cloud.axes, cloud.scale, h, k)
            clear_hidden(hidden, at, k)
            # M, M_,x, M_,y   Eq. (8)
            moment_matrices(h, k, cloud.scale, moments)
            if not invert_moment(moments[0], inverse):
                return point
            # C(x; x - X_I) = H(0)^T M^-1 H(x - X_I)   Eq. (10), and its gradient
            correction_polynomials(moments, inverse, cloud.scale, b)
            for i in range(n):
                p = polynomial_value(b, 0, h, i)
                if phi.size > 0:
                    # Phi_I = C phi_a, so z^R = sum_I Phi_I d_I   Eq. (13): the integral (11) as the sum
                    # (12) over particles with Delta x_I = 1, here and in M
                    phi[at + i] = p * k[0, i]
                for j in range(1, rows):
                    p_j = polynomial_value(b, j, h, i)
                    # Phi_I,j = C_,j phi_a + C phi_a,j
                    grad[2 * at + (j - 1) * n + i] = p_j * k[0, i] + p * k[j, i]
    return -1

"""Reproducing kernel shape functions Phi_I(x) and their gradients, Eqs. (10)-(13).

Arrays are ragged and flat. Points come in groups that share one list of neighbours (the quadrature
points of a background cell, or a single particle). With ``n`` neighbours and ``q`` points a group,

    phi  is stored as (group, point, neighbour),
    grad is stored as (group, point, component, neighbour),

the neighbour running fastest. That order is kept everywhere in the package.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled
from seal_mdao.rkpm.moment import (
    correction_polynomials,
    gathered,
    invert_moment,
    moment_matrices,
    n_monomials,
    neighbour_terms,
    polynomial_value,
)

NOTHING_HIDDEN = np.empty((0, 2), int)


class Cloud(NamedTuple):
    """Particles of one design with their kernels.

    Attributes
    ----------
    particles : ndarray, shape (n_particles, 2)
        Undeformed coordinates X_I (the kernel is Lagrangian).
    radius : ndarray, shape (n_particles,)
        Support radius a of every particle, decided once for the drawn body; of product kernels the
        radius of the circle around the support.
    scale : float
        Length that makes the monomials dimensionless.
    n_basis : int
        3 for the linear, 6 for the quadratic basis.
    hidden : ndarray of int, shape (m, 2)
        Particles, and those near enough for their supports that they do not see, see ``visibility``.
    axes : ndarray, shape (n_particles, 2, 2), or None for round kernels
        Rows: inverse half-widths of every particle's product kernel along its two directions.
    """

    particles: np.ndarray
    radius: np.ndarray
    scale: float
    n_basis: int
    hidden: np.ndarray = NOTHING_HIDDEN
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
        Whether the values, and whether the gradients are used; what is not has no entries in tables.
    """

    anchors: np.ndarray
    weights: np.ndarray
    group_size: int
    valued: bool = True
    sloped: bool = True

    def at(self, particles):
        """Coordinates of the points, shape (n_points, 2), length unit of ``particles``."""
        return np.einsum("pk,pki->pi", self.weights, particles[self.anchors])


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
        Flat (group, point, component, neighbour), per length. What a table is not asked for has no
        entries.
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


@compiled
def evaluate_shape_functions(cloud, points, start, neighbours, phi, grad, inverses):
    """Fill ``phi`` and ``grad``, those that have entries, and M^-1 of every point, ``inverses``
    (n_points, m, m); return the first point with a singular moment matrix, or -1."""
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
            inverse = inverses[point]
            neighbour_terms(points[point], near, cloud.axes, cloud.scale, h, k)
            moment_matrices(h, k, cloud.scale, moments)
            if not invert_moment(moments[0], inverse):
                return point
            correction_polynomials(moments, inverse, cloud.scale, b)
            at = s0 * group_size + q * n
            for i in range(n):
                p = polynomial_value(b, 0, h, i)
                if phi.size > 0:
                    phi[at + i] = p * k[0, i]
                for j in range(1, rows):
                    p_j = polynomial_value(b, j, h, i)
                    grad[2 * at + (j - 1) * n + i] = p_j * k[0, i] + p * k[j, i]
    return -1

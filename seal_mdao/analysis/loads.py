"""Generalised forces: dead loads from tractions and body forces, and reactions of a body.

Forces are conjugate to the coefficients d after the essential transformation: at a constrained
particle, where the shape functions interpolate, they are physical forces per unit depth.
"""

import numpy as np

from seal_mdao.analysis.body import Discretization
from seal_mdao.analysis.equations import Scatter
from seal_mdao.analysis.internal_force import assemble_internal
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.rkpm.tables import build_table


def point_loads(discretization: Discretization, points: PointSet, forces: np.ndarray) -> np.ndarray:
    """Generalised forces of concentrated loads, sum_p Phi_I(X_p) f_p, shape (n, 2).

    Parameters
    ----------
    points : PointSet
        Where the loads act.
    forces : ndarray, shape (n_points, 2)
        Force per unit depth at each point (traction times length, body force times area).
    """
    built = build_table(discretization.cloud, points, discretization.transformation)
    table = built.table
    group = np.repeat(np.arange(table.n_groups), np.diff(table.start))
    out = np.zeros_like(discretization.particles)
    for g in range(points.group_size):
        # entries of point g of every group
        offset = np.arange(table.neighbours.size) - table.start[group]
        n = np.diff(table.start)[group]
        at = table.start[group] * points.group_size + g * n + offset
        np.add.at(
            out,
            table.neighbours,
            table.phi[at, None] * forces[group * points.group_size + g],
        )
    return out


def edge_points(edges: np.ndarray, particles: np.ndarray, n_gauss: int = 3):
    """Gauss points of straight boundary edges, and their lengths.

    Parameters
    ----------
    edges : ndarray of int, shape (m, 2)
        Particles at the two ends of every edge.

    Returns
    -------
    points : PointSet
    lengths : ndarray, shape (m * n_gauss,)
        Quadrature weight of every point.
    """
    g, w = np.polynomial.legendre.leggauss(n_gauss)
    weights = np.column_stack([0.5 * (1 - g), 0.5 * (1 + g)])
    size = np.linalg.norm(np.diff(particles[edges], axis=1)[:, 0], axis=1)
    points = PointSet(np.repeat(edges, n_gauss, axis=0), np.tile(weights, (len(edges), 1)), n_gauss)
    return points, np.outer(0.5 * size, w).ravel()


def internal_forces(
    discretization: Discretization, material: MooneyRivlin, d: np.ndarray
) -> np.ndarray:
    """Internal forces of all components, imposed ones included, shape (n, 2), N/m.

    At an imposed component of a converged step this is the force that holds it there.
    """
    n = len(discretization.particles)
    every = Scatter(np.arange(2 * n).reshape(n, 2), np.empty(0, int), np.empty(0, np.int32))
    force = np.zeros(2 * n + 1)
    constants = (material.c10, material.c01, material.bulk_modulus)
    bad = assemble_internal(
        discretization.cells.table, discretization.weights, constants, d, every, force, np.empty(0)
    )
    if bad >= 0:
        raise ValueError(f"background cell {bad} is turned inside out at these displacements")
    return force[:-1].reshape(n, 2)

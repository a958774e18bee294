"""Approximation by the shape functions alone: errors of the reproducing kernel interpolant."""

import numpy as np

from seal_mdao.rkpm.basis import BASIS_SIZE
from seal_mdao.rkpm.cells import cell_map, quadrature_points, quadrature_weights, support_radii
from seal_mdao.rkpm.shape_functions import Cloud
from verification.bodies import Grid, scattered
from verification.fields import values_at
from verification.manufactured import (
    Convergence,
    displacement,
    displacement_gradient,
)


def interpolation_error(n: int, basis_order: int, seed: int = 1) -> tuple[float, float]:
    """L2 and H1 errors of sum_I Phi_I(x) u(X_I) on an irregular cloud of ``n`` x ``n`` cells."""
    grid = Grid(n, n)
    X = scattered(grid, 0.3, seed)
    radius = support_radii(grid.cells, X, 2.0 if basis_order == 1 else 2.5)
    cloud = Cloud(X, radius, float(radius.max()), BASIS_SIZE[basis_order])
    mapping = cell_map(grid.cells, 4)
    points, w = quadrature_points(mapping), quadrature_weights(mapping, X).ravel()
    value, slope = values_at(cloud, points._replace(group_size=1), displacement(X))
    value = value - displacement(points.at(X))
    slope = slope - displacement_gradient(points.at(X))
    return np.sqrt(w @ (value**2).sum(axis=1)), np.sqrt(w @ (slope**2).sum(axis=(1, 2)))


def interpolation_convergence(basis_order: int = 1, cells=(8, 16, 32, 64)) -> Convergence:
    """Errors of the interpolant of a smooth function; exact: O(h^(p+1)) in L2, O(h^p) in H1.

    W. K. Liu, S. Li and T. Belytschko, Comput. Methods Appl. Mech. Engrg. 143 (1997) 113, for the
    order of reproducing kernel interpolation with a basis complete to degree p.
    """
    l2, h1 = np.array([interpolation_error(n, basis_order) for n in cells]).T
    return Convergence(1.0 / np.array(cells), l2, h1)

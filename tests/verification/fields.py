"""Fields of a solved body: values and gradients at arbitrary points, stresses."""

import numpy as np

from seal_mdao.analysis.path_result import ConvergedStep, PathResult
from seal_mdao.equilibrium.discretization import Discretization
from seal_mdao.materials.isotropic import cofactor
from seal_mdao.rkpm.cells import cell_map, quadrature_points, quadrature_weights
from seal_mdao.rkpm.shape_functions import Cloud, PointSet
from seal_mdao.rkpm.tables import build_table
from seal_mdao.structure.particle_stress import deformation_gradients
from seal_mdao.terms.point_assembly import interpolate


def domain_rule(body, particles: np.ndarray, n_gauss: int) -> tuple[PointSet, np.ndarray]:
    """Gauss points of all cells, one a group, and their weights, whatever the body integrates with."""
    mapping = cell_map(body.cells, n_gauss)
    points = quadrature_points(mapping)._replace(group_size=1)
    return points, quadrature_weights(mapping, particles).ravel()


def values_at(cloud: Cloud, points: PointSet, d: np.ndarray, transformation=None):
    """Values (k, 2) and gradients (k, 2, 2) of coefficients ``d`` at points, one a group.

    The gradients are the shape functions' own, without the correction for consistent integration.
    """
    table = build_table(cloud, points, transformation).table
    value = np.empty((table.n_groups, 2))
    interpolate(table, d, value)
    f = deformation_gradients(table, d)[:, :4].reshape(-1, 2, 2)
    return value, f - np.eye(2)


def displacement_at(disc: Discretization, points: PointSet, d: np.ndarray):
    """Displacements and their gradients at points of a body, as ``values_at``."""
    return values_at(disc.cloud, points, d, disc.transformation)


def piola_stresses(path: PathResult, step: ConvergedStep) -> np.ndarray:
    """First Piola-Kirchhoff stress that the analysis integrates, shape (n_cells, q, 2, 2)."""
    structure = path.problem.term("structure")
    deformation = structure.deformation_of(step.d[None], [step.fraction])
    w_t, w_j = structure.energy_derivatives(deformation)[:2, 0, ..., None, None]
    pressure = structure.pressure(deformation)[0, ..., None, None]
    F = deformation.f[0, ..., :4].reshape(*w_t.shape[:2], 2, 2)
    stress = 2.0 * w_t * F + (w_j + pressure) * cofactor(F)
    return stress.reshape(*path.discretization.weights.shape, 2, 2)

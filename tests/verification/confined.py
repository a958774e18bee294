"""Stiffness of confined rubber under a uniform pressure, with the error of the integration."""

import numpy as np

from seal_mdao.analysis.problem import PathProblem
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from verification.bodies import Grid, fixed_components, grid_body, scattered

CELLS, STEP = 8, 1e-6
MATERIAL = MooneyRivlin(0.4, 0.1, 1e3)
"""Of shear modulus 1."""


def stiffness_under_pressure(n_gauss: int, pressure: float, axisymmetric: bool) -> float:
    """Smallest eigenvalue of the tangent of the inner particles under a pressure, in shear moduli, over
    the one without pressure.

    All particles of an uneven cloud are moved to x = lambda X, where the stress is the pressure alone; a
    solid cylinder, or a square in plane strain.
    """
    grid = Grid(CELLS, CELLS)
    X = scattered(grid, 0.2, 3)
    fixed = fixed_components(len(X), grid.boundary, grid.boundary)
    body = grid_body(grid, X, fixed, n_gauss=n_gauss, axisymmetric=axisymmetric)
    terms = (elastic_body(MATERIAL),)
    structure = PathProblem(discretize(body, X, terms), terms).terms[0]
    free = np.argwhere(~fixed)

    def smallest(p):
        # p = -K (J - 1)
        stretch = (1.0 - p / MATERIAL.bulk_modulus) ** (1.0 / (3 if axisymmetric else 2))
        tangent = np.empty((len(free), len(free)))
        for column, (particle, component) in zip(tangent.T, free, strict=True):
            d, ends = (stretch - 1.0) * X, []
            for sign in (1.0, -1.0):
                moved = d.copy()
                moved[particle, component] += sign * STEP
                ends.append(structure.forces(moved, 1.0)[~fixed])
            column[:] = (ends[0] - ends[1]) / (2.0 * STEP)
        return np.linalg.eigvalsh(0.5 * (tangent + tangent.T))[0]

    return smallest(pressure) / smallest(0.0)

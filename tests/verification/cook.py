"""Cook's membrane, nearly incompressible neo-Hookean rubber under a dead shear traction.

There is no closed form. The value compared with is the limit of a second discretisation of the same
problem, biquadratic elements with discontinuous linear pressure; the clamped corners are singular,
so that any uniform mesh converges slowly (observed order about one).
"""

import numpy as np

from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from verification.biquadratic import mapped_elements, solve_elements
from verification.bodies import (
    Grid,
    fixed_components,
    grid_body,
    row_gauss_points,
)
from verification.solving import ramp, solve, tight

# E = 240.565, nu = 0.4999 (J. C. Simo and F. Armero, Int. J. Numer. Meth. Engng 33 (1992) 1413):
# shear modulus 80.1938, bulk modulus 400 942; 100 in all on the right side; any stress unit
MATERIAL = MooneyRivlin(c10=0.5 * 80.1938, c01=0.0, bulk_modulus=400_942.0)
TRACTION = 100.0 / 16.0
# limit of ``cook_reference`` from 24, 48 and 96 cells a side (6.924757, 6.929514, 6.931864)
CONVERGED = 6.9342


def membrane(reference: np.ndarray) -> np.ndarray:
    """Unit square to the membrane (0, 0), (48, 44), (48, 60), (0, 44)."""
    s, t = reference.T
    return np.column_stack([48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s)])


def cook_deflection(cells: int = 16, material: MooneyRivlin = MATERIAL, n_steps: int = 5) -> float:
    """Vertical displacement of the upper right corner (48, 60), ``cells`` x ``cells`` cells."""
    grid = Grid(cells, cells)
    X = membrane(grid.reference)
    fixed = fixed_components(len(X), x=grid.left, y=grid.left)
    right = row_gauss_points(grid.right, 2)
    shear = DeadLoad("shear", right, np.array([0.0, TRACTION]), ramp(n_steps))
    terms = elastic_body(material), shear
    path = solve(grid_body(grid, X, fixed), X, terms, n_steps, options=tight(material))
    return float(path.displacement()[grid.top[-1], 1])


def cook_reference(cells: int = 16, material: MooneyRivlin = MATERIAL, n_steps: int = 4) -> float:
    """The same displacement from ``cells`` x ``cells`` biquadratic elements of ``biquadratic``."""
    mesh = mapped_elements(cells, cells, membrane)
    rows = 2 * cells + 1
    left, right = np.arange(rows), len(mesh.nodes) - rows + np.arange(rows)
    fixed = np.zeros((len(mesh.nodes), 2), bool)
    fixed[left] = True
    share = np.zeros(rows)
    for k, weight in enumerate((1.0, 4.0, 1.0)):
        np.add.at(share, 2 * np.arange(cells) + k, weight / (6.0 * cells))
    force = np.zeros_like(mesh.nodes)
    force[right, 1] = 16.0 * TRACTION * share
    return float(solve_elements(mesh, material, fixed, force, n_steps)[-1, 1])


def limit(coarse: float, middle: float, fine: float) -> float:
    """Aitken's extrapolation of three values on meshes of halved size."""
    return fine + (fine - middle) ** 2 / (2.0 * middle - coarse - fine)

"""Patch tests and homogeneous deformations: stresses that must come out exact to rounding."""

from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.body import discretize
from seal_mdao.analysis.loads import edge_points, internal_forces, point_loads
from seal_mdao.materials.mooney_rivlin import MooneyRivlin, cofactor
from seal_mdao.verification.bodies import Grid, edges_of, fixed_components, grid_body, scattered
from seal_mdao.verification.fields import piola_stresses
from seal_mdao.verification.solving import ramp, solve_free

# displacement gradient of the patch: stretch, shear and rotation of order 20 %
GRADIENT = np.array([[0.20, 0.15], [-0.10, -0.12]])
MATERIAL = MooneyRivlin(80.0, 20.0, 2000.0)


class PatchErrors(NamedTuple):
    """Largest errors of a patch test.

    Attributes
    ----------
    displacement : float
        Over the side of the patch.
    stress : float
        Over the largest component of the exact stress.
    """

    displacement: float
    stress: float


def homogeneous_stress(F: np.ndarray, material: MooneyRivlin) -> np.ndarray:
    """First Piola-Kirchhoff stress of a homogeneous deformation, K/2 (J - 1)^2 included."""
    J = np.linalg.det(F)
    return material.stress(F) + material.bulk_modulus * (J - 1.0) * cofactor(F)


def patch_test(traction: bool, basis_order: int = 1, cells: int = 6, seed: int = 5) -> PatchErrors:
    """Linear displacements x = (I + H) X on an irregular cloud; exact: F = I + H everywhere.

    Parameters
    ----------
    traction : bool
        False: all boundary particles have imposed displacements. True: those of the left side
        only, and dead tractions P N act on the other three.
    """
    grid = Grid(cells, cells)
    X = scattered(grid, 0.3, seed)
    held = grid.left if traction else grid.boundary
    support = 2.0 if basis_order == 1 else 3.0
    fixed = fixed_components(len(X), x=held, y=held)
    disc = discretize(grid_body(grid, X, fixed, support, basis_order=basis_order), X)
    stress = homogeneous_stress(np.eye(2) + GRADIENT, MATERIAL)
    force = np.zeros_like(X)
    if traction:
        for row, normal in ((grid.right, (1, 0)), (grid.bottom, (0, -1)), (grid.top, (0, 1))):
            points, length = edge_points(edges_of(row), X, 2)
            force += point_loads(disc, points, np.outer(length, stress @ normal))
    u = X @ GRADIENT.T
    path = solve_free(disc, MATERIAL, ramp(u, 5), ramp(force, 5))
    difference = piola_stresses(disc, MATERIAL, path.steps[-1].d) - stress
    return PatchErrors(
        float(np.abs(path.displacement() - u).max()),
        float(np.abs(difference).max() / np.abs(stress).max()),
    )


class Compression(NamedTuple):
    """Homogeneous plane-strain compression between frictionless platens.

    Attributes
    ----------
    stretch : ndarray, shape (n_steps,)
        Height over undeformed height.
    pressure, exact_pressure : ndarray, shape (n_steps,)
        Force per undeformed width over the shear modulus.
    width, exact_width : ndarray, shape (n_steps,)
        Width over undeformed width.
    """

    stretch: np.ndarray
    pressure: np.ndarray
    exact_pressure: np.ndarray
    width: np.ndarray
    exact_width: np.ndarray


def free_width(stretch: float, material: MooneyRivlin) -> float:
    """Lateral stretch l of P_11 = 0 in F = diag(l, stretch), the faces being free (Newton)."""
    width, step = 1.0 / stretch, 1e-30
    for _ in range(50):
        P = homogeneous_stress(np.diag([width + 1j * step, stretch]), material)[0, 0]
        change = P.real / (P.imag / step)
        width -= change
        if abs(change) < 1e-15:
            break
    return width


def compress_block(
    bulk_ratio: float = 1e3, final_stretch: float = 0.5, n_steps: int = 10, seed: int = 5
) -> Compression:
    """A 2 x 1 block squeezed between platens on which it slides freely, irregular cloud.

    Exact: F = diag(l, h) with l from P_11(l, h) = 0 of the compressible material and the platen
    pressure -P_22; lengths over the block's, stresses over the shear modulus.
    """
    grid = Grid(12, 6)
    X = scattered(grid, 0.25, seed) * [2.0, 1.0]
    fixed = fixed_components(len(X), x=[grid.bottom[0]], y=[*grid.bottom, *grid.top])
    material = MooneyRivlin(0.4, 0.1, bulk_ratio)
    disc = discretize(grid_body(grid, X, fixed), X)
    target = np.zeros_like(X)
    target[grid.top, 1] = final_stretch - 1.0
    path = solve_free(disc, material, ramp(target, n_steps))
    stretch = np.linspace(1.0, final_stretch, n_steps + 1)[1:]
    force = [internal_forces(disc, material, s.d)[grid.top, 1].sum() for s in path.nominal_steps]
    ends = (grid.right, grid.left)
    width = [
        1.0 + np.subtract(*(path.displacement(k)[row, 0].mean() for row in ends)) / 2.0
        for k in range(n_steps)
    ]
    exact = np.array([free_width(h, material) for h in stretch])
    stress = [
        homogeneous_stress(np.diag(f), material)[1, 1] for f in zip(exact, stretch, strict=True)
    ]
    return Compression(
        stretch, -np.array(force) / 2.0, -np.array(stress), np.array(width), exact
    )  # fmt: skip

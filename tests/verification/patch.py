"""Patch tests and homogeneous deformations: stresses that must come out exact to rounding."""

from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.materials.isotropic import Isotropic, cofactor
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from verification.bodies import (
    Grid,
    fixed_components,
    grid_body,
    row_gauss_points,
    scattered,
)
from verification.fields import piola_stresses
from verification.solving import grown, holding_forces, ramp, solve, tight

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


def homogeneous_stress(F: np.ndarray, material: Isotropic) -> np.ndarray:
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
    prescribed = grid.left if traction else grid.boundary
    support = 2.0 if basis_order == 1 else 3.0
    fixed = fixed_components(len(X), x=prescribed, y=prescribed)
    body = grid_body(grid, X, fixed, support, basis_order=basis_order)
    stress = homogeneous_stress(np.eye(2) + GRADIENT, MATERIAL)
    sides = {"right": (1, 0), "bottom": (0, -1), "top": (0, 1)} if traction else {}
    loads = [
        DeadLoad(side, row_gauss_points(getattr(grid, side), 2), stress @ normal, ramp(5))
        for side, normal in sides.items()
    ]
    u = X @ GRADIENT.T
    path = solve(body, X, (elastic_body(MATERIAL), *loads), 5, grown(u, 5), tight(MATERIAL))
    difference = piola_stresses(path, path.steps[-1]) - stress
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


def free_width(stretch: float, material: Isotropic) -> float:
    """Lateral stretch l of P_11 = 0 in F = diag(l, stretch), the faces being free (Newton)."""
    width, step = 1.0 / stretch, 1e-30
    for _ in range(50):
        P = homogeneous_stress(np.diag([width + 1j * step, stretch]), material)[0, 0]
        change = P.real / (P.imag / step)
        width -= change
        if abs(change) < 1e-15:
            break
    return width


class Squeezed(NamedTuple):
    """A squeezed block.

    Attributes
    ----------
    stretch, width : ndarray, shape (n_steps,)
        Height and width over the undeformed ones.
    pressure : ndarray, shape (n_steps,)
        Force per undeformed width.
    path : PathResult
    """

    stretch: np.ndarray
    pressure: np.ndarray
    width: np.ndarray
    path: PathResult


def squeeze(
    material: Isotropic, cells=(12, 6), walls: bool = False, final_stretch=0.5, n_steps=10, seed=5
) -> Squeezed:
    """A 2 x 1 block squeezed between platens on which it slides freely, irregular cloud.

    Parameters
    ----------
    walls : bool
        Whether smooth walls keep the sides where they are; else these are free.

    """
    grid = Grid(*cells)
    X = scattered(grid, 0.25, seed) * [2.0, 1.0]
    prescribed = [*grid.left, *grid.right] if walls else [grid.bottom[0]]
    fixed = fixed_components(len(X), x=prescribed, y=[*grid.bottom, *grid.top])
    target = np.zeros_like(X)
    target[grid.top, 1] = final_stretch - 1.0
    body, imposed = grid_body(grid, X, fixed), grown(target, n_steps)
    path = solve(body, X, (elastic_body(material),), n_steps, imposed, tight(material))
    sides = np.array([path.displacement(k)[[grid.left, grid.right], 0] for k in range(n_steps)])
    width = 1.0 + np.diff(sides.mean(axis=2), axis=1)[:, 0] / 2.0
    pressure = -holding_forces(path)[:, grid.top, 1].sum(axis=1) / 2.0
    return Squeezed(np.linspace(1.0, final_stretch, n_steps + 1)[1:], pressure, width, path)


def compress_block(bulk_ratio: float = 1e3, n_steps: int = 10) -> Compression:
    """The block squeezed to half its height, its sides free; stresses over the shear modulus.

    Exact: F = diag(l, h) with l from P_11(l, h) = 0 of the compressible material and the platen
    pressure -P_22.
    """
    material = MooneyRivlin(0.4, 0.1, bulk_ratio)
    stretch, pressure, width, _ = squeeze(material, n_steps=n_steps)
    exact = np.array([free_width(h, material) for h in stretch])
    stress = [
        homogeneous_stress(np.diag(f), material)[1, 1] for f in zip(exact, stretch, strict=True)
    ]
    return Compression(stretch, pressure, -np.array(stress), width, exact)

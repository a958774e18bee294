"""Inflation of a thick-walled incompressible Mooney-Rivlin cylinder in plane strain."""

from typing import NamedTuple

import numpy as np

from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import ElasticBody, elastic_body
from verification.bodies import Grid, fixed_components, grid_body
from verification.solving import grown, holding_forces, solve, tight

BORE, OUTSIDE = 1.0, 2.0


class Inflation(NamedTuple):
    """Pressure against bore stretch.

    Attributes
    ----------
    stretch : ndarray, shape (n_steps,)
        Deformed over undeformed bore radius.
    pressure, exact : ndarray, shape (n_steps,)
        Computed pressure and the closed form for the incompressible material, over the shear
        modulus.
    """

    stretch: np.ndarray
    pressure: np.ndarray
    exact: np.ndarray

    @property
    def error(self) -> np.ndarray:
        """Relative error of the pressure at every stretch."""
        return self.pressure / self.exact - 1.0


def inflation_pressure(stretch, bore: float = BORE, outside: float = OUTSIDE):
    """Bore pressure over the shear modulus mu = 2 (C10 + C01), incompressible, plane strain.

    With a^2 - A^2 = r^2 - R^2 and lambda = r / R the radial equilibrium
    d sigma_r / dr = mu (lambda^2 - lambda^-2) / r integrates to

        p / mu = ln(lambda_a / lambda_b) + (lambda_b^-2 - lambda_a^-2) / 2,

    lambda_a and lambda_b being the stretches of the bore and of the outer surface (R. S. Rivlin,
    Phil. Trans. R. Soc. A 242 (1949) 173; R. W. Ogden, Non-linear Elastic Deformations, 5.3).
    """
    a = np.asarray(stretch, float)
    b = np.sqrt(1.0 + (a**2 - 1.0) * (bore / outside) ** 2)
    return np.log(a / b) + 0.5 * (b**-2 - a**-2)


def inflate(
    elastic: ElasticBody,
    cells: tuple[int, int] = (8, 16),
    final_stretch: float = 2.0,
    n_steps: int = 10,
) -> tuple[np.ndarray, np.ndarray]:
    """Bore stretches and pressures, (n_steps,) each, of a quarter of a cylinder of any materials.

    The bore's radial displacement is imposed; the cells are numbered layer by layer from the bore.

    Parameters
    ----------
    cells : tuple of int
        Background cells through the wall and along the quarter.
    """
    grid = Grid(*cells)
    radius = BORE + (OUTSIDE - BORE) * grid.reference[:, 0]
    angle = 0.5 * np.pi * grid.reference[:, 1]
    X = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    bore = grid.left
    fixed = fixed_components(len(X), x=[*bore, *grid.top], y=[*bore, *grid.bottom])
    target = np.zeros_like(X)
    target[bore] = (final_stretch - 1.0) * X[bore]
    body, options = grid_body(grid, X, fixed), tight(*(r.material for r in elastic.regions))
    path = solve(body, X, (elastic,), n_steps, grown(target, n_steps), options)
    stretch = np.linspace(1.0, final_stretch, n_steps + 1)[1:]
    normal = X[bore] / BORE
    radial = np.einsum("ski,ki->s", holding_forces(path)[:, bore], normal)
    return stretch, radial / (0.5 * np.pi * BORE * stretch)


def inflate_cylinder(bulk_ratio: float = 1e3, cells: tuple[int, int] = (8, 16)) -> Inflation:
    """The Mooney-Rivlin cylinder inflated to twice its bore in ten steps.

    Parameters
    ----------
    bulk_ratio : float
        Bulk over shear modulus.
    cells : tuple of int
        As of ``inflate``.
    """
    material = MooneyRivlin(0.4, 0.1, bulk_ratio)
    stretch, pressure = inflate(elastic_body(material), cells)
    return Inflation(stretch, pressure / material.shear_modulus, inflation_pressure(stretch))

"""Bodies with fluid pressure all round, which shrink uniformly: F = lambda 1, h = lambda.

The pressure acts at the points with which the consistent integration integrates the boundary: the state
is exact to rounding.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from seal_mdao.loads.fluid_pressure import FluidPressure
from seal_mdao.materials.mooney_rivlin import MooneyRivlin, energy_derivatives
from seal_mdao.structure.elastic_body import elastic_body
from verification.bodies import Grid, fixed_components, grid_body, scattered
from verification.solving import ramp, solve, tight

MATERIAL = MooneyRivlin(0.4, 0.1, 10.0)
PRESSURE = 2.0
"""Of two shear moduli."""


class ImmersedErrors(NamedTuple):
    """Errors of a body that shrinks under the pressure, over its strain lambda - 1.

    Attributes
    ----------
    strain : float
        Root mean square of the components of F - lambda 1, and of h - lambda.
    displacement : float
        Root mean square over the particles, over the side of the section.
    volume : float
        Of the mean of J.
    """

    strain: float
    displacement: float
    volume: float


def _ring_stretch() -> float:
    """Solve p = -K (J - 1), J = lambda^3."""
    return (1.0 - PRESSURE / MATERIAL.bulk_modulus) ** (1 / 3)


def _plane_stretch() -> float:
    """Solve P = -p cof F for F = lambda 1 in the plane: 2 W_T + W_J + K (J - 1) = -p, T = 2 lambda^2."""

    def excess(stretch):
        j = stretch**2
        w_t, w_j, *_ = energy_derivatives(2.0 * j, j, MATERIAL.c10, MATERIAL.c01)
        return 2.0 * w_t + w_j + MATERIAL.bulk_modulus * (j - 1.0) + PRESSURE

    return brentq(excess, 0.5, 1.0, xtol=1e-15, rtol=1e-15)


def immersed(cells: int, bore: float | None, uneven: float = 0.0) -> ImmersedErrors:
    """Analyse a square section of side 1 above its plane of symmetry, under pressure all round.

    Parameters
    ----------
    bore : float or None
        Inner radius; 0: a solid cylinder, which touches the axis; None: plane strain, half of a section
        beside its plane of symmetry.
    uneven : float
        Largest shift of the particles over their distance.
    """
    ring = bore is not None
    grid = Grid(cells, cells)
    X = scattered(grid, uneven, 1) + np.array([bore or 0.0, 0.0])
    fixed = fixed_components(len(X), x=[] if bore else grid.left, y=grid.bottom)
    # from the plane of symmetry upwards, over the top, and down the bore
    edge = np.concatenate([grid.right, grid.top[-2::-1]])
    if bore:
        edge = np.concatenate([edge, grid.left[-2::-1]])
    body = grid_body(grid, X, fixed, axisymmetric=ring)
    terms = elastic_body(MATERIAL), FluidPressure("fluid", edge, "start", PRESSURE, ramp(2), ())
    path = solve(body, X, terms, 2, options=tight(MATERIAL))
    # J = lambda^2, of a body of revolution lambda^3
    power, stretch = (3, _ring_stretch()) if ring else (2, _plane_stretch())
    d, disc = path.steps[-1].d, path.discretization
    found = path.problem.terms[0].deformation_of(d[None], [2.0]).f
    f = found.reshape(-1, found.shape[-1])
    weights = disc.weights.ravel() / disc.weights.sum()
    # 11, 12, 21, 22, J - 1, h
    apart = f[:, [0, 1, 2, 3]] - stretch * np.array([1.0, 0.0, 0.0, 1.0])
    if ring:
        apart = np.column_stack([apart, f[:, 5] - stretch])
    errors = (
        np.sqrt(weights @ (apart**2).sum(axis=1)),
        np.sqrt(np.mean((d - (stretch - 1.0) * X) ** 2)),
        abs(weights @ f[:, 4] - (stretch**power - 1.0)),
    )
    return ImmersedErrors(*(float(error) / (1.0 - stretch) for error in errors))

"""Bodies with fluid pressure all round, which shrink uniformly: F = lambda 1, h = lambda.

The pressure acts at particles and at the middles of sides, not at the points with which the boundary is
integrated: the state is exact up to errors at corners of the section, in plane strain as in a body of
revolution.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.loads.fluid_pressure import FluidPressure
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from verification.bodies import Grid, fixed_components, grid_body
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


def immersed(cells: int, bore: float = 0.0) -> ImmersedErrors:
    """Analyse a square section of side 1 above its plane of symmetry, under pressure all round.

    Parameters
    ----------
    bore : float
        Inner radius; 0: a solid cylinder, which touches the axis.
    """
    grid = Grid(cells, cells)
    X = grid.reference + np.array([bore, 0.0])
    fixed = fixed_components(len(X), x=[] if bore else grid.left, y=grid.bottom)
    # from the plane of symmetry upwards, over the top, and down the bore
    edge = np.concatenate([grid.right, grid.top[-2::-1]])
    if bore:
        edge = np.concatenate([edge, grid.left[-2::-1]])
    body = grid_body(grid, X, fixed, axisymmetric=True)
    terms = elastic_body(MATERIAL), FluidPressure("fluid", edge, "start", PRESSURE, ramp(2), ())
    path = solve(body, X, terms, 2, options=tight(MATERIAL))
    # p = -K (lambda^3 - 1)
    stretch = (1.0 - PRESSURE / MATERIAL.bulk_modulus) ** (1 / 3)
    d, disc = path.steps[-1].d, path.discretization
    f = path.problem.terms[0].deformation_of(d[None], [2.0]).f.reshape(-1, 6)
    weights = disc.weights.ravel() / disc.weights.sum()
    # 11, 12, 21, 22, J - 1, h
    apart = f[:, [0, 1, 2, 3, 5]] - stretch * np.array([1.0, 0.0, 0.0, 1.0, 1.0])
    errors = (
        np.sqrt(weights @ (apart**2).sum(axis=1)),
        np.sqrt(np.mean((d - (stretch - 1.0) * X) ** 2)),
        abs(weights @ f[:, 4] - (stretch**3 - 1.0)),
    )
    return ImmersedErrors(*(float(error) / (1.0 - stretch) for error in errors))

"""Thick-walled tubes and spheres under internal pressure: bodies of revolution of Mooney-Rivlin rubber.

The exact solutions are those of the nearly incompressible material: with the stretches lambda_r = r' and
lambda_t = r / R, radial and circumferential nominal stresses P_r, P_t, and n = 1 or 2 curvatures

    dP_r/dR + n (P_r - P_t) / R = 0,    P_r(A) = -p lambda_t^n,    P_r(B) = 0.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.loads.fluid_pressure import FluidPressure
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from verification.bodies import Grid, fixed_components, grid_body
from verification.solving import ramp, solve, tight

BORE, OUTSIDE = 1.0, 2.0
MATERIAL = MooneyRivlin(0.4, 0.1, 1e3)
COMPLEX_STEP = 1e-30
TIGHT = {"rtol": 1e-12, "atol": 1e-13, "method": "DOP853"}


class Wall(NamedTuple):
    """A wall under pressure from inside.

    Attributes
    ----------
    curvatures : int
        1 for a tube in plane strain, 2 for a sphere.
    pressure : float
        kPa.
    """

    curvatures: int
    pressure: float


TUBE, SPHERE = Wall(1, 0.3), Wall(2, 0.5)


def nominal_stresses(radial, hoop, curvatures: int, material: MooneyRivlin = MATERIAL):
    """Compute P_r and P_t of W = C10 (I1 J^(-2/3) - 3) + C01 (I2 J^(-4/3) - 3) + K/2 (J - 1)^2."""
    stretches = np.array([radial, hoop, hoop if curvatures == 2 else 1.0 + 0.0 * hoop])
    squares, jacobian = stretches**2, stretches.prod(axis=0)
    first = squares.sum(axis=0)
    second = 0.5 * (first**2 - (squares**2).sum(axis=0))
    # P_i = dW/dlambda_i
    own = material.c10 * jacobian ** (-2 / 3) * (2.0 * stretches - 2 / 3 * first / stretches)
    other = 2.0 * stretches * (first - squares) - 4 / 3 * second / stretches
    own = own + material.c01 * jacobian ** (-4 / 3) * other
    return (own + material.bulk_modulus * (jacobian - 1.0) * jacobian / stretches)[:2]


def _profile(outside: float, wall: Wall):
    """Integrate (r, lambda_r) from the free outside with the deformed radius ``outside`` to the bore."""
    n, hoop = wall.curvatures, outside / OUTSIDE

    def slope(radius, state):
        r, stretch = state
        around = r / radius
        p_r, p_t = nominal_stresses(stretch, around, n)
        # dP_r/dlambda_r lambda_r' + dP_r/dlambda_t (lambda_r - lambda_t) / R = -n (P_r - P_t) / R
        by_radial, by_hoop = (
            nominal_stresses(stretch + 1j * a, around + 1j * b, n)[0].imag / COMPLEX_STEP
            for a, b in ((COMPLEX_STEP, 0.0), (0.0, COMPLEX_STEP))
        )
        return [stretch, -(n * (p_r - p_t) + by_hoop * (stretch - around)) / radius / by_radial]

    # the outside is free
    free = brentq(lambda own: nominal_stresses(own, hoop, n)[0], 0.3, 1.5, xtol=1e-15)
    return solve_ivp(slope, (OUTSIDE, BORE), [outside, free], **TIGHT).y[:, -1]


def exact_bore(wall: Wall) -> float:
    """Compute the deformed radius of the bore under the pressure."""

    def excess(outside):
        r, stretch = _profile(outside, wall)
        hoop = r / BORE
        return -nominal_stresses(stretch, hoop, wall.curvatures)[0] / hoop**wall.curvatures

    outside = brentq(lambda own: excess(own) - wall.pressure, OUTSIDE, 1.2 * OUTSIDE, xtol=1e-14)
    return _profile(outside, wall)[0]


def inflate(wall: Wall, cells: int, basis_order: int = 1, n_steps: int = 4) -> PathResult:
    """Inflate a slice of a tube, or half a sphere above its equator, by the pressure on its bore."""
    sphere = wall.curvatures == 2
    grid = Grid(cells, 2 * cells if sphere else cells)
    radius = BORE + (OUTSIDE - BORE) * grid.reference[:, 0]
    along = grid.reference[:, 1]
    X = np.column_stack([radius, (OUTSIDE - BORE) * along])
    if sphere:
        # from the equator to the axis
        X = radius[:, None] * np.column_stack([np.cos(angle := 0.5 * np.pi * along), np.sin(angle)])
        X[grid.top, 0] = 0.0
    fixed = fixed_components(
        len(X), x=grid.top if sphere else [], y=grid.bottom if sphere else [*grid.top, *grid.bottom]
    )
    support, gauss = (2.0, 2) if basis_order == 1 else (3.0, 3)
    body = grid_body(
        grid, X, fixed, support, basis_order=basis_order, n_gauss=gauss, axisymmetric=True
    )
    # the body is on the left of its edges: the bore is walked downwards
    fluid = FluidPressure("fluid", grid.left[::-1], "start", wall.pressure, ramp(n_steps), ())
    return solve(body, X, (elastic_body(MATERIAL), fluid), n_steps, options=tight(MATERIAL))


def bore_errors(wall: Wall, cells: tuple[int, ...], basis_order: int) -> np.ndarray:
    """Compute the error of the bore's deformed radius, root mean square over the bore, over its
    displacement, for every grid."""
    exact, errors = exact_bore(wall), []
    for count in cells:
        x = inflate(wall, count, basis_order).steps[-1].responses[1].x
        # from the axis of the tube, or from the centre of the sphere
        r = x[:, 0] if wall.curvatures == 1 else np.hypot(*x.T)
        errors.append(np.sqrt(np.mean((r - exact) ** 2)) / (exact - BORE))
    return np.array(errors)

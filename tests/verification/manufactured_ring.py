"""Manufactured finite-strain solution of a body of revolution: L2 and H1 errors under refinement.

The square section from R = 1 to 2 is loaded by body forces and tractions 2 pi R per unit of the section,
those of the Mooney-Rivlin energy of the principal stretches, never of the code of the materials.
"""

import numpy as np

from seal_mdao.equilibrium.discretization import Discretization, discretize
from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.rkpm.axisymmetry import CIRCUMFERENCE
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.points import fixed_points
from verification.bodies import Grid, fixed_components, grid_body, row_gauss_points, scattered
from verification.fields import displacement_at, domain_rule
from verification.manufactured import AMPLITUDE, MATERIAL, STEP, WAVE, Convergence
from verification.quadratic_integration import discretize_quadratic
from verification.solving import grown, ramp, solve_discretized, tight

INNER = 1.0
"""Inner radius over the side of the section."""


def deformation(X: np.ndarray):
    """Places, F (3, 3) and its hoop stretch of two isochoric shears one after the other, J = 1:

    r^2 = R^2 + 2 A sin(kZ + 0.4),    z = Z + A sin(kr + 0.2).
    """
    R, Z = X[..., 0], X[..., 1]
    r = np.sqrt(R * R + 2.0 * AMPLITUDE * np.sin(WAVE * Z + 0.4))
    slope = AMPLITUDE * WAVE * np.cos(WAVE * r + 0.2)
    F = np.zeros((*R.shape, 3, 3), X.dtype)
    F[..., 0, 0], F[..., 0, 1] = R / r, AMPLITUDE * WAVE * np.cos(WAVE * Z + 0.4) / r
    F[..., 1, :] = slope[..., None] * F[..., 0, :]
    F[..., 1, 1] += 1.0
    F[..., 2, 2] = r / R
    return np.stack([r, Z + AMPLITUDE * np.sin(WAVE * r + 0.2)], axis=-1), F


def stress(X: np.ndarray) -> np.ndarray:
    """First Piola-Kirchhoff stress (..., 3, 3) at J = 1, where the bulk modulus does not act."""
    F = deformation(X)[1]
    C = np.swapaxes(F, -1, -2) @ F
    one = np.trace(C, axis1=-2, axis2=-1)[..., None, None]
    two = 0.5 * (one**2 - np.trace(C @ C, axis1=-2, axis2=-1)[..., None, None])
    inverse = np.swapaxes(np.linalg.inv(F), -1, -2)
    # d(I1 J^(-2/3))/dF = 2 (F - I1/3 F^-T),  d(I2 J^(-4/3))/dF = 2 (I1 F - F C - 2/3 I2 F^-T)
    by_one, by_two = F - one / 3.0 * inverse, one * F - F @ C - 2.0 / 3.0 * two * inverse
    return 2.0 * (MATERIAL.c10 * by_one + MATERIAL.c01 * by_two)


def body_force(X: np.ndarray) -> np.ndarray:
    """-Div P per undeformed volume, shape (..., 2), by the complex step."""
    P, R = stress(X), X[..., 0]
    along = [stress(X + 1j * STEP * e).imag[..., :2, j] / STEP for j, e in enumerate(np.eye(2))]
    # P_iR,R + P_iZ,Z + P_iR / R, less P_hh / R in the radial component
    force = -sum(along) - P[..., :2, 0] / R[..., None]
    force[..., 0] += P[..., 2, 2] / R
    return force


def dead_loads(body, X, grid: Grid, n_edge: int, n_steps: int) -> list:
    """Body force in the cells and tractions P N on all four sides, as terms."""
    points, area = domain_rule(body, X, 3)
    place = points.at(X)
    inside = fixed_points(points, CIRCUMFERENCE * place[:, 0] * area)
    loads = [DeadLoad("inside", inside, body_force(place), ramp(n_steps))]
    normals = {"right": (1, 0), "left": (-1, 0), "bottom": (0, -1), "top": (0, 1)}
    for side, normal in normals.items():
        where = row_gauss_points(getattr(grid, side), n_edge)
        place = where.points.at(X)
        traction = stress(place)[:, :2, :2] @ np.array(normal, float)
        density = CIRCUMFERENCE * place[:, :1] * traction
        loads.append(DeadLoad(side, where, density, ramp(n_steps)))
    return loads


def errors(disc: Discretization, d: np.ndarray) -> tuple[float, float]:
    """L2 error without the rigid motion along the axis, H1 seminorm of the error, in the section."""
    points, w = domain_rule(disc.body, disc.particles, 5)
    X, (value, slope) = points.at(disc.particles), displacement_at(disc, points, d)
    x, F = deformation(X)
    e = value - (x - X)
    e[:, 1] -= w @ e[:, 1] / w.sum()
    slope = slope - (F[:, :2, :2] - np.eye(2))
    return np.sqrt(w @ (e**2).sum(axis=1)), np.sqrt(w @ (slope**2).sum(axis=(1, 2)))


def solution_error(n: int, basis_order: int, consistent: int, seed: int) -> tuple[float, float]:
    """L2 and H1 errors with ``n`` x ``n`` cells on an irregular cloud, held at one particle.

    Parameters
    ----------
    consistent : int
        Order to which the integration is consistent: 1 as in the analysis, 2 with
        ``quadratic_integration``.
    """
    grid = Grid(n, n)
    X = scattered(grid, 0.2, seed) + np.array([INNER, 0.0])
    fixed = fixed_components(len(X), y=[grid.left[n // 2]])
    support, n_gauss = (2.0, 2) if basis_order == 1 else (3.0, 3)
    body = grid_body(
        grid, X, fixed, support, basis_order=basis_order, n_gauss=n_gauss, axisymmetric=True
    )
    terms = elastic_body(MATERIAL), *dead_loads(body, X, grid, 2 if consistent == 1 else 3, 2)
    disc = (discretize if consistent == 1 else discretize_quadratic)(body, X, terms)
    moved = grown(deformation(X)[0] - X, 2)
    path = solve_discretized(disc, terms, 2, moved, tight(MATERIAL))
    return errors(disc, path.steps[-1].d)


def ring_convergence(basis_order: int, consistent: int, cells, seeds=(1, 2)) -> Convergence:
    """Errors of the manufactured problem, root mean square over several irregular clouds."""
    squares = np.array(
        [
            [np.square(solution_error(n, basis_order, consistent, seed)) for seed in seeds]
            for n in cells
        ]
    )
    l2, h1 = np.sqrt(squares.mean(axis=1)).T
    return Convergence(1.0 / np.array(cells), l2, h1)

"""Manufactured finite-strain solution: L2 and H1 errors of the whole analysis under refinement."""

from typing import NamedTuple

import numpy as np

from seal_mdao.equilibrium.discretization import Discretization, discretize
from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.materials.isotropic import cofactor
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.points import fixed_points
from verification.bodies import (
    Grid,
    fixed_components,
    grid_body,
    row_gauss_points,
    scattered,
)
from verification.fields import displacement_at, domain_rule
from verification.quadratic_integration import discretize_quadratic
from verification.solving import grown, ramp, solve_discretized, tight

AMPLITUDE, WAVE = 0.1, 2.0
# shear modulus 1, bulk modulus 50 (any stress unit)
MATERIAL = MooneyRivlin(0.4, 0.1, 50.0)
STEP = 1e-30


class Convergence(NamedTuple):
    """Errors of a sequence of particle clouds.

    Attributes
    ----------
    spacing : ndarray, shape (m,)
        Mean particle spacing over the side of the square.
    l2, h1 : ndarray, shape (m,)
        L2 norm of the displacement's error, rigid motion taken out, and of its gradient's error.
    """

    spacing: np.ndarray
    l2: np.ndarray
    h1: np.ndarray

    @property
    def l2_slopes(self) -> np.ndarray:
        return slopes(self.spacing, self.l2)

    @property
    def h1_slopes(self) -> np.ndarray:
        return slopes(self.spacing, self.h1)


def slopes(spacing, error) -> np.ndarray:
    """Observed orders between consecutive spacings, shape (m - 1,)."""
    return np.diff(np.log(error)) / np.diff(np.log(spacing))


def displacement(X: np.ndarray) -> np.ndarray:
    """Two shears one after the other, x = X + A sin(kY + 0.4), y = Y + A sin(kx + 0.2): J = 1.

    Isochoric, as rubber deforms, so that the constant pressure of a background cell is exact and
    the rates are those of the shape functions.
    """
    u = AMPLITUDE * np.sin(WAVE * X[..., 1] + 0.4)
    return np.stack([u, AMPLITUDE * np.sin(WAVE * (X[..., 0] + u) + 0.2)], axis=-1)


def displacement_gradient(X: np.ndarray) -> np.ndarray:
    """du_i / dX_j of ``displacement``, shape (..., 2, 2); complex arguments allowed."""
    u = AMPLITUDE * np.sin(WAVE * X[..., 1] + 0.4)
    u_y = AMPLITUDE * WAVE * np.cos(WAVE * X[..., 1] + 0.4)
    v_x = AMPLITUDE * WAVE * np.cos(WAVE * (X[..., 0] + u) + 0.2)
    rows = [np.stack([0.0 * u, u_y], axis=-1), np.stack([v_x, v_x * u_y], axis=-1)]
    return np.stack(rows, axis=-2)


def piola_stress(X: np.ndarray, material: MooneyRivlin) -> np.ndarray:
    """First Piola-Kirchhoff stress of the chosen deformation, shape (..., 2, 2)."""
    H = displacement_gradient(X)
    F = np.eye(2) + H
    change = H[..., 0, 0] + H[..., 1, 1] + H[..., 0, 0] * H[..., 1, 1] - H[..., 0, 1] * H[..., 1, 0]
    return material.stress(F) + material.bulk_modulus * change[..., None, None] * cofactor(F)


def body_force(X: np.ndarray, material: MooneyRivlin) -> np.ndarray:
    """-Div P per undeformed area, shape (..., 2), by the complex step: exact to rounding."""
    along = [
        piola_stress(X + 1j * STEP * e, material).imag[..., j] for j, e in enumerate(np.eye(2))
    ]
    return -sum(along) / STEP


def dead_loads(body, X, grid: Grid, material: MooneyRivlin, n_edge: int, n_steps: int) -> list:
    """Body force in the cells and tractions P N on all four sides, as terms."""
    points, area = domain_rule(body, X, 3)
    inside = fixed_points(points, area)
    loads = [DeadLoad("inside", inside, body_force(points.at(X), material), ramp(n_steps))]
    normals = {"right": (1, 0), "left": (-1, 0), "bottom": (0, -1), "top": (0, 1)}
    for side, normal in normals.items():
        where = row_gauss_points(getattr(grid, side), n_edge)
        traction = piola_stress(where.points.at(X), material) @ np.array(normal, float)
        loads.append(DeadLoad(side, where, traction, ramp(n_steps)))
    return loads


def errors(disc: Discretization, d: np.ndarray) -> tuple[float, float]:
    """L2 error without the rigid motion, and H1 seminorm of the error, 5 x 5 points a cell."""
    points, w = domain_rule(disc.body, disc.particles, 5)
    places, (value, slope) = points.at(disc.particles), displacement_at(disc, points, d)
    e = value - displacement(places)
    x, y = (places + displacement(places)).T
    one, zero = np.ones_like(x), np.zeros_like(x)
    rigid = np.array([[one, zero], [zero, one], [-y, x]])
    gram = np.einsum("p,aip,bip->ab", w, rigid, rigid)
    share = np.linalg.solve(gram, np.einsum("p,aip,pi->a", w, rigid, e))
    e = e - np.einsum("a,aip->pi", share, rigid)
    slope = slope - displacement_gradient(places)
    return np.sqrt(w @ (e**2).sum(axis=1)), np.sqrt(w @ (slope**2).sum(axis=(1, 2)))


def solution_error(n: int, basis_order: int, consistent: int, seed: int) -> tuple[float, float]:
    """L2 and H1 errors with ``n`` x ``n`` cells on an irregular cloud.

    Three components are held at the values of the exact solution: both in the middle of the left
    side, the vertical one in the middle of the right side.

    Parameters
    ----------
    basis_order : int
    consistent : int
        Order to which the integration is consistent: 1 as in the analysis, 2 with
        ``quadratic_integration``.
    """
    grid = Grid(n, n)
    X = scattered(grid, 0.2, seed)
    left, right = grid.left[n // 2], grid.right[n // 2]
    fixed = fixed_components(len(X), x=[left], y=[left, right])
    support, n_gauss = (2.0, 2) if basis_order == 1 else (3.0, 3)
    body = grid_body(grid, X, fixed, support, basis_order=basis_order, n_gauss=n_gauss)
    # the analysis' consistent gradients see two points of every edge; so must its tractions
    loads = dead_loads(body, X, grid, MATERIAL, 2 if consistent == 1 else 3, 2)
    terms = elastic_body(MATERIAL), *loads
    disc = (discretize if consistent == 1 else discretize_quadratic)(body, X, terms)
    path = solve_discretized(disc, terms, 2, grown(displacement(X), 2), tight(MATERIAL))
    return errors(disc, path.steps[-1].d)


def manufactured_convergence(
    basis_order: int = 1, consistent: int = 1, cells=(8, 16, 32), seeds=(1, 2, 3)
) -> Convergence:
    """Errors of the manufactured problem, root mean square over several irregular clouds.

    The displacement is chosen, the stress P follows from the package's material, the body force is
    -Div P and the tractions P N act all round the unit square. With basis order p the errors of
    Galerkin's method are O(h^(p+1)) in L2 and O(h^p) in H1.
    """
    squares = np.array(
        [
            [np.square(solution_error(n, basis_order, consistent, seed)) for seed in seeds]
            for n in cells
        ]
    )
    l2, h1 = np.sqrt(squares.mean(axis=1)).T
    return Convergence(1.0 / np.array(cells), l2, h1)

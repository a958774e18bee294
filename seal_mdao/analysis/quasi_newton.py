"""Quasi-Newton iterations that reuse the factor of the last converged tangent, for large clouds.

There a factorisation costs dozens of solutions. The old tangent K0 alone is a poor approximation, for
rubber is nearly incompressible: motions that preserve the volume to K0 no longer do so after a rotation
of the body by 0.01. Its factor is therefore

- pushed forward with the deformation since: with f the deformation gradient from the last converged
  step to the predictor, du -> f du maps volume-preserving motions of the one state onto those of the
  other, exactly where f is uniform, so f K0^-1 f^T approximates the inverse of the tangent;
- corrected for the contact points whose state differs at the predictor (Sherman-Morrison-Woodbury);
- improved by Broyden's method in its limited-memory form: C. T. Kelley, Solving Nonlinear Equations
  with Newton's Method, SIAM 2003, chapter 4; M. S. Engelman, G. Strang, K.-J. Bathe, The application
  of quasi-Newton methods in fluid mechanics, Int. J. Numer. Methods Eng. 17, 1981.
"""

import numpy as np
from scipy.linalg import block_diag

from seal_mdao.analysis.assembly import Assembly
from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.newton import converged
from seal_mdao.analysis.path_result import ConvergedStep, Status
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.touching import unit_loads
from seal_mdao.equilibrium.corrected_factor import CorrectedFactor
from seal_mdao.equilibrium.tangent_layout import TangentLayout
from seal_mdao.structure.deformation import particle_gradients

# Most increments need 6 to 10 iterations; without halving of the residual in PATIENCE they are given up.
LIMIT, PATIENCE = 25, 6
# Each point that newly touches or slips costs two solutions.
MOST_NEW_CONTACTS = 10


class Reuse:
    """Back-off rule for old factors: n failures in a row suppress the next 2^(n-1) - 1 tries.

    In large load steps the tangent mostly changes too much, and failed iterations are lost time.
    """

    def __init__(self):
        self.failures, self.skips = 0, 0

    def is_due(self) -> bool:
        """Return whether to try old factors; called before every solution."""
        self.skips -= 1
        return self.skips < 0

    def learn(self, converged: bool) -> None:
        """Record the outcome; called after every try."""
        self.failures = 0 if converged else self.failures + 1
        self.skips = 2 ** max(self.failures - 1, 0) - 1


class CarriedFactor:
    """Inverse f K0^-1 f^T of an old tangent, pushed forward with a deformation.

    Parameters
    ----------
    factor : object
        Factor of K0.
    gradients : ndarray, shape (n, 2, 2)
        Deformation gradient f at every particle since K0.
    """

    def __init__(self, factor, gradients: np.ndarray, layout: TangentLayout):
        self.factor, self.gradients, self.layout = factor, gradients, layout

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        # f^T r at every particle, then K0^-1, then f
        back = np.einsum("pji,pj->pi", self.gradients, self.layout.gather(rhs))
        old = self.layout.gather(self.factor.solve(self.layout.reduce(back)))
        return self.layout.reduce(np.einsum("pij,pj->pi", self.gradients, old))


class BroydenSteps:
    """Broyden's update of a fixed approximate inverse, stored as the steps taken."""

    def __init__(self):
        self.steps, self.squares = [], []

    def next(self, step: np.ndarray) -> np.ndarray:
        """Return the step of the updated inverse from ``step`` = B_0^-1 r, that of the fixed one."""
        steps, squares = self.steps, self.squares
        # product of rank-one updates (Kelley 2003, chapter 4): with the steps s_0, ..., s_n and
        # z = B_0^-1 r,  z <- z + s_k+1 (s_k . z) / |s_k|^2 for k = 0, ..., n - 1, then
        # s_n+1 = z / (1 - (s_n . z) / |s_n|^2)
        for made, following, square in zip(steps, steps[1:], squares, strict=False):
            step = step + following * ((made @ step) / square)
        if steps:
            step = step / (1.0 - (steps[-1] @ step) / squares[-1])
        steps.append(step)
        squares.append(step @ step)
        return step


def _gradients(problem: PathProblem, d: np.ndarray) -> np.ndarray:
    """Compute deformation gradients at the particles, shape (n, 2, 2)."""
    disc, out = problem.discretization, np.empty((*d.shape, 2))
    raw = disc.transformation.coefficients(d)
    particle_gradients(disc.cells.raw, disc.body.cells, raw, out)
    return out


def _new_contacts(now: Assembly, last: ConvergedStep) -> list | None:
    """List terms at single points with the points on another branch than in the factorised tangent.

    None where a term that couples points, as self-contact, has changed its branch, and for too many
    points.
    """
    found = []
    for term, own, before in zip(now.problem.terms, now.responses, last.responses, strict=True):
        points = np.flatnonzero(own.branch != before.branch)
        if points.size and term.couples_points:
            return None
        if points.size:
            # D: change of the 2 x 2 tangents of these points
            found.append((term, points, (own.tangent - before.tangent)[points]))
    return found if sum(at.size for _, at, _ in found) <= MOST_NEW_CONTACTS else None


def _inverse(increment: Increment, d, changed: list):
    """Build the approximate inverse of the tangent at ``d``."""
    # f = F(d) F(d_n)^-1
    problem = increment.problem
    since = _gradients(problem, d) @ np.linalg.inv(_gradients(problem, increment.last.d))
    carried = CarriedFactor(increment.factor, since, problem.discretization.layout)
    if not changed:
        return carried
    # K0 + P D P^T: P unit loads in x and y at the changed points, D their blocks
    columns = [load for term, points, _ in changed for load in unit_loads(problem, term, points)]
    blocks = [tangent for _, _, tangents in changed for tangent in tangents]
    return CorrectedFactor(carried, np.array(columns), block_diag(*blocks))


def quasi_newton(increment: Increment, guess: np.ndarray) -> Solution:
    """Iterate to equilibrium from ``guess`` (n, 2) with the factor of the last converged tangent.

    Iterations need the forces only; the tangent is assembled and factorised once, after convergence.
    The status is NOT_CONVERGED also where Newton's method is expected to be faster.
    """
    d, now, inverse, iteration, residuals, broyden = guess, None, None, None, [], BroydenSteps()

    def ended(status):
        return Solution(status, d, tuple(residuals), now)

    for _ in range(LIMIT + 1):
        now = increment.evaluate(d, iteration, tangent=False)
        if now is None:
            return ended(Status.INVERTED)
        residuals.append(now.size)
        if not np.isfinite(now.size):
            return ended(Status.DIVERGED)
        if converged(now, increment.options):
            return _factorized(increment, now, tuple(residuals))
        if len(residuals) > PATIENCE and now.size > 0.5 * residuals[-1 - PATIENCE]:
            break
        if inverse is None:
            changed = _new_contacts(now, increment.last)
            if changed is None:
                break
            try:
                inverse = _inverse(increment, d, changed)
            except np.linalg.LinAlgError:
                return ended(Status.SINGULAR)
        # Broyden's step with z = B_0^-1 r
        d = d - increment.gather(broyden.next(inverse.solve(now.residual)))
        iteration = now.iteration
    return ended(Status.NOT_CONVERGED)


def _factorized(increment: Increment, now: Assembly, residuals: tuple) -> Solution:
    """Factorise the tangent where the iterations converged; the forces keep their bits.

    A symmetric one is checked for stability at every step, which needs factors in double precision.
    """
    now = increment.evaluate(now.d, now.iteration)
    try:
        symmetric = increment.problem.symmetric
        factor = now.factorize(check=True) if symmetric else now.factorize_roughly()
    except np.linalg.LinAlgError:
        return Solution(Status.SINGULAR, now.d, residuals, now)
    return Solution(Status.CONVERGED, now.d, residuals, now, factor)

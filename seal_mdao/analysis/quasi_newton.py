"""Iterations that reuse the factor of the last converged tangent, for large clouds.

There a factorisation costs dozens of solutions. The old tangent K0 alone is a poor one, for rubber
hardly changes its volume: the motions that K0 takes for free of volume change no longer are once
the body has turned by a hundredth. Its factor is therefore

- carried along with the deformation since: with f the deformation gradient from the last converged
  step to the predictor, du -> f du maps motions without volume change of the one onto those of the
  other, exactly where f is uniform, so f K0^-1 f^T stands for the inverse of the tangent;
- corrected for the contact points whose state is another at the predictor (Sherman-Morrison-Woodbury);
- improved by Broyden's method in its limited-memory form: C. T. Kelley, Solving Nonlinear Equations
  with Newton's Method, SIAM 2003, chapter 4; M. S. Engelman, G. Strang, K.-J. Bathe, The application
  of quasi-Newton methods in fluid mechanics, Int. J. Numer. Methods Eng. 17, 1981.
"""

import numpy as np
from scipy.linalg import block_diag

from seal_mdao.analysis.newton import NewtonOptions, converged
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import ConvergedStep, Status
from seal_mdao.analysis.touching import unit_loads
from seal_mdao.equilibrium.corrected_factor import CorrectedFactor
from seal_mdao.equilibrium.equations import TangentLayout
from seal_mdao.structure.deformation import particle_gradients

# Most need 6 to 10 iterations; what is not halved within PATIENCE of them will not converge soon.
LIMIT, PATIENCE = 25, 6
# Each point that touches or slips anew costs two solutions.
MOST_NEW_CONTACTS = 10


class Reuse:
    """Whether old factors are worth a try: after n failures in a row 2^(n-1) - 1 solutions go without.

    Large load steps mostly change too much for them, and what was tried is lost.
    """

    def __init__(self):
        self.failures, self.rests = 0, 0

    def is_due(self) -> bool:
        """Asked before every solution."""
        self.rests -= 1
        return self.rests < 0

    def learn(self, converged: bool) -> None:
        """Told after every try."""
        self.failures = 0 if converged else self.failures + 1
        self.rests = 2 ** max(self.failures - 1, 0) - 1


class CarriedFactor:
    """f K0^-1 f^T: the inverse of an old tangent, carried along with a deformation.

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
        back = np.einsum("pji,pj->pi", self.gradients, self.layout.gather(rhs))
        old = self.layout.gather(self.factor.solve(self.layout.reduce(back)))
        return self.layout.reduce(np.einsum("pij,pj->pi", self.gradients, old))


class BroydenSteps:
    """Broyden's update of a fixed approximate inverse, kept as the steps that were made."""

    def __init__(self):
        self.steps, self.squares = [], []

    def next(self, step: np.ndarray) -> np.ndarray:
        """The step to make in place of ``step``, that of the fixed approximate inverse."""
        steps, squares = self.steps, self.squares
        for made, then, square in zip(steps, steps[1:], squares, strict=False):
            step = step + then * ((made @ step) / square)
        if steps:
            step = step / (1.0 - (steps[-1] @ step) / squares[-1])
        steps.append(step)
        squares.append(step @ step)
        return step


def _gradients(problem: PathProblem, d: np.ndarray) -> np.ndarray:
    """Deformation gradients at the particles, shape (n, 2, 2)."""
    disc, out = problem.discretization, np.empty((*d.shape, 2))
    raw = disc.transformation.coefficients(d)
    particle_gradients(disc.cells.raw, disc.body.cells, raw, out)
    return out


def _new_contacts(problem: PathProblem, last: ConvergedStep) -> list | None:
    """Terms at single points, with the points on another branch than in the factorised tangent; None
    where a term that couples points is on another one."""
    found = []
    for term, now, then in zip(problem.terms, problem.responses, last.responses, strict=True):
        points = np.flatnonzero(now.branch != then.branch)
        if points.size and term.couples_points:
            return None
        if points.size:
            found.append((term, points, (now.tangent - then.tangent)[points]))
    return found


def _inverse(problem: PathProblem, d, last: ConvergedStep, changed: list):
    """Approximate inverse of the tangent at ``d``, where the forces were assembled."""
    since = _gradients(problem, d) @ np.linalg.inv(_gradients(problem, last.d))
    carried = CarriedFactor(problem.factor, since, problem.discretization.layout)
    if not changed:
        return carried
    columns = [load for term, points, _ in changed for load in unit_loads(problem, term, points)]
    blocks = [tangent for _, _, tangents in changed for tangent in tangents]
    return CorrectedFactor(carried, np.array(columns), block_diag(*blocks))


def quasi_newton(
    problem: PathProblem, d, target: float, last: ConvergedStep, options: NewtonOptions
):
    """Iterations at a fixed loading with the factor of the last converged tangent.

    They need the forces only; the tangent is assembled and factorised once, where they converged.

    Parameters
    ----------
    problem : PathProblem
        Its factor is that of the tangent at ``last``.
    d : ndarray, shape (n, 2)
        The predictor.

    Returns
    -------
    status, d, residuals
        As of ``newton``, with the factor left in ``problem``; NOT_CONVERGED also where Newton's
        method promises to be faster.
    """
    layout = problem.discretization.layout
    inverse = None
    residuals, broyden, status = [], BroydenSteps(), Status.NOT_CONVERGED
    problem.begin()
    for _ in range(LIMIT + 1):
        if not problem.assemble_forces(d, target, last.after):
            status = Status.INVERTED
            break
        residual, size, rounding = problem.residual()
        residuals.append(size)
        if not np.isfinite(size):
            status = Status.DIVERGED
            break
        if converged(problem, size, rounding, options):
            inverse = None  # it holds the old factor
            status = _factorize(problem, d, target, last)
            break
        if len(residuals) > PATIENCE and size > 0.5 * residuals[-1 - PATIENCE]:
            break
        if inverse is None:
            changed = _new_contacts(problem, last)
            if changed is None or sum(at.size for _, at, _ in changed) > MOST_NEW_CONTACTS:
                break
            try:
                inverse = _inverse(problem, d, last, changed)
            except np.linalg.LinAlgError:
                status = Status.SINGULAR
                break
        d = d - layout.gather(broyden.next(inverse.solve(residual)))
    return status, d, tuple(residuals)


def _factorize(problem, d, target, last) -> Status:
    """Factorise the tangent where the iterations converged; the forces stay, bit for bit.

    A symmetric one tells at every step whether it is stable, which rough factors do not.
    """
    problem.assemble(d, target, last.after)
    try:
        if problem.symmetric:
            problem.factorize(check=True)
        else:
            problem.factorize_roughly()
    except np.linalg.LinAlgError:
        return Status.SINGULAR
    return Status.CONVERGED

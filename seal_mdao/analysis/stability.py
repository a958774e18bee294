"""Loss of stability of equilibrium, and the switch of the path to a stable branch.

A converged step is stable when its tangent is positive definite; where friction or another term without
a potential makes it unsymmetric, when its determinant is positive. Both follow from its factor at
negligible cost.

Without friction the path leaves an unstable equilibrium: the state is perturbed along its critical mode
and descends the potential at the same loading (``descent``). The perturbation only gives the start
of the iterations; the equilibrium found satisfies the unperturbed equations.
"""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.analysis.descent import descend
from seal_mdao.analysis.jumps import extent
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import ConvergedStep, Status
from seal_mdao.equilibrium.modes import nearest_mode

# Perturbation along the critical mode over the size of the body.
PUSH = 1e-3
# Cosine below which a mode counts as orthogonal to a direction where its sign is chosen.
SENSELESS = 1e-3
# Step of the path parameter in the central difference of the potential.
NEARBY = 1e-4


@dataclass(frozen=True, eq=False)
class CriticalPoint:
    """Critical point: loss of stability of equilibrium.

    Attributes
    ----------
    fraction : float
        Path parameter, in nominal load steps.
    kind : str
        "branch": the branch continues and is unstable; "limit": it ends, or Newton's method finds no
        continuation; "unsymmetric": the determinant has become negative, under friction.
    mode : ndarray, shape (n, 2)
        Critical mode as generalised displacements, its largest component 1.
    moved : float
        Largest displacement of a particle to the equilibrium at which the path continued, mm.
    released : float
        Energy released by the jump, mJ/m. A lower bound where the terms have no potential
        (``jumps.released_energy``), NaN where that bound is not positive.
    """

    fraction: float
    kind: str
    mode: np.ndarray
    moved: float
    released: float


def critical_mode(problem: PathProblem, factor, way, negative: bool) -> np.ndarray:
    """Compute the mode (n, 2) of the eigenvalue nearest to zero, largest component 1, sign of ``way``.

    Where the increment ``way`` (n, 2) of the path is orthogonal to it, as in symmetric bodies, its sign
    makes the sum of x positive, else that of y, else the rotation counter-clockwise.
    """
    layout, x = problem.discretization.layout, problem.discretization.particles
    # the factor of the last step may be in single precision; ``kept`` gives double precision
    _, mode = nearest_mode(factor.kept(), layout.n_equations, problem.symmetric, negative)
    mode = layout.gather(mode / np.abs(mode).max())
    # infinitesimal rotation (-y, x)
    turn = np.column_stack([-x[:, 1], x[:, 0]])
    for sense in (way, np.array([1.0, 0.0]), np.array([0.0, 1.0]), turn):
        sense = np.broadcast_to(sense, mode.shape)
        # phi . v, compared with SENSELESS |phi| |v|
        along = float(np.sum(mode * sense))
        if abs(along) > SENSELESS * np.linalg.norm(mode) * np.linalg.norm(sense):
            return mode if along > 0.0 else -mode
    return mode


def is_stable(problem: PathProblem, at_any_cost: bool = False) -> bool:
    """Return whether the tangent factorised last is stable; True where an unsymmetric one costs much."""
    if problem.symmetric or problem.discretization.layout.storage.tells_sign:
        return problem.factor.positive
    return problem.factor.kept().positive if at_any_cost else True


def follows_stable(problem: PathProblem, options: NewtonOptions) -> bool:
    """Return whether the path switches to stable equilibria."""
    return options.branch == "stable" and problem.symmetric


def leave(problem, status: Status, d, target, last: ConvergedStep, options: NewtonOptions, note):
    """Switch from the end of a stable branch, shortly after ``last``, to the next stable equilibrium.

    Parameters
    ----------
    status : Status
        UNSTABLE for an unstable equilibrium ``d``, whose factor is in the problem; another one where
        Newton's method found none near the prediction ``d``.

    Returns
    -------
    status, d, residuals
        As of ``newton``.
    point : CriticalPoint
        None where no stable equilibrium was found.
    """
    kind = "branch" if status is Status.UNSTABLE else "limit"
    if kind == "limit":
        problem.factorize_at(last)
    # branch: the mode of the negative eigenvalue at the unstable equilibrium;
    # limit: the mode that becomes singular, at the last stable step
    mode = critical_mode(problem, problem.factor, d - last.d, negative=kind == "branch")
    available = _available(problem, d if kind == "branch" else None, target, last)
    # perturbed start d + PUSH L phi; beyond a limit point the prediction is no equilibrium anyway
    push = PUSH * extent(problem) * mode if kind == "branch" else 0.0
    status, found, residuals = descend(problem, d + push, target, last.after, options, note)
    if status is not Status.CONVERGED:
        return status, d, residuals, None
    # released = Pi(left branch) - Pi(found), both at ``target``
    released = available - problem.potential(found, target, last.after)
    point = limit_point(last, found, mode, released)
    if kind == "branch":
        # stability is lost somewhere between the two steps: their mean
        point = replace(point, kind=kind, fraction=0.5 * (last.fraction + target))
    return status, found, residuals, point


def limit_point(last: ConvergedStep, found, mode, released=np.nan) -> CriticalPoint:
    """Build the critical point at the end of a branch, from ``last`` to the equilibrium ``found``."""
    moved = float(np.abs(found - last.d).max())
    return CriticalPoint(
        last.fraction, "limit", mode, moved, released if released > 0.0 else np.nan
    )


def _available(problem: PathProblem, unstable, target, last: ConvergedStep) -> float:
    """Compute the potential of the branch that is left, at ``target``: of the ``unstable`` equilibrium.

    Where there is none, that of ``last`` and the work of the loading on it.
    """
    if unstable is not None:
        return problem.potential(unstable, target, last.after)
    # Pi(d_n, lambda) ~ Pi_n + dPi/dlambda (lambda - lambda_n) + work of prescribed displacements
    work = _driving(problem, last.d, last.fraction, last.before) * (target - last.fraction)
    work += problem.held_work(last.d, last.fraction, target)
    return problem.potential(last.d, last.fraction, last.before) + work


def _driving(problem: PathProblem, d, fraction, history) -> float:
    """Differentiate the potential with respect to the path parameter at fixed displacements."""
    beyond, before = (
        problem.potential(d, fraction + side * NEARBY, history) for side in (1.0, -1.0)
    )
    # dPi/dlambda = [Pi(lambda + h) - Pi(lambda - h)] / 2 h
    return (beyond - before) / (2.0 * NEARBY)


def flagged(problem: PathProblem, step: ConvergedStep, before: ConvergedStep) -> CriticalPoint:
    """Build the critical point of the first unstable ``step`` of a branch that the path stays on.

    The factor of the step is in the problem.
    """
    symmetric = problem.symmetric
    mode = critical_mode(problem, problem.factor, step.d - before.d, negative=symmetric)
    kind = "branch" if symmetric else "unsymmetric"
    return CriticalPoint(step.fraction, kind, mode, 0.0, 0.0 if symmetric else np.nan)

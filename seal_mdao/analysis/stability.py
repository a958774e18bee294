"""Where equilibrium loses its stability, and the stable branch that the path takes there.

A converged step is stable when its tangent is positive definite; where friction or another term without
a potential makes it unsymmetric, when its determinant is positive. Its factor tells, at no cost that
counts.

Without friction the path leaves an unstable equilibrium: it is pushed a little along its critical mode,
and led down the potential at the same loading (``descent``). The push is a place to start from, nothing
of it is in the equilibrium that is found.
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.analysis.descent import descend
from seal_mdao.analysis.modes import nearest_mode
from seal_mdao.analysis.newton import NewtonOptions, newton
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import ConvergedStep, Status

# The push along the critical mode, over the size of the body.
PUSH = 1e-3
# The critical loading is found between two steps by so many bisections.
BISECTIONS = 5
# What is less than that share of the largest counts as zero where the sense of a mode is chosen.
SENSELESS = 1e-3
# Step of the path parameter in the difference that gives the force of the loading.
NEARBY = 1e-4


@dataclass(frozen=True, eq=False)
class CriticalPoint:
    """Where equilibrium lost its stability.

    Attributes
    ----------
    fraction : float
        Path parameter, in nominal load steps.
    kind : str
        "branch": the branch goes on and is not stable any more; "limit": it ends, or Newton's method
        finds no way on; "unsymmetric": the determinant has become negative, under friction.
    mode : ndarray, shape (n, 2)
        Critical mode as generalised displacements, its largest component 1.
    moved : float
        Largest displacement of a particle from there to the equilibrium at which the path went on.
    released : float
        Energy that the path lost on the way, mJ/m; NaN where the terms have no potential.
    """

    fraction: float
    kind: str
    mode: np.ndarray
    moved: float
    released: float


def critical_mode(problem: PathProblem, factor, way, negative: bool) -> np.ndarray:
    """Mode (n, 2) whose eigenvalue is next to zero, largest component 1, in the sense of ``way``.

    Where the way (n, 2) of the path has no part in it, as in symmetric bodies, its sense is that of a
    positive sum of x, else of y, else of turning to the left.
    """
    layout, x = problem.discretization.layout, problem.discretization.particles
    _, mode = nearest_mode(factor, layout.n_equations, problem.symmetric, negative)
    mode = layout.gather(mode / np.abs(mode).max())
    turn = np.column_stack([-x[:, 1], x[:, 0]])
    for sense in (way, np.array([1.0, 0.0]), np.array([0.0, 1.0]), turn):
        sense = np.broadcast_to(sense, mode.shape)
        along = float(np.sum(mode * sense))
        if abs(along) > SENSELESS * np.linalg.norm(mode) * np.linalg.norm(sense):
            return mode if along > 0.0 else -mode
    return mode


def leave(problem: PathProblem, d, target, last: ConvergedStep, options: NewtonOptions, note):
    """From the unstable equilibrium ``d``, whose factor is in the problem, to a stable one.

    Returns
    -------
    status, d, residuals
        As of ``newton``.
    point : CriticalPoint
        None where no stable equilibrium was found.
    """
    mode = critical_mode(problem, problem.factor, d - last.d, negative=True)
    above = problem.potential(d, target, last.after)
    fraction = _onset(problem, target, last, options)
    size = PUSH * np.ptp(problem.discretization.particles, axis=0).max()
    status, found, residuals = descend(problem, d + size * mode, target, last.after, options, note)
    if status is not Status.CONVERGED:
        return status, d, residuals, None
    released = above - problem.potential(found, target, last.after)
    moved = float(np.abs(found - d).max())
    return status, found, residuals, CriticalPoint(fraction, "branch", mode, moved, released)


def _onset(problem: PathProblem, target, last: ConvergedStep, options: NewtonOptions) -> float:
    """Path parameter at which the branch of ``last`` loses its stability, before ``target``."""
    low, high = last.fraction, target
    factor = problem.factorize_at(last).kept()
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        guess = problem.predict(last, factor, middle)[0]
        status, *_ = newton(problem, guess, middle, last.after, options)
        if status is not Status.CONVERGED:
            break
        low, high = (middle, high) if problem.factor.positive else (low, middle)
    return 0.5 * (low + high)


def pass_limit(problem: PathProblem, guess, target, last: ConvergedStep, options, note):
    """From ``last``, beyond which Newton's method finds no way, to a stable equilibrium at ``target``.

    Returns
    -------
    status, d, residuals, point
        As of ``leave``.
    """
    mode = critical_mode(problem, problem.factorize_at(last), guess - last.d, negative=False)
    status, found, residuals = descend(problem, guess, target, last.after, options, note)
    if status is not Status.CONVERGED:
        return status, guess, residuals, None
    work = 0.5 * (target - last.fraction) * (
        _driving(problem, last.d, last.fraction, last.before)
        + _driving(problem, found, target, last.after)
    )  # fmt: skip
    stored = problem.potential(last.d, last.fraction, last.before)
    released = stored + work - problem.potential(found, target, last.after)
    moved = float(np.abs(found - last.d).max())
    return status, found, residuals, CriticalPoint(last.fraction, "limit", mode, moved, released)


def _driving(problem: PathProblem, d, fraction, history) -> float:
    """Derivative of the potential with respect to the path parameter, at fixed displacements."""
    beyond, before = (
        problem.potential(d, fraction + side * NEARBY, history) for side in (1.0, -1.0)
    )
    return (beyond - before) / (2.0 * NEARBY)


def flagged(problem: PathProblem, step: ConvergedStep, before: ConvergedStep) -> CriticalPoint:
    """The first unstable ``step`` of a branch that the path stays on; its factor is in the problem."""
    symmetric = problem.symmetric
    mode = critical_mode(problem, problem.factor, step.d - before.d, negative=symmetric)
    kind = "branch" if symmetric else "unsymmetric"
    return CriticalPoint(step.fraction, kind, mode, 0.0, 0.0 if symmetric else np.nan)

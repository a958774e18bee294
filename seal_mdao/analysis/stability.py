"""Where equilibrium loses its stability, and the stable branch that the path takes there.

A converged step is stable when its tangent is positive definite; where friction or another term without
a potential makes it unsymmetric, when its determinant is positive. Its factor tells, at no cost that
counts.

Without friction the path leaves an unstable equilibrium: it is pushed a little along its critical mode,
and led down the potential at the same loading (``descent``). The push is a place to start from, nothing
of it is in the equilibrium that is found.
"""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.analysis.descent import descend
from seal_mdao.analysis.jumps import extent
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import ConvergedStep, Status
from seal_mdao.equilibrium.modes import nearest_mode

# The push along the critical mode, over the size of the body.
PUSH = 1e-3
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
        Energy that the path lost on the way, mJ/m. A lower bound where the terms have no potential
        (``jumps.released_energy``), NaN where that says nothing.
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
    # that of the last step may be rough; what is kept is exact
    _, mode = nearest_mode(factor.kept(), layout.n_equations, problem.symmetric, negative)
    mode = layout.gather(mode / np.abs(mode).max())
    turn = np.column_stack([-x[:, 1], x[:, 0]])
    for sense in (way, np.array([1.0, 0.0]), np.array([0.0, 1.0]), turn):
        sense = np.broadcast_to(sense, mode.shape)
        along = float(np.sum(mode * sense))
        if abs(along) > SENSELESS * np.linalg.norm(mode) * np.linalg.norm(sense):
            return mode if along > 0.0 else -mode
    return mode


def is_stable(problem: PathProblem, at_any_cost: bool = False) -> bool:
    """Whether the tangent factorised last says so; True where asking an unsymmetric one costs much."""
    if problem.symmetric or problem.discretization.layout.storage.tells_sign:
        return problem.factor.positive
    return problem.factor.kept().positive if at_any_cost else True


def follows_stable(problem: PathProblem, options: NewtonOptions) -> bool:
    """Whether the path goes on to stable equilibria."""
    return options.branch == "stable" and problem.symmetric


def leave(problem, status: Status, d, target, last: ConvergedStep, options: NewtonOptions, note):
    """From the end of a stable branch, a little behind ``last``, to the next stable equilibrium.

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
    mode = critical_mode(problem, problem.factor, d - last.d, negative=kind == "branch")
    available = _available(problem, d if kind == "branch" else None, target, last)
    push = PUSH * extent(problem) * mode if kind == "branch" else 0.0
    status, found, residuals = descend(problem, d + push, target, last.after, options, note)
    if status is not Status.CONVERGED:
        return status, d, residuals, None
    released = available - problem.potential(found, target, last.after)
    point = limit_point(last, found, mode, released)
    if kind == "branch":
        point = replace(point, kind=kind, fraction=0.5 * (last.fraction + target))
    return status, found, residuals, point


def limit_point(last: ConvergedStep, found, mode, released=np.nan) -> CriticalPoint:
    """The end of a branch at ``last``, from where the body went to ``found``."""
    moved = float(np.abs(found - last.d).max())
    return CriticalPoint(
        last.fraction, "limit", mode, moved, released if released > 0.0 else np.nan
    )


def _available(problem: PathProblem, unstable, target, last: ConvergedStep) -> float:
    """Potential of the branch that is left at ``target``: of the ``unstable`` equilibrium there.

    Where there is none that of ``last`` and the work of the loading on it.
    """
    if unstable is not None:
        return problem.potential(unstable, target, last.after)
    work = _driving(problem, last.d, last.fraction, last.before) * (target - last.fraction)
    work += problem.held_work(last.d, last.fraction, target)
    return problem.potential(last.d, last.fraction, last.before) + work


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

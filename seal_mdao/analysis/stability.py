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
from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.jumps import extent
from seal_mdao.analysis.path_result import ConvergedStep
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.equilibrium.eigenmodes import nearest_mode

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


def critical_mode(problem: PathProblem, factor, moved, negative: bool) -> np.ndarray:
    """Compute the mode (n, 2) of the eigenvalue nearest to zero, largest component 1, sign of ``moved``.

    Where the increment ``moved`` (n, 2) is orthogonal to it, as in symmetric bodies, its sign
    makes the sum of x positive, else that of y, else the rotation counter-clockwise.
    """
    layout, x = problem.discretization.layout, problem.discretization.particles
    _, mode = nearest_mode(factor, layout.n_equations, problem.symmetric, negative)
    mode = layout.gather(mode / np.abs(mode).max())
    # infinitesimal rotation (-y, x)
    turn = np.column_stack([-x[:, 1], x[:, 0]])
    for sense in (moved, np.array([1.0, 0.0]), np.array([0.0, 1.0]), turn):
        sense = np.broadcast_to(sense, mode.shape)
        # phi . v, compared with SENSELESS |phi| |v|
        along = float(np.sum(mode * sense))
        if abs(along) > SENSELESS * np.linalg.norm(mode) * np.linalg.norm(sense):
            return mode if along > 0.0 else -mode
    return mode


def follows_stable(increment: Increment) -> bool:
    """Return whether the path switches to stable equilibria."""
    return increment.options.branch == "stable" and increment.problem.symmetric


def leave(increment: Increment, guess, unstable: Solution | None = None):
    """Switch from the end of a stable branch to the next stable equilibrium.

    Parameters
    ----------
    guess : ndarray, shape (n, 2)
        Where the descent begins beyond a limit point.
    unstable : Solution, optional
        The ``unstable`` equilibrium that is left; None where Newton's method found none.

    Returns
    -------
    Solution
    CriticalPoint
        None where no stable equilibrium was found.
    """
    problem, last = increment.problem, increment.last
    # branch: the mode of the negative eigenvalue at the unstable equilibrium;
    # limit: the mode that becomes singular, at the last stable step
    if unstable is None:
        mode = critical_mode(problem, increment.factor, guess - last.d, negative=False)
        available, begin = _available(increment), guess
    else:
        mode = critical_mode(problem, unstable.factor, unstable.d - last.d, negative=True)
        # perturbed start d + PUSH L phi
        available = unstable.assembly.potential
        begin = unstable.d + PUSH * extent(problem) * mode
    found = descend(increment, begin)
    if not found.converged:
        return found, None
    # released = Pi(left branch) - Pi(found), both at the target
    point = limit_point(last, found.d, mode, available - found.assembly.potential)
    if unstable is not None:
        # stability is lost somewhere between the two steps: their mean
        point = replace(point, kind="branch", fraction=0.5 * (last.fraction + increment.target))
    return found, point


def limit_point(last: ConvergedStep, found, mode, released=np.nan) -> CriticalPoint:
    """Build the critical point at the end of a branch, from ``last`` to the equilibrium ``found``."""
    moved = float(np.abs(found - last.d).max())
    return CriticalPoint(
        last.fraction, "limit", mode, moved, released if released > 0.0 else np.nan
    )


def _available(increment: Increment) -> float:
    """Compute the potential at the target of the branch that ends: that of the last step, and the work
    of the loading on it."""
    problem, last, target = increment.problem, increment.last, increment.target
    # Pi(d_n, lambda) ~ Pi_n + dPi/dlambda (lambda - lambda_n) + work of prescribed displacements
    work = _driving(problem, last) * (target - last.fraction)
    work += problem.prescribed_work(last.d, last, target)
    return _potential(problem, last, last.fraction) + work


def _potential(problem: PathProblem, step: ConvergedStep, fraction: float) -> float:
    """Compute the potential at the displacements of ``step`` and another path parameter."""
    return problem.evaluate(step.d, fraction, step.before, tangent=False).potential


def _driving(problem: PathProblem, step: ConvergedStep) -> float:
    """Differentiate the potential with respect to the path parameter at fixed displacements."""
    # dPi/dlambda = [Pi(lambda + h) - Pi(lambda - k)] / (h + k), k = h unless the path, or the first
    # load step after preliminary increments, begins there
    begin = 0.0 if step.fraction >= 0.0 else problem.begins_at
    after, before = step.fraction + NEARBY, max(step.fraction - NEARBY, begin)
    change = _potential(problem, step, after) - _potential(problem, step, before)
    return float(change) / (after - before)


def flagged(problem: PathProblem, factor, step: ConvergedStep, before: ConvergedStep):
    """Build the critical point of the first unstable ``step`` of a branch that the path stays on."""
    symmetric = problem.symmetric
    mode = critical_mode(problem, factor, step.d - before.d, negative=symmetric)
    kind = "branch" if symmetric else "unsymmetric"
    return CriticalPoint(step.fraction, kind, mode, 0.0, 0.0 if symmetric else np.nan)

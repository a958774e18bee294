"""Equilibrium beyond a limit point, if the smallest increment fails or jumps.

In this order, and each only where the one before found none:

1. A jump under friction: damped motion at the same loading, else the equilibrium that Newton's method
   has found. (There is no potential to descend.)
2. Without friction: descent of the potential at the same loading (``stability.leave``).
3. Damped motion at the end of the nominal step; under friction descent where that is slow; damped motion
   with all its iterations. A saddle at which it may end is left by descent again.
4. If an equilibrium found there stores more energy than the loading supplies: the same at the end of the
   smallest increment.

Equilibria that store more energy than the loading supplies are not accepted (``jumps.without_gain``).
"""

from dataclasses import replace

import numpy as np

from seal_mdao.analysis.descent import descend
from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.jumps import jump_of, released_energy, without_gain
from seal_mdao.analysis.newton import newton
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.predictor import closest, predict
from seal_mdao.analysis.pseudo_time import relax
from seal_mdao.analysis.stability import critical_mode, follows_stable, leave, limit_point

# Iterations of damped motion before descent is tried.
SOON = 300
# Iterations of descent under friction, which needs some 200 where it converges.
DESCENT = 500


def beyond(increment: Increment, failed: Solution, guess: np.ndarray, end: float):
    """Find an equilibrium beyond the smallest increment.

    Parameters
    ----------
    failed : Solution
        How the increment ended.
    guess : ndarray, shape (n, 2)
        Its predictor.
    end : float
        Path parameter at the end of the nominal step.

    Returns
    -------
    Solution
    CriticalPoint or None
        None under friction where the path continues without a jump.
    target : float
        Path parameter of that equilibrium.
    """
    if failed.status is Status.JUMPED and not increment.problem.symmetric:
        return *_after_jump(increment, failed.d, guess), increment.target
    if follows_stable(increment):
        unstable = failed if failed.status is Status.UNSTABLE else None
        found, point = leave(increment, guess, unstable)
        if without_gain(increment, found).converged:
            return found, point, increment.target
    found, point = _at_the_end(replace(increment, target=end))
    if found.status is Status.GAINED and increment.target < end:
        nearer, its_point = _at_the_end(increment)
        if nearer.converged:
            return nearer.after(found.residuals), its_point, increment.target
    return found, point, end


def shortened(increment: Increment, iterations: int) -> Increment:
    """Return the increment with at most so many iterations of damped motion or descent."""
    few = min(iterations, increment.options.damped_iterations)
    return replace(increment, options=replace(increment.options, damped_iterations=few))


def _after_jump(increment: Increment, d, guess):
    """Find the equilibrium after a jump under friction, from ``guess``, else from ``d``."""
    mode = critical_mode(
        increment.problem, increment.factor, guess - increment.last.d, negative=False
    )
    found = without_gain(increment, relax(shortened(increment, SOON), guess))
    if not found.converged:
        found = newton(increment, d)
    return found, _point(increment, found, mode)


def _at_the_end(increment: Increment):
    """Find equilibrium at the end of an increment by damped motion, from the Euler predictor."""
    euler = predict(increment)
    mode = critical_mode(
        increment.problem, increment.factor, euler[0] - increment.last.d, negative=False
    )
    guess = closest(increment, euler)
    found = _damped_equilibrium(increment, guess)
    # iterations that cycle between stick and slip fail without a limit point: the path continues
    # where the predictor says, and no energy is released
    symmetric = increment.problem.symmetric
    lost = found.converged and (
        symmetric or jump_of(increment, found.assembly, guess) is Status.JUMPED
    )
    point = _point(increment, found, mode) if lost else None
    # damped motion may end on an unstable equilibrium, a saddle: leave that along its mode
    if found.converged and follows_stable(increment) and not found.factor.positive:
        left, point = leave(increment, guess, found)
        found = left.after(found.residuals)
    return found, point


def _point(increment: Increment, found: Solution, mode):
    """Build the limit point between the last step and an equilibrium; None where none was ``found``."""
    if not found.converged:
        return None
    last = increment.last
    released = released_energy(increment.problem, found.assembly, last, increment.target).least
    return limit_point(last, found.d, mode, released)


def _damped_equilibrium(increment: Increment, guess) -> Solution:
    """Find equilibrium by damped motion; under friction by descent where that is slow or moves off."""
    few = shortened(increment, SOON)
    found = without_gain(increment, relax(few, guess))
    slow = found.status is Status.NOT_CONVERGED and few.options != increment.options
    if not increment.problem.symmetric and (slow or found.status is Status.MOVED_OFF):
        # descent from the same prediction; where it fails, damped motion with all its iterations
        descended = without_gain(increment, descend(shortened(increment, DESCENT), guess))
        if descended.status in (Status.CONVERGED, Status.GAINED):
            return descended
    return without_gain(increment, relax(increment, guess)) if slow else found

"""Equilibrium beyond a limit point, where the smallest increment fails or jumps."""

from dataclasses import replace

import numpy as np

from seal_mdao.analysis.descent import descend
from seal_mdao.analysis.jumps import released_energy
from seal_mdao.analysis.newton import newton
from seal_mdao.analysis.pseudo_time import relax
from seal_mdao.analysis.result import Status
from seal_mdao.analysis.stability import critical_mode, follows_stable, leave, limit_point

# Iterations of damped motion before descent is tried.
SOON = 300
# Iterations of descent under friction, which needs some 200 where it converges.
DESCENT = 500


def beyond(problem, status, d, guess, targets, last, options, note):
    """Find an equilibrium beyond the smallest step, which ended with ``status`` at ``d``.

    A stable one is sought at the first of the ``targets`` by descent; damped motion ends at the second.

    Returns
    -------
    status, d, residuals
        As of ``newton``.
    point : CriticalPoint
    target : float
        Path parameter of that equilibrium.
    """
    target, end = targets
    # under friction there is no potential to descend: accept where damped motion or Newton landed
    if status is Status.JUMPED and not problem.symmetric:
        return *_equilibrium_after_jump(problem, d, guess, target, last, options, note), target
    # with a potential: descend at the loading of the smallest step, from the unstable
    # equilibrium along its mode, or from the prediction beyond a limit point
    if follows_stable(problem, options):
        begin = d if status is Status.UNSTABLE else guess
        left, d, residuals, point = leave(problem, status, begin, target, last, options, note)
        if left is Status.CONVERGED:
            return left, d, residuals, point, target
    # else damped motion at the end of the increment, from the Euler predictor
    euler = problem.predict(last, problem.factorize_at(last), end)
    mode = critical_mode(problem, problem.factor, euler[0] - last.d, negative=False)
    guess = problem.closest(euler, end, last.after)
    status, d, residuals = _damped_equilibrium(problem, guess, end, last, options, note)
    released = np.nan
    if status is Status.CONVERGED:
        released = released_energy(problem, d, last, end)[0]
    point = limit_point(last, d, mode, released)
    stable = status is not Status.CONVERGED or problem.factor.positive
    # damped motion may end on an unstable equilibrium, a saddle: leave that along its mode
    if follows_stable(problem, options) and not stable:
        status, d, more, point = leave(problem, Status.UNSTABLE, d, end, last, options, note)
        residuals += more
    return status, d, residuals, point, end


def _damped_equilibrium(problem, guess, end, last, options, note):
    """Find equilibrium by damped motion; under friction by descent where that is slow or moves off."""
    few = replace(options, damped_iterations=min(SOON, options.damped_iterations))
    status, d, residuals = relax(problem, guess, end, last.after, few, note)
    slow = status is Status.NOT_CONVERGED and few != options
    if not problem.symmetric and (slow or status is Status.MOVED_OFF):
        few = replace(options, damped_iterations=min(DESCENT, options.damped_iterations))
        # descent from the same prediction; where it fails, damped motion with all its iterations
        found = descend(problem, guess, end, last.after, few, note)
        if found[0] is Status.CONVERGED:
            return found
    if not slow:
        return status, d, residuals
    return relax(problem, guess, end, last.after, options, note)


def _equilibrium_after_jump(problem, d, guess, target, last, options, note):
    """Find the equilibrium after a jump under friction that persists in the smallest increment.

    By damped motion from the prediction ``guess``; else from ``d``, where Newton's method ended.

    Returns
    -------
    status, d, residuals, point
        As of ``leave``.
    """
    mode = critical_mode(problem, problem.factorize_at(last), guess - last.d, negative=False)
    few = replace(options, damped_iterations=min(SOON, options.damped_iterations))
    status, found, residuals = relax(problem, guess, target, last.after, few, note)
    if status is not Status.CONVERGED:
        status, found, residuals = newton(problem, d, target, last.after, options)
    released = released_energy(problem, found, last, target)[0]
    return status, found, residuals, limit_point(last, found, mode, released)

"""Where the smallest increment fails or jumps: equilibrium beyond a limit point."""

from dataclasses import replace

import numpy as np

from seal_mdao.analysis.descent import descend
from seal_mdao.analysis.jumps import released_energy
from seal_mdao.analysis.newton import newton
from seal_mdao.analysis.pseudo_time import relax
from seal_mdao.analysis.result import Status
from seal_mdao.analysis.stability import critical_mode, follows_stable, leave, limit_point

# Damped motion that has found no equilibrium within so many iterations gives way to descent.
SOON = 300
# Descent under friction finds one within some 200 iterations, or none.
DESCENT = 500


def beyond(problem, status, d, guess, targets, last, options, note):
    """Equilibrium beyond the smallest step, which ended with ``status`` at ``d``.

    A stable one is looked for at the first of the ``targets``; damped motion leads to the second.

    Returns
    -------
    status, d, residuals
        As of ``newton``.
    point : CriticalPoint
    target : float
        Where that is.
    """
    target, end = targets
    if status is Status.JUMPED and not problem.symmetric:
        return *_landed(problem, d, guess, target, last, options, note), target
    if follows_stable(problem, options):
        begin = d if status is Status.UNSTABLE else guess
        left, d, residuals, point = leave(problem, status, begin, target, last, options, note)
        if left is Status.CONVERGED:
            return left, d, residuals, point, target
    euler = problem.predict(last, problem.factorize_at(last), end)
    mode = critical_mode(problem, problem.factor, euler[0] - last.d, negative=False)
    guess = problem.closest(euler, end, last.after)
    status, d, residuals = _at_rest(problem, guess, end, last, options, note)
    released = np.nan
    if status is Status.CONVERGED:
        released = released_energy(problem, d, last, end)[0]
    point = limit_point(last, d, mode, released)
    stable = status is not Status.CONVERGED or problem.factor.positive
    if follows_stable(problem, options) and not stable:
        status, d, more, point = leave(problem, Status.UNSTABLE, d, end, last, options, note)
        residuals += more
    return status, d, residuals, point, end


def _at_rest(problem, guess, end, last, options, note):
    """Equilibrium by damped motion, which mostly finds it soon; by descent where it does not."""
    few = replace(options, damped_iterations=min(SOON, options.damped_iterations))
    status, d, residuals = relax(problem, guess, end, last.after, few, note)
    slow = status is Status.NOT_CONVERGED and few != options
    if not problem.symmetric and (slow or status is Status.MOVED_OFF):
        few = replace(options, damped_iterations=min(DESCENT, options.damped_iterations))
        found = descend(problem, guess, end, last.after, few, note)
        if found[0] is Status.CONVERGED:
            return found
    if not slow:
        return status, d, residuals
    return relax(problem, guess, end, last.after, options, note)


def _landed(problem, d, guess, target, last, options, note):
    """Equilibrium after a jump under friction that the smallest increment still shows.

    Where damped motion leads from the prediction ``guess``; else ``d``, where Newton's method ended.

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

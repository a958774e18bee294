"""Pseudo-transient continuation: the way to equilibrium where Newton's method cycles or diverges.

Where the last sticking points begin to slide the seal may lose its stability for a moment: the
tangent of the sliding seal is indefinite, and Newton's method is sent back to stick, for ever. The
seal itself slides on to the next equilibrium, and so does the overdamped motion alpha d' = -residual
that is followed here with implicit Euler steps. The damping alpha falls with the residual, so the
last iterations are Newton's, and what they find is equilibrium under the same forces.

C. T. Kelley and D. E. Keyes, Convergence analysis of pseudo-transient continuation, SIAM J. Numer.
Anal. 35, 1998.
"""

from collections.abc import Callable

import numpy as np

from seal_mdao.analysis.newton import NewtonOptions, converged
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import Status

# First damping over the mean diagonal entry of the tangent.
FIRST_DAMPING = 1e-4
# The damping falls to no less than this share in an iteration, and rises to no more than that.
FALL, RISE = 0.3, 2.0
# An iteration whose residual is that large, and that many times the last one, is made again.
LARGE, GROWTH = 0.5, 3.0
STRONGER = 4.0
# A body that has moved that many times its own size moves off for ever.
FAR = 1.5


def relax(
    problem: PathProblem,
    d,
    target: float,
    history,
    options: NewtonOptions,
    note: Callable[[int, float], None] | None = None,
):
    """Equilibrium at a fixed loading by damped motion.

    Parameters
    ----------
    note : callable, optional
        Called with the number of every iteration and the relative residual.

    Returns
    -------
    status, d, residuals
        As of ``newton``; MOVED_OFF where the body leaves for ever.
    """
    try:
        return _follow(problem, d, target, history, options, note)
    except np.linalg.LinAlgError:
        return Status.SINGULAR, d, ()


def ending(status: Status, options: NewtonOptions) -> str:
    """How damped motion ended that did not find equilibrium, and what can be done; a sentence."""
    if options.damped_iterations == 0:
        return ""
    if status is Status.MOVED_OFF:
        return "Damped motion carries the body off: there is nothing that would hold it"
    if status is Status.NOT_CONVERGED:
        return (
            f"Damped motion did not come to rest within {options.damped_iterations} iterations; allow "
            "more of them (damped_iterations of NewtonOptions)"
        )
    return f"Damped motion did not help: {status.value}"


def _follow(problem, d, target, history, options, note):
    layout = problem.discretization.layout
    diagonal = layout.storage.diagonal()
    residuals, damping, before = [], None, d
    far = FAR * np.ptp(problem.discretization.particles, axis=0).max()
    problem.begin()
    for number in range(options.damped_iterations):
        upright = problem.assemble(d, target, history)
        if damping is None:
            if not upright:
                return Status.INVERTED, d, ()
            damping = FIRST_DAMPING * np.abs(problem.values[diagonal]).mean()
        residual, size, rounding = problem.residual()
        if not upright or (residuals and not size <= max(LARGE, GROWTH * residuals[-1])):
            # from the same place again, more slowly
            damping *= STRONGER
            problem.assemble(before, target, history)
            residual = problem.residual()[0]
        else:
            if residuals:
                damping *= np.clip(size / residuals[-1], FALL, RISE)
            residuals.append(size)
            before = d
            if np.abs(d).max() > far:
                return Status.MOVED_OFF, d, tuple(residuals)
            if note is not None:
                note(number, size)
            if converged(problem, size, rounding, options):
                problem.factorize(check=True)
                return Status.CONVERGED, d, tuple(residuals)
        problem.values[diagonal] += damping
        d = before - layout.gather(problem.factorize().solve(residual))
    return Status.NOT_CONVERGED, before, tuple(residuals)

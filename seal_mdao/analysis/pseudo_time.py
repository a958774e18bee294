"""Pseudo-transient continuation: equilibrium where Newton's method cycles or diverges.

Where the last sticking points begin to slide the seal may lose its stability temporarily: the tangent
of the sliding seal is indefinite, and Newton's method returns to stick again and again. The seal itself
slides to the next equilibrium, and so does the overdamped motion alpha d' = -r(d), integrated here with
implicit Euler steps (K + alpha I) dd = -r. The damping alpha falls with the residual, so the last
iterations are Newton's and converge to equilibrium under the same forces.

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
# Bounds of the factor alpha_k+1 / alpha_k = |r_k+1| / |r_k| (switched evolution relaxation).
FALL, RISE = 0.3, 2.0
# A step is rejected where the relative residual exceeds LARGE and GROWTH times the one before; it is
# repeated with STRONGER times the damping.
LARGE, GROWTH = 0.5, 3.0
STRONGER = 4.0
# Displacement over the size of the body beyond which it moves away without bound.
FAR = 1.5


def relax(
    problem: PathProblem,
    d,
    target: float,
    history,
    options: NewtonOptions,
    note: Callable[[int, float], None] | None = None,
):
    """Find equilibrium at a fixed loading by damped motion (pseudo-transient continuation).

    Parameters
    ----------
    note : callable, optional
        Called with the number of every iteration and the relative residual.

    Returns
    -------
    status, d, residuals
        As of ``newton``; MOVED_OFF where the body moves away without bound.
    """
    try:
        return _follow(problem, d, target, history, options, note)
    except np.linalg.LinAlgError:
        return Status.SINGULAR, d, ()


def ending(status: Status, options: NewtonOptions) -> str:
    """Describe how damped motion ended without equilibrium, and what can be done; a sentence."""
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
        evaluated = problem.assemble(d, target, history)
        if damping is None:
            if not evaluated:
                return Status.INVERTED, d, ()
            # alpha_0 = FIRST_DAMPING mean |K_ii|
            damping = FIRST_DAMPING * np.abs(problem.values[diagonal]).mean()
        residual, size, rounding = problem.residual()
        if not evaluated or (residuals and not size <= max(LARGE, GROWTH * residuals[-1])):
            # rejected, or an inverted point: from the last accepted d again with larger alpha
            damping *= STRONGER
            problem.assemble(before, target, history)
            residual = problem.residual()[0]
        else:
            if residuals:
                # alpha_k+1 = alpha_k |r_k+1| / |r_k|, within FALL and RISE
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
        # implicit Euler step: d <- d - (K + alpha I)^-1 r
        problem.values[diagonal] += damping
        d = before - layout.gather(problem.factorize().solve(residual))
    return Status.NOT_CONVERGED, before, tuple(residuals)

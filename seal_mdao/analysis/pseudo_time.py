"""Pseudo-transient continuation: equilibrium where Newton's method cycles or diverges.

Where the last sticking points begin to slide the seal may lose its stability temporarily: the tangent
of the sliding seal is indefinite, and Newton's method returns to stick again and again. The seal itself
slides to the next equilibrium, and so does the overdamped motion alpha d' = -r(d), integrated here with
implicit Euler steps (K + alpha I) dd = -r. The damping alpha falls with the residual, so the last
iterations are Newton's and converge to equilibrium under the same forces.

C. T. Kelley and D. E. Keyes, Convergence analysis of pseudo-transient continuation, SIAM J. Numer.
Anal. 35, 1998.
"""

import numpy as np

from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.newton import NewtonOptions, converged
from seal_mdao.analysis.path_result import Status

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


def relax(increment: Increment, guess: np.ndarray) -> Solution:
    """Find equilibrium by damped motion (pseudo-transient continuation) from ``guess`` (n, 2).

    The status is MOVED_OFF where the body moves away without bound.
    """
    try:
        return _follow(increment, guess)
    except np.linalg.LinAlgError:
        return Solution(Status.SINGULAR, guess, ())


def ending(status: Status, options: NewtonOptions) -> str:
    """Describe how damped motion ended without equilibrium, and what can be done; a sentence."""
    if options.damped_iterations == 0:
        return ""
    if status is Status.MOVED_OFF:
        return (
            "Damped motion (pseudo-time) moves the seal away without limit, because no constraint "
            "or contact stops it"
        )
    if status is Status.NOT_CONVERGED:
        return (
            "Damped motion (pseudo-time) did not reach equilibrium within "
            f"{options.damped_iterations} iterations; increase damped_iterations of NewtonOptions"
        )
    return f"Damped motion (pseudo-time) failed, too: {status.value}"


def _follow(increment: Increment, d) -> Solution:
    far = FAR * np.ptp(increment.problem.discretization.particles, axis=0).max()
    now = last = increment.evaluate(d)
    if now is None:
        return Solution(Status.INVERTED, d, ())
    if not np.isfinite(now.size):  # beyond the limit of a material
        return Solution(Status.DIVERGED, d, (now.size,), now)
    # alpha_0 = FIRST_DAMPING mean |K_ii|
    residuals, damping = [], FIRST_DAMPING * now.mean_stiffness
    for number in range(increment.options.damped_iterations):
        if now is None or (residuals and not now.size <= max(LARGE, GROWTH * residuals[-1])):
            # rejected, or an inverted point: from the last accepted d again with larger alpha
            damping *= STRONGER
        else:
            if residuals:
                # alpha_k+1 = alpha_k |r_k+1| / |r_k|, within FALL and RISE
                damping *= np.clip(now.size / residuals[-1], FALL, RISE)
            residuals.append(now.size)
            last = now
            if np.abs(now.d).max() > far:
                return Solution(Status.MOVED_OFF, now.d, tuple(residuals), now)
            if increment.note is not None:
                increment.note(number, now.size)
            if converged(now, increment.options):
                factor = now.factorize(check=True)
                return Solution(Status.CONVERGED, now.d, tuple(residuals), now, factor)
        # implicit Euler step: d <- d - (K + alpha I)^-1 r
        step = last.factorize(shift=damping).solve(last.residual)
        now = increment.evaluate(last.d - increment.gather(step), last.iteration)
    return Solution(Status.NOT_CONVERGED, last.d, tuple(residuals), last)

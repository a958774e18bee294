"""Regularised Newton descent from an unstable state to a stable equilibrium at a fixed loading.

Newton steps s = -(K + alpha I)^-1 r, with the smallest alpha that makes K + alpha I positive definite,
each halved until the force along it does not oppose it: they descend the potential, and end as Newton's
method where K itself is positive definite. Where halving does not suffice, alpha grows temporarily.
The potential itself is not evaluated. Under friction, where there is none, the same steps are tried as a
last resort: alpha makes the determinant positive and the step oppose the residual.

J. Nocedal and S. J. Wright, Numerical Optimization, 2nd ed., Springer 2006, section 3.4.
"""

import numpy as np

from seal_mdao.analysis.assembly import Assembly
from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.newton import converged
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.pseudo_time import FAR
from seal_mdao.equilibrium.eigenmodes import nearest_mode

# Shift alpha over |lowest eigenvalue|, and its growth factor while it is too small.
ENOUGH, MORE = 2.0, 4.0
# A step s is halved until r(d + t s) . s <= -TURNED r(d) . s: largest opposing force along it.
TURNED = 0.5
HALVINGS = 12
# Where halving fails alpha is multiplied by RISE, from FIRST times the mean diagonal entry on; each
# accepted step multiplies it by FALL. Above SLOWEST times the mean diagonal entry descent is given up.
RISE, FIRST, FALL, SLOWEST = 10.0, 1e-9, 0.2, 1e3
# Below that relative residual full Newton steps of a stable state are accepted without the test.
NEAR = 1e-3


def descend(increment: Increment, guess: np.ndarray) -> Solution:
    """Find a stable equilibrium of lower potential from ``guess`` (n, 2), which must not be one itself.

    The status is MOVED_OFF where the body moves away without bound.
    """
    now = increment.evaluate(guess)
    if now is None:
        return Solution(Status.INVERTED, guess, ())
    residuals = []
    try:
        return _descend(increment, now, residuals)
    except np.linalg.LinAlgError:
        return Solution(Status.SINGULAR, guess, tuple(residuals), now)


def _descend(increment: Increment, now: Assembly, residuals: list) -> Solution:
    """Descend from the state ``now``; the relative residuals are appended to ``residuals``."""
    far = FAR * np.ptp(increment.problem.discretization.particles, axis=0).max()
    # least: lower bound of alpha, 0 unless halving has failed
    stiffness, least = now.mean_stiffness, 0.0
    first = FIRST * stiffness
    for number in range(increment.options.damped_iterations):
        residuals.append(now.size)
        if increment.note is not None:
            increment.note(number, now.size)
        if not np.isfinite(now.size):  # beyond the limit of a material
            return Solution(Status.DIVERGED, now.d, tuple(residuals), now)
        factor, shift = _definite(now, least, first)
        if shift == 0.0 and converged(now, increment.options):
            return Solution(Status.CONVERGED, now.d, tuple(residuals), now, factor)
        if np.abs(now.d).max() > far:
            return Solution(Status.MOVED_OFF, now.d, tuple(residuals), now)
        # (K + alpha I) s = -r
        step = -factor.solve(now.residual)
        length = _step_length(increment, now, step, shift == 0.0 and now.size < NEAR)
        least = RISE * max(shift, first) if not length else FALL * least if least > first else 0.0
        if least > SLOWEST * stiffness:
            break
        # a new solution: no sliding point is forced to stick for its earlier direction
        now = increment.evaluate(now.d + length * increment.gather(step))
    return Solution(Status.NOT_CONVERGED, now.d, tuple(residuals), now)


def _definite(now: Assembly, least: float, first: float):
    """Factorise K + alpha I, alpha >= ``least`` and such that it is positive definite.

    Returns
    -------
    factor : Factor
    shift : float
        alpha; 0 where K itself is positive definite.

    Raises
    ------
    LinAlgError
        No alpha suffices, as for a tangent with entries that are not numbers.
    """
    symmetric = now.problem.symmetric
    factor, shift = now.factorize(check=True), least
    if factor.positive and not least:
        return factor, 0.0
    if not factor.positive and symmetric:
        # alpha = ENOUGH |lambda|, lambda the negative eigenvalue nearest to zero; more negative ones
        # are found by the loop below, which enlarges alpha until the factor is positive definite
        lowest = nearest_mode(factor, now.residual.size, True, negative=True)[0]
        shift = max(shift, ENOUGH * abs(lowest))
    shift = max(shift, first)
    while np.isfinite(shift):
        factor = now.factorize(check=True, shift=shift)
        # unsymmetric: positive determinant, and s . r = -r . (K + alpha I)^-1 r < 0
        if factor.positive and (symmetric or now.residual @ factor.solve(now.residual) > 0.0):
            return factor, shift
        shift *= MORE
    raise np.linalg.LinAlgError("no shift makes the tangent positive definite")


def _step_length(increment: Increment, now: Assembly, step, full: bool) -> float:
    """Find the step length t in {1, 1/2, 1/4, ...} by backtracking; 0 where none descends.

    With ``full`` the first one without inverted quadrature points, without a test of the force.
    """
    driven, whole, length = now.residual @ step, increment.gather(step), 1.0
    for _ in range(HALVINGS):
        trial = increment.evaluate(now.d + length * whole, tangent=False)
        # curvature condition on the slope of the potential: r(d + t s) . s <= -TURNED r(d) . s
        if trial is not None and (full or trial.residual @ step <= -TURNED * driven):
            return length
        length *= 0.5
    return 0.0

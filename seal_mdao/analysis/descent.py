"""Regularised Newton descent from an unstable state to a stable equilibrium at a fixed loading.

Newton steps s = -(K + alpha I)^-1 r, with the smallest alpha that makes K + alpha I positive definite,
each halved until the force along it does not oppose it: they descend the potential, and end as Newton's
method where K itself is positive definite. Where halving does not suffice, alpha grows temporarily.
The potential itself is not evaluated. Under friction, where there is none, the same steps are tried as a
last resort: alpha makes the determinant positive and the step oppose the residual.

J. Nocedal and S. J. Wright, Numerical Optimization, 2nd ed., Springer 2006, section 3.4.
"""

from collections.abc import Callable

import numpy as np

from seal_mdao.analysis.newton import NewtonOptions, converged
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.pseudo_time import FAR
from seal_mdao.analysis.result import Status
from seal_mdao.equilibrium.modes import nearest_mode

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


def descend(
    problem: PathProblem,
    d,
    target: float,
    history,
    options: NewtonOptions,
    note: Callable[[int, float], None] | None = None,
):
    """Find a stable equilibrium of lower potential from ``d``, which must not be an equilibrium.

    Parameters
    ----------
    note : callable, optional
        Called with the number of every iteration and the relative residual.

    Returns
    -------
    status, d, residuals
        As of ``newton``; MOVED_OFF where the body moves away without bound.
    """
    residuals = []
    far = FAR * np.ptp(problem.discretization.particles, axis=0).max()
    problem.begin()
    if not problem.assemble(d, target, history):
        return Status.INVERTED, d, ()
    # least: lower bound of alpha, 0 unless halving has failed
    first = FIRST * np.abs(problem.values[problem.discretization.layout.storage.diagonal()]).mean()
    (residual, size, rounding), least = problem.residual(), 0.0
    try:
        for number in range(options.damped_iterations):
            residuals.append(size)
            if note is not None:
                note(number, size)
            if not np.isfinite(size):  # beyond the limit of a material
                return Status.DIVERGED, d, tuple(residuals)
            factor, stable, shift = _definite(problem, least, residual, first)
            if stable and converged(problem, size, rounding, options):
                return Status.CONVERGED, d, tuple(residuals)
            if np.abs(d).max() > far:
                return Status.MOVED_OFF, d, tuple(residuals)
            # (K + alpha I) s = -r
            step = -factor.solve(residual)
            taken = _step_length(
                problem, d, step, residual, target, history, stable and size < NEAR
            )
            least = (
                RISE * max(shift, first) if not taken else FALL * least if least > first else 0.0
            )
            # first / FIRST is the mean diagonal entry
            if least > SLOWEST * first / FIRST:
                break
            d = d + taken * problem.discretization.layout.gather(step)
            problem.begin()  # no sliding point is forced to stick for its earlier direction
            problem.assemble(d, target, history)
            residual, size, rounding = problem.residual()
    except np.linalg.LinAlgError:
        return Status.SINGULAR, d, tuple(residuals)
    return Status.NOT_CONVERGED, d, tuple(residuals)


def _definite(problem: PathProblem, least: float, residual, first: float):
    """Factorise K + alpha I, alpha >= ``least`` and such that it is positive definite.

    Returns
    -------
    factor : Factor
    stable : bool
        Whether K is positive definite and not shifted.
    shift : float
        alpha.
    """
    storage, values = problem.discretization.layout.storage, problem.values.copy()
    factor, shift = problem.factorize(check=True), least
    stable = factor.positive
    if stable and not least:
        return factor, True, 0.0
    if not stable and problem.symmetric:
        # alpha = ENOUGH |lambda|, lambda the negative eigenvalue nearest to zero; more negative ones
        # are found by the loop below, which enlarges alpha until the factor is positive definite
        lowest = nearest_mode(factor, storage.n, True, negative=True)[0]
        shift = max(shift, ENOUGH * abs(lowest))
    shift = max(shift, first)
    while True:
        problem.values[:] = values
        problem.values[storage.diagonal()] += shift
        factor = problem.factorize(check=True)
        # unsymmetric: positive determinant, and s . r = -r . (K + alpha I)^-1 r < 0
        if factor.positive and (problem.symmetric or residual @ factor.solve(residual) > 0.0):
            return factor, False, shift
        shift *= MORE


def _step_length(problem, d, step, residual, target, history, full: bool) -> float:
    """Find the step length t in {1, 1/2, 1/4, ...} by backtracking; 0 where none descends.

    With ``full`` the first one without inverted quadrature points, without a test of the force.
    """
    driven, increment, length = residual @ step, problem.discretization.layout.gather(step), 1.0
    for _ in range(HALVINGS):
        problem.begin()
        # curvature condition on the slope of the potential: r(d + t s) . s <= -TURNED r(d) . s
        if problem.assemble_forces(d + length * increment, target, history) and (
            full or problem.residual()[0] @ step <= -TURNED * driven
        ):
            return length
        length *= 0.5
    return 0.0

"""The way down from a state that is not stable to the next stable equilibrium, at a fixed loading.

Newton steps with the tangent K + alpha I, alpha as small as makes it positive definite, each halved
until the force along it has not turned against it: they lead down the potential, and end as Newton's
method where K itself is positive definite. Where halving does not help, alpha grows for a while.
The potential is not needed. Under friction, where there is none, the same steps are tried where nothing
else leads on: alpha is such that the determinant is positive and the step goes against the residual.

J. Nocedal and S. J. Wright, Numerical Optimization, 2nd ed., Springer 2006, section 3.4.
"""

from collections.abc import Callable

import numpy as np

from seal_mdao.analysis.newton import NewtonOptions, converged
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.pseudo_time import FAR
from seal_mdao.analysis.result import Status
from seal_mdao.equilibrium.modes import nearest_mode

# Shift over the size of the negative eigenvalue, and by how much it grows while it is too small.
ENOUGH, MORE = 2.0, 4.0
# A step is halved until the force against it is at most that share of the force that drove it.
TURNED = 0.5
HALVINGS = 12
# Where that is not enough the shift is so many times larger, and at first that share of the mean
# diagonal entry; with every step that is, it falls again. From SLOWEST on it is given up.
RISE, FIRST, FALL, SLOWEST = 10.0, 1e-9, 0.2, 1e3
# From that relative residual on full Newton steps of a stable state are taken as they are.
NEAR = 1e-3


def descend(
    problem: PathProblem,
    d,
    target: float,
    history,
    options: NewtonOptions,
    note: Callable[[int, float], None] | None = None,
):
    """Stable equilibrium below the state ``d``, which must not be an equilibrium itself.

    Parameters
    ----------
    note : callable, optional
        Called with the number of every iteration and the relative residual.

    Returns
    -------
    status, d, residuals
        As of ``newton``; MOVED_OFF where the body leaves for ever.
    """
    residuals = []
    far = FAR * np.ptp(problem.discretization.particles, axis=0).max()
    problem.begin()
    if not problem.assemble(d, target, history):
        return Status.INVERTED, d, ()
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
            step = -factor.solve(residual)
            share = _share(problem, d, step, residual, target, history, stable and size < NEAR)
            least = (
                RISE * max(shift, first) if not share else FALL * least if least > first else 0.0
            )
            if least > SLOWEST * first / FIRST:
                break
            d = d + share * problem.discretization.layout.gather(step)
            problem.begin()  # no sliding point is held for its direction before
            problem.assemble(d, target, history)
            residual, size, rounding = problem.residual()
    except np.linalg.LinAlgError:
        return Status.SINGULAR, d, tuple(residuals)
    return Status.NOT_CONVERGED, d, tuple(residuals)


def _definite(problem: PathProblem, least: float, residual, first: float):
    """Factor of the assembled tangent, shifted where it is not positive definite and by ``least``;
    whether it is so without a shift; the shift."""
    storage, values = problem.discretization.layout.storage, problem.values.copy()
    factor, shift = problem.factorize(check=True), least
    stable = factor.positive
    if stable and not least:
        return factor, True, 0.0
    if not stable and problem.symmetric:
        lowest = nearest_mode(factor, storage.n, True, negative=True)[0]
        shift = max(shift, ENOUGH * abs(lowest))
    shift = max(shift, first)
    while True:
        problem.values[:] = values
        problem.values[storage.diagonal()] += shift
        factor = problem.factorize(check=True)
        if factor.positive and (problem.symmetric or residual @ factor.solve(residual) > 0.0):
            return factor, False, shift
        shift *= MORE


def _share(problem, d, step, residual, target, history, whole: bool) -> float:
    """How much of a step is taken: the whole one near the end, if no point is turned inside out; 0 where
    no share of it leads down."""
    driven, way, share = residual @ step, problem.discretization.layout.gather(step), 1.0
    for _ in range(HALVINGS):
        problem.begin()
        if problem.assemble_forces(d + share * way, target, history) and (
            whole or problem.residual()[0] @ step <= -TURNED * driven
        ):
            return share
        share *= 0.5
    return 0.0

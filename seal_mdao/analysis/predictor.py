"""Predictors of an increment, in the order in which they are made and tried.

1. Euler's, from the tangent of the last converged step (``predict``): one, or two where a term gives two
   estimates of how its force changes.
2. With the curvature that the step before showed (``bend_of``); of two the one with the smaller residual
   (``closest``).
3. With the forces of points that begin to touch (``touching``). Where no corrector converges from that
   one, they are tried from the second one as well.
"""

from collections.abc import Iterator

import numpy as np

from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.jumps import SMALL_BEND
from seal_mdao.analysis.path_result import ConvergedStep
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.touching import at_rest_where_it_touches


def predictors(increment: Increment, euler: np.ndarray, bend) -> Iterator[np.ndarray]:
    """Yield the predictors (n, 2) from which the correctors are tried, in this order.

    Parameters
    ----------
    euler : ndarray, shape (1 or 2, n, 2)
        Of ``predict``.
    bend : ndarray or None
        Of ``bend_of`` at the last step.
    """
    bent = 0.0 if bend is None else (increment.target - increment.last.fraction) ** 2 * bend
    guess = closest(increment, euler + bent)
    touching = at_rest_where_it_touches(increment, guess)
    yield touching
    if touching is not guess:
        yield guess


def predict(increment: Increment) -> np.ndarray:
    """Compute Euler predictors (1 or 2, n, 2) from a converged step, reusing its factorisation."""
    # each term gives the change of its force with the loading at fixed d: none, one, or two
    # estimates (slip continues, or stops); combine all first ones, and all second ones
    step, problem = increment.last, increment.problem
    loads = [np.zeros(problem.discretization.layout.force_size)]
    for term, response in zip(problem.terms, step.responses, strict=True):
        changes = term.changes(step, response, increment.target)
        if changes:
            pairs = max(len(loads), len(changes))
            loads = [loads[min(i, len(loads) - 1)] + changes[min(i, len(changes) - 1)]
                     for i in range(pairs)]  # fmt: skip
    return np.stack([_euler(increment, load) for load in loads])


def _euler(increment: Increment, load) -> np.ndarray:
    """Compute d_n - K^-1 load, with ``load`` the change of the forces at fixed displacements."""
    problem, d = increment.problem, increment.last.d
    layout = problem.discretization.layout
    layout.condense_force(load)
    load = load[: layout.n_equations]
    if problem.imposed is not None:
        # prescribed increment du_p: its forces K_fp du_p on the free components are part of the load
        du = problem.prescribed_increment(increment.last.fraction, increment.target)
        load = load + _prescribed_rate(problem, increment.last, du)
        d = d + du
    return d - layout.gather(increment.factor.solve(load))


def _prescribed_rate(problem: PathProblem, last: ConvergedStep, du, step=1e-6) -> np.ndarray:
    """Compute the change K_fp du_p of the forces at the last step with prescribed displacements.

    By a forward difference, which suffices for the predictor.
    """
    moved, own = (
        problem.forces_on_all(d, last.fraction, last.before) for d in (last.d + step * du, last.d)
    )
    change = moved - own
    return problem.discretization.layout.reduce(change / step)


def closest(increment: Increment, guesses) -> np.ndarray:
    """Select the displacements with the smallest relative residual."""
    if len(guesses) == 1:
        return guesses[0]
    found = [increment.evaluate(d, tangent=False) for d in guesses]
    return guesses[int(np.argmin([np.inf if own is None else own.size for own in found]))]


def bend_of(step: ConvergedStep, before: ConvergedStep, euler) -> np.ndarray | None:
    """Compute the error of the Euler predictor per square of the step, which estimates that of the
    next step.

    None where a term went to another branch, for the path has a kink there, and where it is no small
    correction of the step.
    """
    missed = step.d - euler
    small = np.abs(missed).max() <= SMALL_BEND * np.abs(euler - before.d).max()
    if not (small and step.same_branches(before)):
        return None
    # curvature: missed = 1/2 d'' (delta lambda)^2
    return missed / (step.fraction - before.fraction) ** 2

"""Points that begin to touch, for the predictor: Euler's knows the forces of the last step only.

It leads many points into a profile of which few touch in the end, and Newton's method begins with all
of them pressed in. So what such points do is found first, with the body as linear as at the last
converged step, with tangent K, and their own laws f as they are:

    u = -K^-1 P^T r,    r = f(x + P u),    P: shape functions at these points,

a small problem for the forces r, by Newton's method. From there none or few change their state.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import ConvergedStep

MOST_ITERATIONS = 30
# Relative, of a prediction.
TOLERANCE = 1e-8


class _Points(NamedTuple):
    """Points of one term that touch at the predictor and did not at the last converged step."""

    term: object
    history: object
    points: np.ndarray


def unit_loads(problem: PathProblem, term, points: np.ndarray) -> list:
    """Loads (n_equations,) of unit forces in x and y at points (m,) of a term, one after the other."""
    layout, loads = problem.discretization.layout, []
    for point in points:
        branch, force = np.zeros(len(term.where), int), np.zeros((len(term.where), 2))
        branch[point] = 1
        for component in range(2):
            force[point] = np.eye(2)[component]
            load = term.point_loads(force, branch)
            layout.condense_force(load)
            loads.append(load[: layout.n_equations])
    return loads


def _respond(problem: PathProblem, term, d, target: float, history):
    """What a term at single points answers; its force goes nowhere."""
    raw, nowhere = problem.discretization.transformation.coefficients(d), np.empty(0)
    force = np.zeros(problem.discretization.layout.force_size)
    return term.add(d, raw, target, history, force, nowhere)


def _new_points(problem: PathProblem, d, target: float, last: ConvergedStep) -> list[_Points]:
    """Points that touch at ``d`` and did not at the last step, of all terms at single points."""
    found = []
    for term, history, then in zip(problem.terms, last.after, last.responses, strict=True):
        if not term.couples_points:
            now = _respond(problem, term, d, target, history)
            points = np.flatnonzero((now.branch != 0) & (then.branch == 0))
            if points.size:
                found.append(_Points(term, history, points))
    return found


def at_rest_where_it_touches(
    problem: PathProblem, guess, target: float, last: ConvergedStep
) -> np.ndarray:
    """The predictor ``guess`` (n, 2), moved to where the points that begin to touch are at rest.

    Parameters
    ----------
    problem : PathProblem
        Its factor is that of the tangent at ``last``.

    Returns
    -------
    ndarray, shape (n, 2)
        ``guess`` itself where no point begins to touch, or where they come to no rest.
    """
    problem.begin()
    new = _new_points(problem, guess, target, last)
    if not new:
        return guess
    layout = problem.discretization.layout
    loads = np.array([load for own in new for load in unit_loads(problem, own.term, own.points)])
    moved = problem.factor.solve(np.ascontiguousarray(loads.T))
    compliance = loads @ moved
    problem.begin()
    d, r = guess, np.zeros(len(loads))
    for _ in range(MOST_ITERATIONS):
        responses = [_respond(problem, own.term, d, target, own.history) for own in new]
        both = list(zip(new, responses, strict=True))
        force = np.concatenate([now.force[own.points].ravel() for own, now in both])
        tangent = block_diag(*(block for own, now in both for block in now.tangent[own.points]))
        off = r - force
        if np.linalg.norm(off) <= TOLERANCE * max(np.linalg.norm(force), np.linalg.norm(r)):
            return d
        try:
            r = r - np.linalg.solve(np.eye(r.size) + tangent @ compliance, off)
        except np.linalg.LinAlgError:
            return guess
        d = guess - layout.gather(moved @ r)
    return guess

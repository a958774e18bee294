"""Correction of the predictor for points that begin to touch.

The Euler predictor moves many points into a profile of which few touch in the end, and Newton's method
would start with all of them in penetration. The contact forces of these points are therefore found
first, with the body linearised at the last converged step (tangent K) and the points' own laws f:

    u = -K^-1 P^T r,    r = f(x + P u),    P: shape functions at these points,

a small nonlinear problem for the forces r, solved by Newton's method. Few points change their state
after that.

Walls of the body that touch each other are predicted by ``linear_contact``.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.problem import PathProblem

MOST_ITERATIONS = 30
# Relative residual of that small problem.
TOLERANCE = 1e-8


class _Points(NamedTuple):
    """Points of one term that touch at the predictor and did not at the last converged step."""

    term: object
    history: object
    points: np.ndarray


def unit_loads(problem: PathProblem, term, points: np.ndarray) -> list:
    """Assemble loads (n_equations,) of unit forces at points (m,) of a term: x, y of the first, ..."""
    layout, loads = problem.discretization.layout, []
    # column of P: force e_i at one point, through its shape functions; branch 1 marks the only
    # point with a force
    for point in points:
        branch, force = np.zeros(len(term.where), int), np.zeros((len(term.where), 2))
        branch[point] = 1
        for component in range(2):
            force[point] = np.eye(2)[component]
            load = term.point_loads(force, branch)
            layout.condense_force(load)
            loads.append(load[: layout.n_equations])
    return loads


def _respond(increment: Increment, term, d, history):
    """Evaluate the response of a term at single points; its assembled force is discarded."""
    disc = increment.problem.discretization
    raw, force = disc.transformation.coefficients(d), np.zeros(disc.layout.force_size)
    return term.add(d, raw, increment.target, history, force, np.empty(0))


def _new_points(increment: Increment, d) -> list[_Points]:
    """List points that touch at ``d`` and did not at the last step, of all terms at single points."""
    found, responses = [], increment.last.responses
    for term, history, before in zip(
        increment.problem.terms, increment.history, responses, strict=True
    ):
        if not term.couples_points:
            term.begin()
            now = _respond(increment, term, d, history)
            points = np.flatnonzero((now.branch != 0) & (before.branch == 0))
            if points.size:
                found.append(_Points(term, history, points))
    return found


def _laws(increment: Increment, new: list[_Points], d):
    """Forces f (2 m,) of all points and their tangent df/dx (2 m, 2 m)."""
    responses = [_respond(increment, own.term, d, own.history) for own in new]
    both = list(zip(new, responses, strict=True))
    force = np.concatenate([now.force[own.points].ravel() for own, now in both])
    return force, block_diag(*(block for own, now in both for block in now.tangent[own.points]))


def at_rest_where_it_touches(increment: Increment, guess: np.ndarray) -> np.ndarray:
    """Correct the predictor ``guess`` (n, 2) to equilibrium of the points that begin to touch.

    Returns
    -------
    ndarray, shape (n, 2)
        ``guess`` itself where no point begins to touch, or Newton's method does not converge.
    """
    problem, new = increment.problem, _new_points(increment, guess)
    if not new:
        return guess
    loads = np.array([load for own in new for load in unit_loads(problem, own.term, own.points)])
    # moved = K^-1 P^T and the compliance P K^-1 P^T of the points
    moved = increment.factor.solve(np.ascontiguousarray(loads.T))
    compliance = loads @ moved
    for own in new:
        own.term.begin()
    d, r = guess, np.zeros(len(loads))
    for _ in range(MOST_ITERATIONS):
        force, tangent = _laws(increment, new, d)
        # residual r - f(x + P u(r)); tangent of f: df/dx
        off = r - force
        if np.linalg.norm(off) <= TOLERANCE * max(np.linalg.norm(force), np.linalg.norm(r)):
            return d
        try:
            # with u = -K^-1 P^T r:  (1 + df/dx P K^-1 P^T) dr = -(r - f)
            r = r - np.linalg.solve(np.eye(r.size) + tangent @ compliance, off)
        except np.linalg.LinAlgError:
            return guess
        d = guess - increment.gather(moved @ r)
    return guess

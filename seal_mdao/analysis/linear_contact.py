"""Linear steps that satisfy the contact law: sequential linearisation for stiff self-contact.

The tangent of Newton's method has every point open, sticking or slipping as it was. Walls that fold
onto each other at stiff penalties change that at many points at once, and since both walls have points
their conditions depend nearly linearly on each other: a step with wrong states leads far away, where
the next states are worse. Here only the body and the kinematics are linearised (tangent K), and the
contact law stays as it is. With u the step of the tangent, the contact forces r beyond the linearised
ones satisfy

    r = f(B (u - K^-1 B^T r)),    B: rates of gap and natural coordinate of the points,

a small problem with piecewise smooth f, solved by Newton's method with a line search. Where the
iterations converge r is zero, so they converge to the same equilibrium, as fast as Newton's method.

N. H. Josephy, Newton's method for generalized equations, Mathematics Research Center report 1965,
University of Wisconsin, 1979; S. P. Dirkse, M. C. Ferris, The PATH solver: a nonmonotone stabilization
scheme for mixed complementarity problems, Optimization Methods and Software 5, 1995.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.increment import Increment

MOST_ITERATIONS = 60
# Residual of the small problem relative to its forces.
TOLERANCE = 1e-7
# Smallest fraction of a Newton step, and decrease of the residual relative to the fraction.
SMALLEST, DECREASE = 0.01, 0.1


class _State(NamedTuple):
    """The small problem at one r: displacements, residual, deviations of the law and their slopes."""

    d: np.ndarray
    off: np.ndarray
    deviation: np.ndarray
    slopes: np.ndarray

    @property
    def size(self) -> float:
        return float(np.linalg.norm(self.off))


class _Step:
    """Points whose forces deviate from the linearised ones, with their unit loads.

    Parameters
    ----------
    contacts : list
        As of ``PathProblem.linear_contacts``.
    d : ndarray, shape (n, 2)
        Displacements after the step of the tangent.
    factor : object
        Factor of the tangent.
    """

    def __init__(self, increment: Increment, contacts: list, d, factor):
        self.increment, self.contacts, self.d, self.factor = increment, contacts, d, factor
        self.first = np.cumsum([0, *map(len, contacts)])
        self.scale = max(np.linalg.norm(own.linearization.forces) for own in contacts)
        self.points = np.empty(0, int)
        self.loads = np.empty((0, increment.problem.discretization.layout.n_equations))
        self.moved = self.loads.T

    def at(self, r) -> _State:
        """Evaluate at forces ``r`` (2 p,) of the points."""
        # u - K^-1 B^T r
        d = self.d - self.increment.gather(self.moved @ r) if r.size else self.d
        # f beyond the linearised forces, and df by the motion (dg, dxi)
        found = [own.deviation(own.motion(d)) for own in self.contacts]
        deviation, slopes = (np.concatenate(parts) for parts in zip(*found, strict=True))
        # r - f
        off = -deviation
        off[self.points] += r.reshape(-1, 2)
        return _State(d, off, deviation, slopes)

    def converged(self, r, now: _State) -> bool:
        # relative to the forces of the linearisation, of the law and r
        scale = max(self.scale, np.linalg.norm(now.deviation), np.linalg.norm(r))
        return now.size <= TOLERANCE * scale

    def with_new_points(self, r, now: _State) -> np.ndarray:
        """Add the points outside that deviate; return ``r`` with zeros for them."""
        # points whose state differs from that of the tangent
        outside = now.deviation.any(axis=1)
        outside[self.points] = False
        new, layout = np.flatnonzero(outside), self.increment.problem.discretization.layout
        if not new.size:
            return r
        loads = []
        for point in new:
            contact = int(np.searchsorted(self.first, point, side="right")) - 1
            for load in self.contacts[contact].loads(point - self.first[contact]):
                layout.condense_force(load)
                loads.append(load[: layout.n_equations])
        loads = np.array(loads)
        # K^-1 B^T
        moved = self.factor.solve(np.ascontiguousarray(loads.T))
        self.points = np.concatenate([self.points, new])
        self.loads, self.moved = np.vstack([self.loads, loads]), np.hstack([self.moved, moved])
        return np.concatenate([r, np.zeros(len(loads))])

    def newton(self, now: _State) -> np.ndarray:
        """Compute Newton's step of r."""
        # (1 + df B K^-1 B^T) dr = -(r - f)
        compliance = (self.loads @ self.moved).reshape(-1, 2, self.loads.shape[0])
        tangent = np.einsum("mij,mjk->mik", now.slopes[self.points], compliance)
        tangent = tangent.reshape(len(self.loads), -1) + np.eye(len(self.loads))
        return -np.linalg.solve(tangent, now.off[self.points].ravel())

    def searched(self, r, step, now: _State) -> tuple[np.ndarray, _State]:
        """Search along Newton's step for a smaller residual; the smallest one found where none is."""
        fraction, best = 1.0, None
        while fraction >= SMALLEST:
            trial = self.at(r + fraction * step)
            if best is None or trial.size < best[1].size:
                best = r + fraction * step, trial
            # |r - f| falls by at least DECREASE of what the linear problem promises
            if trial.size < (1.0 - DECREASE * fraction) * now.size:
                return r + fraction * step, trial
            fraction *= 0.5
        return best


def with_contact(increment: Increment, contacts: list, d, factor) -> np.ndarray:
    """Correct a linear step to one that satisfies the contact law of the points of ``contacts``.

    Parameters
    ----------
    contacts : list
        As of ``PathProblem.linear_contacts``, linearised where the tangent is.
    d : ndarray, shape (n, 2)
        Displacements after the step of the tangent.
    factor : object
        Factor of the tangent.

    Returns
    -------
    ndarray, shape (n, 2)
        ``d`` itself where all points are in the states of the tangent, or no solution is found.
    """
    if not contacts:
        return d
    step, r = _Step(increment, contacts, d, factor), np.empty(0)
    for _ in range(MOST_ITERATIONS):
        now = step.at(r)
        if step.converged(r, now):
            return now.d
        r = step.with_new_points(r, now)
        try:
            r, now = step.searched(r, step.newton(now), now)
        except np.linalg.LinAlgError:
            return d
    return d


def predicted(increment: Increment, euler: np.ndarray) -> np.ndarray | None:
    """Correct the Euler predictor (n, 2) for self-contact; None where no walls face each other."""
    problem = increment.problem
    if not problem.touches_itself:
        return None
    iteration = problem.begin_mixed(increment.last, increment.target)
    contacts = problem.linear_contacts(iteration, increment.history)
    return with_contact(increment, contacts, euler, increment.factor) if contacts else None

"""The load path: displacement-driven increments with predictors, correctors and step cutting.

Every increment goes through the same list, each entry only where those before it failed:

1. Where a nearby solution is known (``solve_path(near=...)``): mixed iterations from there.
2. Where walls of the body face each other: mixed iterations from a predictor that satisfies their
   contact law (``linear_contact``).
3. The predictors (``predictor.predictors``): with the points that begin to touch, then without them.
4. From each of them the correctors (``corrected``): Newton's method; mixed iterations, for stiff
   contact. Where only profiles hold the body, none touches it yet and Newton's method cycles, also
   from the mean of the cycle.
5. Damped motion, where Newton's method cycles between stick and slip and the increment ends a nominal
   step.
6. Half of the increment, until it is the smallest one.
7. Another equilibrium, beyond a limit point (``limit_points.beyond``).

A step that was halved is solved as one from where its parts led, under friction.

Where profiles overlap the undeformed body at the start of the first load step, preliminary increments
up to the parameter 0 come before it: these profiles move there from where they are clear
(``Motion.retraction``), and nothing else changes. They are solved like load steps, but are not counted.

Always from the undeformed state and with a fixed step sequence, so that the same inputs give the
same bits whatever was computed before. Of two paths whose first steps are the same the second may
resume from the state of the first (``PathState``), which gives the same bits, too.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.jumps import FAR_AWAY, extent, is_far, jump_of, without_gain
from seal_mdao.analysis.limit_points import beyond, shortened
from seal_mdao.analysis.linear_contact import predicted
from seal_mdao.analysis.mixed_newton import mixed_newton
from seal_mdao.analysis.newton import NewtonOptions, iterate, newton
from seal_mdao.analysis.path_result import ConvergedStep, PathResult, Status
from seal_mdao.analysis.predictor import bend_of, predict, predictors
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.pseudo_time import ending, relax
from seal_mdao.analysis.stability import flagged
from seal_mdao.equilibrium.memory import keep_freed_memory
from seal_mdao.equilibrium.tangent_layout import Factor
from seal_mdao.equilibrium.threads import one_blas_thread

# Equilibrium that is near by is found by damped motion within so many iterations.
NEAR = 40
# A step that is not stable, or jumps, is halved that often: the path leaves its branch near the end.
NEAR_THE_END = 5


def corrected(increment: Increment, guess: np.ndarray) -> Solution:
    """Correct the predictor ``guess`` (n, 2) to equilibrium on the branch of the path.

    UNSTABLE, JUMPED or GAINED in place of CONVERGED where the path should not go there.
    """
    found = _judged(increment, newton(increment, guess), guess)
    if found.status in (Status.CONVERGED, Status.UNSTABLE):
        return found
    # mixed iterations from the same predictor, where Newton's method fails or jumps
    mixed = mixed_newton(increment, guess)
    residuals = found.residuals + mixed.residuals[1:]
    if mixed.converged and not is_far(increment, mixed.d, guess):
        return _judged(increment, mixed, guess)._replace(residuals=residuals)
    return found._replace(residuals=residuals, assembly=mixed.assembly)


def _judged(increment: Increment, found: Solution, guess) -> Solution:
    """Replace CONVERGED by UNSTABLE, JUMPED or GAINED where the path should not go."""
    if found.converged and increment.options.branch == "stable":
        jump = jump_of(increment, found.assembly, guess)
        if jump is not None:
            return found._replace(status=jump)
        if increment.problem.symmetric and not found.factor.positive:
            return found._replace(status=Status.UNSTABLE)
    return found


def is_free(problem: PathProblem) -> bool:
    """Return whether nothing but contact prevents a translation of the body."""
    # a radial displacement stretches a body of revolution
    first = 1 if problem.discretization.body.axisymmetric else 0
    return bool(np.any(np.all(problem.discretization.layout.equations[:, first:] >= 0, axis=0)))


def _most_cuts(status: Status, options: NewtonOptions) -> int:
    """Return how often a step that ends so is halved."""
    near = status in (Status.UNSTABLE, Status.JUMPED)
    return min(NEAR_THE_END, options.max_cuts) if near else options.max_cuts


class PathState(NamedTuple):
    """State after a nominal step on which the remaining load path depends.

    Attributes
    ----------
    steps, points : tuple
        Converged steps and critical points up to there.
    cuts : int
    bend : ndarray or None
        Of ``predictor.bend_of`` at the last step.
    factor : Factor
        Of the tangent at the last step.
    memory : float
        Bytes that are left for factors.
    """

    steps: tuple
    points: tuple
    cuts: int
    bend: np.ndarray | None
    factor: Factor
    memory: float


class _Path:
    """The path so far: its steps, and what the next one needs to know of them.

    Parameters
    ----------
    problem : PathProblem
    options : NewtonOptions
    memory : float
        Bytes for the factors that are kept.
    note, halved : callable or None
        Called in every iteration of damped motion, and where a step is halved.
    near : callable or None
        As of ``solve_path``.
    """

    def __init__(self, problem: PathProblem, options, memory: float, note, halved, near):
        self.problem, self.options, self.near, self.halved = problem, options, near, halved
        self.memory, self.note = memory, note
        self.steps, self.points, self.cuts, self.bend = [], [], 0, None
        # the undeformed state
        history = problem.no_history()
        undeformed = np.zeros_like(problem.discretization.particles)
        start = problem.evaluate(undeformed, problem.begins_at, history)
        for term, response in zip(problem.terms, start.responses, strict=True):
            term.check_start(response)
        self.factor = start.factorize()
        self.start = self.last = ConvergedStep(
            -1, problem.begins_at, start.d, history, start.responses, 0, (0.0,),
            stable=self.factor.positive,
        )  # fmt: skip

    def state(self) -> PathState:
        """Return all that the rest of the path depends on."""
        return PathState(
            tuple(self.steps), tuple(self.points), self.cuts, self.bend,
            self.factor, self.memory,
        )  # fmt: skip

    def resume(self, state: PathState) -> int:
        """Continue from the state of a path with the same steps up to there; return their number."""
        self.steps, self.points = list(state.steps), list(state.points)
        self.cuts, self.bend = state.cuts, state.bend
        self.last, self.factor, self.memory = self.steps[-1], state.factor, state.memory
        return self.last.nominal + 1

    def increment(self, target: float) -> Increment:
        """Return the increment from the last step to ``target``."""
        return Increment(
            self.problem, target, self.last.after, self.options, self.last, self.factor, self.note
        )

    def nominal_step(self, nominal: int) -> PathResult | None:
        """Make the nominal step, halved where need be; return the failed path where it ends in it.

        Negative ones are the preliminary increments.
        """
        begin, memory, n_points, pending = len(self.steps), self.memory, len(self.points), [1.0]
        while pending:
            part, last, point = pending.pop(), self.last, None
            increment = self.increment(last.fraction + part if pending else nominal + 1.0)
            euler = predict(increment)
            found, guess = self._solved(increment, euler)
            if found.status is Status.CYCLED and not pending:
                found = self._damped(increment, found, guess)
            if not found.converged and 0.5 * part >= 0.5 ** _most_cuts(found.status, self.options):
                self.cuts, self.bend = self.cuts + 1, None
                pending += [0.5 * part, 0.5 * part]
                if self.halved is not None:
                    self.halved(self.last.fraction)
                continue
            target = increment.target
            if not found.converged:
                failed = found
                found, point, target = beyond(increment, failed, guess, nominal + 1.0)
                if not found.converged:
                    return self._failed(nominal, increment, failed, found.status)
                pending = pending if target < nominal + 1.0 else []
            self._add(-1 if pending else max(nominal, -1), target, found, point)
            self.bend = bend_of(self.last, last, euler[0])
        if len(self.steps) > begin + 1 and self.problem.history_dependent:
            self._as_one(begin, memory, n_points)
        return None

    def _solved(self, increment: Increment, euler):
        """Try the correctors from each predictor in turn; return the solution and its predictor."""
        tried, near = (), None if self.near is None else self.near(increment)
        if near is not None:
            found = iterate(increment, *near, mixed=True)
            found = _judged(increment, found, near[0])
            if found.converged:
                return found, near[0]
            tried = found.residuals
        guess = predicted(increment, euler[0])
        if guess is not None:
            # walls face each other: mixed iterations whose linear steps satisfy the contact law
            found = mixed_newton(increment, guess)
            if found.converged and not is_far(increment, found.d, guess):
                found = _judged(increment, found, guess)
                if found.status in (Status.CONVERGED, Status.UNSTABLE):
                    return found, guess
            tried += found.residuals
        for guess in predictors(increment, euler, self.bend):
            found = corrected(increment, guess).after(tried)
            if found.converged:
                break
            tried = found.residuals
        if found.status is Status.CYCLED and not increment.last.touched and is_free(self.problem):
            # it moves from one profile to the other as if rigid; between them it touches both
            between = corrected(increment, found.d).after(tried)
            if between.converged:
                return between, found.d
        return found, guess

    def _damped(self, increment: Increment, failed: Solution, guess) -> Solution:
        """Solve an increment that ends a nominal step under friction by damped motion; return ``failed``
        where that finds no equilibrium nearby.

        Iterations that cycle between stick and slip do so in shorter increments, too.
        """
        if self.problem.symmetric:
            return failed
        found = relax(shortened(increment, NEAR), guess).after(failed.residuals)
        if not found.converged or is_far(increment, found.d, guess):
            return failed
        found = _judged(increment, found, guess)
        return found if found.converged else failed

    def _add(self, nominal: int, target: float, found: Solution, point=None) -> None:
        """Continue to the equilibrium ``found`` at ``target``."""
        problem, before, self.factor = self.problem, self.last, found.factor
        self.memory -= self.factor.nbytes
        self.last = ConvergedStep(
            nominal, target, found.d, before.after, found.assembly.responses,
            len(found.residuals) - 1, found.residuals,
            self.factor if self.memory >= 0.0 else None,
            self.factor.positive,
        )  # fmt: skip
        if point is None and before.stable and not self.last.stable:
            point = flagged(problem, self.factor, self.last, before)
        self.points += [] if point is None else [point]
        self.steps.append(self.last)

    def _as_one(self, begin: int, memory: float, n_points: int) -> None:
        """Solve the nominal step whose parts begin at index ``begin`` as one, from where they led.

        Under friction a step in parts is another path, and measures would jump where a change of the
        design makes Newton's method need them. Where there is no equilibrium nearby the parts stay.
        """
        parts, first = self.last, self.steps[begin - 1] if begin else self.start
        tried = tuple(size for step in self.steps[begin:] for size in step.residuals[:-1])
        increment = replace(self.increment(parts.fraction), history=first.after, last=first)
        near = max(np.abs(parts.d - first.d).max(), FAR_AWAY * extent(self.problem))
        found = newton(increment, parts.d).after(tried)
        if not found.converged:
            # stiff contact: linearised where the parts led
            found = mixed_newton(replace(increment, last=parts), parts.d).after(found.residuals)
            if np.abs(found.d - parts.d).max() > near:
                found = found._replace(status=Status.NOT_CONVERGED)
        if not found.converged:
            found = relax(shortened(increment, NEAR), parts.d).after(found.residuals)
        found = without_gain(increment, found)
        if not found.converged or np.abs(found.d - parts.d).max() > near:
            return
        del self.steps[begin:]
        self.last, self.memory, self.bend = first, memory, None
        # where stability was lost in the parts is not reported twice
        point = self.points.pop() if len(self.points) > n_points else None
        self._add(parts.nominal, parts.fraction, found, point)

    def _failed(self, nominal: int, increment: Increment, failed: Solution, status: Status):
        """Return the path up to where it ``failed``; damped motion ended with ``status``."""
        # nothing is differentiated; an exception that holds the path stays small
        steps = [replace(step, factor=None) for step in self.steps]
        return PathResult(
            self.problem, self.start, steps, failed.status, self.cuts,
            _describe(nominal, increment, failed), ending(status, self.options), tuple(self.points),
        )  # fmt: skip

    def completed(self) -> PathResult:
        """Return the complete path."""
        return PathResult(
            self.problem, self.start, self.steps, Status.CONVERGED, self.cuts,
            critical_points=tuple(self.points),
        )  # fmt: skip


@one_blas_thread
def solve_path(
    problem: PathProblem,
    n_steps: int,
    options: NewtonOptions | None = None,
    factor_memory: float = 0.0,
    callback: Callable[[ConvergedStep], None] | None = None,
    resume: PathState | None = None,
    states: dict | None = None,
    near: Callable | None = None,
) -> PathResult:
    """Compute the load path of a problem from the undeformed state.

    Parameters
    ----------
    problem : PathProblem
    n_steps : int
        Nominal load steps.
    factor_memory : float
        GiB for the factors of converged tangents, which the sensitivities use again. The first that
        fit are kept; the sweeps make the others again.
    callback : callable, optional
        Called with every ``ConvergedStep`` that completes a nominal step. Its methods ``damped`` and
        ``halved``, where it has them, are called with the number of every iteration of damped motion
        and the residual, and with the load steps completed where a load step is halved.
    resume : PathState, optional
        Of a path of the same body and terms whose nominal steps are the same up to there: those steps
        are taken, bit for bit what they would be.
    near : callable, optional
        ``near(increment)`` returns displacements (n, 2) near the solution and the state of mixed
        iterations there (``PathProblem.begin_near``), or None.
    states : dict of int to PathState, optional
        Added to: the state after every nominal step that is solved, by the number of nominal steps.

    Returns
    -------
    PathResult
        Complete, or up to the step that failed; no exception is raised for a failed path.

    Raises
    ------
    GeometryError
        When the undeformed state is not admissible (a body that starts inside a rigid profile).
    """
    keep_freed_memory()
    options = NewtonOptions() if options is None else options
    damped, halved = (getattr(callback, name, None) for name in ("damped", "halved"))
    path = _Path(problem, options, factor_memory * 2**30, damped, halved, near)
    begin = int(problem.begins_at) if resume is None else path.resume(resume)
    # report the steps that were taken as if they were solved now
    for step in path.steps if callback is not None else ():
        if step.nominal >= 0:
            callback(step)
    for nominal in range(begin, n_steps):
        failed = path.nominal_step(nominal)
        if failed is not None:
            return failed
        if nominal < 0:
            continue
        if callback is not None:
            callback(path.last)
        if states is not None:
            states[nominal + 1] = path.state()
    return path.completed()


def _describe(nominal: int, increment: Increment, failed: Solution) -> str:
    """Describe where the path ended, for messages."""
    terms, target, residuals = increment.problem.terms, increment.target, failed.residuals
    now = increment.last if failed.assembly is None else failed.assembly
    states = [
        term.describe(response, target) for term, response in zip(terms, now.responses, strict=True)
    ]
    return (
        f"load step {nominal + 1} (load parameter {target:.4f}): {failed.status.value}; relative "
        f"residual {residuals[-1] if residuals else np.nan:.2e} after {max(len(residuals) - 1, 0)} "
        "iterations" + "".join(f"; {state}" for state in states if state)
    )

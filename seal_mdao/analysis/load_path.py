"""The load path: displacement-driven steps with a predictor and step cutting.

The predictor is Euler's, from the converged tangent, with the curvature that the last step showed.
Where a term gives two estimates of how its force changes, the one with the smaller residual is taken.
What points do that begin to touch is predicted too (``touching``).
Where Newton's method fails mixed iterations follow (``mixed_newton``), for stiff contact.
A step that was halved is solved as one from where its parts led, under friction.
Where the smallest step still fails, damped motion leads to equilibrium at the end of the nominal one.
Where equilibrium is not stable, the path goes on to a stable one (``stability``).

Always from the undeformed state and with a fixed step sequence, so that the same inputs give the
same bits whatever was computed before.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seal_mdao.analysis.jumps import FAR_AWAY, SMALL_BEND, extent, is_far, jumped
from seal_mdao.analysis.limit_points import beyond
from seal_mdao.analysis.mixed_newton import mixed_newton
from seal_mdao.analysis.newton import NewtonOptions, newton
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.pseudo_time import ending, relax
from seal_mdao.analysis.quasi_newton import Reuse, quasi_newton
from seal_mdao.analysis.result import ConvergedStep, PathResult, Status
from seal_mdao.analysis.stability import flagged, is_stable
from seal_mdao.analysis.touching import at_rest_where_it_touches
from seal_mdao.equilibrium.threads import one_blas_thread

# Equilibrium that is near by is found by damped motion within so many iterations.
NEAR = 40
# A step that is not stable, or jumps, is halved that often: the path leaves its branch near the end.
NEAR_THE_END = 5


def _initial_step(problem: PathProblem) -> ConvergedStep:
    """The undeformed state, whose tangent is factorised."""
    d, history = np.zeros_like(problem.discretization.particles), problem.no_history()
    problem.begin()
    problem.assemble(d, 0.0, history)
    for term, response in zip(problem.terms, problem.responses, strict=True):
        term.check_start(response)
    problem.factorize()
    return _record(problem, -1, 0.0, d, history, (0.0,), None, is_stable(problem))


def _bend(step: ConvergedStep, before: ConvergedStep, euler) -> np.ndarray | None:
    """What the Euler predictor missed, per square of the step: the next one misses about the same.

    None where a term went to another branch, for the path has a kink there, and where it is no small
    correction of the step.
    """
    missed = step.d - euler
    small = np.abs(missed).max() <= SMALL_BEND * np.abs(euler - before.d).max()
    if not (small and step.same_branches(before)):
        return None
    return missed / (step.fraction - before.fraction) ** 2


def _correct(problem, guess, target, last, options, reuse):
    """Equilibrium from the predictor ``guess``, as ``newton`` returns it.

    Where old factors are not reused, or did not lead there, Newton's method finds it.
    """
    tried = ()
    if problem.discretization.layout.storage.reuses_factors and reuse.is_due():
        status, d, tried = quasi_newton(problem, guess, target, last, options)
        reuse.learn(status is Status.CONVERGED)
        if status is Status.CONVERGED:
            return status, d, tried
    status, d, residuals = newton(problem, guess, target, last.after, options)
    return status, d, tried + residuals


def _equilibrium(problem, guess, target, last, options, reuse):
    """Equilibrium as ``newton`` returns it; UNSTABLE or JUMPED where the path should not go there.

    Where Newton's method fails or jumps mixed iterations follow, which must not lead far away.
    """
    status, d, residuals = _correct(problem, guess, target, last, options, reuse)
    status = _judged(problem, status, d, guess, last, target, options)
    if status in (Status.CONVERGED, Status.UNSTABLE):
        return status, d, residuals
    mixed, found, more = mixed_newton(problem, guess, target, last, options)
    residuals += more[1:]  # from the same predictor
    if mixed is Status.CONVERGED and not is_far(problem, found, guess, last):
        return _judged(problem, mixed, found, guess, last, target, options), found, residuals
    return status, d, residuals


def _judged(problem, status, d, guess, last, target, options) -> Status:
    """UNSTABLE or JUMPED in place of CONVERGED where the path should not go; factor in ``problem``."""
    if status is Status.CONVERGED and options.branch == "stable":
        if jumped(problem, d, guess, last, target):
            return Status.JUMPED
        if problem.symmetric and not problem.factor.positive:
            return Status.UNSTABLE
    return status


def _most_cuts(status: Status, options: NewtonOptions) -> int:
    """How often a step that ends so is halved."""
    near = status in (Status.UNSTABLE, Status.JUMPED)
    return min(NEAR_THE_END, options.max_cuts) if near else options.max_cuts


def _record(problem, nominal, fraction, d, before, residuals, factor, stable) -> ConvergedStep:
    responses = tuple(response.kept() for response in problem.responses)
    return ConvergedStep(
        nominal, fraction, d, before, responses, len(residuals) - 1, residuals, factor, stable
    )


class _Walk:
    """The path so far: its steps, and what the next one needs to know of them.

    Parameters
    ----------
    problem : PathProblem
    n_steps : int
        Nominal load steps; the last one is asked whether it is stable, at any cost.
    options : NewtonOptions
    memory : float
        Bytes for the factors that are kept.
    note : callable or None
        Called in every iteration of damped motion.
    """

    def __init__(
        self, problem: PathProblem, n_steps: int, options: NewtonOptions, memory: float, note
    ):
        self.problem, self.n_steps, self.options = problem, n_steps, options
        self.memory, self.note = memory, note
        self.start = self.last = _initial_step(problem)
        self.steps, self.points, self.cuts, self.bend = [], [], 0, None
        self.reuse = Reuse()

    def nominal_step(self, nominal: int) -> PathResult | None:
        """Make the nominal step, halved where need be; the failed path where it ends in it."""
        problem, options, begin = self.problem, self.options, len(self.steps)
        memory, n_points, pending = self.memory, len(self.points), [1.0]
        while pending:
            share, last = pending.pop(), self.last
            target = nominal + 1.0 if not pending else last.fraction + share
            euler = problem.predict(last, problem.factor, target)
            bent = 0.0 if self.bend is None else (target - last.fraction) ** 2 * self.bend
            guess = problem.closest(euler + bent, target, last.after)
            euler_alone, guess = guess, at_rest_where_it_touches(problem, guess, target, last)
            status, d, residuals = _equilibrium(problem, guess, target, last, options, self.reuse)
            if status is not Status.CONVERGED and guess is not euler_alone:
                problem.factorize_at(last)
                guess, tried = euler_alone, residuals
                status, d, residuals = _equilibrium(
                    problem, guess, target, last, options, self.reuse
                )
                residuals = tried + residuals
            if status is not Status.CONVERGED and 0.5 * share >= 0.5 ** _most_cuts(status, options):
                self.cuts, self.bend = self.cuts + 1, None
                pending += [0.5 * share, 0.5 * share]
                # the predictor needs the tangent of the last converged step again
                problem.factorize_at(last)
                continue
            point = None
            if status is not Status.CONVERGED:
                failure = _describe(problem, status, nominal, target, residuals)
                onward, d, residuals, point, target = beyond(
                    problem, status, d, guess, (target, nominal + 1.0), last, options, self.note
                )
                if onward is not Status.CONVERGED:
                    return self._failed(status, failure, ending(onward, options))
                pending = pending if target < nominal + 1.0 else []
            self._add(-1 if pending else nominal, target, d, residuals, point)
            self.bend = _bend(self.last, last, euler[0])
        if len(self.steps) > begin + 1 and problem.history_dependent:
            self._as_one(begin, memory, n_points)
        return None

    def _add(self, nominal: int, target: float, d, residuals: tuple, point=None) -> None:
        """Go on to a converged step, whose factor is in the problem."""
        problem, before = self.problem, self.last
        self.memory -= problem.factor.nbytes
        kept = problem.factor.kept() if self.memory >= 0.0 else None
        stable = is_stable(problem, at_any_cost=nominal + 1 == self.n_steps)
        self.last = _record(problem, nominal, target, d, before.after, residuals, kept, stable)
        if point is None and before.stable and not self.last.stable:
            point = flagged(problem, self.last, before)
        self.points += [] if point is None else [point]
        self.steps.append(self.last)

    def _as_one(self, begin: int, memory: float, n_points: int) -> None:
        """Solve the nominal step whose parts begin at place ``begin`` as one, from where they led.

        Under friction a step in parts is another path, and measures would jump where a change of the
        design makes Newton's method need them. Where there is no equilibrium nearby the parts stay.
        """
        problem, parts = self.problem, self.last
        first = self.steps[begin - 1] if begin else self.start
        target, history = parts.fraction, first.after
        tried = tuple(size for step in self.steps[begin:] for size in step.residuals[:-1])
        status, d, residuals = newton(problem, parts.d, target, history, self.options)
        if status is not Status.CONVERGED:
            tried += residuals
            few = replace(self.options, damped_iterations=min(NEAR, self.options.damped_iterations))
            status, d, residuals = relax(problem, parts.d, target, history, few, self.note)
        near = max(np.abs(parts.d - first.d).max(), FAR_AWAY * extent(problem))
        if status is not Status.CONVERGED or np.abs(d - parts.d).max() > near:
            problem.factorize_at(parts)
            return
        del self.steps[begin:]
        self.last, self.memory, self.bend = first, memory, None
        # where stability was lost in the parts is not told twice
        point = self.points.pop() if len(self.points) > n_points else None
        self._add(parts.nominal, target, d, tried + residuals, point)

    def _failed(self, status: Status, failure: str, damped: str) -> PathResult:
        # nothing is differentiated; an exception that holds the path stays small
        steps = [replace(step, factor=None) for step in self.steps]
        return PathResult(
            self.problem, self.start, steps, status, self.cuts, failure, damped, tuple(self.points)
        )

    def completed(self) -> PathResult:
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
) -> PathResult:
    """Follow the program of a problem's terms from the undeformed state.

    Parameters
    ----------
    problem : PathProblem
    n_steps : int
        Nominal load steps.
    factor_memory : float
        GiB for the factors of converged tangents, which the sensitivities use again. The first that
        fit are kept; the sweeps make the others again.
    callback : callable, optional
        Called with every ``ConvergedStep`` that completes a nominal step. Its method ``damped``, where
        it has one, is called with the number of every iteration of damped motion and the residual.

    Returns
    -------
    PathResult
        Complete, or up to the step that failed; no exception is raised for a failed path.

    Raises
    ------
    GeometryError
        When the undeformed state is not admissible (a body that starts inside a rigid profile).
    """
    options = NewtonOptions() if options is None else options
    walk = _Walk(
        problem, n_steps, options, factor_memory * 2**30, getattr(callback, "damped", None)
    )
    for nominal in range(n_steps):
        failed = walk.nominal_step(nominal)
        if failed is not None:
            return failed
        if callback is not None:
            callback(walk.last)
    return walk.completed()


def _describe(problem, status, nominal, target, residuals) -> str:
    states = [
        term.describe(response, target)
        for term, response in zip(problem.terms, problem.responses, strict=False)
    ]
    return (
        f"load step {nominal + 1} (path parameter {target:.4f}): {status.value}; relative residual "
        f"{residuals[-1] if residuals else np.nan:.2e} after {max(len(residuals) - 1, 0)} iterations"
        + "".join(f"; {state}" for state in states if state)
    )

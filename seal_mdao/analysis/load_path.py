"""The load path: displacement-driven steps with a predictor and step cutting.

The predictor is Euler's, from the converged tangent, with the curvature that the last step showed.
With the incremental history there are two, and the one with the smaller residual is taken. Where the
smallest step still fails, damped motion leads to equilibrium at the end of the nominal one.

Always from the undeformed state and with a fixed step sequence, so that the same inputs give the
same bits whatever was computed before.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seal_mdao.analysis.body import Discretization
from seal_mdao.analysis.loading import LoadPoint, LoadProgram
from seal_mdao.analysis.newton import NewtonOptions, newton
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.pseudo_time import relax
from seal_mdao.analysis.quasi_newton import quasi_newton
from seal_mdao.analysis.result import ConvergedStep, PathResult, Status
from seal_mdao.analysis.threads import one_blas_thread
from seal_mdao.contact.friction import OPEN, SLIP, ContactHistory, ContactLaw, no_history
from seal_mdao.errors import GeometryError
from seal_mdao.geometry.profile import RigidProfile
from seal_mdao.materials.mooney_rivlin import MooneyRivlin

# Share of the step that the Euler predictor may miss if its miss is to predict the next one.
SMALL_BEND = 0.03


def _initial_step(problem: PathProblem, loading: LoadPoint) -> ConvergedStep:
    """The undeformed state, whose tangent is factorised."""
    disc = problem.discretization
    d, history = np.zeros_like(disc.particles), no_history(len(disc.body.contact))
    problem.assemble(d, loading, history)
    problem.factorize()
    return _record(problem, -1, 0.0, loading, d, history, (0.0,), None)


def _bend(step: ConvergedStep, before, euler, share) -> np.ndarray | None:
    """What the Euler predictor missed, per square of the step: the next one misses about the same.

    None where a contact state changed, for the path has a kink there, and where it is no small
    correction of the step.
    """
    missed = step.d - euler
    small = np.abs(missed).max() <= SMALL_BEND * np.abs(euler - before).max()
    if not (small and np.array_equal(step.before.state, step.after.state)):
        return None
    return missed / share**2


def _correct(problem, guess, target, last, options):
    """Equilibrium from the predictor ``guess``, as ``newton`` returns it.

    Where old factors are not reused, or did not lead there, Newton's method finds it.
    """
    tried = ()
    if problem.discretization.layout.storage.reuses_factors:
        status, d, tried = quasi_newton(problem, guess, target, last, options)
        if status is Status.CONVERGED:
            return status, d, tried
    status, d, residuals = newton(problem, guess, target, last.after, options)
    return status, d, tried + residuals


def _record(problem, nominal, fraction, loading, d, history, residuals, factor) -> ConvergedStep:
    after = ContactHistory(problem.state.copy(), problem.kept.copy())
    return ConvergedStep(
        nominal, fraction, loading, d, history, after, problem.x.copy(), problem.force.copy(),
        problem.gap.copy(), len(residuals) - 1, residuals, factor,
    )  # fmt: skip


@one_blas_thread
def solve_path(
    discretization: Discretization,
    material: MooneyRivlin,
    profile: RigidProfile,
    law: ContactLaw,
    program: LoadProgram,
    options: NewtonOptions | None = None,
    factor_memory: float = 0.0,
    callback: Callable[[ConvergedStep], None] | None = None,
) -> PathResult:
    """Follow a load program from the undeformed state.

    Parameters
    ----------
    program : LoadProgram
        Motion of the profile, imposed displacements and dead loads.
    factor_memory : float
        GiB for the factors of converged tangents, which the sensitivities use again. The first that
        fit are kept; the sweeps make the others again.
    callback : callable, optional
        Called with every ``ConvergedStep`` that completes a nominal step.

    Returns
    -------
    PathResult
        Complete, or up to the step that failed; no exception is raised for a failed path.

    Raises
    ------
    GeometryError
        When the undeformed body starts inside the profile.
    """
    options = NewtonOptions() if options is None else options
    problem = PathProblem(discretization, material, profile, law)
    start = _initial_step(problem, program.at(0.0))
    last = start
    if np.any(last.after.state != OPEN):
        deepest = -float(last.gap.min())
        raise GeometryError(
            f"the undeformed body starts {deepest:.3g} inside the rigid profile; start it farther away"
        )
    steps, cuts, bend, memory = [], 0, None, factor_memory * 2**30
    for nominal in range(program.n_steps):
        pending = [1.0]
        while pending:
            share = pending.pop()
            end = nominal + 1.0 if not pending else last.fraction + share
            target = program.at(end)
            euler = problem.predict(last, problem.factor, target)
            guesses = euler if bend is None else euler + (end - last.fraction) ** 2 * bend
            guess = problem.closest(guesses, target, last.after)
            status, d, residuals = _correct(problem, guess, target, last, options)
            if status is not Status.CONVERGED and share * 0.5 >= 0.5**options.max_cuts:
                cuts, bend = cuts + 1, None
                pending += [0.5 * share, 0.5 * share]
                # the predictor needs the tangent of the last converged step again
                problem.factorize_at(last)
                continue
            if status is not Status.CONVERGED:
                failure = _describe(problem, status, nominal, end, target, residuals)
                pending, end, target = [], nominal + 1.0, program.at(nominal + 1.0)
                euler = problem.predict(last, problem.factorize_at(last), target)
                guess = problem.closest(euler, target, last.after)
                relaxed, d, residuals = relax(problem, guess, target, last.after, options)
                if relaxed is not Status.CONVERGED:
                    # nothing is differentiated; an exception that holds the path stays small
                    steps = [replace(step, factor=None) for step in steps]
                    return PathResult(discretization, start, steps, status, cuts, failure)
            before = last
            memory -= problem.factor.nbytes
            kept = problem.factor.kept() if memory >= 0.0 else None
            last = _record(
                problem, -1 if pending else nominal, end, target, d, last.after, residuals,
                kept,
            )  # fmt: skip
            bend = _bend(last, before.d, euler[0], end - before.fraction)
            steps.append(last)
        if callback is not None:
            callback(last)
    return PathResult(discretization, start, steps, Status.CONVERGED, cuts)


def _describe(problem, status, nominal, end, target, residuals) -> str:
    state, (x, y) = problem.state, target.position
    return (
        f"load step {nominal + 1} (path parameter {end:.4f}, profile at x = {x:.4g}, "
        f"y = {y:.4g}): {status.value}; relative residual "
        f"{residuals[-1] if residuals else np.nan:.2e} after {max(len(residuals) - 1, 0)} iterations; "
        f"{int(np.sum(state != OPEN))} points in contact, {int(np.sum(state == SLIP))} slipping"
    )

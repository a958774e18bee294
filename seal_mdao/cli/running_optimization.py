"""Running an optimisation, for the scripts that do: how it ended, and how far from optimal."""

import argparse
import time
from collections.abc import Callable

import openmdao.api as om

import seal_mdao as sm
from seal_mdao.cli.arguments import WrongArgumentError, announce, checked_arguments
from seal_mdao.cli.recorded_runs import continued_file, recorder_file
from seal_mdao.drivers.optimality import Optimality, measure_optimality
from seal_mdao.optimization import (
    OPTIMIZERS,
    RunOptions,
    continue_run,
    major_iterations,
    optimization_problem,
)
from seal_mdao.progress import LoadStepProgress
from seal_mdao.recording.claim import RecorderBusyError
from seal_mdao.recording.evaluations import RestartError
from seal_mdao.recording.recorded_optimization import RecordedOptimization, read_optimization

FEASIBLE = 1e-3
"""Largest relative constraint violation of a design that counts as feasible."""


def run_optimization(
    arguments: argparse.Namespace, seal: sm.Seal, task_of: Callable, optimizer: str, kept
) -> tuple[RecordedOptimization, dict]:
    """Begin the optimisation of any seal, or continue the one of ``--restart``, and run it.

    Parameters
    ----------
    task_of : callable
        ``task_of(run)`` gives the ``Task``, with analyses by the ``RunOptions``.
    optimizer : str
        One of ``OPTIMIZERS``.
    kept : AnalysisCache

    Returns
    -------
    RecordedOptimization
        All that is recorded in the output folder.
    dict
        Part of summary.json.
    """
    cases = continued_file(arguments) if arguments.restart else recorder_file(arguments)
    with checked_arguments():
        limit = () if arguments.max_iterations is None else (arguments.max_iterations,)
        driver = OPTIMIZERS[optimizer](*limit)
    announce(seal)
    with LoadStepProgress(seal) as progress:
        recorder = None if arguments.restart else cases
        run = RunOptions(driver, recorder, progress, kept, arguments.out)
        problem = optimization_problem(task_of(run), run)
        if arguments.restart:
            with checked_arguments():
                continue_run(problem, cases)
        numbers = optimize(problem)
    history = read_optimization(cases)
    return history, judged(numbers, history)


def optimize(problem: om.Problem) -> dict:
    """Run the driver; an analysis that fails ends the run, what was recorded stays.

    Returns
    -------
    dict
        Part of summary.json. ``kkt`` is how far the conditions of first order are from being satisfied
        at the end, in the scaling of the driver; with the derivatives of all sides at a kink.
    """
    begun, found = time.perf_counter(), None
    try:
        success = problem.run_driver().success
        message = str(problem.driver.result.exit_status)
        found = measure_optimality(problem.driver)
    except om.AnalysisError as error:
        success, message = False, str(error)
    except (RestartError, RecorderBusyError) as error:
        raise WrongArgumentError(str(error)) from error
    iterations = major_iterations(problem)
    problem.cleanup()
    return {
        "success": bool(success),
        "iterations": iterations,
        "model_evaluations": problem.driver.result.model_evals,
        "reused_evaluations": getattr(problem.driver, "reused_evaluations", 0),
        "kkt": _kkt(found),
        "wall_s": time.perf_counter() - begun,
        "message": message,
    }


def _kkt(found: Optimality | None) -> dict | None:
    if found is None:
        return None
    return {
        "stationarity": found.stationarity,
        "complementarity": found.complementarity,
        "infeasibility": found.infeasibility,
        "sides_of_kink": found.sides,
    }


def judged(run_numbers: dict, history) -> dict:
    """The numbers of a run, which is no success unless it ends feasible."""
    feasible = history.max_violation[-1] <= FEASIBLE
    counted = run_numbers["iterations"]
    return run_numbers | {
        "success": run_numbers["success"] and bool(feasible),
        "iterations": len(history.objective) - 1 if counted is None else counted,
    }


def report_run(optimizer: str, numbers: dict, restarted) -> None:
    """A line on how the optimiser ended, and one on what was taken from the file ``restarted``."""
    state = "converged" if numbers["success"] else "NOT CONVERGED"
    print(
        f"{optimizer} {state} in {numbers['iterations']} iterations, "
        f"{numbers['model_evaluations']} analyses, {numbers['wall_s']:.1f} s: {numbers['message']}"
    )
    if restarted:
        print(
            f"continued {restarted}: {numbers['reused_evaluations']} recorded evaluations used again"
        )

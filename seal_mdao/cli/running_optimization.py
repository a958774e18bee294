"""Run an optimisation for a subcommand: status, iterations, optimality."""

import argparse
import time
from collections.abc import Callable

import openmdao.api as om

import seal_mdao as sm
from seal_mdao.cli.arguments import (
    CASES,
    WrongArgumentError,
    announce,
    checked_arguments,
    existing_file,
    positive_integer,
)
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
from seal_mdao.recording.recorded_optimization import (
    RecordedOptimization,
    read_optimization,
)


def run_optimization(
    arguments: argparse.Namespace, seal: sm.Seal, task_of: Callable, optimizer: str, cache
) -> tuple[RecordedOptimization, dict]:
    """Run the optimisation of any seal, from its start or continued by ``--restart``.

    Parameters
    ----------
    task_of : callable
        ``task_of(run)`` gives the ``Task``, with analyses by the ``RunOptions``.
    optimizer : str
        One of ``OPTIMIZERS``.
    cache : AnalysisCache

    Returns
    -------
    RecordedOptimization
        History read from the recorder file in the output folder.
    dict
        Part of summary.json.
    """
    cases = continued_file(arguments) if arguments.restart else recorder_file(arguments)
    with checked_arguments():
        driver = driver_of(optimizer, arguments.max_iterations)
    # report the time of one analysis
    announce(seal)
    with LoadStepProgress(seal) as progress:
        # a restart continues the recorder file below
        recorder = None if arguments.restart else cases
        run = RunOptions(driver, recorder, progress, cache, arguments.out)
        problem = optimization_problem(task_of(run), run)
        if arguments.restart:
            with checked_arguments():
                continue_run(problem, cases)
        numbers = optimize(problem)
    # from the file, so that the part recorded before a restart is included
    history = read_optimization(cases)
    return history, judged(numbers, history)


def driver_of(optimizer: str, max_iterations: int | None):
    """Make the driver of one of ``OPTIMIZERS``, with its own limit of iterations unless one is given."""
    limit = () if max_iterations is None else (max_iterations,)
    return OPTIMIZERS[optimizer](*limit)


def optimize(problem: om.Problem) -> dict:
    """Run the driver; a failed analysis ends the run, and its record remains.

    Returns
    -------
    dict
        Part of summary.json. ``kkt`` has the residuals of the first-order optimality conditions at the
        end, in the scaling of the driver; with the derivatives of all sides at a kink.
    """
    begun, found = time.perf_counter(), None
    try:
        success = problem.run_driver().success
        message = str(problem.driver.result.exit_status)
        # KKT residuals at the last point of the driver
        found = measure_optimality(problem.driver)
    except om.AnalysisError as error:
        # the record up to the failed analysis remains usable
        success, message = False, str(error)
    except (RestartError, RecorderBusyError) as error:
        raise WrongArgumentError(str(error)) from error
    iterations = major_iterations(problem)
    # closes the recorder so that the file can be read
    problem.cleanup()
    return {
        "success": bool(success),
        "limited": getattr(problem.driver, "limited", False),
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
    """Mark a run that ends infeasible as not successful."""
    # optimisers may report success at an infeasible point
    feasible = bool(history.feasible[-1])
    return run_numbers | {"success": run_numbers["success"] and feasible}


def report_run(optimizer: str, numbers: dict, arguments: argparse.Namespace) -> None:
    """Print the status of the optimiser, how to continue after a limit, and the number of evaluations
    reused from the file of ``--restart``."""
    state = "converged in" if numbers["success"] else "NOT CONVERGED in"
    if numbers["limited"]:
        state = "stopped after"
    print(
        f"{optimizer} {state} {numbers['iterations']} iterations, "
        f"{numbers['model_evaluations']} analyses, {numbers['wall_s']:.1f} s: {numbers['message']}"
    )
    restarted = arguments.restart
    if numbers["limited"]:
        print(f"continue with --restart {arguments.out / CASES} and a larger --max-iterations")
    if restarted:
        print(
            f"continued {restarted}: {numbers['reused_evaluations']} recorded evaluations used again"
        )


def add_optimization_arguments(made: argparse.ArgumentParser, restart: str) -> None:
    """Add the options of a run of an optimiser; ``restart`` is the help of ``--restart``."""
    names = list(OPTIMIZERS)
    group = made.add_argument_group("optimisation")
    add = group.add_argument
    add(
        "--optimizer", type=str.upper, choices=names, default=names[0],
        metavar="|".join(names).lower(), help="optimiser",
    )  # fmt: skip
    add(
        "--max-iterations", type=positive_integer, metavar="N",
        help="maximum number of iterations of the optimiser, including those before a restart; an "
        "optimisation that reaches it can be continued with --restart",
    )  # fmt: skip
    add("--restart", type=existing_file, metavar="CASES.sql", help=restart)
    add(
        "--overwrite",
        action="store_true",
        help="replace the recorder file of an earlier optimisation in the folder --out",
    )

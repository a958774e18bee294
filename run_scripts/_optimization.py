"""Running an optimisation, for the scripts that do: how it ended, and how far from optimal."""

import time

import openmdao.api as om
from _common import WrongArgumentError

from seal_mdao.drivers.optimality import Optimality, measure_optimality
from seal_mdao.optimization import major_iterations
from seal_mdao.recording.claim import RecorderBusyError
from seal_mdao.recording.evaluations import RestartError

FEASIBLE = 1e-3
"""Largest relative constraint violation of a design that counts as feasible."""


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

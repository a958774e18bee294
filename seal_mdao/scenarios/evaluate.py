"""Evaluation of all scenarios of one design."""

from collections.abc import Callable
from concurrent.futures import Executor
from typing import NamedTuple

import numpy as np

from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import Point, run_scenarios
from seal_mdao.scenarios.task import Outcome, SealTask
from seal_mdao.scenarios.variation import Scenarios


class Evaluated(NamedTuple):
    """Results of S scenarios, in their order: values (S, M) of all measures, NaN in failed rows,
    gradients (S, M, P + N) in offsets and parameters of the design, zero in failed rows, or None,
    reasons of failures, empty for successes, and the faults that make results not trustworthy.

    Scenarios with infinite values, whose statistics are undefined, belong to the failed ones.
    """

    values: np.ndarray
    gradients: np.ndarray | None
    failures: tuple
    faults: tuple


def evaluate(
    task: SealTask,
    scenarios: Scenarios,
    offsets: np.ndarray,
    design: dict,
    workers: int | Processes | Executor = 0,
    callback: Callable[[int, Outcome], None] | None = None,
) -> Evaluated:
    """Analyse a design in all scenarios.

    Parameters
    ----------
    task : SealTask
    scenarios : Scenarios
    offsets : ndarray, shape (P,)
        Boundary offsets of the design, mm.
    design : dict of str to float
        Parameters of the task in the design, including those that vary.
    workers : int, Processes or Executor
        As of ``running.run_scenarios``.
    callback : callable, optional
        Called with every number and outcome as they finish.
    """
    points, outcomes = points_of(scenarios, offsets, design), {}
    for number, outcome in run_scenarios(task, points, workers):
        outcomes[number] = outcome
        if callback is not None:
            callback(number, outcome)
    # workers finish in any order; sums over scenarios must not depend on it
    ordered = [_finite(task, outcomes[number]) for number in range(len(scenarios))]
    gradients = None
    if task.derivatives:
        # by the parameters of the design, not of the scenario
        gradients = np.stack([
            _design_gradient(task, scenarios, number, design, outcome, len(offsets))
            for number, outcome in enumerate(ordered)
        ])  # fmt: skip
    return Evaluated(
        np.stack([outcome.values for outcome in ordered]),
        gradients,
        tuple(outcome.failure for outcome in ordered),
        tuple(outcome.faults for outcome in ordered),
    )


def points_of(scenarios: Scenarios, offsets: np.ndarray, design: dict) -> list[Point]:
    """List the points at which a task with the parameters of ``design`` is run, one per scenario."""
    return [
        Point(
            number,
            scenarios.boundary(number, offsets),
            np.array([scenarios.values(number, design)[name] for name in design]),
        )
        for number in range(len(scenarios))
    ]


def _finite(task: SealTask, outcome: Outcome) -> Outcome:
    """Return the outcome, as a failed one if a value is infinite: statistics of it are undefined."""
    # NaN in failed outcomes
    infinite = np.isinf(outcome.values)
    if not infinite.any():
        return outcome
    names = [name for name, own in task.by_measure(infinite).items() if own.any()]
    failure = f"the seal has lost contact, so that {', '.join(names)} is infinite"
    unknown = np.full(task.count, np.nan)
    return outcome._replace(values=unknown, gradient=None, failure=failure)


def _design_gradient(task, scenarios, number, design, outcome, n_offsets) -> np.ndarray:
    """Compute the gradient (M, P + N) of one scenario in the offsets and parameters of the design."""
    if outcome.gradient is None:
        return np.zeros((task.count, n_offsets + len(design)))
    # dm/dp = dm/dp_k dp_k/dp for the parameter p_k of scenario k; offsets are shifted only
    by_design, _ = scenarios.rates(number, design)
    return outcome.gradient * np.concatenate([np.ones(n_offsets), by_design])

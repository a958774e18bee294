"""All scenarios of one design."""

from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import Point, run_scenarios
from seal_mdao.scenarios.task import SealTask
from seal_mdao.scenarios.variation import Scenarios


@dataclass(frozen=True, eq=False)
class Evaluated:
    """What came of S scenarios, in their order.

    Attributes
    ----------
    values : ndarray, shape (S, M)
        Of all measures of the task, one after the other; NaN in rows that failed.
    gradients : ndarray, shape (S, M, P + N), or None
        In the boundary offsets and parameters of the design; zero in rows that failed.
    failures : tuple of str
        Why a scenario failed; empty for those that did not.
    seconds : ndarray, shape (S,)
        That each one took.
    """

    values: np.ndarray
    gradients: np.ndarray | None
    failures: tuple
    seconds: np.ndarray


def evaluate(
    task: SealTask,
    scenarios: Scenarios,
    offsets: np.ndarray,
    design: dict,
    workers: int | Processes | Executor = 0,
) -> Evaluated:
    """Analyse a design in all scenarios.

    Parameters
    ----------
    task : SealTask
        Its parameters are those of ``design``.
    scenarios : Scenarios
    offsets : ndarray, shape (P,)
        Boundary offsets of the design, mm.
    design : dict of str to float
        Scalar parameters of the design, those that vary among them.
    workers : int, Processes or Executor
        As of ``running.run_scenarios``.
    """
    points = points_of(scenarios, offsets, design)
    outcomes = dict(run_scenarios(task, points, workers))
    ordered = [outcomes[number] for number in range(len(scenarios))]
    gradients = None
    if task.derivatives:
        gradients = np.stack([
            _design_gradient(task, scenarios, number, design, outcome, len(offsets))
            for number, outcome in enumerate(ordered)
        ])  # fmt: skip
    return Evaluated(
        np.stack([outcome.values for outcome in ordered]),
        gradients,
        tuple(outcome.failure for outcome in ordered),
        np.array([outcome.seconds for outcome in ordered]),
    )


def points_of(scenarios: Scenarios, offsets: np.ndarray, design: dict) -> list[Point]:
    """Where a task with the parameters of ``design`` is run for every scenario."""
    return [
        Point(
            number,
            scenarios.boundary(number, offsets),
            np.array([scenarios.values(number, design)[name] for name in design]),
        )
        for number in range(len(scenarios))
    ]


def _design_gradient(task, scenarios, number, design, outcome, n_offsets) -> np.ndarray:
    """Gradient (M, P + N) of one scenario in the offsets and parameters of the design."""
    if outcome.gradient is None:
        return np.zeros((task.count, n_offsets + len(design)))
    rates = scenarios.design_rates(number, design)
    return outcome.gradient * np.array([1.0] * n_offsets + [rates[name] for name in design])

"""Where SLSQP begins again when failed analyses or kinks leave no way forward."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from openmdao.core.analysis_error import AnalysisError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seal_mdao.drivers.evaluation import Evaluation, ModelEvaluator
    from seal_mdao.drivers.incumbent import Incumbent
    from seal_mdao.drivers.layout import ProblemLayout

LEAPS = (1.0, 1.5, 2.0, 3.0)
"""Multiples of the wanted step at which the far side of a failing region is looked for."""

SCATTER = (1.0, 0.5, 0.5, 0.25, 0.25, 0.1)
"""Largest distances of points tried around the best one where no leap helps, relative to the
wanted step, or to the move limit if that is smaller; SLSQP begins again at the first good one."""


def around(layout: ProblemLayout, x: NDArray[np.float64], distance: float, random) -> NDArray:
    """Return a random point in the box of a given half width, within the bounds."""
    change = distance * random.uniform(-1.0, 1.0, x.size)
    return layout.clip(x + change)


def derivatives(evaluator: ModelEvaluator, point: Evaluation) -> tuple:
    """Return the totals at a point; one that has none counts as failed.

    Raises
    ------
    AnalysisError
        If the derivatives cannot be had.
    """
    try:
        return evaluator.totals(point.x)
    except AnalysisError as error:
        evaluator.forget(point.x, error)
        raise


def leap(
    evaluator: ModelEvaluator,
    incumbent: Incumbent,
    start: Evaluation,
    wanted: NDArray[np.float64],
    move_limit: float,
) -> tuple | None:
    """Look for a better point beyond the failing region, along the wanted step.

    Returns
    -------
    tuple or None
        The point and its totals.
    """
    for multiple in LEAPS:
        step = multiple * wanted
        if np.abs(step).max() > move_limit:
            break
        try:
            point = evaluator.evaluate(start.x + step)
            incumbent.offer(point)
            if _improves(point, start, incumbent.feasibility_tol):
                return point, derivatives(evaluator, point)
        except AnalysisError:
            continue
    return None


def _improves(point: Evaluation, start: Evaluation, feasibility_tol: float) -> bool:
    allowed = max(start.violation, feasibility_tol)
    return point.violation <= allowed and point.objective < start.objective


def scatter(evaluator: ModelEvaluator, incumbent: Incumbent, reach: float, random) -> tuple | None:
    """Look for any good point around the best one, be it better or worse.

    Returns
    -------
    tuple or None
        The point and its totals.
    """
    for distance in SCATTER:
        x = around(evaluator.layout, incumbent.best.x, distance * reach, random)
        try:
            point = evaluator.evaluate(x)
            incumbent.offer(point)
            return point, derivatives(evaluator, point)
        except AnalysisError:
            continue
    return None

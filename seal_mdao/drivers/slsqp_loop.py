"""SLSQP's major iterations, with a way back from failed analyses and a limit on the step.

The state before every quadratic subproblem is kept. When an analysis fails at the trial point
that the subproblem and the line search lead to, the state is put back, the subproblem is solved
again in a box around the last good point that the failed step does not fit into, and so on. So
SLSQP never hears of a failed point, and the approximation of the Hessian learns nothing from it.
The box also serves as move limit: it is a trust region in the largest-change norm.

A step that the box has shortened says nothing about convergence (a change of the objective below
the tolerance may just mean a small box). Therefore each subproblem is first solved without the
box, which costs no analysis, and only that solution may end the run.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from openmdao.core.analysis_error import AnalysisError

from seal_mdao.drivers.iteration_table import SlsqpIteration
from seal_mdao.drivers.optimality import Optimality
from seal_mdao.drivers.slsqp_form import SlsqpForm
from seal_mdao.drivers.slsqp_kernel import (
    CONVERGED,
    EXIT_MODES,
    LINE_SEARCH_STUCK,
    NEEDS_DERIVATIVES,
    NEEDS_VALUES,
    SlsqpKernel,
)
from seal_mdao.drivers.slsqp_settings import STALLED, LoopOptions, LoopResult

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seal_mdao.drivers.evaluation import Evaluation, ModelEvaluator
    from seal_mdao.drivers.incumbent import Incumbent
    from seal_mdao.drivers.iteration_table import IterationTable

BACK_OFF = (0.5, 0.25, 0.1)
"""Fraction of a failed step that is allowed next; the last entry is used again and again."""

CREEP = 0.01
"""After failures, a step smaller than this fraction of the wanted one is no real progress."""

MAX_CREEPING = 3
"""Iterations without real progress in a row after which backing off is given up."""

LEAPS = (1.0, 1.5, 2.0, 3.0)
"""Multiples of the wanted step at which the far side of a failing region is looked for."""

MAX_LEAPS = 5

SAFE_RATIO = 1e3
"""Ratio of the wanted step to the box up to which the kernel solves the boxed problem well.

Its least-distance subproblem loses digits with the square of this ratio; at 1e6 it fails.
"""


class SlsqpLoop:
    """Drives the SLSQP kernel.

    Parameters
    ----------
    evaluator : ModelEvaluator
        Runs the model.
    incumbent : Incumbent
        Is offered every evaluated point.
    table : IterationTable
        Gets one row per major iteration.
    options : LoopOptions
        Settings.

    Attributes
    ----------
    iterations : int
        Major iterations, that is accepted steps, so far.
    """

    def __init__(
        self,
        evaluator: ModelEvaluator,
        incumbent: Incumbent,
        table: IterationTable,
        options: LoopOptions,
    ):
        self._evaluator = evaluator
        self._incumbent = incumbent
        self._table = table
        self._options = options
        self._form = SlsqpForm(evaluator.layout)
        self._radius = options.move_limit
        self.iterations = 0
        self._leaps = 0
        self._creeping = 0
        self._afresh = False
        self._kernel: SlsqpKernel
        self._point: Evaluation
        self._totals: tuple[NDArray[np.float64], NDArray[np.float64]]

    def run(self, start: Evaluation) -> LoopResult:
        """Iterate from a start until SLSQP ends or failed analyses make an end.

        Raises
        ------
        AnalysisError
            If the derivatives cannot be had at the start.
        """
        self._restart(start, self._derivatives(start))
        while True:
            code = self._major_iteration()
            if code == STALLED and self._leap():
                continue
            if code == LINE_SEARCH_STUCK and self._begin_afresh():
                continue
            if code != NEEDS_DERIVATIVES:
                return self._result(code)

    def _restart(self, point: Evaluation, totals: tuple) -> None:
        """Begin at a point with a fresh approximation of the Hessian."""
        limit = self._options.max_iterations - self.iterations
        form = self._form
        n = self._evaluator.layout.n
        self._kernel = SlsqpKernel(n, form.equalities, form.inequalities, limit)
        self._kernel.x[:] = point.x
        self._point, self._totals = point, totals
        self._radius = self._options.move_limit
        self._scale = max(1.0, np.abs(totals[0]).max() / (SAFE_RATIO * self._radius))
        self._creeping = 0

    def _begin_afresh(self) -> bool:
        """Restart SLSQP where its line search is stuck, with an objective of slope 1.

        Large multipliers of almost satisfied constraints leave SLSQP's merit function too few
        digits. Once is enough to tell whether that was the trouble.
        """
        slope = np.abs(self._totals[0]).max()
        if self._afresh or slope <= self._scale or self._optimal():
            return False
        self._afresh = True
        self._restart(self._point, self._totals)
        self._scale = slope
        return True

    def _major_iteration(self) -> int:
        """Make one step; return -1 after an accepted one, otherwise the code of the end."""
        if self._options.require_optimality and self._optimal():
            return CONVERGED
        before = self._kernel.snapshot()
        self._trials = failed = 0
        while True:
            mode = self._direction(before)
            if mode == LINE_SEARCH_STUCK and self._creeping:
                return STALLED
            if mode != NEEDS_VALUES:
                return mode
            try:
                point = self._line_search()
                totals = self._totals
                if self._kernel.mode == NEEDS_DERIVATIVES:
                    totals = self._derivatives(point)
            except AnalysisError:
                failed += 1
                self._back_off(failed)
                self._kernel.restore(before)
                if failed >= self._options.max_failures:
                    return STALLED
                continue
            self._accept(point, totals, failed)
            return STALLED if self._creeping >= MAX_CREEPING else self._kernel.mode

    def _direction(self, before: tuple) -> int:
        """Solve the quadratic subproblem, within the box where its solution leaves the box."""
        layout, kernel, x = self._evaluator.layout, self._kernel, self._point.x
        values = self._form.values(self._point, *self._totals, self._scale)
        self._bounds = (layout.x_lower, layout.x_upper)
        self._tol = 0.0 if self._options.require_optimality else self._options.tol / self._scale
        mode = kernel.call(values, *self._bounds, self._tol)
        self._wanted = kernel.x - x
        ratio = np.abs(self._wanted).max() / self._radius
        if mode != NEEDS_VALUES or ratio <= 1.0 + 1e-9:
            return mode
        self._tol = 0.0
        if ratio <= 10.0 * SAFE_RATIO:
            kernel.restore(before)
            lower = np.maximum(layout.x_lower, x - self._radius)
            upper = np.minimum(layout.x_upper, x + self._radius)
            self._bounds = (lower, upper)
            if kernel.call(values, lower, upper, 0.0) == NEEDS_VALUES:
                return NEEDS_VALUES
            self._bounds = (layout.x_lower, layout.x_upper)
            kernel.restore(before)
            kernel.call(values, *self._bounds, 0.0)
        return kernel.contract(values, *self._bounds, self._radius)

    def _line_search(self) -> Evaluation:
        """Evaluate trial points until the kernel accepts one or ends."""
        while self._kernel.mode == NEEDS_VALUES:
            self._trials += 1
            point = self._evaluator.evaluate(self._kernel.x)
            self._incumbent.offer(point)
            values = self._form.values(point, *self._totals, self._scale)
            self._kernel.call(values, *self._bounds, self._tol)
        return point

    def _derivatives(self, point: Evaluation) -> tuple:
        try:
            return self._evaluator.totals(point.x)
        except AnalysisError as error:
            self._evaluator.forget(point.x, error)
            raise

    def _back_off(self, failed: int) -> None:
        """Shrink the box so that a failed step does not fit into it."""
        fraction = BACK_OFF[min(failed, len(BACK_OFF)) - 1]
        self._radius = fraction * np.abs(self._kernel.x - self._point.x).max()

    def _accept(self, point: Evaluation, totals: tuple, failed: int) -> None:
        step = float(np.abs(point.x - self._point.x).max())
        creeps = failed and step < CREEP * np.abs(self._wanted).max()
        self._creeping = self._creeping + 1 if creeps else 0
        self.iterations += 1
        self._table.add(
            SlsqpIteration(
                self.iterations,
                self._evaluator.driver.iter_count,
                point.objective,
                point.violation,
                step,
                float(self._radius),
                self._trials,
                failed,
            )
        )
        self._point, self._totals = point, totals
        if not failed:
            self._radius = min(self._options.move_limit, 2.0 * self._radius)

    def _leap(self) -> bool:
        """Look for a better point beyond the failing region; restart there if there is one."""
        if self._leaps >= MAX_LEAPS:
            return False
        self._leaps += 1
        for multiple in LEAPS:
            step = multiple * self._wanted
            if np.abs(step).max() > self._options.move_limit:
                break
            try:
                point = self._evaluator.evaluate(self._point.x + step)
                self._incumbent.offer(point)
                if self._improves(point):
                    self._restart(point, self._derivatives(point))
                    return True
            except AnalysisError:
                continue
        return False

    def _improves(self, point: Evaluation) -> bool:
        allowed = max(self._point.violation, self._incumbent.feasibility_tol)
        return point.violation <= allowed and point.objective < self._point.objective

    def _optimality(self) -> Optimality:
        point, layout = self._point, self._evaluator.layout
        return Optimality.at(layout, point.x, point.constraints, *self._totals)

    def _optimal(self) -> bool:
        return self._optimality().satisfied(self._options.optimality_tol)

    def _result(self, code: int) -> LoopResult:
        message = EXIT_MODES.get(code, f"Unknown exit mode {code} of SLSQP")
        if code == STALLED:
            message = (
                "Stopped: failed analyses leave no way forward from the best point found. "
                f"Last failure: {self._evaluator.last_error}"
            )
        elif code == LINE_SEARCH_STUCK:
            code = CONVERGED if self._optimal() else code
            message = f"{EXIT_MODES[code]} ({self._optimality()})"
        return LoopResult(self._point, self._totals[0], code, message, self.iterations)

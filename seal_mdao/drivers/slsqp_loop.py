"""SLSQP's major iterations, with a way back from failed analyses and a limit on the step.

The state before every quadratic subproblem is kept. When an analysis fails at the trial point
that the subproblem and the line search lead to, points around it are tried first: solvers often
fail at scattered designs, whose neighbours are as good. Where they fail as well the state is put
back, the step of the subproblem is taken again, shorter than the failed one, and so on. So SLSQP
never hears of a failed point, and the approximation of the Hessian learns nothing from it.

The same shortening serves as move limit. The subproblem itself is not restricted to the limit:
its solution in a small box is a corner of it, all variables changed by as much as they may, and
in a small box the linearised constraints have no solution.

A step that has been shortened says nothing about convergence (a change of the objective below
the tolerance may just mean a short step). Only the full step of a subproblem may end the run.
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
    INCOMPATIBLE,
    LINE_SEARCH_STUCK,
    NEEDS_DERIVATIVES,
    NEEDS_VALUES,
    SlsqpKernel,
)
from seal_mdao.drivers.slsqp_settings import STALLED, LoopOptions, LoopResult
from seal_mdao.drivers.slsqp_ways_out import around, derivatives, leap, scatter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seal_mdao.drivers.evaluation import Evaluation, ModelEvaluator
    from seal_mdao.drivers.incumbent import Incumbent
    from seal_mdao.drivers.iteration_table import IterationTable

BACK_OFF = (0.5, 0.25, 0.1)
"""Fraction of a failed step that is allowed next; the last entry is used again and again."""

NEIGHBOURS = (3, 3, 0)
"""Points tried around a failed trial point, in the order of ``BACK_OFF``."""

NEIGHBOUR_DISTANCE = 0.3
"""Largest distance of the neighbours, relative to the largest change of the failed step."""

CREEP = 0.01
"""A step smaller than this fraction of the wanted one is no real progress."""

MAX_CREEPING = 3
"""Iterations without real progress in a row after which the run has to begin again."""

MAX_WAYS_OUT = 4
"""Times that the run may begin again for want of progress."""

SAFE_RATIO = 1e3
"""Largest slope of the objective at a start, relative to the move limit.

The kernel's least-distance subproblem loses digits with the square of this ratio.
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
        self._ways_out = 0
        self._failures_before = 0
        self._creeping = 0
        self._afresh = False
        self._held_back = False
        self._random = np.random.default_rng(0)
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
        self._restart(start, derivatives(self._evaluator, start))
        while True:
            code = self._major_iteration()
            if code == STALLED and self._find_way_out():
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
        self._failures_before = self._evaluator.failures
        self._trials = back_offs = 0
        while True:
            mode = self._direction()
            if mode in (INCOMPATIBLE, LINE_SEARCH_STUCK) and self._creeping:
                return STALLED
            if mode != NEEDS_VALUES:
                return mode
            try:
                point = self._line_search(NEIGHBOURS[min(back_offs, len(NEIGHBOURS) - 1)])
                totals = self._totals
                if self._kernel.mode == NEEDS_DERIVATIVES:
                    totals = derivatives(self._evaluator, point)
            except AnalysisError:
                self._back_off(back_offs)
                back_offs += 1
                self._kernel.restore(before)
                if max(self._failed, back_offs) >= self._options.max_failures:
                    return STALLED
                continue
            self._accept(point, totals, back_offs)
            return STALLED if self._creeping >= MAX_CREEPING else self._kernel.mode

    def _direction(self) -> int:
        """Solve the quadratic subproblem, and shorten its step to the radius."""
        layout, kernel, x = self._evaluator.layout, self._kernel, self._point.x
        values = self._form.values(self._point, *self._totals, self._scale)
        self._bounds = (layout.x_lower, layout.x_upper)
        self._tol = 0.0 if self._options.require_optimality else self._options.tol / self._scale
        mode = kernel.call(values, *self._bounds, self._tol)
        self._wanted = kernel.x - x
        if mode != NEEDS_VALUES or np.abs(self._wanted).max() <= self._radius * (1.0 + 1e-9):
            return mode
        self._tol = 0.0
        return kernel.contract(values, *self._bounds, self._radius)

    def _line_search(self, neighbours: int) -> Evaluation:
        """Evaluate trial points until the kernel accepts one or ends.

        A neighbour of a failed point is good enough as it is or not at all: the way to it need
        not lead downwards.
        """
        kernel = self._kernel
        while kernel.mode == NEEDS_VALUES:
            self._trials += 1
            trial = kernel.x.copy()
            point = self._evaluate_near(trial, neighbours)
            moved = not np.array_equal(kernel.x, trial)
            self._incumbent.offer(point)
            values = self._form.values(point, *self._totals, self._scale)
            kernel.call(values, *self._bounds, self._tol)
            if moved and kernel.mode == NEEDS_VALUES:
                raise self._evaluator.last_error
        return point

    @property
    def _failed(self) -> int:
        """Failed analyses since the last accepted point."""
        return self._evaluator.failures - self._failures_before

    def _evaluate_near(self, trial: NDArray[np.float64], neighbours: int) -> Evaluation:
        """Evaluate the kernel's trial point, or one of its neighbours where it fails."""
        kernel, x = self._kernel, self._point.x
        self._trial_step = np.abs(trial - x).max()
        distance = NEIGHBOUR_DISTANCE * self._trial_step
        for left in range(neighbours, -1, -1):
            try:
                return self._evaluator.evaluate(kernel.x)
            except AnalysisError:
                if not left or self._failed >= self._options.max_failures:
                    raise
            near = around(self._evaluator.layout, trial, distance, self._random)
            kernel.move(np.clip(near, x - self._radius, x + self._radius))

    def _back_off(self, before: int) -> None:
        """Shorten the next step below the failed one."""
        self._radius = BACK_OFF[min(before, len(BACK_OFF) - 1)] * self._trial_step

    def _accept(self, point: Evaluation, totals: tuple, back_offs: int) -> None:
        step = float(np.abs(point.x - self._point.x).max())
        self._held_back = bool(back_offs) or self._radius < self._options.move_limit
        creeps = self._may_creep() and step < CREEP * self._reach()
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
                self._failed,
            )
        )
        self._point, self._totals = point, totals
        if not back_offs:
            self._radius = min(self._options.move_limit, 2.0 * self._radius)

    def _may_creep(self) -> bool:
        """Return whether tiny steps are to be noticed.

        Without failures they come of kinks, on whose other side the slope is another; where
        SciPy's own tests may end the run its iterates are left alone.
        """
        fresh_start_left = self._options.require_optimality and self._ways_out < MAX_WAYS_OUT
        return self._held_back or fresh_start_left

    def _reach(self) -> float:
        """Return the length of the wanted step, or the move limit if that is smaller."""
        return min(self._options.move_limit, np.abs(self._wanted).max())

    def _find_way_out(self) -> bool:
        """Begin again elsewhere when there is no way forward from the point."""
        if self._ways_out >= MAX_WAYS_OUT:
            return False
        self._ways_out += 1
        evaluator, best = self._evaluator, self._incumbent
        limit = self._options.move_limit
        found = leap(evaluator, best, self._point, self._wanted, limit)
        if found is None:
            found = scatter(evaluator, best, self._reach(), self._random)
        if found is None:
            return False
        self._restart(*found)
        return True

    def _optimality(self) -> Optimality:
        point, layout = self._point, self._evaluator.layout
        return Optimality.at(layout, point.x, point.constraints, *self._totals)

    def _optimal(self) -> bool:
        return self._optimality().satisfied(self._options.optimality_tol)

    def _result(self, code: int) -> LoopResult:
        message = EXIT_MODES.get(code, f"Unknown exit mode {code} of SLSQP")
        if code == STALLED:
            failure = self._evaluator.last_error
            message = "Stopped: tiny steps leave no way forward from the best point found."
            if failure is not None:
                message = (
                    "Stopped: failed analyses leave no way forward from the best point found. "
                    f"Last failure: {failure}"
                )
        elif code == LINE_SEARCH_STUCK:
            code = CONVERGED if self._optimal() else code
            message = f"{EXIT_MODES[code]} ({self._optimality()})"
        return LoopResult(self._point, self._totals[0], code, message, self.iterations)

"""The functions Ipopt calls.

An exception must not pass through Ipopt: ipyopt loses some of them and turns others into a
SystemError. So nothing is raised here. A failed analysis gives NaN, at which Ipopt shortens its
step; whatever else happens is kept, and the run is stopped at the next iteration. Until then
every call returns NaN at once without running the model.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np
from openmdao.core.analysis_error import AnalysisError

from seal_mdao.drivers.iteration_table import IpoptIteration

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seal_mdao.drivers.evaluation import ModelEvaluator
    from seal_mdao.drivers.incumbent import Incumbent
    from seal_mdao.drivers.interrupt import InterruptGuard
    from seal_mdao.drivers.iteration_table import IterationTable

CREEP = 0.01
"""After failures, a step shortened to less than this fraction is no real progress."""

MAX_CREEPING = 3
"""Iterations without real progress in a row after which the run is stopped."""


class IpoptCallbacks:
    """Bridge between Ipopt and the model.

    Parameters
    ----------
    evaluator : ModelEvaluator
        Runs the model.
    structure : tuple of ndarray
        Rows (of the constraint vector) and columns of the Jacobian's entries.
    incumbent : Incumbent
        Is offered every evaluated point.
    guard : InterruptGuard
        Tells when the user wants to stop.
    table : IterationTable
        Gets one row per iteration.
    max_failures : int
        Failed analyses in a row after which the run is stopped.
    eager : bool
        Whether the derivatives of a trial point are computed together with its values, so that
        a failure of the derivatives shortens the step as well (Ipopt cannot take back a point
        that it has accepted).
    first_iteration : int
        Number of the first iteration, when a run is continued.

    Attributes
    ----------
    error : tuple or None
        ``sys.exc_info()`` of an exception that is no AnalysisError.
    interrupted, stalled, derivatives_failed : bool
        Why the run was stopped: by the user, after too many failures in a row, or because the
        derivatives failed at an accepted point.
    failures_in_a_row : int
        Failed points since the last good one.
    iterations : int
        Ipopt's iterations so far.
    last_point : ndarray or None
        The last point whose derivatives were computed.
    """

    def __init__(
        self,
        evaluator: ModelEvaluator,
        structure: tuple[NDArray[np.intp], NDArray[np.intp]],
        incumbent: Incumbent,
        guard: InterruptGuard,
        table: IterationTable,
        max_failures: int,
        eager: bool = False,
        first_iteration: int = 0,
    ):
        self._evaluator = evaluator
        self._rows, self._columns = structure
        self._active = evaluator.layout.active
        self._incumbent = incumbent
        self._guard = guard
        self._table = table
        self._max_failures = max_failures
        self._eager = eager
        self._totals: tuple[bytes, tuple] | None = None
        self._failed: set[bytes] = set()
        self._failed_in_iteration = False
        self._creeping = 0
        self.failures_in_a_row = 0
        self.error = None
        self.interrupted = False
        self.stalled = False
        self.derivatives_failed = False
        self.last_point: NDArray[np.float64] | None = None
        self._first_iteration = first_iteration
        self.iterations = first_iteration

    @property
    def stopping(self) -> bool:
        """Whether the run is to end at the next iteration."""
        return bool(self.error or self.interrupted or self.stalled or self.derivatives_failed)

    def objective(self, x: NDArray[np.float64]) -> float:
        """Return the objective at ``x``, NaN if it cannot be had."""
        point = self._attempt(self._values, x)
        return float("nan") if point is None else point.objective

    def constraints(self, x: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write the constraints at ``x`` into ``out``, NaN if they cannot be had."""
        point = self._attempt(self._values, x)
        out[:] = np.nan if point is None else point.constraints[self._active]

    def gradient(self, x: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write the gradient of the objective at ``x`` into ``out``."""
        totals = self._attempt(self._derivatives, x)
        out[:] = np.nan if totals is None else totals[0]

    def jacobian(self, x: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write the entries of the constraint Jacobian at ``x`` into ``out``."""
        totals = self._attempt(self._derivatives, x)
        out[:] = np.nan if totals is None else totals[1][self._rows, self._columns]

    def iteration(self, *state) -> bool:
        """Note an iteration; return False to stop the run.

        Parameters
        ----------
        *state
            What Ipopt tells: algorithm mode, iteration, objective, inf_pr, inf_du, mu, norm of
            the step, regularization, alpha_du, alpha_pr, trials of the line search.
        """
        try:
            if self._guard.requested:
                self.interrupted = True
            if not self.stopping:
                self._note_iteration(*state)
        except BaseException:
            self._keep_error()
        return not self.stopping

    def _note_iteration(
        self, mode, iteration, objective, inf_pr, inf_du, mu, step, _, alpha_du, alpha_pr, trials
    ) -> None:
        self._watch_progress(alpha_pr)
        self.iterations = self._first_iteration + iteration
        self._table.add(
            IpoptIteration(
                iteration=self.iterations,
                analyses=self._evaluator.driver.iter_count,
                objective=objective,
                infeasibility=inf_pr,
                optimality=inf_du,
                barrier=mu,
                step=step,
                alpha=alpha_pr,
                trials=trials,
                phase="restoration" if mode else "",
            )
        )

    def _values(self, x):
        point = self._evaluator.evaluate(x)
        self._incumbent.offer(point)
        if self._eager:
            try:
                self._derivatives(x)
            except AnalysisError as error:
                self._evaluator.forget(x, error)
                raise
        self.failures_in_a_row = 0
        return point

    def _derivatives(self, x):
        key = x.tobytes()
        if self._totals is None or self._totals[0] != key:
            try:
                self._totals = (key, self._evaluator.totals(x))
            except AnalysisError as error:
                self._evaluator.forget(x, error)
                self.derivatives_failed = not self._eager
                raise
        self.last_point = x
        return self._totals[1]

    def _attempt(self, compute, x):
        """Return ``compute(x)``, or None after a failure or once the run is to be stopped."""
        if self.stopping:
            return None
        try:
            return compute(np.array(x))
        except AnalysisError:
            self._count_failure(x)
        except KeyboardInterrupt:
            self.interrupted = True
        except BaseException:
            self._keep_error()
        return None

    def _count_failure(self, x) -> None:
        """Count each failed point once, however many functions Ipopt wants there."""
        self._failed_in_iteration = True
        key = x.tobytes()
        if key not in self._failed:
            self._failed.add(key)
            self.failures_in_a_row += 1
        if self.failures_in_a_row >= self._max_failures:
            self.stalled = True

    def _watch_progress(self, alpha) -> None:
        """Stop a run that failures have kept from real progress for some iterations."""
        creeps = self._failed_in_iteration and alpha < CREEP
        self._creeping = self._creeping + 1 if creeps else 0
        self._failed_in_iteration = False
        if self._creeping >= MAX_CREEPING:
            self.stalled = True

    def _keep_error(self) -> None:
        if self.error is None:
            self.error = sys.exc_info()

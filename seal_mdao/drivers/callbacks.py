"""Callbacks of an optimiser, which never raise an exception through its compiled code.

Ipopt and Uno lose exceptions of their callbacks or treat them as failed evaluations. Here a failed
analysis returns None, after which either of them shortens its step. Any other exception is stored,
and every further call returns None at once, until the optimiser stops.
"""

import numpy as np
from numpy.typing import NDArray
from openmdao.core.analysis_error import AnalysisError

from seal_mdao.drivers.evaluation import Evaluation, ModelEvaluator
from seal_mdao.drivers.interrupt import InterruptGuard
from seal_mdao.drivers.stagnation import Stagnation


class SolverCallbacks:
    """Bridge between an optimiser and the model.

    Parameters
    ----------
    evaluator : ModelEvaluator
    guard : InterruptGuard
    feas_tol : float
        Largest scaled constraint violation of a feasible point.
    max_failures : int
        Failed analyses after which the run is stopped; each point with derivatives cancels one. An
        optimiser at the edge of a region of failures has several in every iteration.

    Attributes
    ----------
    best : Evaluation
        Feasible point of lowest objective; the least infeasible one until there is one.
    firm : Evaluation
        The best point among those with derivatives, from which a run may be restarted.
    eager : bool
        Whether values are returned only where derivatives exist too.
    lost : bool
        Whether derivatives failed at a point whose values were returned before.
    error : BaseException or None
        An exception that is neither AnalysisError nor Ctrl-C.
    interrupted, stalled : bool
        Whether the run is stopped by Ctrl-C, or by too many failures.
    stagnation : Stagnation
        True where the run is stopped because its last designs lie on both sides of a jump.
    """

    def __init__(
        self, evaluator: ModelEvaluator, guard: InterruptGuard, feas_tol: float, max_failures: int
    ):
        self.evaluator = evaluator
        self.best: Evaluation | None = None
        self.firm: Evaluation | None = None
        self.eager = self.lost = False
        self.error: BaseException | None = None
        self.interrupted = self.stalled = False
        self.stagnation = Stagnation()
        self._guard = guard
        self._feas_tol, self._max_failures = feas_tol, max_failures
        self._failures = 0
        self._failed: set[bytes] = set()
        self._totals: tuple[bytes, tuple] = (b"", ())

    @property
    def stopping(self) -> bool:
        """Whether the optimiser is to stop; checked in every iteration."""
        self.interrupted = self.interrupted or self._guard.requested
        return bool(self.error or self.interrupted or self.stalled or self.stagnation)

    @property
    def feasible(self) -> bool:
        """Whether the best point satisfies the constraints."""
        return self.best.violation <= self._feas_tol

    def start(self, prepare) -> NDArray[np.float64]:
        """Evaluate the start, where every error is raised; ``prepare`` is called before derivatives."""
        self.best = self.firm = self.evaluator.start()
        self.stagnation.add(self.best)
        prepare()
        # derivatives that fail here would leave nothing to restart from
        self._derivatives(self.best.x)
        return self.best.x

    def values(self, x: NDArray[np.float64]) -> Evaluation | None:
        """Return the values at ``x``, or None if the analysis fails or the run is to stop."""
        return self._attempt(self._values, x)

    def derivatives(self, x: NDArray[np.float64]) -> tuple | None:
        """Return gradient and Jacobian at ``x``, or None if the analysis fails or the run is to
        stop."""
        found = self._attempt(self._derivatives, x)
        # if eager, they have been computed with the values: a failure is an ordinary one
        self.lost = self.lost or (found is None and not self.eager)
        return found

    def consider_recorded(self) -> None:
        """Choose the best point also among the designs of the earlier run that is continued, which a
        lower limit of iterations does not reach."""
        self.best = min([self.best, *self.evaluator.recorded_points()], key=self._rank)

    def try_again(self) -> bool:
        """Forget failures and stagnation before a restart with other steps; return whether one is
        allowed."""
        self.stalled, self._failures, self.stagnation = False, 0, Stagnation()
        return not self.stopping

    def guarded(self, action, *arguments) -> None:
        """Call an action that may raise, such as printing, and store the exception."""
        try:
            action(*arguments)
        except KeyboardInterrupt:
            self.interrupted = True
        except BaseException as error:
            self.error = self.error or error

    def _attempt(self, compute, x):
        if self.stopping:
            return None
        # the optimiser reuses its memory: take a copy
        x = np.array(x)
        try:
            return compute(x)
        # only AnalysisError is a failed evaluation; all else stops the run and is raised after it
        except AnalysisError:
            self._count_failure(x.tobytes())
        except KeyboardInterrupt:
            self.interrupted = True
        except BaseException as error:
            self.error = error
        return None

    def _values(self, x) -> Evaluation:
        point = self.evaluator.evaluate(x)
        self.stagnation.add(point)
        # the best point so far, even if the optimiser rejects it
        self.best = min(self.best, point, key=self._rank)
        # Ipopt cannot leave an accepted point without derivatives: fail at once instead
        if self.eager:
            self._derivatives(x)
        return point

    def _derivatives(self, x):
        key = x.tobytes()
        # gradient and Jacobian are requested one after the other at the same point
        if self._totals[0] != key:
            self._totals = key, self.evaluator.totals(x)
            self.firm = min(self.firm, self.evaluator.evaluate(x), key=self._rank)
            # a point with derivatives cancels one failure
            self._failures = max(0, self._failures - 1)
        return self._totals[1]

    def _rank(self, point: Evaluation) -> tuple[bool, float]:
        # feasible before infeasible; then by objective, or by violation
        infeasible = point.violation > self._feas_tol
        return infeasible, point.violation if infeasible else point.objective

    def _count_failure(self, key: bytes) -> None:
        """Count each failed point once, however many functions are evaluated there."""
        if key not in self._failed:
            self._failed.add(key)
            self._failures += 1
            self.stalled = self._failures >= self._max_failures

"""What an optimiser asks of the model, so that nothing is ever raised through its compiled code.

Ipopt and Uno lose exceptions of their callbacks or take them for failed evaluations. Here a failed
analysis gives None, after which either of them shortens its step. Whatever else happens is kept,
and every further call gives None at once, until the optimiser stops.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from openmdao.core.analysis_error import AnalysisError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seal_mdao.drivers.evaluation import Evaluation, ModelEvaluator
    from seal_mdao.drivers.interrupt import InterruptGuard


class SolverCallbacks:
    """Bridge between an optimiser and the model.

    Parameters
    ----------
    evaluator : ModelEvaluator
        Runs the model.
    guard : InterruptGuard
        Tells when the user wants to stop.
    feas_tol : float
        Largest scaled constraint violation of a point that counts as feasible.
    max_failures : int
        Failed analyses after which the run is stopped; a good one makes up for one that failed. An
        optimiser that creeps up to a region where all fails has several in every iteration.

    Attributes
    ----------
    best : Evaluation
        Feasible point of lowest objective, or the least infeasible one until there is one.
    firm : Evaluation
        The best point among those that have derivatives, from which a run may begin again.
    eager : bool
        Whether values are given only where derivatives can be had too.
    error : BaseException or None
        An exception that is neither AnalysisError nor Ctrl-C.
    interrupted, stalled : bool
        Whether the run is to stop because of Ctrl-C, or of too many failures.
    """

    def __init__(
        self, evaluator: ModelEvaluator, guard: InterruptGuard, feas_tol: float, max_failures: int
    ):
        self.evaluator = evaluator
        self.best: Evaluation | None = None
        self.firm: Evaluation | None = None
        self.eager = False
        self.error: BaseException | None = None
        self.interrupted = self.stalled = False
        self._guard = guard
        self._feas_tol, self._max_failures = feas_tol, max_failures
        self._failures = 0
        self._failed: set[bytes] = set()
        self._totals: tuple[bytes, tuple] = (b"", ())

    @property
    def stopping(self) -> bool:
        """Whether the optimiser is to stop; asked for at every iteration."""
        self.interrupted = self.interrupted or self._guard.requested
        return bool(self.error or self.interrupted or self.stalled)

    @property
    def feasible(self) -> bool:
        """Whether the best point satisfies the constraints."""
        return self.best.violation <= self._feas_tol

    def start(self, prepare) -> NDArray[np.float64]:
        """Evaluate the start, where whatever goes wrong is raised; ``prepare`` its derivatives."""
        self.best = self.firm = self.evaluator.start()
        prepare()
        self._derivatives(self.best.x)
        return self.best.x

    def values(self, x: NDArray[np.float64]) -> Evaluation | None:
        """Return the values at ``x``, or None if they cannot be had or the run is to stop."""
        return self._attempt(self._values, x)

    def derivatives(self, x: NDArray[np.float64]) -> tuple | None:
        """Return gradient and Jacobian at ``x``, or None likewise."""
        return self._attempt(self._derivatives, x)

    def try_again(self) -> NDArray[np.float64] | None:
        """Return the point from which a run that has got stuck may go on, None if it must end."""
        self.stalled, self._failures = False, 0
        return None if self.stopping else self.firm.x

    def guarded(self, action, *arguments) -> None:
        """Do what may raise, such as printing, and keep the exception."""
        try:
            action(*arguments)
        except KeyboardInterrupt:
            self.interrupted = True
        except BaseException as error:
            self.error = self.error or error

    def _attempt(self, compute, x):
        if self.stopping:
            return None
        x = np.array(x)  # the optimiser's own memory
        try:
            return compute(x)
        except AnalysisError:
            self._count_failure(x.tobytes())
        except KeyboardInterrupt:
            self.interrupted = True
        except BaseException as error:
            self.error = error
        return None

    def _values(self, x) -> Evaluation:
        point = self.evaluator.evaluate(x)
        self.best = min(self.best, point, key=self._rank)
        if self.eager:
            self._derivatives(x)
        return point

    def _derivatives(self, x):
        key = x.tobytes()
        if self._totals[0] != key:
            self._totals = key, self.evaluator.totals(x)
            self.firm = min(self.firm, self.evaluator.evaluate(x), key=self._rank)
            self._failures = max(0, self._failures - 1)
        return self._totals[1]

    def _rank(self, point: Evaluation) -> tuple[bool, float]:
        infeasible = point.violation > self._feas_tol
        return infeasible, point.violation if infeasible else point.objective

    def _count_failure(self, key: bytes) -> None:
        """Count each failed point once, however many functions are wanted there."""
        if key not in self._failed:
            self._failed.add(key)
            self._failures += 1
            self.stalled = self._failures >= self._max_failures

"""What both drivers share: how a run ends, and how it is recorded and reported."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from seal_mdao.drivers.evaluation import ModelEvaluator
from seal_mdao.drivers.layout import read_layout
from seal_mdao.drivers.optimality import Optimality, measure_optimality
from seal_mdao.recording.evaluations import RecordedEvaluations

if TYPE_CHECKING:
    from openmdao.core.driver import DriverResult

    from seal_mdao.drivers.interrupt import InterruptGuard

INTERRUPTED_FEASIBLE = "Stopped by the user (Ctrl-C); the best feasible point found is kept"
INTERRUPTED_INFEASIBLE = (
    "Stopped by the user (Ctrl-C); no feasible point had been found, the least infeasible is kept"
)


class RunSupport:
    """Mixin for a Driver: exit message in words, failed cases marked, optimality measured.

    Attributes
    ----------
    case_failure : str
        Why the analysis of the point being recorded failed; empty for a good point. A failed
        point is recorded with ``success`` 0 and this text as ``msg``.
    history : list
        One record per major iteration of the last run.
    failed_analyses : int
        Number of points of the last run at which the analysis failed.
    reused_evaluations : int
        Number of evaluations that the last run took from ``hotstart_file``.
    repeated_case : int or None
        Number of the case in ``hotstart_file`` whose evaluation is being repeated.
    """

    def __init__(self, **kwargs):
        """Initialize the driver."""
        super().__init__(**kwargs)
        self._clear_run()

    def _clear_run(self) -> None:
        self.case_failure = ""
        self.history = []
        self.failed_analyses = 0
        self.reused_evaluations = 0
        self.repeated_case = None
        self._exit_message = "NOT_RUN"
        self._major_iterations = 0

    def _reset_run(self) -> None:
        """Forget the last run before a new one."""
        self._clear_run()
        self._exit_message = "Ended by an exception"
        self.result.reset()
        self.iter_count = 0
        self._total_jac = None
        self._total_jac_linear = None
        self._exc_info = None

    def _declare_options(self):
        """Declare the options before keyword arguments are processed."""
        super()._declare_options()
        self.options.declare(
            "hotstart_file",
            default=None,
            allow_none=True,
            types=(str, Path),
            desc="Recorder file of an earlier run: at its designs the values and derivatives in "
            "it are taken instead of running the model. Restarts a run where it was cut off.",
        )

    def _evaluator(self, guard: InterruptGuard) -> ModelEvaluator:
        """Make the evaluator of a run."""
        file = self.options["hotstart_file"]
        recorded = None if file is None else RecordedEvaluations(file, self)
        return ModelEvaluator(self, read_layout(self), guard.running, recorded)

    def get_exit_status(self) -> str:
        """Return in words how the last run ended."""
        return super().get_exit_status() if self._in_find_feasible else self._exit_message

    def _update_result(self, result: DriverResult) -> None:
        if not self._in_find_feasible:
            result.iter_count = self._major_iterations

    def _get_recorder_metadata(self, case_name: str) -> dict:
        metadata = super()._get_recorder_metadata(case_name)
        if self.case_failure:
            metadata["success"] = 0
            metadata["msg"] = self.case_failure
        return metadata

    def _print_on_root(self, text: str) -> None:
        if self._problem().comm.rank == 0:
            print(text)

    def optimality(self) -> Optimality:
        """Measure how well the point now in the model satisfies the optimality conditions.

        The total derivatives are computed once more; the model itself is not run.

        Returns
        -------
        Optimality
            Stationarity and infeasibility in driver scaling.

        Raises
        ------
        RuntimeError
            If the problem has no design variables or has not been set up.
        """
        if self._vectors is None:
            raise RuntimeError(f"{self.msginfo}: optimality() needs a problem that has been run.")
        evaluator = ModelEvaluator(self, read_layout(self))
        return measure_optimality(evaluator)

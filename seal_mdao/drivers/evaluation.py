"""Evaluation of the model and of its total derivatives for the drivers.

A failed analysis leaves the model in an undefined state: unconverged states would be the initial
guess of the next solve. The evaluator therefore restores the last converged inputs and outputs, stores
the point as failed, and marks the recorded case as not successful, so that a reader of the case file
cannot mistake it for a result.
"""

from contextlib import nullcontext, suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from openmdao.core.analysis_error import AnalysisError

from seal_mdao import openmdao_access as access
from seal_mdao.drivers.layout import ProblemLayout, flat
from seal_mdao.openmdao_access import FailedCases
from seal_mdao.recording.evaluations import UNFINISHED, RecordedEvaluations, recorded_jacobian
from seal_mdao.recording.recorder_file import Case

INSIDE = 1e-9
"""Distance from the bounds within which a recorded design satisfies them, in driver scaling."""


@dataclass(frozen=True)
class Evaluation:
    """Values of a successfully analysed point, in driver scaling: design variables (n,), objective,
    constraints (m,) with linear and constant ones, and largest violation."""

    x: NDArray[np.float64]
    objective: float
    constraints: NDArray[np.float64]
    violation: float


class ModelEvaluator:
    """Run the model of a driver at points of the optimiser and cache the results.

    Parameters
    ----------
    driver : FailedCases
        After its final setup.
    layout : ProblemLayout
    running : callable
        Returns the context manager inside which the model runs.
    recorded : RecordedEvaluations, optional
        Cases of an earlier run; at its designs the model is not run.

    Attributes
    ----------
    last_failure : str
        Message of the last failed analysis.
    """

    def __init__(
        self,
        driver: FailedCases,
        layout: ProblemLayout,
        running=nullcontext,
        recorded: RecordedEvaluations | None = None,
    ):
        self.driver, self.layout = driver, layout
        self.last_failure = ""
        self._running = running
        self._recorded = recorded
        self._recorded_at: dict[bytes, Case] = {}
        self._known: dict[bytes, Evaluation | str] = {}
        self._loaded: bytes | None = None
        self._restore_last_success = lambda: None
        self._linear_jacobian = None
        self._look_at_jacobian = driver.options["singular_jac_behavior"] != "ignore"

    def start(self) -> Evaluation:
        """Run the model at its initial design, clipped to the bounds, and return the values; where a
        run is continued, those of that run.

        Raises
        ------
        AnalysisError
            If the analysis fails at the start; there is no converged state to restore.
        ValueError
            If the earlier run to be continued had another start, or another model.
        """
        # values in the model are not scaled back and forth: bitwise the run that the user would make
        x = flat(self.driver.get_design_var_values())
        inside = self.layout.clip(x)
        evaluation = self._execute(inside, already_set=np.array_equal(inside, x), run=True)
        if self._recorded is not None:
            self._recorded.check_start()
            self._known[inside.tobytes()] = evaluation = self._start_as_recorded(evaluation)
        return evaluation

    def _start_as_recorded(self, evaluation: Evaluation) -> Evaluation:
        """Return the recorded values of the start: with them the optimiser takes the recorded steps.

        Another version or processor may compute others in the last digits.
        """
        case = self._recorded.find()
        # without derivatives it took no step
        if case is None or case.failure or not case.totals:
            return evaluation
        self._recorded.restore(case)
        # the state of the model is that of its run no more
        self._loaded = None
        return self._values_at(evaluation.x)

    def evaluate(self, x: NDArray[np.float64]) -> Evaluation:
        """Return the values at ``x``, clipped to the bounds; the model runs at most once per point.

        Raises
        ------
        AnalysisError
            If the analysis fails at ``x``, or has failed there before.
        """
        x = self.layout.clip(x)
        # an Evaluation, or the message of a failure
        found = self._known.get(x.tobytes())
        if isinstance(found, str):
            raise AnalysisError(found)
        return self._execute(x) if found is None else found

    def recorded_points(self) -> list[Evaluation]:
        """Return the values at all designs of the earlier run that is continued.

        Nothing is analysed, and the model is left as it is.
        """
        if self._recorded is None:
            return []
        found, restore_state = [], access.snapshot(access.problem_of(self.driver).model)
        for case in self._recorded.cases():
            self._recorded.restore(case)
            x = flat(self.driver.get_design_var_values())
            # values that are not finite were recorded as no failure by another driver
            with suppress(AnalysisError):
                # a run without ``restart`` may have other bounds
                inside = self.layout.clip(x)
                if np.allclose(inside, x, rtol=0.0, atol=INSIDE):
                    found.append(self._values_at(inside))
                    self._recorded_at.setdefault(inside.tobytes(), case)
        restore_state()
        return found

    def totals(self, x: NDArray[np.float64]):
        """Return the gradient of the objective (n,) and the Jacobian of all constraints (m, n) at ``x``.

        The model is run again if its state belongs to another point.

        Raises
        ------
        AnalysisError
            If the derivatives fail; the point counts as failed from then on.
        """
        x = self.layout.clip(x)
        try:
            # derivatives of a continued run are read from its file
            known = self._recorded_totals(x)
            if known is not None:
                return self._as_totals(known)
            self.load(x)
            with self._running():
                return self.totals_here()
        except BaseException as error:
            # a finite difference that failed has left the model at its perturbed design
            self._restore_last_success()
            if isinstance(error, AnalysisError):
                self._note_failure(x, error)
            raise

    def totals_here(self, once: bool = False):
        """Return gradient and Jacobian at the point now in the model, without running it.

        Derivatives requested ``once``, after a run, are not checked for zero rows and columns, which an
        optimum may have.
        """
        layout = self.layout
        rows = access.compute_totals(self.driver, layout.responses, list(layout.desvars), once)
        if self._look_at_jacobian and not once:
            self._look_at_jacobian = False
            access.report_singular(self.driver)
        return self._as_totals(rows)

    def load(self, x: NDArray[np.float64]) -> None:
        """Bring the model into the state of ``x``; run it only if it is in another one."""
        x = self.layout.clip(x)
        # bitwise comparison: derivatives belong to exactly this state
        if x.tobytes() != self._loaded:
            self._execute(x, run=True)

    def load_result(self, x: NDArray[np.float64]) -> None:
        """Bring the model into the state of the result of the run, whose case is the last one of the
        recorder file: readers take the last case as the result."""
        x = self.layout.clip(x)
        if self._recorded is None:
            self.load(x)
            return
        self._set_design(x)
        # a design that the continued run has taken from its file may stand anywhere in it
        if self._recorded.ends_here():
            self.load(x)
        else:
            self._execute(x, run=True, again=True)

    def _execute(
        self, x, already_set: bool = False, run: bool = False, again: bool = False
    ) -> Evaluation:
        """Evaluate ``x``; ``run`` forces the model to run even at recorded designs, ``again`` the
        recorder to record them once more."""
        driver = self.driver
        self._loaded = None
        if not already_set:
            self._set_design(x)
        recorded = self._find_recorded(x)
        if again:
            driver.repeated_case = None
            driver.iter_count = max(driver.iter_count, self._recorded.next_iteration)
        run = run or recorded is None
        failure = None
        try:
            # failed evaluations are recorded with their reason; other exceptions are raised
            with access.recording(driver):
                driver.iter_count += 1
                try:
                    evaluation = self._solve(x, None if run else recorded)
                except BaseException as error:
                    # the recorder reads this when the context ends
                    driver.case_failure = _describe(error)
                    if not isinstance(error, AnalysisError | KeyboardInterrupt):
                        raise
                    failure = error
        finally:
            driver.case_failure = ""
        if failure is None:
            self._restore_last_success = access.snapshot(access.problem_of(driver).model)
            self._loaded = x.tobytes() if run else None
            if self._recorded is not None and driver.repeated_case is None:
                self._recorded.note_recorded()
            self._known[x.tobytes()] = evaluation
            return evaluation
        # back to the last converged state
        access.silence_after_failure(driver)
        self._restore_last_success()
        if isinstance(failure, AnalysisError):
            self._note_failure(x, failure)
        raise failure

    def _set_design(self, x) -> None:
        access.set_design(self.driver, x, self.layout.desvars)
        # a recorded design has its recorded bits, which scaling back and forth may change
        if x.tobytes() in self._recorded_at:
            self._recorded.load_design(self._recorded_at[x.tobytes()])

    def _solve(self, x, recorded: Case | None) -> Evaluation:
        driver = self.driver
        if recorded is None:
            with self._running():
                access.run_model(driver)
        else:
            # continued run: recorded values instead of an analysis
            driver.reused_evaluations += 1
            self._recorded.restore(recorded)
        return self._values_at(x)

    def _values_at(self, x) -> Evaluation:
        """Return the values that are in the model, which belong to ``x``."""
        # scaled values in the order of the driver
        by_name = self.driver.get_objective_values(), self.driver.get_constraint_values()
        objective, constraints = flat(by_name[0])[0], flat(by_name[1])
        wrong = [name for own in by_name for name, x in own.items() if not np.isfinite(x).all()]
        if wrong:
            raise AnalysisError(
                f"values of the objective or of constraints are not finite: {', '.join(wrong)}"
            )
        return Evaluation(x, float(objective), constraints, self.layout.violation(constraints))

    def _note_failure(self, x, error: AnalysisError) -> None:
        # a failure of values and of derivatives at one point counts once
        if not isinstance(self._known.get(x.tobytes()), str):
            self.driver.failed_analyses += 1
        # the text only: the exception would keep all objects of its traceback alive
        self._known[x.tobytes()] = self.last_failure = str(error)

    def _find_recorded(self, x) -> Case | None:
        """Return the case of the earlier run at the current design of the model."""
        if self._recorded is None:
            return None
        case = self._recorded.find()
        self.driver.repeated_case = None if case is None else case.counter
        if case is None:
            self.driver.iter_count = max(self.driver.iter_count, self._recorded.next_iteration)
        else:
            self._recorded_at[x.tobytes()] = case
        return case

    def _recorded_totals(self, x) -> NDArray[np.float64] | None:
        """Return the recorded derivatives of an earlier run at ``x``, and record them again."""
        case = self._recorded_at.get(x.tobytes())
        rows = case and recorded_jacobian(case, self.layout.responses, self.layout.desvars)
        if rows is not None:
            # the earlier run has checked its first Jacobian
            self._look_at_jacobian = False
            self.driver.repeated_case = case.counter
            access.record_totals(self.driver, case.totals)
        return rows

    def _as_totals(self, rows):
        """Assemble gradient and Jacobian from the derivatives of all responses."""
        layout = self.layout
        # Jacobian (m, n) in the row order of the constraint vector
        jacobian = np.zeros((layout.m, layout.n))
        # row 0 is the objective
        jacobian[layout.rows(layout.responses)] = rows[1:]
        # linear constraints in their own rows
        if layout.linear:
            # constant: computed once
            if self._linear_jacobian is None:
                self._linear_jacobian = access.compute_totals(
                    self.driver, layout.linear, list(layout.desvars), once=True
                )
            jacobian[layout.rows(layout.linear)] = self._linear_jacobian
        if not np.isfinite(rows).all():
            raise AnalysisError("the total derivatives are not finite (NaN or infinity)")
        return rows[0].copy(), jacobian


def _describe(error: BaseException) -> str:
    """Describe a failure; other exceptions than AnalysisError mark the case as unfinished."""
    if isinstance(error, AnalysisError):
        return str(error) or type(error).__name__
    return f"{UNFINISHED}: {type(error).__name__} {error}".strip()

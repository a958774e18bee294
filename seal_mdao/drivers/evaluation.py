"""One place where the drivers run the model and ask for its total derivatives.

A failed analysis leaves a model in a state that nobody has checked: half-converged states would
be the starting guess of the next solve. The evaluator therefore puts the last good inputs and
outputs back, remembers the point as failed, and marks the recorded case as not successful, so
that whoever reads the case file cannot mistake it for a result.
"""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from openmdao.core.analysis_error import AnalysisError

from seal_mdao import openmdao_access as access
from seal_mdao.drivers.layout import flat
from seal_mdao.recording.evaluations import UNFINISHED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seal_mdao.drivers.layout import ProblemLayout
    from seal_mdao.openmdao_access import FailedCases
    from seal_mdao.recording.evaluations import RecordedCase, RecordedEvaluations


@dataclass(frozen=True)
class Evaluation:
    """Values of a successfully analysed point, in driver scaling.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Design variables.
    objective : float
    constraints : ndarray, shape (m,)
        Constraints, linear and constant ones included.
    violation : float
        Largest constraint violation.
    """

    x: NDArray[np.float64]
    objective: float
    constraints: NDArray[np.float64]
    violation: float


class ModelEvaluator:
    """Runs the model of a driver at points of the optimiser and remembers what it found.

    Parameters
    ----------
    driver : FailedCases
        The driver, after its final setup.
    layout : ProblemLayout
    running : callable
        Returns the context manager inside which the model runs.
    recorded : RecordedEvaluations, optional
        What an earlier run found out; at its designs the model is not run.

    Attributes
    ----------
    last_failure : str
        Why the last analysis that failed did so.
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
        self._recorded_at: dict[bytes, RecordedCase] = {}
        self._known: dict[bytes, Evaluation | str] = {}
        self._loaded: bytes | None = None
        self._good_vectors = None
        self._linear_jacobian = None
        self._look_at_jacobian = driver.options["singular_jac_behavior"] != "ignore"

    def start(self) -> Evaluation:
        """Run the model at its own design point, moved onto the bounds where it is outside.

        Returns
        -------
        Evaluation
            Values at the start. Values already in the model are not scaled back and forth, so
            the first run is bitwise the run the user would have made.

        Raises
        ------
        AnalysisError
            If the analysis fails at the start; there is nothing to go back to.
        ValueError
            If an earlier run is to be continued and it began elsewhere, or with another model.
        """
        x = flat(self.driver.get_design_var_values())
        inside = self.layout.clip(x)
        evaluation = self._execute(inside, already_set=np.array_equal(inside, x), run=True)
        if self._recorded is not None:
            self._recorded.check_start()
        return evaluation

    def evaluate(self, x: NDArray[np.float64]) -> Evaluation:
        """Return the values at ``x`` (on the bounds where it is outside), running at most once.

        Raises
        ------
        AnalysisError
            If the analysis fails at ``x``, or has failed there before.
        """
        x = self.layout.clip(x)
        found = self._known.get(x.tobytes())
        if isinstance(found, str):
            raise AnalysisError(found)
        return self._execute(x) if found is None else found

    def totals(self, x: NDArray[np.float64]):
        """Return the gradient of the objective and the Jacobian of all constraints at ``x``.

        The model is run again when its state belongs to another point.

        Returns
        -------
        gradient : ndarray, shape (n,)
        jacobian : ndarray, shape (m, n)

        Raises
        ------
        AnalysisError
            If the derivatives cannot be had; the point counts as failed from then on.
        """
        x = self.layout.clip(x)
        try:
            known = self._recorded_totals(x)
            if known is not None:
                return self._as_totals(known)
            self.load(x)
            with self._running():
                return self.totals_here()
        except AnalysisError as error:
            self._note_failure(x, error)
            raise

    def totals_here(self, once: bool = False):
        """Return gradient and Jacobian at the point now in the model, without running it.

        Those that are asked for ``once``, after a run, are not checked for zero rows and columns: an
        optimum may have some.
        """
        layout = self.layout
        rows = access.compute_totals(self.driver, layout.responses, list(layout.desvars), once)
        if self._look_at_jacobian and not once:
            self._look_at_jacobian = False
            access.report_singular(self.driver)
        return self._as_totals(rows)

    def load(self, x: NDArray[np.float64]) -> None:
        """Bring the model into the state of ``x``, running it only when it is elsewhere."""
        x = self.layout.clip(x)
        if x.tobytes() != self._loaded:
            self._execute(x, run=True)

    def _execute(self, x, already_set: bool = False, run: bool = False) -> Evaluation:
        """Evaluate ``x``; ``run`` the model even where an earlier run has been."""
        driver = self.driver
        self._loaded = None
        failure = None
        if not already_set:
            access.set_design(driver, x, self.layout.desvars)
        recorded = self._find_recorded(x)
        run = run or recorded is None
        try:
            with access.recording(driver):
                driver.iter_count += 1
                try:
                    evaluation = self._solve(x, None if run else recorded)
                except BaseException as error:
                    driver.case_failure = _describe(error)
                    if not isinstance(error, AnalysisError | KeyboardInterrupt):
                        raise
                    failure = error
        finally:
            driver.case_failure = ""
        if failure is None:
            self._accept(evaluation, loaded=run)
            return evaluation
        self._recover(x, failure)
        raise failure

    def _solve(self, x, recorded: RecordedCase | None) -> Evaluation:
        driver = self.driver
        if recorded is None:
            with self._running():
                access.run_model(driver)
        else:
            driver.reused_evaluations += 1
            recorded.restore(access.problem_of(driver).model)
        objective = flat(driver.get_objective_values())[0]
        constraints = flat(driver.get_constraint_values())
        if not (np.isfinite(objective) and np.isfinite(constraints).all()):
            raise AnalysisError("the model gave a value that is not finite (nan or inf)")
        return Evaluation(x, float(objective), constraints, self.layout.violation(constraints))

    def _accept(self, evaluation: Evaluation, loaded: bool) -> None:
        vectors = access.problem_of(self.driver).model.get_nonlinear_vectors()[:2]
        self._good_vectors = [(vector, vector.asarray(copy=True)) for vector in vectors]
        self._loaded = evaluation.x.tobytes() if loaded else None
        self._known[evaluation.x.tobytes()] = evaluation

    def _recover(self, x, failure) -> None:
        """Put the last good state back after a failed or interrupted run."""
        access.silence_after_failure(self.driver)
        for vector, values in self._good_vectors or ():
            vector.set_val(values)
        if isinstance(failure, AnalysisError):
            self._note_failure(x, failure)

    def _note_failure(self, x, error: AnalysisError) -> None:
        if not isinstance(self._known.get(x.tobytes()), str):
            self.driver.failed_analyses += 1
        # the text alone: the error itself would keep all that was on the stack
        self._known[x.tobytes()] = self.last_failure = str(error)

    def _find_recorded(self, x) -> RecordedCase | None:
        """Return what an earlier run found at the design that is in the model."""
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
        """Return the derivatives that an earlier run found at ``x``, and record them again."""
        case = self._recorded_at.get(x.tobytes())
        rows = case and case.jacobian(self.layout.responses, self.layout.desvars)
        if rows is not None:
            self._look_at_jacobian = False  # the earlier run has looked at the first one
            self.driver.repeated_case = case.counter
            access.record_totals(self.driver, case.totals)
        return rows

    def _as_totals(self, rows):
        """Return gradient and Jacobian out of the derivatives of all responses."""
        layout = self.layout
        jacobian = np.zeros((layout.m, layout.n))
        jacobian[layout.rows(layout.responses)] = rows[1:]
        if layout.linear:
            if self._linear_jacobian is None:  # constant
                self._linear_jacobian = access.compute_totals(
                    self.driver, layout.linear, list(layout.desvars), once=True
                )
            jacobian[layout.rows(layout.linear)] = self._linear_jacobian
        if not np.isfinite(rows).all():
            raise AnalysisError("the total derivatives are not finite (nan or inf)")
        return rows[0].copy(), jacobian


def _describe(error: BaseException) -> str:
    """Say why a point has no values; what is no failure of the analysis is no property of the point."""
    if isinstance(error, AnalysisError):
        return str(error) or type(error).__name__
    return f"{UNFINISHED}: {type(error).__name__} {error}".strip()

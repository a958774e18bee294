"""One place where the drivers run the model and ask for its total derivatives.

A failed analysis leaves a model in a state that nobody has checked: half-converged states would
be the starting guess of the next solve. The evaluator therefore puts the last good inputs and
outputs back, remembers the point as failed, and marks the recorded case as not successful, so
that whoever reads the case file cannot mistake it for a result.
"""

from __future__ import annotations

from collections import OrderedDict
from contextlib import nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from openmdao.core.analysis_error import AnalysisError
from openmdao.core.driver import RecordingDebugging

from seal_mdao.drivers.counting import counting_failures
from seal_mdao.drivers.layout import approximates_derivatives
from seal_mdao.recording.evaluations import UNFINISHED
from seal_mdao.recording.recorder import record_totals

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from numpy.typing import NDArray
    from openmdao.core.driver import Driver

    from seal_mdao.drivers.layout import ProblemLayout
    from seal_mdao.recording.evaluations import RecordedCase, RecordedEvaluations

MEMORY = 64
"""Number of evaluated points whose values are kept."""


def _describe(error: BaseException) -> str:
    """Say why a point has no values; what is no failure of the analysis is no property of the point."""
    if isinstance(error, AnalysisError):
        return str(error) or type(error).__name__
    return f"{UNFINISHED}: {type(error).__name__} {error}".strip()


@dataclass(frozen=True)
class Evaluation:
    """Values of a successfully analysed point, in driver scaling.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Design variables.
    objective : float
        Objective.
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
    """Runs the model of a driver at points of the optimizer and remembers what it found.

    Parameters
    ----------
    driver : Driver
        The driver, after its final setup. It may have an attribute ``case_failure``, which is
        set to the reason while a failed point is recorded, and ``repeated_case``, which is set to
        the number of the recorded case at whose design the model is.
    layout : ProblemLayout
        Layout of the problem.
    interruptible : callable or None
        Returns a context manager inside which the model runs.
    recorded : RecordedEvaluations, optional
        What an earlier run found out; at its designs the model is not run.

    Attributes
    ----------
    failures : int
        Failed analyses since the start of the run, those of an earlier run included.
    reused : int
        Evaluations that were taken from the earlier run.
    last_error : AnalysisError or None
        The most recent failure.
    """

    def __init__(
        self,
        driver: Driver,
        layout: ProblemLayout,
        interruptible: Callable[[], AbstractContextManager] = nullcontext,
        recorded: RecordedEvaluations | None = None,
    ):
        self.driver = driver
        self.layout = layout
        self.failures = 0
        self.reused = 0
        self.last_error: AnalysisError | None = None
        self._interruptible = interruptible
        self._recorded = recorded
        self._recorded_at: dict[bytes, RecordedCase] = {}
        self._known: OrderedDict[bytes, Evaluation | AnalysisError] = OrderedDict()
        self._loaded: bytes | None = None
        self._good_vectors = None
        self._linear_jac = None
        self._check_jacobian = driver.options["singular_jac_behavior"] != "ignore"

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
        x, _ = self.current()
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
        if isinstance(found, AnalysisError):
            raise found
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
            If the derivatives cannot be had at ``x``.
        """
        known = self._recorded_totals(x)
        if known is not None:
            return self._as_totals(known)
        self.load(x)
        try:
            with self._interruptible():
                return self._compute_totals()
        except AnalysisError as error:
            self._note_failure(error)
            raise

    def current(self):
        """Return the design variables and constraint values that are in the model now."""
        driver = self.driver
        driver.get_design_var_values()
        driver.get_constraint_values()
        vectors = driver._vectors
        return vectors["design_var"].asarray().copy(), vectors["constraint"].asarray().copy()

    def totals_here(self):
        """Return gradient and Jacobian at the point now in the model, without running it.

        Raises
        ------
        AnalysisError
            If the derivatives cannot be had.
        """
        return self._compute_totals()

    def load(self, x: NDArray[np.float64]) -> None:
        """Bring the model into the state of ``x``, running it only when it is elsewhere."""
        x = self.layout.clip(x)
        if x.tobytes() != self._loaded:
            self._execute(x, run=True)

    def forget(self, x: NDArray[np.float64], error: AnalysisError) -> None:
        """Treat ``x`` as failed from now on (its derivatives could not be computed)."""
        self._remember(self.layout.clip(x), error)

    @property
    def linear_jacobian(self) -> NDArray[np.float64]:
        """Constant Jacobian of the linear constraints, shape (number of linear rows, n)."""
        if self._linear_jac is None:
            shape = (self.layout.linear_rows.size, self.layout.n)
            self._linear_jac = np.zeros(shape)
            if self.layout.linear:
                self._linear_jac[:] = self._linear_totals()
        return self._linear_jac

    def _execute(self, x, already_set: bool = False, run: bool = False) -> Evaluation:
        """Evaluate ``x``; ``run`` the model even where an earlier run has been."""
        driver = self.driver
        self._loaded = None
        failure = None
        if not already_set:
            self._set_design(x)
        recorded = self._find_recorded(x)
        run = run or recorded is None
        try:
            with RecordingDebugging(driver._get_name(), driver.iter_count, driver):
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
        case = self._recorded_at.get(self.layout.clip(x).tobytes())
        rows = case and case.jacobian(self.layout.responses, self.layout.desvars)
        if rows is not None:
            self._check_jacobian = False  # the earlier run has looked at the first one
            self.driver.repeated_case = case.counter
            record_totals(self.driver, case.totals)
        return rows

    def _solve(self, x, recorded: RecordedCase | None) -> Evaluation:
        driver = self.driver
        if recorded is None:
            active = driver._problem().model._relevance.nonlinear_active("iter")
            with self._interruptible(), active, counting_failures(driver.result, "model"):
                driver._run_solve_nonlinear()
        else:
            self.reused += 1
            recorded.restore(driver._problem().model)
        objective = float(np.ravel(next(iter(driver.get_objective_values().values())))[0])
        driver.get_constraint_values()
        constraints = driver._vectors["constraint"].asarray().copy()
        if not (np.isfinite(objective) and np.isfinite(constraints).all()):
            raise AnalysisError("the model gave a value that is not finite (nan or inf)")
        return Evaluation(x, objective, constraints, self.layout.violation(constraints))

    def _set_design(self, x) -> None:
        driver = self.driver
        comm = driver._problem().comm
        if comm.size > 1:
            comm.Bcast(x, root=0)
        driver._vectors["design_var"].set_data(x, driver_scaling=True)
        driver._set_design_vars(driver_scaling=True)

    def _accept(self, evaluation: Evaluation, loaded: bool) -> None:
        model = self.driver._problem().model
        vectors = (model._inputs, model._outputs)
        self._good_vectors = [(vector, vector.asarray(copy=True)) for vector in vectors]
        self._loaded = evaluation.x.tobytes() if loaded else None
        self._remember(evaluation.x, evaluation)

    def _recover(self, x, failure) -> None:
        """Put the last good state back after a failed or interrupted run."""
        self.driver._problem().model._clear_iprint()
        for vector, values in self._good_vectors or ():
            vector.set_val(values)
        if isinstance(failure, AnalysisError):
            self._remember(x, failure)
            self._note_failure(failure)

    def _note_failure(self, error: AnalysisError) -> None:
        self.failures += 1
        self.last_error = error

    def _remember(self, x, found: Evaluation | AnalysisError) -> None:
        self._known[x.tobytes()] = found
        if len(self._known) > MEMORY:
            self._known.popitem(last=False)

    def _compute_totals(self):
        rows = self._raw_totals(self.layout.responses)
        self._check_singular()
        return self._as_totals(rows)

    def _as_totals(self, rows):
        """Return gradient and Jacobian out of the derivatives of all responses."""
        layout, linear = self.layout, self.linear_jacobian
        jacobian = np.zeros((layout.m, layout.n))
        jacobian[layout.nonlinear_rows] = rows[1:]
        jacobian[layout.linear_rows] = linear
        if not (np.isfinite(rows).all()):
            raise AnalysisError("the total derivatives are not finite (nan or inf)")
        return rows[0].copy(), jacobian

    def _linear_totals(self):
        """Compute the linear constraints' derivatives without touching the nonlinear ones."""
        driver = self.driver
        nonlinear, driver._total_jac = driver._total_jac, None
        try:
            return self._raw_totals(self.layout.linear)
        finally:
            driver._total_jac = nonlinear

    def _raw_totals(self, of):
        with counting_failures(self.driver.result, "deriv"):
            return self.driver._compute_totals(
                of=list(of), wrt=list(self.layout.desvars), return_format="array"
            )

    def _check_singular(self) -> None:
        """Report zero rows and columns of the first total Jacobian, as OpenMDAO's drivers do."""
        driver = self.driver
        if not self._check_jacobian or driver._total_jac is None:
            return
        self._check_jacobian = False
        if approximates_derivatives(driver._problem().model):
            return
        driver._total_jac.check_total_jac(
            raise_error=driver.options["singular_jac_behavior"] == "error",
            tol=driver.options["singular_jac_tol"],
        )

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

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from numpy.typing import NDArray
    from openmdao.core.driver import Driver

    from seal_mdao.drivers.layout import ProblemLayout

MEMORY = 64
"""Number of evaluated points whose values are kept."""


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
        set to the reason while a failed point is recorded.
    layout : ProblemLayout
        Layout of the problem.
    interruptible : callable or None
        Returns a context manager inside which the model runs.

    Attributes
    ----------
    failures : int
        Failed analyses since the start of the run.
    last_error : AnalysisError or None
        The most recent failure.
    """

    def __init__(
        self,
        driver: Driver,
        layout: ProblemLayout,
        interruptible: Callable[[], AbstractContextManager] = nullcontext,
    ):
        self.driver = driver
        self.layout = layout
        self.failures = 0
        self.last_error: AnalysisError | None = None
        self._interruptible = interruptible
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
        """
        x, _ = self.current()
        inside = self.layout.clip(x)
        return self._execute(inside, already_set=np.array_equal(inside, x))

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
            self._execute(x)

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

    def _execute(self, x, already_set: bool = False) -> Evaluation:
        driver = self.driver
        self._loaded = None
        failure = None
        if not already_set:
            self._set_design(x)
        with RecordingDebugging(driver._get_name(), driver.iter_count, driver):
            driver.iter_count += 1
            try:
                evaluation = self._solve(x)
            except (AnalysisError, KeyboardInterrupt) as error:
                driver.case_failure = str(error) or type(error).__name__
                failure = error
        driver.case_failure = ""
        if failure is None:
            self._accept(evaluation)
            return evaluation
        self._recover(x, failure)
        raise failure

    def _solve(self, x) -> Evaluation:
        driver = self.driver
        active = driver._problem().model._relevance.nonlinear_active("iter")
        with self._interruptible(), active, counting_failures(driver.result, "model"):
            driver._run_solve_nonlinear()
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

    def _accept(self, evaluation: Evaluation) -> None:
        model = self.driver._problem().model
        vectors = (model._inputs, model._outputs)
        self._good_vectors = [(vector, vector.asarray(copy=True)) for vector in vectors]
        self._loaded = evaluation.x.tobytes()
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
        layout = self.layout
        linear = self.linear_jacobian
        rows = self._raw_totals(layout.responses)
        self._check_singular()
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

"""SlsqpDriver: OpenMDAO's SLSQP with a line search that continues after failed analyses."""

import sys

import numpy as np
import openmdao.api as om
from tqdm import tqdm

from seal_mdao.components.failures import warn_of_faults
from seal_mdao.drivers.layout import flat, read_layout, require_single_objective
from seal_mdao.drivers.optimizer_driver import VIOLATED
from seal_mdao.drivers.solver_libraries import count, tolerance
from seal_mdao.openmdao_access import (
    FailedCases,
    ScipyIterations,
    TotalsInUnits,
    faults,
    problem_of,
    scaled_bounds,
    snapshot,
)

FAILED_OBJECTIVE = 1e20
"""Scaled objective of a failed analysis. The line search rejects the step and tries a tenth of it."""
FEASIBLE = 1e-6
"""Largest violation of a constraint that is satisfied, in driver scaling."""


class SlsqpDriver(FailedCases, TotalsInUnits, ScipyIterations):
    """OpenMDAO's ScipyOptimizeDriver with SLSQP; an analysis that fails shortens the step.

    AnalysisError at the start, or in the derivatives, ends the run as usual. Use `UnoDriver`
    or `IpoptDriver` where analyses fail often, and where a run may have to be continued.

    Parameters
    ----------
    **kwargs
        Options of ScipyOptimizeDriver. ``disp``, unless given, is true where the output is a
        terminal; it prints a line per analysis in addition to SciPy's summary.

    Attributes
    ----------
    failed_analyses : int
        Number of points of the last run at which the analysis failed.
    exit_message : str
        Message of a run that failed; names violated constraints.
    """

    exit_message = ""

    def __init__(self, **kwargs):
        super().__init__(**{"optimizer": "SLSQP", "disp": sys.stdout.isatty(), **kwargs})

    def run(self) -> bool:
        """Optimise; see ScipyOptimizeDriver.

        Raises
        ------
        ValueError
            For an invalid tolerance or iteration limit, or a negative scaler.
        RuntimeError
            For an objective with several entries.
        """
        # OpenMDAO's driver does not check its options
        tolerance("tol", self.options["tol"])
        count("maxiter", self.options["maxiter"])
        _require_positive_scalers(self)
        require_single_objective(self)
        self.failed_analyses, self.case_failure, self.exit_message = 0, "", ""
        model = self._model = problem_of(self).model
        self._restore = self._scipy_optimize_result = None
        # an attribute of the instance hides the method of the class during the run
        model.run_solve_nonlinear = self._analyse
        try:
            fail = super().run()
        finally:
            del model.run_solve_nonlinear, self._model, self._restore
        if fail:
            # OpenMDAO's driver has printed SciPy's message without the constraints
            self.exit_message = str(self._scipy_optimize_result.message)
            violated = read_layout(self).violated(flat(self.get_constraint_values()), FEASIBLE)
            if violated:
                self.exit_message += VIOLATED.format(violated)
                tqdm.write(self.exit_message)
        warn_of_faults(f"{self.msginfo}: final design", faults(self), set())
        return fail

    def get_exit_status(self) -> str:
        """Return the message of the last run: of one that failed SciPy's, with violated constraints."""
        return self.exit_message or super().get_exit_status()

    def get_objective_values(self, driver_scaling: bool = True) -> dict:
        """Return the objective by name; after a failed analysis a value that the line search rejects."""
        found = super().get_objective_values(driver_scaling)
        if not self.case_failure:
            return found
        # the failed case has been recorded by now: restore the state of the last success
        self._restore()
        self.case_failure = ""
        # shape of the objective, value that the line search rejects
        return {name: np.full_like(value, FAILED_OBJECTIVE) for name, value in found.items()}

    def _analyse(self) -> None:
        """Run the model; store a failure, or raise it at the start and in finite differences."""
        if self.computing_totals:
            type(self._model).run_solve_nonlinear(self._model)
            return
        self.case_failure = ""
        try:
            type(self._model).run_solve_nonlinear(self._model)
        except om.AnalysisError as error:
            # the start: there is no state to restore
            if self._restore is None:
                raise
            self.failed_analyses += 1
            self.case_failure = str(error) or "the analysis failed"
        else:
            self._restore = snapshot(self._model)
        # above SciPy's own output and any progress bar
        if self.options["disp"]:
            value = super().get_objective_values()
            text = self.case_failure or ", ".join(f"{n} = {v.item():.6e}" for n, v in value.items())
            tqdm.write(f"analysis {self.iter_count}: {text}")


def _require_positive_scalers(driver: SlsqpDriver) -> None:
    """Raise ValueError for a negative scaler: OpenMDAO's driver would take an upper bound as a lower
    one, and report a design that violates it as a success."""
    for kind in ("design_var", "constraint"):
        for name, (*_, equals, scaler) in scaled_bounds(driver, kind).items():
            if equals is None and scaler is not None and np.min(scaler) < 0.0:
                raise ValueError(
                    f"SlsqpDriver cannot use the negative scaler of {name!r}, which exchanges its lower "
                    "and upper bounds; use ref > ref0, or the driver UnoDriver or IpoptDriver"
                )

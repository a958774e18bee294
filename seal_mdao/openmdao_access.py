"""All uses of private names of OpenMDAO, and differences between its releases since 3.38.

OpenMDAO has no public interface for the tasks of an optimisation driver: responses and their scaling,
total derivatives of a running problem, recorded data.
"""

import json
import os
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import openmdao.api as om
from openmdao.core.driver import Driver, RecordingDebugging
from openmdao.core.group import Group
from openmdao.utils.general_utils import default_noraise, make_serializable
from openmdao.utils.record_util import create_local_meta

SCALED_METADATA = not hasattr(Driver, "autoscaler")
"""Whether the metadata of variables hold scaled bounds, as in releases before 3.44."""
INFINITE = 1e30
"""Absent bound in those."""


class RunOnce(om.NonlinearRunOnce):
    """Run the subsystems of a group once; if an analysis fails, set all their variables to NaN.

    Subsystems behind the one that failed do not run: a driver that continues would record their values
    of the last design for this one. Subsystems that run only before or after the optimisation (option
    ``group_by_pre_opt_post`` of the problem) keep their values.
    """

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self._completed, self._failed = None, False

    def solve(self):
        """Run the subsystems."""
        system = self._system()
        if self._completed is None:
            self._completed = system._outputs.asarray(copy=True)
        try:
            super().solve()
        except om.AnalysisError:
            self._failed = True
            components = system.system_iter(recurse=True, typ=om.ExplicitComponent)
            for component in system._relevance.filter(components):
                # independent variables are the design, and may not be set again for the next one
                if not isinstance(component, om.IndepVarComp):
                    for vector in (component._inputs, component._outputs):
                        vector.set_val(np.nan)
            raise
        self._failed = False
        if not system.under_complex_step:
            self._completed = system._outputs.asarray(copy=True)

    def replace_nan(self) -> None:
        """Set the outputs of the last completed run after one that failed, or the initial ones."""
        outputs = self._system()._outputs
        if self._failed and np.isnan(outputs.asarray()).any():
            outputs.set_val(self._completed)


class UnchangedByResiduals(om.ExplicitComponent):
    """Component whose outputs are unchanged if its residuals cannot be computed.

    Line searches of ``NewtonSolver`` (option ``retry_on_analysis_error``) shorten the step after an
    ``AnalysisError``, and begin from the outputs as they were.
    """

    def _apply_nonlinear(self):
        before = self._outputs.asarray(copy=True)
        try:
            super()._apply_nonlinear()
        except om.AnalysisError:
            self._outputs.set_val(before)
            raise


class FailedCases(Driver):
    """Mixin of a driver that marks the recorded case of a failed analysis.

    Attributes
    ----------
    case_failure : str
        Reason of the failure of the analysis that is being recorded; empty for a success.
    failed_analyses : int
        Number of points of the last run at which the analysis failed.
    """

    case_failure = ""
    failed_analyses = 0

    # the only hook at which a driver can mark a case as failed
    def _get_recorder_metadata(self, case_name: str) -> dict:
        metadata = super()._get_recorder_metadata(case_name)
        if self.case_failure:
            metadata |= {"success": 0, "msg": self.case_failure}
        return metadata


class TotalsInUnits(Driver):
    """Mixin of a driver of OpenMDAO whose total derivatives are in the declared units; see
    ``convert_totals``.

    Attributes
    ----------
    computing_totals : bool
        Whether total derivatives are being computed; finite differences run the model meanwhile.
    """

    computing_totals = False

    def _compute_totals(self, *args, **kwargs):
        self.computing_totals = True
        try:
            totals = super()._compute_totals(*args, **kwargs)
        finally:
            self.computing_totals = False
        convert_totals(self)
        return totals


class ScipyIterations(om.ScipyOptimizeDriver):
    """Mixin of OpenMDAO's driver of SciPy whose result counts the iterations of the optimiser, not the
    evaluations of the model."""

    counts_iterations = True

    def _update_result(self, result) -> None:
        # None after a failed analysis at the start, which raises
        found = self._scipy_optimize_result
        result.iter_count = 0 if found is None else int(found.nit)


def counted_iterations(driver: Driver) -> int | None:
    """Return the number of iterations of the last run; None for a driver whose result counts evaluations
    of the model instead."""
    return driver.result.iter_count if getattr(driver, "counts_iterations", False) else None


class DriverHooks(FailedCases):
    """Private hooks of a driver as public methods and attributes: name under which cases are recorded,
    message and major iterations of the last run."""

    case_name = "Driver"
    exit_message = "NOT_RUN"
    iterations = 0
    counts_iterations = True

    def declare_options(self, declare) -> None:
        """Declare the options of the driver."""

    def get_exit_status(self) -> str:
        """Return the message of the last run."""
        return super().get_exit_status() if self._finding else self.exit_message

    # options given as keyword arguments are set before the __init__ of a subclass continues
    def _declare_options(self):
        super()._declare_options()
        self.declare_options(self.options.declare)

    def _get_name(self) -> str:
        return self.case_name

    def _setup_driver(self, problem) -> None:
        super()._setup_driver(problem)
        if len(self._objs) > 1:
            raise RuntimeError(
                f"{self.msginfo} does not support multiple objectives: {sorted(self._objs)}."
            )

    # result.iter_count is filled in here
    def _update_result(self, result) -> None:
        if not self._finding:
            result.iter_count = self.iterations

    # Problem.find_feasible runs another optimiser (SciPy's) through this driver
    @property
    def _finding(self) -> bool:
        return getattr(self, "_in_find_feasible", False)


class SqliteHooks(om.SqliteRecorder):
    """Private hooks and attributes of ``SqliteRecorder`` under public names."""

    @property
    def path(self) -> str:
        """Recorder file; the database is created there when the run begins."""
        return self._filepath

    @path.setter
    def path(self, path) -> None:
        self._filepath = str(path)

    @property
    def counter(self) -> int:
        """Number of the last recorded case."""
        return self._counter

    @counter.setter
    def counter(self, number: int) -> None:
        self._counter = number

    def is_started(self, requester) -> bool:
        """Return whether the recorder has been started for this requester."""
        return requester in self._started

    def make_database(self, comm) -> None:
        """Create a database at ``path``."""
        super()._initialize_database(comm)

    def use_database(self, connection) -> None:
        """Record into an existing database."""
        self.connection = self.metadata_connection = connection
        self._database_initialized = True

    def open_database(self, comm) -> None:
        """Create or open the database; to be overridden."""
        self.make_database(comm)

    def _initialize_database(self, comm):
        self.open_database(comm)


# ---- the problem of a driver ----


def problem_of(driver: Driver) -> om.Problem:
    """Return the problem of a driver, which has a weak reference to it."""
    return driver._problem()


def sources(driver: Driver) -> dict[str, str]:
    """Return the sources of design variables, objectives and constraints by their names."""
    tables = (driver._designvars, driver._responses)
    return {name: meta["source"] for table in tables for name, meta in table.items()}


def variable_settings(driver: Driver) -> dict[str, dict]:
    """Return the settings of design variables and responses by name, in the form of recorder files."""
    tables = (driver._designvars, driver._objs, driver._cons)
    plain = {
        name: {key: make_serializable(value) for key, value in meta.items()}
        for table in tables
        for name, meta in table.items()
    }
    return json.loads(json.dumps(plain, default=default_noraise))


def with_unscaled_bounds(setting: dict) -> dict:
    """Return one of the ``variable_settings`` with its bounds before scaling."""
    if not SCALED_METADATA:
        return setting
    # releases before 3.44 replace finite bounds by (bound + adder) scaler
    scaler, adder = (setting.get(key) for key in ("scaler", "adder"))
    found = {}
    for key in ("lower", "upper", "equals"):
        bound = np.array(setting.get(key), float)
        if setting.get(key) is not None and np.abs(bound).max() < INFINITE:
            bound = bound / (1.0 if scaler is None else scaler) - (0.0 if adder is None else adder)
            found[key] = np.round(bound, 12).tolist()  # rounding of the scaling
    return setting | found


def linear_constraints(driver: Driver) -> list[str]:
    """Return the names of the linear constraints."""
    return [name for name, meta in driver._cons.items() if meta["linear"]]


def nonlinear_responses(driver: Driver) -> list[str]:
    """Return objective and nonlinear constraints in the row order that a total colouring assumes."""
    return list(driver._get_ordered_nl_responses())


def approximates_derivatives(model: Group) -> bool:
    """Return whether any group approximates derivatives; OpenMDAO's relevance is unreliable then."""
    return any(group._has_approx for group in model.system_iter(True, True, typ=Group))


def constant_constraints(driver: Driver) -> list[str]:
    """Return the constraints that depend on no design variable, of which OpenMDAO itself warns."""
    model = problem_of(driver).model
    if approximates_derivatives(model):
        return []
    constants = set(model._relevance._no_dv_responses)
    return [name for name, meta in driver._cons.items() if meta["source"] in constants]


def run_afterwards(driver: Driver) -> set[str]:
    """Return the paths of components that OpenMDAO runs only after an optimisation (option
    ``group_by_pre_opt_post``), because no response depends on them.

    During the optimisation their variables have values of an earlier run, or initial ones.
    """
    components = problem_of(driver).model._post_components
    return set(components or ()) if driver.supports["optimization"] else set()


def scaled_bounds(driver: Driver, kind: str) -> dict[str, tuple]:
    """Return lower bound, upper bound, equality value and scaler (or None) by name, in driver scaling.

    ``kind`` is "design_var" or "constraint".
    """
    metadata = driver._designvars if kind == "design_var" else driver._cons
    if SCALED_METADATA:
        keys = ("lower", "upper", "equals", "total_scaler")
        return {name: tuple(map(own.get, keys)) for name, own in metadata.items()}
    bounds, own = driver.autoscaler.get_bounds_scaling(kind), driver.autoscaler._var_meta[kind]
    return {
        n: (bounds[n].lower, bounds[n].upper, bounds[n].equals, own[n]["total_scaler"])
        for n in metadata
    }


# ---- a run ----


def begin_run(driver: Driver) -> None:
    """Reset the last run; check objective and design variables as OpenMDAO's drivers do."""
    driver.result.reset()
    driver.iter_count = 0
    driver._total_jac = driver._total_jac_linear = None
    driver._check_for_missing_objective()
    driver._check_for_invalid_desvar_values()


def set_design(driver: Driver, x: np.ndarray, slices: dict[str, slice]) -> None:
    """Set a design in driver scaling in the model."""
    comm = problem_of(driver).comm
    # the design of process 0 on all processes
    if comm.size > 1:
        comm.Bcast(x, root=0)
    if getattr(driver, "_vectors", None) is None:  # before 3.44
        for name, part in slices.items():
            driver.set_design_var(name, x[part])
    else:
        driver._vectors["design_var"].set_data(x, driver_scaling=True)
        driver._set_design_vars(driver_scaling=True)


def run_model(driver: Driver) -> None:
    """Run the model; a run that raises is counted as well."""
    # without components that do not depend on the design and run once, before or after
    relevance = problem_of(driver).model._relevance
    with relevance.nonlinear_active("iter"), counting_failures(driver.result, "model"):
        driver._run_solve_nonlinear()


def compute_totals(driver: Driver, of: list[str], wrt: list[str], once: bool) -> np.ndarray:
    """Compute total derivatives in driver scaling.

    OpenMDAO reuses the set-up of the last call, which fits one list of responses only; responses
    requested ``once`` have their own.
    """
    kept = driver._total_jac
    if once:
        driver._total_jac = None
    try:
        with counting_failures(driver.result, "deriv"):
            totals = driver._compute_totals(of=of, wrt=wrt, return_format="array")
            convert_totals(driver)
            return totals
    finally:
        if once:
            # a model that approximates its totals is set up for the last list of responses only
            approximated = problem_of(driver).model._owns_approx_jac
            driver._total_jac = None if approximated else kept


def convert_totals(driver: Driver) -> None:
    """Convert the last total derivatives of a driver, in place, to the declared units of design
    variables and responses, where OpenMDAO has not done so.

    OpenMDAO 3.45 omits the conversion for all lists of responses but that of the objective and the
    nonlinear constraints: derivatives of linear constraints are in the units of the model.
    """
    # derivatives of linear constraints are stored apart if the driver supports linear constraints
    totals = driver._total_jac if driver._total_jac is not None else driver._total_jac_linear
    if not hasattr(totals, "_identify_unit_active_vars"):  # before 3.44
        return
    if not (totals._resp_unit_scalers or totals._desvar_unit_scalers):
        # d(u_f f)/d(u_x x) = (u_f / u_x) df/dx; later computations of the same list are converted
        totals._identify_unit_active_vars()
        totals._apply_unit_scaling(totals.J_dict)


def report_singular(driver: Driver) -> None:
    """Report zero rows and columns of the total Jacobian, as OpenMDAO's drivers do once."""
    if driver._total_jac is not None and not approximates_derivatives(problem_of(driver).model):
        driver._total_jac.check_total_jac(
            raise_error=driver.options["singular_jac_behavior"] == "error",
            tol=driver.options["singular_jac_tol"],
        )


def prepare_coloring(driver: Driver) -> None:
    """Compute the total colouring if one was declared and is not static."""
    problem_of(driver).get_total_coloring(driver._coloring_info, run_model=False)


def snapshot(model: Group) -> Callable[[], None]:
    """Store inputs and outputs of a model; return the function that restores them."""
    stored = [(v, v.asarray(copy=True)) for v in model.get_nonlinear_vectors()[:2]]

    def restore() -> None:
        for vector, numbers in stored:
            vector.set_val(numbers)

    return restore


def doe_failure(driver: Driver) -> str:
    """Return why the case of a ``DOEDriver`` that is being recorded failed; empty for a success, and for
    other drivers.

    ``DOEDriver`` notes the failure as the traceback of the exception, but does not record it.
    """
    # an attribute of the driver from its first case
    noted = getattr(driver, "_metadata", None) if isinstance(driver, om.DOEDriver) else None
    if not noted or noted["success"]:
        return ""
    return noted["msg"].strip().splitlines()[-1]


def silence_after_failure(driver: Driver) -> None:
    """Reset the depth of the failed analysis in the tree of solvers, which indents their output."""
    problem_of(driver).model._clear_iprint()


@contextmanager
def counting_failures(result, kind: str):
    """Count an evaluation ("model" or "deriv") that raises; OpenMDAO counts those that return."""
    try:
        yield
    except BaseException:
        name = f"{kind}_evals"
        setattr(result, name, getattr(result, name) + 1)
        raise


# ---- recording ----


def recording(driver: Driver) -> RecordingDebugging:
    """Return the context that records a case, and prints for ``debug_print``, at its end."""
    return RecordingDebugging(driver._get_name(), driver.iter_count, driver)


def record_totals(driver: Driver, totals: dict) -> None:
    """Record derivatives (by ``"of!wrt"``) that have not been computed by OpenMDAO in this run."""
    if not (driver.recording_options["record_derivatives"] and driver._rec_mgr.has_recorders()):
        return
    name, stack = driver._get_name(), driver._recording_iter
    stack.push((name, driver.iter_count))
    try:
        driver._rec_mgr.record_derivatives(driver, totals, create_local_meta(name))
    finally:
        stack.pop()


def recorders(driver: Driver) -> list:
    """Return the recorders of a driver."""
    return list(driver._rec_mgr)


def recorder_file(recorder: om.SqliteRecorder) -> str:
    """Return the path of the file of a recorder."""
    return recorder._filepath


def recorder_path(problem: om.Problem, path) -> Path:
    """Return the path of a recorder file: a bare name is in the problem's output folder."""
    bare = not (os.path.sep in str(path) or "/" in str(path))
    return (Path(problem.get_outputs_dir()) if bare else Path()).absolute() / path


def contact_states(driver: Driver) -> dict[str, str]:
    """States of contact by their names, of all components of the model that have ``contact_states``."""
    systems = problem_of(driver).model.system_iter(include_self=True, recurse=True)
    own = {s.pathname: s.contact_states() for s in systems if hasattr(s, "contact_states")}
    if len(own) == 1:
        return next(iter(own.values()))
    return {
        f"{path}: {name}": state for path, found in own.items() for name, state in found.items()
    }


def faults(driver: Driver) -> list[str]:
    """Faults of the last design's results, of all components of the model that have ``faults``."""
    systems = problem_of(driver).model.system_iter(include_self=True, recurse=True)
    own = {s.pathname: s.faults() for s in systems if hasattr(s, "faults")}
    return [
        f"{path}: {text}" if len(own) > 1 else text for path, found in own.items() for text in found
    ]


def find_value(vector, name: str) -> np.ndarray | None:
    """Return a flat view of a variable in a vector of the model; None if it is not there."""
    return vector._abs_get_val(name) if vector._contains_abs(name) else None


def independent_outputs(driver: Driver) -> set[str]:
    """Return the absolute names of all independent variables of the model."""
    model = problem_of(driver).model
    return {
        name for name, meta in model.abs_meta_iter("output") if "openmdao:indep_var" in meta["tags"]
    }

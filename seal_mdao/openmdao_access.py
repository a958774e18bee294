"""The one module that uses names of OpenMDAO with a leading underscore, each with its reason.

OpenMDAO has no public interface for what an optimisation driver does: which responses there are and
how they are scaled, total derivatives of a running problem, and what a recorder notes. What differs
between the releases since 3.38 is hidden here as well.
"""

from __future__ import annotations

import json
import os
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
"""Bound that stands for none in those."""


class RunOnce(om.NonlinearRunOnce):
    """Run the subsystems of a group once; where an analysis fails leave NaN in all that they have.

    Subsystems behind the one that failed do not run: a driver that continues would record what the last
    design has left in them as values of this one. Independent variables keep their values: they are
    the design, and some of them are not set again for the next one.
    """

    def solve(self):
        """Run the subsystems."""
        try:
            super().solve()
        except om.AnalysisError:
            for component in self._system().system_iter(recurse=True, typ=om.ExplicitComponent):
                if not isinstance(component, om.IndepVarComp):
                    for vector in (component._inputs, component._outputs):
                        vector.set_val(np.nan)
            raise


class FailedCases(Driver):
    """Mixin of a driver that marks the recorded case of a failed analysis.

    ``_get_recorder_metadata`` is the only hook at which a driver can say that a case failed.

    Attributes
    ----------
    case_failure : str
        Why the analysis that is being recorded failed; empty for a good one.
    failed_analyses : int
        Number of points of the last run at which the analysis failed.
    """

    case_failure = ""
    failed_analyses = 0

    def _get_recorder_metadata(self, case_name: str) -> dict:
        metadata = super()._get_recorder_metadata(case_name)
        if self.case_failure:
            metadata |= {"success": 0, "msg": self.case_failure}
        return metadata

    def find_model(self) -> Group:
        """The model that the driver runs."""
        return problem_of(self).model


class DriverHooks(FailedCases):
    """The private hooks of a driver as plain methods and attributes.

    Attributes
    ----------
    case_name : str
        Name under which cases are recorded.
    exit_message : str
        How the last run ended.
    iterations : int
        Major iterations of the last run.
    """

    case_name = "Driver"
    exit_message = "NOT_RUN"
    iterations = 0

    def declare_options(self, declare) -> None:
        """Declare the driver's options."""

    def get_exit_status(self) -> str:
        """Return in words how the last run ended."""
        return super().get_exit_status() if self._finding else self.exit_message

    # options given as keyword arguments are set before a subclass' __init__ goes on
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
        """The recorder file; where the database is made when the run begins."""
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
        """Whether this requester has announced itself."""
        return requester in self._started

    def make_database(self, comm) -> None:
        """Make a new database at ``path``."""
        super()._initialize_database(comm)

    def use_database(self, connection) -> None:
        """Record into a database that is there already."""
        self.connection = self.metadata_connection = connection
        self._database_initialized = True

    def open_database(self, comm) -> None:
        """Make or open the database; the place to override."""
        self.make_database(comm)

    def _initialize_database(self, comm):
        self.open_database(comm)


# ---- the problem of a driver ----


def problem_of(driver: Driver) -> om.Problem:
    """The problem; a driver keeps a weak reference to it."""
    return driver._problem()


def sources(driver: Driver) -> dict[str, str]:
    """Absolute names behind design variables, objectives and constraints, by their own names."""
    tables = (driver._designvars, driver._responses)
    return {name: meta["source"] for table in tables for name, meta in table.items()}


def variable_settings(driver: Driver) -> dict[str, dict]:
    """Settings of design variables, objectives and constraints by name, as recorder files hold them."""
    tables = (driver._designvars, driver._objs, driver._cons)
    plain = {
        name: {key: make_serializable(value) for key, value in meta.items()}
        for table in tables
        for name, meta in table.items()
    }
    return json.loads(json.dumps(plain, default=default_noraise))


def with_unscaled_bounds(setting: dict) -> dict:
    """One of the ``variable_settings`` with its bounds as they were given.

    Releases before 3.44 keep (bound + adder) scaler in their place, but for infinite ones.
    """
    if not SCALED_METADATA:
        return setting
    scaler, adder = (setting.get(key) for key in ("scaler", "adder"))
    found = {}
    for key in ("lower", "upper", "equals"):
        bound = np.array(setting.get(key), float)
        if setting.get(key) is not None and np.abs(bound).max() < INFINITE:
            bound = bound / (1.0 if scaler is None else scaler) - (0.0 if adder is None else adder)
            found[key] = np.round(bound, 12).tolist()  # what scaling to and fro has rounded
    return setting | found


def linear_constraints(driver: Driver) -> list[str]:
    """Names of the linear constraints."""
    return [name for name, meta in driver._cons.items() if meta["linear"]]


def nonlinear_responses(driver: Driver) -> list[str]:
    """Objective and nonlinear constraints in the row order that a total colouring assumes."""
    return list(driver._get_ordered_nl_responses())


def approximates_derivatives(model: Group) -> bool:
    """Whether any group approximates its derivatives; OpenMDAO's relevance is not reliable then."""
    return any(group._has_approx for group in model.system_iter(True, True, typ=Group))


def constant_constraints(driver: Driver) -> list[str]:
    """Names of the constraints that depend on no design variable, as OpenMDAO itself warns."""
    model = problem_of(driver).model
    if approximates_derivatives(model):
        return []
    constants = set(model._relevance._no_dv_responses)
    return [name for name, meta in driver._cons.items() if meta["source"] in constants]


def scaled_bounds(driver: Driver, kind: str) -> dict[str, tuple]:
    """Lower bound, upper bound and equality value (or None) by name, in driver scaling.

    Parameters
    ----------
    driver : Driver
    kind : str
        "design_var" or "constraint".
    """
    metadata = driver._designvars if kind == "design_var" else driver._cons
    if SCALED_METADATA:
        return {n: (m["lower"], m["upper"], m.get("equals")) for n, m in metadata.items()}
    found = driver.autoscaler.get_bounds_scaling(kind)
    if not isinstance(found, tuple):
        return {n: (found[n].lower, found[n].upper, found[n].equals) for n in metadata}
    lower, upper, equals = found  # 3.44: three vectors
    return {
        n: (lower[n], upper[n], equals[n] if m.get("equals") is not None else None)
        for n, m in metadata.items()
    }


def total_scalers(driver: Driver, kind: str) -> dict:
    """Factors of driver scaling by name; None where there is none."""
    metadata = driver._designvars if kind == "design_var" else driver._cons
    own = getattr(getattr(driver, "autoscaler", None), "_var_meta", None)
    return {name: (own[kind] if own else metadata)[name]["total_scaler"] for name in metadata}


# ---- a run ----


def begin_run(driver: Driver) -> None:
    """Forget the last run, and check objective and design variables as OpenMDAO's drivers do."""
    driver.result.reset()
    driver.iter_count = 0
    driver._total_jac = driver._total_jac_linear = None
    driver._check_for_missing_objective()
    driver._check_for_invalid_desvar_values()


def set_design(driver: Driver, x: np.ndarray, slices: dict[str, slice]) -> None:
    """Put a design in driver scaling into the model."""
    comm = problem_of(driver).comm
    if comm.size > 1:
        comm.Bcast(x, root=0)
    if getattr(driver, "_vectors", None) is None:  # before 3.44
        for name, part in slices.items():
            driver.set_design_var(name, x[part])
    else:
        driver._vectors["design_var"].set_data(x, driver_scaling=True)
        driver._set_design_vars(driver_scaling=True)


def run_model(driver: Driver) -> None:
    """Run what depends on the design; a run that raises is counted and timed as well."""
    relevance = problem_of(driver).model._relevance  # leaves out what runs once before or after
    with relevance.nonlinear_active("iter"), counting_failures(driver.result, "model"):
        driver._run_solve_nonlinear()


def compute_totals(driver: Driver, of: list[str], wrt: list[str], once: bool) -> np.ndarray:
    """Total derivatives in driver scaling, with the set-up that OpenMDAO keeps from call to call.

    The set-up fits one list of responses only; those that are asked for ``once`` have their own.
    """
    kept = driver._total_jac
    if once:
        driver._total_jac = None
    try:
        with counting_failures(driver.result, "deriv"):
            return driver._compute_totals(of=of, wrt=wrt, return_format="array")
    finally:
        if once:
            driver._total_jac = kept


def report_singular(driver: Driver) -> None:
    """Report zero rows and columns of the total Jacobian, as OpenMDAO's drivers do for the first."""
    if driver._total_jac is not None and not approximates_derivatives(problem_of(driver).model):
        driver._total_jac.check_total_jac(
            raise_error=driver.options["singular_jac_behavior"] == "error",
            tol=driver.options["singular_jac_tol"],
        )


def prepare_coloring(driver: Driver) -> None:
    """Compute the total colouring if one was declared and is not static."""
    problem_of(driver).get_total_coloring(driver._coloring_info, run_model=False)


def silence_after_failure(driver: Driver) -> None:
    """Forget how deep in the tree of solvers the failed analysis was, which indents their output."""
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
    """Context whose end records a case and does ``debug_print``."""
    return RecordingDebugging(driver._get_name(), driver.iter_count, driver)


def record_totals(driver: Driver, totals: dict) -> None:
    """Hand derivatives (by ``"of!wrt"``) that were not computed just now to the recorders."""
    if not (driver.recording_options["record_derivatives"] and driver._rec_mgr.has_recorders()):
        return
    name, stack = driver._get_name(), driver._recording_iter
    stack.push((name, driver.iter_count))
    try:
        driver._rec_mgr.record_derivatives(driver, totals, create_local_meta(name))
    finally:
        stack.pop()


def recorders(driver: Driver) -> list:
    """The recorders of a driver."""
    return list(driver._rec_mgr)


def recorder_file(recorder: om.SqliteRecorder) -> str:
    """Path of the file of a recorder."""
    return recorder._filepath


def recorder_path(problem: om.Problem, path) -> Path:
    """Where OpenMDAO's recorders put a file: a bare name is in the problem's output folder."""
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


def find_value(vector, name: str) -> np.ndarray | None:
    """View of a variable in a vector of the model, flat; None if it is not there."""
    return vector._abs_get_val(name) if vector._contains_abs(name) else None


def independent_outputs(driver: Driver) -> set[str]:
    """Absolute names of all that the model takes as given."""
    model = problem_of(driver).model
    return {
        name for name, meta in model.abs_meta_iter("output") if "openmdao:indep_var" in meta["tags"]
    }

"""Base class of the drivers: options, start and end of a run, and messages."""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from numpy.typing import NDArray
from openmdao.core.analysis_error import AnalysisError
from tqdm import tqdm

from seal_mdao import openmdao_access as access
from seal_mdao.components.failures import warn_of_faults
from seal_mdao.drivers.callbacks import SolverCallbacks
from seal_mdao.drivers.evaluation import ModelEvaluator
from seal_mdao.drivers.interrupt import InterruptGuard
from seal_mdao.drivers.kink import find_kink
from seal_mdao.drivers.layout import flat, read_layout
from seal_mdao.drivers.optimality import Optimality
from seal_mdao.drivers.solver_libraries import count, positive_count, tolerance
from seal_mdao.drivers.stagnation import PATIENCE, Stagnation
from seal_mdao.recording import run_log
from seal_mdao.recording.evaluations import RecordedEvaluations

SUPPORTED = (
    "optimization", "gradients", "inequality_constraints", "equality_constraints",
    "two_sided_constraints", "linear_constraints", "simultaneous_derivatives",
)  # fmt: skip
INTERRUPTED = "Stopped by the user (Ctrl-C); "
BEST_KEPT = "the best feasible design found is the result"
LEAST_KEPT = (
    "no feasible design was found, so the design with the smallest constraint violation is the "
    "result"
)

VIOLATED = "; violated constraints, in driver scaling: {}"


@dataclass(frozen=True)
class SolverEnd:
    """Result of an optimiser: final point (n,) in driver scaling, whether it reports convergence, its
    status in words, and whether a limit of iterations or time ended it."""

    x: NDArray
    success: bool
    message: str
    limited: bool = False


class OptimizerDriver(access.DriverHooks):
    """Base class of drivers for continuous design variables with bounds, one objective and
    constraints.

    Equality, one- and two-sided and linear constraints, all with OpenMDAO's scaling, units, indices,
    aliases and total colouring. A failed analysis (AnalysisError, or a value that is not finite)
    shortens the step. AnalysisError at the start, and any other exception anywhere, is raised
    unchanged.

    A successful run leaves the model at the optimiser's result, any other one at the best feasible
    point found, or the least infeasible one; those of a continued run are among them. A run that was
    not ended by a limit or Ctrl-C counts as a success if that point satisfies the optimality
    conditions, see `Optimality`, be it at a kink that no direction improves, see `Kink`. Components
    with a method ``contact_states``, states by name, have the states that change there named. Those
    with a method ``faults``, texts, have the faults of the final design reported by an
    ``UntrustworthyResultWarning``.

    A run that tries nearly the same designs on both sides of a jump of the model is stopped, and its
    message names what jumps, see `Stagnation`.

    Attributes
    ----------
    opt_settings : dict
        Options of the optimiser; they override those of the driver.
    fail : bool
        Whether the last run failed.
    limited : bool
        Whether a limit of iterations or time ended the last run.
    failed_analyses : int
        Number of points of the last run at which the analysis or its derivatives failed.
    reused_evaluations : int
        Number of evaluations that the last run took from ``hotstart_file``.
    kink : Kink or None
        The kink at which the last run ended.
    repeated_case : int or None
        Number of the case in ``hotstart_file`` whose evaluation is being repeated.
    """

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        # OpenMDAO refuses problems with unsupported features
        for feature in SUPPORTED:
            self.supports[feature] = True
        self.supports["integer_design_vars"] = self.supports["distributed_design_vars"] = False
        self.opt_settings: dict = {}
        self.fail = self.limited = False
        self._forget_run()

    def prepare(self, callbacks: SolverCallbacks) -> Callable[[NDArray], SolverEnd]:
        """Return the function that runs the optimiser from a start, before the model is run.

        Raises
        ------
        ValueError
            If the optimiser rejects an entry of ``opt_settings``.
        """
        raise NotImplementedError

    def declare_options(self, declare) -> None:
        """Declare the common options of the drivers."""
        declare(
            "tol", default=1e-3, check_valid=tolerance,
            desc="Optimality tolerance, in driver scaling.",
        )  # fmt: skip
        declare(
            "feas_tol", default=1e-6, check_valid=tolerance,
            desc="Largest constraint violation of a feasible point, in driver scaling.",
        )  # fmt: skip
        declare("maxiter", default=200, check_valid=count, desc="Maximum number of iterations.")
        declare(
            "disp", default=None, values=[None, True, False],
            desc="Print one line per iteration; None: only if the output is a terminal.",
        )  # fmt: skip
        declare(
            "max_failures", default=15, check_valid=positive_count,
            desc="Number of failed analyses after which the optimisation stops; every design at which "
            "derivatives are computed cancels one failure.",
        )  # fmt: skip
        declare(
            "singular_jac_behavior", default="warn", values=["error", "warn", "ignore"],
            desc="Action if the first total Jacobian has zero rows or columns.",
        )  # fmt: skip
        declare(
            "singular_jac_tol", default=1e-16, check_valid=tolerance,
            desc="Tolerance for zero rows and columns.",
        )  # fmt: skip
        declare(
            "hotstart_file", default=None, allow_none=True, types=(str, Path),
            desc="Recorder file of an interrupted optimisation, which is continued: recorded "
            "values and derivatives replace analyses of the same designs. A name without "
            "folder is relative to the output folder of the problem, as for recorders.",
        )  # fmt: skip

    def run(self) -> bool:
        """Optimise; return whether the run failed.

        Raises
        ------
        RuntimeError
            If the problem has no objective or no design variables, or an objective with several entries.
        ValueError
            If the optimiser rejects an entry of ``opt_settings``.
        AnalysisError
            If the analysis or its derivatives fail at the start.
        """
        self._forget_run()
        self.exit_message = run_log.BY_EXCEPTION
        access.begin_run(self)
        # continue an earlier run: its cases replace analyses
        file = self.options["hotstart_file"]
        if file is not None:
            file = access.recorder_path(access.problem_of(self), file)
        recorded = None if file is None else RecordedEvaluations(file, self)
        with InterruptGuard() as guard:
            evaluator = ModelEvaluator(self, read_layout(self), guard.running, recorded)
            callbacks = SolverCallbacks(
                evaluator, guard, self.options["feas_tol"], self.options["max_failures"]
            )
            # options are checked before the first analysis
            solve = self.prepare(callbacks)
            end = solve(callbacks.start(lambda: access.prepare_coloring(self)))
            if callbacks.stopping or not end.success:
                callbacks.consider_recorded()
            # the search for a kink analyses designs that are nearly the same, too
            stagnation, callbacks.stagnation = callbacks.stagnation, Stagnation()
            # many stops are successes in fact: check the KKT conditions independently
            optimal = ""
            if not (end.limited or callbacks.interrupted or callbacks.error) and (
                callbacks.stalled or not end.success
            ):
                optimal = self.optimal_anyway(callbacks)
        # exceptions stored by the callbacks are raised outside the code of the optimiser
        if callbacks.error is not None:
            raise callbacks.error
        self._finish(end, callbacks, optimal, stagnation)
        return self.fail

    def show_iteration(self, objective: float, infeasibility: float, optimality: float) -> None:
        """Count an iteration and print a line if requested."""
        self.iterations += 1
        # by default only where someone watches
        if self.options["disp"] or (self.options["disp"] is None and sys.stdout.isatty()):
            # repeat the header every 30 lines
            if self._next_header == self.iterations:
                self._print("iteration  analyses       objective  infeasibility  optimality")
                self._next_header += 30
            self._print(
                f"{self.iterations:9d} {self.iter_count:9d} {objective:15.6e} {infeasibility:14.2e} "
                f"{optimality:11.2e}"
            )

    def optimal_anyway(self, callbacks: SolverCallbacks) -> str:
        """Return a message if the best point satisfies the KKT conditions, else an empty string."""
        # of the best point, whatever the optimiser reports
        best, tolerances = callbacks.best, (self.options["tol"], self.options["feas_tol"])
        try:
            totals = callbacks.evaluator.totals(best.x)
        except AnalysisError:
            return ""
        found = Optimality.at(callbacks.evaluator.layout, best.x, best.constraints, *totals)
        if found.satisfied(*tolerances):
            return f"No better design was found; {found}"
        # contact states may change at the best point: derivatives of all sides
        self.kink = find_kink(callbacks, totals, *tolerances, partial(access.contact_states, self))
        return str(self.kink or "")

    def _forget_run(self) -> None:
        self.exit_message = "NOT_RUN"
        self.iterations = self.failed_analyses = self.reused_evaluations = 0
        self.repeated_case, self.kink, self.limited = None, None, False
        self._next_header = 1

    def _finish(
        self, end: SolverEnd, callbacks: SolverCallbacks, optimal: str, stagnation: Stagnation
    ) -> None:
        """Leave the model at the result, and set the status and message of the run."""
        stopped = callbacks.interrupted or callbacks.stalled
        # stopped or unsuccessful, and the optimality conditions do not hold
        self.fail = (stopped or not end.success) and not optimal
        self.limited = end.limited and not stopped
        self.exit_message = optimal or self._describe(end, callbacks, stagnation)
        evaluator = callbacks.evaluator
        # the model is left at the result, so that outputs and derivatives belong to it
        evaluator.load_result(callbacks.best.x if stopped or not end.success else end.x)
        constraints, feas_tol = flat(self.get_constraint_values()), self.options["feas_tol"]
        violated = evaluator.layout.violated(constraints, feas_tol)
        if self.fail and violated:
            self.exit_message += VIOLATED.format(violated)
        # constraints that no design variable affects were hidden from the optimiser
        constants = evaluator.layout.violated_constants(constraints, feas_tol)
        if constants:
            self.fail = True
            self.exit_message = (
                f"Infeasible: constraint(s) {constants} are violated and do not depend on any "
                "design variable"
            )
        if self.limited:
            self._print(f"Optimization stopped.\n{self.exit_message}\n{'-' * 35}")
        elif self.fail:
            self._print(f"Optimization FAILED.\n{self.exit_message}\n{'-' * 35}")
        elif self._next_header > 1:
            self._print(f"Optimization Complete\n{self.exit_message}\n{'-' * 35}")
        warn_of_faults(f"{self.msginfo}: final design", access.faults(self), set())

    def _describe(self, end: SolverEnd, callbacks: SolverCallbacks, stagnation: Stagnation) -> str:
        if callbacks.interrupted:
            return INTERRUPTED + (BEST_KEPT if callbacks.feasible else LEAST_KEPT)
        # failures are named even if the optimiser reports another reason
        if callbacks.stalled:
            return (
                "Stopped: every step from the best design found leads to a failed analysis; "
                "tighten the bounds or start from another design. Last failure: "
                f"{callbacks.evaluator.last_failure}"
            )
        kept = BEST_KEPT if callbacks.feasible else LEAST_KEPT
        if end.limited:
            return f"{end.message}; {kept}"
        if stagnation and not end.success:
            jumps = stagnation.jumps(callbacks.evaluator.layout)
            return (
                f"Stopped: the model jumps between the last {PATIENCE} designs, which are nearly the "
                f"same: {jumps}; {kept}; tighten the bounds or start from another design"
            )
        if end.success or not self.failed_analyses:
            return end.message
        return (
            f"{end.message}; {self.failed_analyses} analyses failed, "
            f"last: {callbacks.evaluator.last_failure}"
        )

    def _print(self, text: str) -> None:
        if access.problem_of(self).comm.rank == 0:
            # above the progress bar of an analysis, if any
            tqdm.write(text)

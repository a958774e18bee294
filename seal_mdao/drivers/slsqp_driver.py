"""ResilientSLSQPDriver: SLSQP that survives failed analyses and can limit its steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import openmdao.api as om
from scipy.optimize import OptimizeResult

from seal_mdao.drivers.incumbent import Incumbent
from seal_mdao.drivers.interrupt import InterruptGuard
from seal_mdao.drivers.iteration_table import IterationTable
from seal_mdao.drivers.run_support import (
    INTERRUPTED_FEASIBLE,
    INTERRUPTED_INFEASIBLE,
    RunSupport,
)
from seal_mdao.drivers.slsqp_kernel import CONVERGED, load_kernel
from seal_mdao.drivers.slsqp_loop import SlsqpLoop
from seal_mdao.drivers.slsqp_settings import INTERRUPTED, STALLED, LoopOptions, LoopResult

if TYPE_CHECKING:
    from seal_mdao.drivers.evaluation import Evaluation

SETTINGS = frozenset({"ftol", "maxiter", "disp", "iprint"})
"""What ``opt_settings`` may hold."""


class ResilientSLSQPDriver(RunSupport, om.ScipyOptimizeDriver):
    """ScipyOptimizeDriver's SLSQP that backs off when an analysis fails.

    The options and results are those of `ScipyOptimizeDriver`, and without failures and without
    a move limit so are the iterates: the same compiled SLSQP is at work. It is driven step by
    step, though, instead of through ``scipy.optimize.minimize``, for two reasons.

    *A failed analysis* (AnalysisError, or a value that is nan or infinite) is not given to SLSQP
    as a large objective: the line search would interpolate with a made-up value, accept the
    point after ten contractions whatever it is, and may take the tiny step for convergence.
    Instead a few points around the failed one are tried: solvers often fail at scattered designs
    with good ones in between, and SLSQP goes on from a neighbour as if it had wanted it. If that
    does not help, SLSQP's state from before the step is restored and the step is taken again,
    half as long at first, then shorter.

    *No way forward.* Where ``max_failures`` analyses fail in an iteration, and after several
    iterations of tiny steps, the far side of the failing region is tried at a few points along
    the step, and then random points around the best one; the run begins again from there, up to
    four times, and stops otherwise. The random numbers are the same in every run. Without
    failures this is done only with ``require_optimality`` (tiny steps come of kinks then).

    *A move limit* shortens steps by halves until no variable changes by more, in the direction
    that SLSQP wants. After failures it grows back with good steps. SLSQP keeps its approximation
    of the Hessian all the while, except where it begins again.

    *The end.* As in SciPy a run is a success when the objective changes by less than ``tol``,
    which need not be an optimum. With ``require_optimality`` only a point that satisfies the
    first-order optimality conditions to ``optimality_tol`` is; see `Optimality`.

    AnalysisError at the start, and any other exception anywhere, is raised unchanged. After
    Ctrl-C and after a stop because of failures the model is left at the best feasible point seen
    (the least infeasible one if there is none). `DriverResult.iter_count` is the number of major
    iterations, that is of accepted steps. They are kept in ``history``, and ``disp=2`` prints
    them as a table.

    Parameters
    ----------
    **kwargs
        Options of the driver.

    Attributes
    ----------
    opt_settings : dict
        ``ftol``, ``maxiter``, ``disp`` and ``iprint`` of SciPy's SLSQP; they win over the
        driver's options.

    Raises
    ------
    ImportError
        If SciPy is older than 1.16.
    """

    def __init__(self, **kwargs):
        """Initialize the driver."""
        load_kernel()
        super().__init__(**kwargs)

    def _declare_options(self):
        """Declare the options before keyword arguments are processed."""
        super()._declare_options()
        declare = self.options.declare
        self.options.undeclare("optimizer")
        declare("optimizer", default="SLSQP", values=["SLSQP"], desc="Always SLSQP.")
        declare(
            "move_limit",
            default=None,
            allow_none=True,
            lower=0.0,
            desc="Largest change of any scaled design variable in a major iteration.",
        )
        declare(
            "max_failures",
            default=10,
            lower=1,
            desc="Failed analyses in a major iteration after which backing off is given up.",
        )
        declare(
            "optimality_tol",
            default=1e-6,
            lower=0.0,
            desc="Where the line search can gain nothing more, the run is a success if the "
            "optimality conditions hold to this tolerance.",
        )
        declare(
            "require_optimality",
            default=False,
            types=bool,
            desc="Do not stop because the objective changes little, only where the optimality "
            "conditions hold to optimality_tol.",
        )
        declare(
            "feas_tol",
            default=1e-6,
            lower=0.0,
            desc="Scaled constraint violation up to which a point may be kept as the best one.",
        )

    def run(self) -> bool:
        """Optimize.

        Returns
        -------
        bool
            True if the run failed.

        Raises
        ------
        RuntimeError
            If the problem has no objective or no design variables.
        ValueError
            If ``opt_settings`` holds something else than SLSQP's settings, or ``move_limit`` is
            zero.
        AnalysisError
            If the analysis fails at the start.
        """
        self._reset_run()
        self._check_for_missing_objective()
        self._check_for_invalid_desvar_values()
        options, verbosity = self._loop_options()
        printer = self._print_on_root if verbosity > 1 else None
        with InterruptGuard() as guard:
            evaluator = self._evaluator(guard)
            incumbent = Incumbent(self.options["feas_tol"])
            start = evaluator.start()
            incumbent.offer(start)
            self._problem().get_total_coloring(self._coloring_info, run_model=False)
            loop = SlsqpLoop(evaluator, incumbent, IterationTable(self.history, printer), options)
            ended = self._iterate(loop, start, incumbent)
        self._finish(ended, evaluator, incumbent, verbosity)
        return self.fail

    def _loop_options(self) -> tuple[LoopOptions, int]:
        """Return the settings of the loop and the verbosity."""
        unknown = sorted(set(self.opt_settings) - SETTINGS)
        if unknown:
            raise ValueError(
                f"opt_settings: unknown {unknown}; SLSQP takes {sorted(SETTINGS)} here."
            )
        settings = {
            "ftol": self.options["tol"],
            "maxiter": self.options["maxiter"],
            "disp": self.options["disp"],
            **self.opt_settings,
        }
        limit = self.options["move_limit"]
        if limit == 0:
            raise ValueError("move_limit must be positive, or None for no limit.")
        verbosity = int(settings.get("iprint", settings["disp"])) if settings["disp"] else 0
        options = LoopOptions(
            tol=settings["ftol"],
            max_iterations=int(settings["maxiter"]),
            move_limit=np.inf if limit is None else float(limit),
            max_failures=self.options["max_failures"],
            optimality_tol=self.options["optimality_tol"],
            require_optimality=self.options["require_optimality"],
        )
        return options, verbosity

    @staticmethod
    def _iterate(loop: SlsqpLoop, start: Evaluation, incumbent: Incumbent) -> LoopResult:
        """Run the loop, turning Ctrl-C into a result."""
        try:
            return loop.run(start)
        except KeyboardInterrupt:
            message = INTERRUPTED_FEASIBLE if incumbent.feasible else INTERRUPTED_INFEASIBLE
            return LoopResult(incumbent.best, None, INTERRUPTED, message, loop.iterations)

    def _finish(self, ended: LoopResult, evaluator, incumbent, verbosity: int) -> None:
        """Leave the model at the result and report it."""
        point = incumbent.best if ended.code in (STALLED, INTERRUPTED) else ended.point
        evaluator.load(point.x)
        self.fail = ended.code != CONVERGED
        self._exit_message = ended.message
        self.failed_analyses = evaluator.failures
        self.reused_evaluations = evaluator.reused
        self._major_iterations = ended.iterations
        constants = evaluator.layout.violated_constants(point.constraints, self.options["feas_tol"])
        if constants:
            self.fail = True
            self._exit_message = (
                f"Infeasible: constraint(s) {constants} are violated and do not depend on any "
                "design variable"
            )
        self._scipy_optimize_result = OptimizeResult(
            x=point.x,
            fun=point.objective,
            jac=ended.gradient,
            nit=ended.iterations,
            nfev=self.result.model_evals,
            njev=self.result.deriv_evals,
            status=ended.code,
            message=self._exit_message,
            success=not self.fail,
        )
        self._report(verbosity)

    def _report(self, verbosity: int) -> None:
        """Print the end of the run as ScipyOptimizeDriver does."""
        result = self._scipy_optimize_result
        if verbosity > 0:
            self._print_on_root(
                f"{result.message}    (Exit mode {result.status})\n"
                f"            Current function value: {result.fun}\n"
                f"            Iterations: {result.nit}\n"
                f"            Function evaluations: {result.nfev}\n"
                f"            Gradient evaluations: {result.njev}"
            )
        if self.fail:
            self._print_on_root(f"Optimization FAILED.\n{result.message}\n{'-' * 35}")
        elif verbosity > 0:
            self._print_on_root(f"Optimization Complete\n{'-' * 35}")

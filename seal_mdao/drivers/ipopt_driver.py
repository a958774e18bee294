"""IpoptDriver: Ipopt from a plain ``pip install``, for any OpenMDAO problem."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from openmdao.core.analysis_error import AnalysisError
from openmdao.core.constants import INT_DTYPE
from openmdao.core.driver import Driver

from seal_mdao.drivers.incumbent import Incumbent
from seal_mdao.drivers.interrupt import InterruptGuard
from seal_mdao.drivers.ipopt_callbacks import IpoptCallbacks
from seal_mdao.drivers.ipopt_options import import_ipyopt, ipopt_settings
from seal_mdao.drivers.ipopt_status import NUMBER_TROUBLE_CODES, SUCCESS_CODES, status_message
from seal_mdao.drivers.iteration_table import IterationTable
from seal_mdao.drivers.optimality import Optimality
from seal_mdao.drivers.run_support import (
    INTERRUPTED_FEASIBLE,
    INTERRUPTED_INFEASIBLE,
    RunSupport,
)
from seal_mdao.drivers.sparsity import colored_entries, jacobian_structure

if TYPE_CHECKING:
    from openmdao.core.problem import Problem
    from openmdao.utils.coloring import Coloring

CITATIONS = """
@article{Waechter_Biegler_2006,
  author = {W{\\"a}chter, Andreas and Biegler, Lorenz T.},
  title = {On the implementation of an interior-point filter line-search algorithm for
           large-scale nonlinear programming},
  journal = {Mathematical Programming},
  volume = {106}, number = {1}, pages = {25--57}, year = {2006},
  doi = {10.1007/s10107-004-0559-y}
}
"""


class IpoptDriver(RunSupport, Driver):
    """Interior-point optimizer Ipopt, by way of ipyopt.

    Continuous design variables with bounds, one objective, equality, one- and two-sided and
    linear constraints, all with OpenMDAO's scaling, indices, aliases and total colouring.
    The Hessian is approximated (limited memory) unless ``opt_settings`` says otherwise.

    When the model raises AnalysisError Ipopt shortens its step. After ``max_failures`` failures
    in a row the run is stopped, because Ipopt itself would go on halving the step many hundreds
    of times; it is a success if the best point satisfies the optimality conditions to ``tol``,
    see `Optimality`. If derivatives fail at a point that Ipopt has already accepted, the run continues
    from the last point whose derivatives are known, and from then on values and derivatives are
    computed together. AnalysisError at the start, and any other exception anywhere, is raised
    unchanged.

    After Ctrl-C, after a stop because of failures, and where Ipopt breaks down numerically, the
    model is left at the best feasible point seen (the least infeasible one if there is none);
    otherwise at Ipopt's result. `DriverResult.iter_count` is the number of Ipopt iterations.

    Parameters
    ----------
    **kwargs
        Options of the driver.

    Attributes
    ----------
    opt_settings : dict
        Options of Ipopt; they win over the driver's options.
    fail : bool
        Whether the last run failed.
    ipopt_code : int or None
        Return code of the last run.

    Raises
    ------
    ImportError
        If ipyopt is not installed.
    """

    def __init__(self, **kwargs):
        """Initialize the driver."""
        import_ipyopt()
        super().__init__(**kwargs)
        for feature in (
            "optimization",
            "gradients",
            "inequality_constraints",
            "equality_constraints",
            "two_sided_constraints",
            "linear_constraints",
            "simultaneous_derivatives",
            "total_jac_sparsity",
        ):
            self.supports[feature] = True
        for feature in (
            "multiple_objectives",
            "integer_design_vars",
            "distributed_design_vars",
            "active_set",
        ):
            self.supports[feature] = False
        self.supports._read_only = True
        self.opt_settings: dict = {}
        self.fail = False
        self.ipopt_code: int | None = None
        self.cite = CITATIONS
        self._total_jac_format = "array"

    def _declare_options(self):
        """Declare the options before keyword arguments are processed."""
        super()._declare_options()
        declare = self.options.declare
        declare("tol", default=1e-6, lower=0.0, desc="Ipopt's convergence tolerance (scaled).")
        declare("maxiter", default=200, lower=0, desc="Maximum number of Ipopt iterations.")
        declare("disp", default=False, types=(int, bool), desc="Print a table of iterations.")
        declare(
            "max_failures",
            default=15,
            lower=1,
            desc="Failed analyses in a row after which the run is stopped.",
        )
        declare(
            "feas_tol",
            default=1e-6,
            lower=0.0,
            desc="Scaled constraint violation up to which a point may be kept as the best one.",
        )
        declare(
            "singular_jac_behavior",
            default="warn",
            values=["error", "warn", "ignore"],
            desc="What to do about zero rows or columns of the first total Jacobian.",
        )
        declare("singular_jac_tol", default=1e-16, desc="Tolerance for zero rows and columns.")

    def _get_name(self) -> str:
        """Return the name under which cases are recorded."""
        return "Ipopt"

    def _setup_driver(self, problem: Problem) -> None:
        """Prepare the driver; the last step of the final setup.

        Raises
        ------
        RuntimeError
            If there are several objectives, or discrete or distributed design variables.
        """
        super()._setup_driver(problem)
        if len(self._objs) > 1:
            raise RuntimeError(
                f"{self.msginfo} does not support multiple objectives: {sorted(self._objs)}."
            )
        self._setup_tot_jac_sparsity()

    def _setup_tot_jac_sparsity(self, coloring: Coloring | None = None) -> None:
        """Take the sparsity of the total Jacobian from a total colouring, if there is one."""
        self._con_subjacs = {}
        coloring = coloring if coloring is not None else self._get_static_coloring()
        sparsity = None if coloring is None else coloring.get_subjac_sparsity()
        if sparsity is not None:
            by_source = self._problem().model._owns_approx_of is not None
            self._con_subjacs = colored_entries(self, by_source, sparsity)

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
            If Ipopt does not know a name or refuses a value in ``opt_settings``.
        AnalysisError
            If the analysis or its derivatives fail at the start.
        """
        self._reset_run()
        self._check_for_missing_objective()
        self._check_for_invalid_desvar_values()
        settings = ipopt_settings(
            self.opt_settings, tol=self.options["tol"], max_iter=self.options["maxiter"]
        )
        with InterruptGuard() as guard:
            evaluator = self._evaluator(guard)
            incumbent = Incumbent(self.options["feas_tol"])
            start = evaluator.start()
            incumbent.offer(start)
            self._problem().get_total_coloring(self._coloring_info, run_model=False)
            x, code, callbacks = self._solve(evaluator, incumbent, guard, settings, start.x)
        self.ipopt_code = code
        self.failed_analyses = evaluator.failures
        self.reused_evaluations = evaluator.reused
        self._major_iterations = callbacks.iterations
        if callbacks.error is not None:
            raise callbacks.error[1].with_traceback(callbacks.error[2])
        self._finish(x, code, callbacks, evaluator, incumbent)
        return self.fail

    def _solve(self, evaluator, incumbent, guard, settings, x):
        """Run Ipopt, once more with eager derivatives if they fail at an accepted point."""
        structure = jacobian_structure(self, evaluator.layout, evaluator.linear_jacobian)
        printer = self._print_on_root if self.options["disp"] else None
        table = IterationTable(self.history, printer)
        done = 0
        for eager in (False, True):
            callbacks = IpoptCallbacks(
                evaluator,
                structure,
                incumbent,
                guard,
                table,
                self.options["max_failures"],
                eager=eager,
                first_iteration=done,
            )
            settings = {**settings, "max_iter": settings["max_iter"] - done}
            problem = self._ipopt_problem(evaluator.layout, structure, callbacks, settings)
            x, _, code = problem.solve(np.array(x))
            if not callbacks.derivatives_failed:
                break
            if callbacks.last_point is None:
                raise evaluator.last_error
            x, done = callbacks.last_point, callbacks.iterations
        return x, code, callbacks

    @staticmethod
    def _ipopt_problem(layout, structure, callbacks, settings):
        rows, columns = structure
        active = layout.active
        ipopt_row = np.cumsum(active) - 1
        empty = np.zeros(0, dtype=INT_DTYPE)
        return import_ipyopt().Problem(
            n=layout.n,
            x_l=layout.x_lower,
            x_u=layout.x_upper,
            m=int(active.sum()),
            g_l=layout.c_lower[active],
            g_u=layout.c_upper[active],
            sparsity_indices_jac_g=(ipopt_row[rows], columns),
            sparsity_indices_h=(empty, empty),
            eval_f=callbacks.objective,
            eval_grad_f=callbacks.gradient,
            eval_g=callbacks.constraints,
            eval_jac_g=callbacks.jacobian,
            intermediate_callback=callbacks.iteration,
            ipopt_options=settings,
        )

    def _finish(self, x, code, callbacks, evaluator, incumbent) -> None:
        """Leave the model at the result and say in words how the run ended."""
        stopped = callbacks.interrupted or callbacks.stalled
        if stopped or code in NUMBER_TROUBLE_CODES:
            x = incumbent.best.x
        evaluator.load(x)
        self.fail = stopped or code not in SUCCESS_CODES
        self._exit_message = self._describe_end(code, callbacks, evaluator, incumbent)
        if callbacks.stalled and not callbacks.interrupted:
            self._accept_stalled(incumbent.best, evaluator)
        constants = evaluator.layout.violated_constants(
            evaluator.current()[1], self.options["feas_tol"]
        )
        if constants:
            self.fail = True
            self._exit_message = (
                f"Infeasible: constraint(s) {constants} are violated and do not depend on any "
                "design variable"
            )
        if self.fail:
            self._print_on_root(f"Optimization FAILED.\n{self._exit_message}\n{'-' * 35}")
        elif self.options["disp"]:
            self._print_on_root(f"Optimization Complete\n{self._exit_message}\n{'-' * 35}")

    def _accept_stalled(self, best, evaluator) -> None:
        """Count a run that failures have stopped as a success where its best point is optimal."""
        try:
            totals = evaluator.totals(best.x)
        except AnalysisError:
            return
        reached = Optimality.at(evaluator.layout, best.x, best.constraints, *totals)
        if reached.satisfied(self.options["tol"]):
            self.fail = False
            self._exit_message = f"Failed analyses all around, but the {reached}"

    @staticmethod
    def _describe_end(code, callbacks, evaluator, incumbent) -> str:
        if callbacks.interrupted:
            return INTERRUPTED_FEASIBLE if incumbent.feasible else INTERRUPTED_INFEASIBLE
        if callbacks.stalled:
            return (
                "Stopped: failed analyses leave no way forward from the best point found. "
                f"Last failure: {evaluator.last_error}"
            )
        message = status_message(code)
        if code in NUMBER_TROUBLE_CODES and evaluator.failures:
            message += f"; {evaluator.failures} analyses failed, last: {evaluator.last_error}"
        return message

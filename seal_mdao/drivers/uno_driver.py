"""UnoDriver: the SQP and interior-point methods of Uno, for any OpenMDAO problem."""

import numpy as np

from seal_mdao.drivers.callbacks import SolverCallbacks
from seal_mdao.drivers.optimizer_driver import OptimizerDriver, SolverEnd
from seal_mdao.drivers.solver_libraries import import_library, positive, set_option

CITATION = """
@article{Vanaret_Leyffer_2026,
  author = {Vanaret, Charlie and Leyffer, Sven},
  title = {Implementing a unified solver for nonlinearly constrained optimization},
  journal = {Mathematical Programming Computation}, year = {2026}
}
"""

CHOICES = {
    "preset": ("filtersqp", "funnelsqp", "filterslp", "ipopt"),
    "hessian_model": ("LBFGS", "LSR1", "identity", "zero"),
    "inequality_handling_method": ("inequality_constrained", "interior_point"),
    "inertia_correction_strategy": ("primal", "primal_dual", "none"),
    "progress_norm": ("L1", "L2", "INF"),
    "QP_solver": ("BQPD", "HiGHS"),
    "logger": ("SILENT", "DISCRETE", "WARNING", "INFO", "DEBUG", "DEBUG2", "DEBUG3"),
}
"""Values of the options that Uno 2.9 does not validate; most invalid ones cause a segmentation fault."""

STUCK = ("ALGORITHMIC_ERROR", "FEASIBLE_SMALL_STEP", "INFEASIBLE_SMALL_STEP")
LEAP = 10.0
"""Factor of the trust region at the restart of a stalled run."""

MESSAGES = {
    "FEASIBLE_KKT_POINT": "Optimal solution found",
    "FEASIBLE_FJ_POINT": "Converged to a feasible point where constraint gradients are dependent",
    "INFEASIBLE_STATIONARY_POINT": "Converged to a point of local infeasibility; the problem may be "
    "infeasible",
    "FEASIBLE_SMALL_STEP": "The steps became too small, at a feasible point",
    "INFEASIBLE_SMALL_STEP": "The steps became too small, at an infeasible point",
    "UNBOUNDED": "The objective is unbounded below",
    "ITERATION_LIMIT": "Maximum number of iterations exceeded",
    "TIME_LIMIT": "Maximum time exceeded",
    "EVALUATION_ERROR": "Uno could not start (check opt_settings)",
    "ALGORITHMIC_ERROR": "The optimiser found no acceptable step",
}
"""Messages of Uno's statuses."""


class NotEvaluatedError(Exception):
    """Report a failed evaluation to Uno, which then reduces its trust region."""


class UnoDriver(OptimizerDriver):
    """Optimiser Uno: sequential quadratic programming with a filter and a trust region.

    Preset ``filtersqp`` with an L-BFGS approximation of the Hessian; ``opt_settings`` accepts any
    option of Uno, ``preset`` among them. Driver and failures: see `OptimizerDriver`. Where Uno stalls
    at a point that can be improved, it is restarted once at the best point with a larger trust region,
    which may step across a region of failed analyses or a kink.

    Parameters
    ----------
    tol : float
        Optimality tolerance, in driver scaling (1e-3).
    feas_tol : float
        Largest constraint violation of a feasible point, in driver scaling (1e-6).
    maxiter : int
        Maximum number of iterations (200).
    disp : bool, optional
        Print a line per iteration; by default where the output is a terminal.
    max_failures : int
        Failed analyses after which the run is stopped; a design with derivatives cancels one failure
        (15).
    singular_jac_behavior : {"warn", "error", "ignore"}
        Action for zero rows or columns of the first total Jacobian.
    singular_jac_tol : float
        Tolerance for zero rows and columns (1e-16).
    hotstart_file : str or Path, optional
        Recorder file of an earlier run, whose values replace runs of the model at its designs.
    trust_radius : float
        Largest change of a design variable in the first iteration, in driver scaling (0.3).

    Raises
    ------
    ImportError
        If unopy is not installed.
    """

    case_name = "Uno"

    def __init__(self, **kwargs):
        import_unopy()
        super().__init__(**kwargs)
        self.cite = CITATION

    def declare_options(self, declare) -> None:
        """Declare the options of the driver."""
        super().declare_options(declare)
        declare(
            "trust_radius", default=0.3, check_valid=positive,
            desc="Largest change of a design variable in the first iteration, in driver scaling.",
        )  # fmt: skip

    def prepare(self, callbacks: SolverCallbacks):
        """Return the function that runs Uno from a start; see the base class."""
        # opt_settings override the options of the driver
        settings = {
            "hessian_model": "LBFGS", "logger": "SILENT", "primal_tolerance": self.options["feas_tol"],
            "dual_tolerance": self.options["tol"], "max_iterations": self.options["maxiter"],
            "TR_radius": self.options["trust_radius"], **self.opt_settings,
        }  # fmt: skip
        solver = _solver(settings)
        # called in every iteration; accepted points are reported
        solver.set_termination_callback(lambda *state: callbacks.stopping)
        solver.set_notify_acceptable_iterate_callback(
            lambda *state: callbacks.guarded(self._note, callbacks, *state)
        )

        def solve(start) -> SolverEnd:
            problem = _uno_model(callbacks)
            problem.set_initial_primal_iterate(start)
            result = solver.optimize(problem)
            # stalled and not optimal: restart once, with the remaining iterations
            if _status(result) in STUCK and callbacks.try_again():
                optimal = self.optimal_anyway(callbacks)
                if optimal:
                    return SolverEnd(callbacks.best.x, True, optimal)
                left = int(settings["max_iterations"]) - self.iterations
                solver.set_option("max_iterations", max(1, left))
                solver.set_option("TR_radius", LEAP * settings["TR_radius"])
                problem.set_initial_primal_iterate(callbacks.firm.x)
                result = solver.optimize(problem)
            return _end(result, start.size)

        return solve

    def _note(self, callbacks: SolverCallbacks, x, *state) -> None:
        """Report an accepted point; ``state`` ends with infeasibility, stationarity, complementarity.

        During the restoration of feasibility ``x`` is followed by slack variables of Uno.
        """
        # the values are cached: nothing is analysed here
        point = callbacks.values(x[: callbacks.evaluator.layout.n])
        if point is not None:
            self.show_iteration(point.objective, state[-3], max(state[-2:]))


def import_unopy():
    """Import unopy on demand."""
    return import_library("unopy", "UnoDriver", "unopy")


def _solver(settings: dict):
    """Create the solver with its settings; raise ValueError for unknown names or rejected values."""
    # checked here, because Uno does not
    for name, choice in CHOICES.items():
        if settings.get(name, choice[0]) not in choice:
            raise ValueError(
                f"opt_settings['{name}'] = {settings[name]!r} is not supported; it must be one of "
                f"{choice}"
            )
    solver = import_unopy().UnoSolver()
    solver.set_preset(settings.pop("preset", "filtersqp"))
    for name, value in settings.items():
        set_option(solver.set_option, name, value)
    return solver


def _uno_model(callbacks: SolverCallbacks):
    """Build the problem of Uno, without constraints that no design variable affects."""
    # minimise f(x) subject to x_L <= x <= x_U
    unopy, layout = import_unopy(), callbacks.evaluator.layout
    model = unopy.Model(
        unopy.PROBLEM_NONLINEAR, layout.n, layout.x_lower, layout.x_upper, unopy.ZERO_BASED_INDEXING
    )
    model.set_objective(
        unopy.MINIMIZE,
        lambda x: _given(callbacks.values(x)).objective,
        lambda x, out: np.copyto(out, _given(callbacks.derivatives(x))[0]),
    )
    # constraints l <= c(x) <= u with a dense Jacobian
    rows = np.flatnonzero(layout.active)
    if rows.size:
        model.set_constraints(
            rows.size,
            lambda x, out: np.copyto(out, _given(callbacks.values(x)).constraints[rows]),
            layout.c_lower[rows],
            layout.c_upper[rows],
            rows.size * layout.n,
            *layout.jacobian_pattern,
            lambda x, out: np.copyto(out, _given(callbacks.derivatives(x))[1][rows].ravel()),
        )
    return model


def _given(found):
    # Uno treats exceptions as failed evaluations
    if found is None:
        raise NotEvaluatedError
    return found


def _status(result) -> str:
    """Return the status of Uno, or that of its solution if the optimisation succeeded."""
    ended = result.optimization_status.name
    return result.solution_status.name if ended == "SUCCESS" else ended


def _end(result, n: int) -> SolverEnd:
    status = _status(result)
    return SolverEnd(
        # slack variables of Uno follow the design variables
        np.array(result.primal_solution[:n]),
        status == "FEASIBLE_KKT_POINT",
        MESSAGES.get(status, f"Uno ended with {status}"),
        status.endswith("_LIMIT"),
    )

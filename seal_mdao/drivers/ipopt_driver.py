"""IpoptDriver: Ipopt by ``pip install``, for any OpenMDAO problem."""

import numpy as np

from seal_mdao.drivers.callbacks import SolverCallbacks
from seal_mdao.drivers.optimizer_driver import OptimizerDriver, SolverEnd
from seal_mdao.drivers.solver_libraries import import_library, set_option

CITATION = """
@article{Waechter_Biegler_2006,
  author = {W{\\"a}chter, Andreas and Biegler, Lorenz T.},
  title = {On the implementation of an interior-point filter line-search algorithm for
           large-scale nonlinear programming},
  journal = {Mathematical Programming}, year = {2006}, doi = {10.1007/s10107-004-0559-y}
}
"""

DEFAULTS = {
    "bound_relax_factor": 0.0,
    "hessian_approximation": "limited-memory",
    "print_level": 0,
    "sb": "yes",
}
"""Settings that ``opt_settings`` overrides. Ipopt's default permits iterates 1e-8 outside the bounds,
where the model is never run (a square root may fail there)."""

MESSAGES = {
    0: "Optimal solution found",
    1: "Solved to acceptable level",
    2: "Converged to a point of local infeasibility; the problem may be infeasible",
    3: "The search direction became too small",
    4: "The iterates diverge; the problem may be unbounded",
    5: "Stopped by request",
    6: "A feasible point was found, as requested",
    -1: "Maximum number of iterations exceeded",
    -2: "Restoration of feasibility failed",
    -3: "The search direction could not be computed (linear solver)",
    -4: "Maximum CPU time exceeded",
    -10: "Too few degrees of freedom: more equality constraints than free design variables",
    -11: "Invalid problem definition (check the bounds)",
    -12: "Invalid option (for example a linear solver that is not installed)",
    -13: "A function or derivative value is not a number",
}
"""Messages of Ipopt's return codes; only 0 and 1 are successes."""


class IpoptDriver(OptimizerDriver):
    """Interior-point optimiser Ipopt, called through ipyopt.

    The Hessian is approximated (limited memory); ``opt_settings`` accepts any option of Ipopt. Driver
    and failures: see `OptimizerDriver`. Ipopt cannot reject a point that it has accepted; if the
    derivatives fail there, it restarts at the best point with derivatives, and from then on values
    and derivatives are computed together.

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

    Raises
    ------
    ImportError
        If ipyopt is not installed.
    """

    case_name = "Ipopt"

    def __init__(self, **kwargs):
        import_ipyopt()
        super().__init__(**kwargs)
        self.cite = CITATION

    def prepare(self, callbacks: SolverCallbacks):
        """Return the function that runs Ipopt from a start; see the base class."""
        problem = _ipopt_problem(self, callbacks)
        # opt_settings override the options of the driver
        settings = {
            **DEFAULTS, "tol": self.options["tol"], "constr_viol_tol": self.options["feas_tol"],
            "max_iter": self.options["maxiter"], **self.opt_settings,
        }  # fmt: skip
        for name, value in settings.items():
            # Ipopt writes logical options as yes and no
            word = {True: "yes", False: "no"}[value] if isinstance(value, bool) else value
            set_option(lambda name, value: problem.set(**{name: value}), name, word)

        def solve(x) -> SolverEnd:
            x, _, code = problem.solve(np.array(x))
            # restart from the best point with derivatives, with the remaining iterations
            if callbacks.lost and not callbacks.stopping:
                callbacks.eager, callbacks.lost = True, False
                problem.set(max_iter=max(0, int(settings["max_iter"]) - self.iterations))
                x, _, code = problem.solve(callbacks.firm.x.copy())
            return SolverEnd(x, code in (0, 1), _message(code), code in (-1, -4))

        return solve


def _ipopt_problem(driver: IpoptDriver, callbacks: SolverCallbacks):
    """Build the problem of ipyopt, without constraints that no design variable affects."""
    layout = callbacks.evaluator.layout
    rows, empty = np.flatnonzero(layout.active), np.zeros(0, dtype=np.intp)

    # NaN marks a failed evaluation
    def objective(x) -> float:
        point = callbacks.values(x)
        return np.nan if point is None else point.objective

    def constraints(x, out) -> None:
        point = callbacks.values(x)
        out[:] = np.nan if point is None else point.constraints[rows]

    def gradient(x, out) -> None:
        # dense Jacobian of the active constraints, row by row
        totals = callbacks.derivatives(x)
        out[:] = np.nan if totals is None else totals[0]

    def jacobian(x, out) -> None:
        totals = callbacks.derivatives(x)
        out[:] = np.nan if totals is None else totals[1][rows].ravel()

    def end_of_iteration(mode, iteration, value, infeasibility, optimality, *_) -> bool:
        # iteration 0 is the start
        if iteration > 0:
            callbacks.guarded(driver.show_iteration, value, infeasibility, optimality)
        return not (callbacks.lost or callbacks.stopping)

    return import_ipyopt().Problem(
        n=layout.n,
        x_l=layout.x_lower,
        x_u=layout.x_upper,
        m=rows.size,
        g_l=layout.c_lower[rows],
        g_u=layout.c_upper[rows],
        # no Hessian
        sparsity_indices_jac_g=layout.jacobian_pattern,
        sparsity_indices_h=(empty, empty),
        eval_f=objective,
        eval_grad_f=gradient,
        eval_g=constraints,
        eval_jac_g=jacobian,
        intermediate_callback=end_of_iteration,
    )


def import_ipyopt():
    """Import ipyopt on demand."""
    return import_library("ipyopt", "IpoptDriver", '"seal_mdao[ipopt]"')


def _message(code: int) -> str:
    """Return the message of Ipopt's return code, with the number if it is not a success."""
    # the code helps to find a failure in Ipopt's documentation
    words = MESSAGES.get(code, "Ipopt ended with an unknown error")
    return words if code in (0, 1) else f"{words} (Ipopt code {code})"

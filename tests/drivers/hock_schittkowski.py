"""Thirty-three problems of the Hock-Schittkowski collection as OpenMDAO problems.

The documentation shows the table of the drivers on all problems.
The problems are described in W. Hock and K. Schittkowski, Test Examples for Nonlinear
Programming Codes, Springer 1981.
"""

from __future__ import annotations

from dataclasses import dataclass

import hs_more_variables
import hs_three_variables
import hs_two_variables
import numpy as np
import openmdao.api as om
from hs_problem import HSProblem

import seal_mdao as sm
from seal_mdao.drivers.optimality import measure_optimality

MODULES = (hs_two_variables, hs_three_variables, hs_more_variables)
PROBLEMS = {problem.number: problem for module in MODULES for problem in module.PROBLEMS}

TOL = 1e-9
PRINTED = {11: 1e-9, 65: 1e-10, 66: 1e-10, 71: 1e-7, 76: 1e-9, 77: 1e-8, 78: 1e-8, 100: 1e-7}
"""Unit of the last printed digit of the optima that have no closed form."""


class HSComp(om.ExplicitComponent):
    """Objective ``f`` and constraints ``c`` of a test problem, with analytic partials."""

    def initialize(self):
        """Declare the problem as an option."""
        self.options.declare("problem", types=HSProblem, recordable=False)

    def setup(self):
        """Declare inputs and outputs."""
        problem = self.options["problem"]
        self.add_input("x", val=np.array(problem.start, dtype=float))
        self.add_output("f", val=0.0)
        if problem.c is not None:
            self.add_output("c", val=np.zeros(len(problem.c_lower)))

    def setup_partials(self):
        """Declare dense partials."""
        self.declare_partials("*", "*")

    def compute(self, inputs, outputs):
        """Evaluate the functions."""
        problem = self.options["problem"]
        outputs["f"] = problem.f(inputs["x"])
        if problem.c is not None:
            outputs["c"] = problem.c(inputs["x"])

    def compute_partials(self, inputs, partials):
        """Evaluate the derivatives."""
        problem = self.options["problem"]
        partials["f", "x"] = problem.df(inputs["x"])
        if problem.c is not None:
            partials["c", "x"] = problem.dc(inputs["x"])


@dataclass(frozen=True)
class Solution:
    """What a driver made of a problem.

    ``error`` of the objective and ``violation`` are absolute; ``bound`` is what the tolerance of the
    driver leaves of an error, see `error_bound`.
    """

    number: int
    driver: str
    error: float
    bound: float
    violation: float
    iterations: int
    model_evals: int
    deriv_evals: int
    success: bool
    status: str


def build(number: int, driver: om.Driver) -> om.Problem:
    """Return the test problem, set up with a driver."""
    problem = PROBLEMS[number]
    prob = om.Problem(driver=driver, reports=None)
    model = prob.model
    model.add_subsystem("hs", HSComp(problem=problem), promotes=["*"])
    model.add_design_var("x", lower=_bound(problem.lower), upper=_bound(problem.upper))
    model.add_objective("f")
    for i, (lower, upper) in enumerate(zip(problem.c_lower, problem.c_upper, strict=True)):
        bounds = {"equals": lower} if lower == upper else {"lower": lower, "upper": upper}
        model.add_constraint("c", indices=[i], alias=f"c{i}", linear=problem.linear, **bounds)
    prob.setup()
    return prob


def _bound(bound):
    return np.array(bound, dtype=float) if isinstance(bound, tuple) else float(bound)


def make_driver(name: str) -> om.Driver:
    """Return one of the drivers of the table with tight tolerances."""
    if name == "SLSQP":
        return sm.SlsqpDriver(tol=TOL, maxiter=300, disp=False)
    return {"Uno": sm.UnoDriver, "IPOPT": sm.IpoptDriver}[name](tol=TOL, feas_tol=TOL, maxiter=300)


def error_bound(problem: HSProblem, prob: om.Problem) -> float:
    """Return how far the objective may be from the optimum at a point that is one to ``TOL``.

    To first order f - f* = r (x - x*) - lambda v, with the residual r of the Lagrangian's gradient and
    the violations v (or distances to bounds) both at most TOL. No better is known of x - x* than the
    size of the variables. Ipopt scales an objective with a start gradient above 100 down to that and
    means TOL so; Uno divides by the mean multiplier where that is above 100.
    """
    x, multipliers = prob.get_val("x"), measure_optimality(prob.driver).multipliers
    steep = np.abs(problem.df(np.array(problem.start, dtype=float))).max()
    scale = max(100.0, steep, multipliers) / 100.0
    conditions = TOL * scale * (1.0 + np.abs(x).sum() + multipliers)
    return conditions + PRINTED.get(problem.number, 0.0)


def solve(number: int, name: str) -> Solution:
    """Solve a problem with a driver and compare with the known optimum."""
    problem = PROBLEMS[number]
    driver = make_driver(name)
    prob = build(number, driver)
    driver.options["invalid_desvar_behavior"] = "ignore"
    driver.options["singular_jac_behavior"] = "ignore"
    result = prob.run_driver()
    objective, violation = prob.get_val("f")[0], 0.0
    if problem.c is not None:
        values = prob.get_val("c")
        below = np.array(problem.c_lower) - values
        above = values - np.array(problem.c_upper)
        violation = float(max(0.0, below.max(), above.max()))
    prob.cleanup()
    return Solution(
        number,
        name,
        abs(objective - problem.optimum),
        error_bound(problem, prob),
        violation,
        result.iter_count,
        result.model_evals,
        result.deriv_evals,
        result.success,
        result.exit_status,
    )

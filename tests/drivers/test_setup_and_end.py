"""Wrong problems are refused in words; where runs start and end."""

from __future__ import annotations

import re

import numpy as np
import openmdao.api as om
import pytest
from driver_models import (
    d_rosenbrock,
    plane_problem,
    projection_problem,
    rosenbrock,
    run_projection,
)
from openmdao.utils.om_warnings import DriverWarning

import seal_mdao as sm

SOLUTION = [2.0, -2.0, 1.0, 0.5]


def test_several_objectives(make_driver):
    prob = projection_problem(make_driver())
    prob.model.add_objective("s", index=0)
    prob.setup()
    with pytest.raises(RuntimeError, match="does not support multiple objectives"):
        prob.run_driver()


def test_no_objective(make_driver):
    prob = om.Problem(driver=make_driver(), reports=None)
    prob.model.add_subsystem("c", om.ExecComp("y = x"), promotes=["*"])
    prob.model.add_design_var("x")
    prob.setup()
    with pytest.raises(RuntimeError, match="requires objective to be declared"):
        prob.run_driver()


@pytest.mark.parametrize("make", [sm.UnoDriver, sm.IpoptDriver, sm.SlsqpDriver])
def test_objective_of_several_entries(make):
    """Refused before anything is analysed."""
    prob = om.Problem(driver=make(), reports=None)
    numbers = om.ExecComp("f = (x - 1)**2", x=np.zeros(3), f=np.zeros(3), do_coloring=False)
    prob.model.add_subsystem("c", numbers, promotes=["*"])
    prob.model.add_design_var("x", indices=[1], lower=-2.0, upper=2.0)
    prob.model.add_objective("f")
    prob.setup()
    text = f"{make.__name__}: the objective 'f' has 3 entries, but an objective must be a single number"
    with pytest.raises(RuntimeError, match=text):
        prob.run_driver()
    assert numbers.iter_count == 0


def test_no_design_variable(make_driver):
    prob = om.Problem(driver=make_driver(), reports=None)
    prob.model.add_subsystem("c", om.ExecComp("y = x"), promotes=["*"])
    prob.model.add_objective("y")
    prob.setup()
    prob.driver.options["singular_jac_behavior"] = "ignore"
    with pytest.raises(RuntimeError, match="no design variables"):
        prob.run_driver()


def test_discrete_design_variable(make_driver):
    prob = om.Problem(driver=make_driver(), reports=None)
    ivc = om.IndepVarComp()
    ivc.add_discrete_output("k", val=3)
    prob.model.add_subsystem("ivc", ivc, promotes=["*"])
    prob.model.add_subsystem("c", om.ExecComp("y = x"), promotes=["*"])
    prob.model.add_design_var("k")
    prob.model.add_objective("y")
    prob.setup()
    with pytest.raises(RuntimeError, match="Discrete design variables are not supported"):
        prob.run_driver()


def test_crossed_bounds(make_driver):
    prob = projection_problem(make_driver(), lower=2.0, upper=1.0)
    prob.setup()
    prob.driver.options["invalid_desvar_behavior"] = "ignore"
    with pytest.raises(ValueError, match="lower bound of 'x' lies above"):
        prob.run_driver()


def test_infeasible_problem_is_no_success(make_driver):
    prob = projection_problem(make_driver())
    cube = om.ExecComp("c = x[0]**3", x={"shape": 4, "units": "m"})
    prob.model.add_subsystem("cube", cube, promotes=["*"])
    prob.model.add_constraint("s", indices=[0], upper=1.0)
    prob.model.add_constraint("c", lower=8.0)
    prob.setup()
    prob.set_val("x", np.full(4, 0.5))
    prob.driver.options["singular_jac_behavior"] = "ignore"
    result = prob.run_driver()
    assert not result.success
    assert prob.driver.fail
    assert re.search(
        r"infeasib|incompatible|constraints to [1-9]\.\de[+-]0[01]", result.exit_status
    )
    found = re.search(r"; violated constraints, in driver scaling: (.*)$", result.exit_status)[1]
    s, c = (prob.get_val(name)[0] for name in "sc")
    sizes = {"s": s - 1.0, "c": (8.0 - c) / 8.0}
    assert found == ", ".join(f"{n} by {own:.2g}" for n, own in sizes.items() if own > 1e-6)


def test_start_outside_the_bounds(make_driver):
    prob = projection_problem(make_driver(), lower=0.0, upper=2.5)
    prob.setup()
    prob.set_val("x", np.array([-5.0, 7.0, 1.2, 1.2]))
    with pytest.warns(DriverWarning, match="out of their specified bounds"):
        result = prob.run_driver()
    assert result.success
    assert prob.get_val("x") == pytest.approx([2.5, 0.0, 1.0, 0.5], abs=1e-5)


def test_model_is_never_run_outside_the_bounds(make_driver):
    prob = projection_problem(make_driver(), lower=0.0, upper=2.5)
    visited = []
    run = prob.driver._run_solve_nonlinear

    def watching():
        visited.append(prob.get_val("x").copy())
        return run()

    prob.driver._run_solve_nonlinear = watching
    run_projection(prob, (0.3, 0.3, 0.3, 0.3))
    assert len(visited) >= 3
    assert np.min(visited) >= 0.0
    assert np.max(visited) <= 2.5


def test_run_again_from_the_optimum(make_driver):
    prob = projection_problem(make_driver())
    prob.model.add_constraint("s", indices=[0], upper=4.0)
    assert run_projection(prob, (0.5, 0.5, 0.5, 0.5)) == pytest.approx(SOLUTION, abs=1e-5)
    evaluations = prob.driver.result.model_evals
    result = prob.run_driver()
    assert result.success
    assert result.model_evals <= evaluations
    assert prob.get_val("x") == pytest.approx(SOLUTION, abs=1e-5)


def test_iteration_limit_is_no_success(make_driver):
    prob = plane_problem(make_driver(maxiter=1), (-1.2, 1), rosenbrock, d_rosenbrock)
    result = prob.run_driver()
    assert not result.success
    assert result.iter_count == 1
    assert "iteration" in result.exit_status.lower()


def test_a_limit_is_reported_even_when_quiet(make_driver, capsys):
    prob = plane_problem(make_driver(maxiter=1, disp=False), (-1.2, 1), rosenbrock, d_rosenbrock)
    result = prob.run_driver()
    printed = capsys.readouterr().out
    # a limit is no failure: the best point is there to use
    assert "Optimization stopped." in printed
    assert result.exit_status in printed
    assert prob.driver.limited
    assert "the best feasible design found is the result" in result.exit_status


class CountingComp(om.ExplicitComponent):
    """Passes its input on and counts its runs."""

    def setup(self):
        """Declare an input and an output."""
        self.add_input("a", val=1.0)
        self.add_output("b", val=1.0)
        self.declare_partials("b", "a", val=1.0)
        self.runs = 0

    def compute(self, inputs, outputs):
        """Pass the input on."""
        self.runs += 1
        outputs["b"] = inputs["a"]


def test_components_before_and_after_the_optimization_run_once(make_driver):
    prob = om.Problem(driver=make_driver(), reports=None)
    prob.options["group_by_pre_opt_post"] = True
    model = prob.model
    before = model.add_subsystem("before", CountingComp())
    model.add_subsystem("goal", om.ExecComp("y = (x - t)**2"), promotes=["x"])
    model.add_subsystem("triple", om.ExecComp("z = 3 * x"), promotes=["x"])
    after = model.add_subsystem("after", CountingComp())
    model.connect("before.b", "goal.t")
    model.connect("triple.z", "after.a")
    model.add_design_var("x", lower=-5.0, upper=5.0)
    model.add_objective("goal.y")
    prob.setup()
    prob.set_val("x", 4.0)
    assert prob.run_driver().success
    assert (before.runs, after.runs) == (1, 1)
    assert prob.get_val("after.b") == pytest.approx([3.0], abs=1e-4)


@pytest.mark.filterwarnings("ignore:The following groups have a nonlinear solver")
def test_implicit_model(make_driver):
    prob = om.Problem(driver=make_driver(), reports=None)
    model = prob.model
    coupled = model.add_subsystem("coupled", om.Group(), promotes=["*"])
    balance = om.BalanceComp("y", rhs_val=0.0, val=1.0, eq_units=None)
    coupled.add_subsystem("residual", om.ExecComp("r = y**3 + y - x"), promotes=["*"])
    coupled.add_subsystem("balance", balance, promotes=[("lhs:y", "r"), "y"])
    coupled.nonlinear_solver = om.NewtonSolver(solve_subsystems=False, iprint=-1)
    coupled.nonlinear_solver.options["err_on_non_converge"] = True
    coupled.linear_solver = om.DirectSolver()
    model.add_subsystem("goal", om.ExecComp("f = (y - 1.5)**2"), promotes=["*"])
    model.add_design_var("x", lower=-20.0, upper=20.0)
    model.add_objective("f")
    prob.setup()
    prob.set_val("x", 0.5)
    assert prob.run_driver().success
    assert prob.get_val("x") == pytest.approx([1.5**3 + 1.5], rel=1e-4)

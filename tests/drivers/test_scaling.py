"""Bounds, constraints of all kinds, indices, aliases, units and scaling."""

from __future__ import annotations

import numpy as np
import openmdao.api as om
import pytest
from driver_models import projection_problem, run_projection

from seal_mdao.drivers.layout import read_layout

NEAR = (0.5, 0.5, 0.5, 0.5)


def test_bounds(make_driver):
    upper = np.array([1.0, 10.0, 10.0, 10.0])
    prob = projection_problem(make_driver(), lower=-1.0, upper=upper)
    assert run_projection(prob) == pytest.approx([1.0, -1.0, 1.0, 0.5], abs=1e-5)


def test_equality_constraint(make_driver):
    prob = projection_problem(make_driver())
    prob.model.add_constraint("s", indices=[0], equals=4.0)
    assert run_projection(prob, NEAR) == pytest.approx([2.0, -2.0, 1.0, 0.5], abs=1e-5)


def test_two_sided_constraint_with_indices_and_aliases(make_driver):
    prob = projection_problem(make_driver())
    model = prob.model
    model.add_constraint("s", indices=[0, 2], lower=0.01, upper=0.25, alias="outer")
    model.add_constraint("s", indices=[1], upper=1.0, alias="inner")
    model.add_constraint("s", indices=[3], lower=1.0, alias="last")
    x = run_projection(prob, (0.3, -0.3, 0.2, 1.2))
    assert x == pytest.approx([0.5, -1.0, 0.5, 1.0], abs=1e-5)


def test_lower_side_of_a_two_sided_constraint(make_driver):
    prob = projection_problem(make_driver())
    prob.model.add_constraint("s", indices=[3], lower=1.0, upper=4.0)
    assert run_projection(prob, (0.0, 0.0, 0.0, 1.5))[3] == pytest.approx(1.0, abs=1e-5)


def test_design_variable_indices_leave_the_rest_alone(make_driver):
    prob = projection_problem(make_driver(), indices=[1, 3])
    x = run_projection(prob, (7.0, 0.0, 8.0, 0.0))
    assert x == pytest.approx([7.0, -2.0, 8.0, 0.5], abs=1e-5)


def test_units_of_design_variables(make_driver):
    prob = projection_problem(make_driver(), lower=-150.0, upper=150.0, units="cm")
    assert run_projection(prob) == pytest.approx([1.5, -1.5, 1.0, 0.5], abs=1e-5)


@pytest.mark.parametrize(
    "scaling",
    [
        {"ref": 5.0},
        {"ref": 5.0, "ref0": 1.0},
        {"scaler": 0.1, "adder": 2.0},
        {"ref": np.array([1.0, 10.0, 0.1, 2.0])},
        {"ref": -2.0},
    ],
    ids=["ref", "ref0", "scaler", "array", "negative"],
)
def test_scaled_design_variables(make_driver, scaling):
    upper = np.array([1.5, 10.0, 10.0, 10.0])
    prob = projection_problem(make_driver(), lower=-1.0, upper=upper, **scaling)
    assert run_projection(prob) == pytest.approx([1.5, -1.0, 1.0, 0.5], abs=1e-5)


@pytest.mark.parametrize("ref", [100.0, 0.01, -1.0])
def test_scaled_constraints(make_driver, ref):
    prob = projection_problem(make_driver())
    upper = np.array([4.0, 1.0])
    prob.model.add_constraint("s", indices=[0, 1], upper=upper, ref=ref)
    assert run_projection(prob, NEAR) == pytest.approx([2.0, -1.0, 1.0, 0.5], abs=2e-5)


def test_bounds_turned_round_by_a_negative_scaler(make_driver):
    prob = projection_problem(make_driver(), lower=-1.0, upper=3.0, ref=-2.0)
    prob.model.add_constraint("s", lower=0.5, ref=-4.0)
    run_projection(prob, (1.0, 1.0, 1.0, 1.0))
    layout = read_layout(prob.driver)
    assert layout.x_lower == pytest.approx(np.full(4, -1.5))
    assert layout.x_upper == pytest.approx(np.full(4, 0.5))
    assert layout.c_upper == pytest.approx(np.full(4, -0.125))
    assert np.isneginf(layout.c_lower).all()


def test_maximization(make_driver):
    prob = om.Problem(driver=make_driver(), reports=None)
    prob.model.add_subsystem("c", om.ExecComp("y = 5 - (x - 2)**2"), promotes=["*"])
    prob.model.add_design_var("x", lower=-9.0, upper=9.0)
    prob.model.add_objective("y", ref=-1.0)
    prob.setup()
    assert prob.run_driver().success
    assert prob.get_val("x") == pytest.approx([2.0], abs=1e-6)


def test_autoscaler(make_driver):
    module = pytest.importorskip(  # since OpenMDAO 3.45
        "openmdao.drivers.autoscalers.bounds_autoscaler"
    )
    driver = make_driver()
    driver.autoscaler = module.BoundsAutoscaler()
    upper = np.array([1.5, 10.0, 10.0, 10.0])
    prob = projection_problem(driver, lower=-1.0, upper=upper)
    assert run_projection(prob) == pytest.approx([1.5, -1.0, 1.0, 0.5], abs=1e-5)
    layout = read_layout(driver)
    assert layout.x_lower == pytest.approx(np.zeros(4))
    assert layout.x_upper == pytest.approx(np.ones(4))


def test_bounds_of_1e30_count_as_none(make_driver):
    prob = projection_problem(make_driver(), lower=-1e30, upper=1e30)
    assert run_projection(prob) == pytest.approx([3.0, -2.0, 1.0, 0.5], abs=1e-5)
    assert np.isinf(read_layout(prob.driver).x_lower).all()


def test_fixed_design_variable(make_driver):
    lower, upper = np.full(4, -10.0), np.full(4, 10.0)
    lower[2] = upper[2] = 0.25
    prob = projection_problem(make_driver(), lower=lower, upper=upper)
    x = run_projection(prob, (0.0, 0.0, 0.25, 0.0))
    assert x == pytest.approx([3.0, -2.0, 0.25, 0.5], abs=1e-5)

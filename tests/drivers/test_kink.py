"""Ends at a kink, where the gradient of no side satisfies the optimality conditions."""

from __future__ import annotations

import numpy as np
import openmdao.api as om
import pytest
from driver_models import PlaneComp, plane_problem

import seal_mdao as sm
from seal_mdao.drivers.layout import read_layout
from seal_mdao.drivers.optimality import Optimality, measure_optimality
from seal_mdao.drivers.optimizer_driver import OptimizerDriver, SolverEnd


class StuckDriver(OptimizerDriver):
    """An optimiser that gives up at its start."""

    def prepare(self, callbacks):
        return lambda x: SolverEnd(x, False, "no step is accepted")


class WallComp(PlaneComp):
    """A component that names the wall it is on, as contact does its states."""

    def contact_states(self):
        return {"the wall": "left" if self.visited[-1][0] < 0.0 else "right"}


def valley(x):
    """max(3 x0, -x0) + (x1 - 1)^2, with its minimum at a kink: (0, 1)."""
    return max(3.0 * x[0], -x[0]) + (x[1] - 1.0) ** 2


def d_valley(x):
    return [3.0 if x[0] >= 0.0 else -1.0, 2.0 * (x[1] - 1.0)]


def stuck(f, df, start):
    driver = StuckDriver()
    prob = plane_problem(driver, start, f, df)
    return prob, prob.run_driver()


def test_a_minimum_at_a_kink_is_a_success():
    prob = plane_problem(sm.UnoDriver(), (2.3, -4.0), valley, d_valley)
    result = prob.run_driver()
    assert result.success, result.exit_status
    assert result.exit_status.startswith("Stationary at a kink, from which no direction improves")
    assert "with the derivatives of 2 sides of a kink" in result.exit_status
    assert prob.get_val("x") == pytest.approx([0.0, 1.0], abs=1e-3)
    # the model is at the result, and its conditions are those of both sides
    assert prob.get_val("f") == pytest.approx(valley(prob.get_val("x")), rel=1e-15)
    found = measure_optimality(prob.driver)
    assert found.satisfied(1e-3, 1e-6)
    assert sorted(found.weights) == pytest.approx([0.25, 0.75], abs=1e-3)
    # elsewhere than at the result nothing is known of a kink
    for away in (1.0, -1.0):
        prob.set_val("x", [away, 1.0])
        prob.run_model()
        assert measure_optimality(prob.driver).stationarity == pytest.approx(1.0)


@pytest.mark.parametrize("away", [0.0, 3e-6, -5e-5])
def test_a_kink_beside_the_best_point_is_found(away):
    prob, result = stuck(valley, d_valley, (away, 1.0))
    assert result.success, result.exit_status
    assert abs(prob.get_val("x")[0]) <= abs(away)


def test_a_kink_along_which_the_objective_falls_is_no_end():
    """The valley's floor falls along x1, 250 times less than its walls rise."""

    def df(x):
        return [50.0 if x[0] >= 0.0 else -50.0, 0.2]

    prob, result = stuck(lambda x: 50.0 * abs(x[0]) + 0.2 * x[1], df, (0.0, 3.0))
    assert not result.success
    assert result.exit_status == "no step is accepted"
    # a step along the floor was found on the way, and is kept
    assert prob.get_val("x")[1] < 3.0
    sides = [(np.array(df([sign, 0.0])), np.empty((0, 2))) for sign in (1.0, -1.0)]
    layout = read_layout(prob.driver)
    found = Optimality.at(layout, np.array([0.0, 3.0]), np.empty(0), *sides[0], sides[1:])
    assert found.descent == pytest.approx([0.0, -0.2])
    assert found.stationarity == pytest.approx(0.2 / 50.0)


@pytest.mark.parametrize("away", [0.0, 1e-5, -1e-5])
def test_a_ridge_is_no_end(away):
    """The gradients of both its sides combine to zero as well, but every step down improves."""
    prob, result = stuck(
        lambda x: -abs(x[0]), lambda x: [-1.0 if x[0] >= 0.0 else 1.0, 0.0], (away, 1.0)
    )
    assert not result.success
    assert abs(prob.get_val("x")[0]) > abs(away)
    assert prob.model.plane.calls == 2  # what the first step brings shows that there is no kink


def test_a_kink_of_a_constraint():
    """min 0.2 x0 + x1 with x1 >= 1.5 |x0|: the constraint alone has the kink."""
    prob = om.Problem(driver=StuckDriver(), reports=None)
    prob.model.add_subsystem("plane", PlaneComp(
        f=lambda x: x[1] - 1.5 * abs(x[0]), df=lambda x: [-1.5 * np.copysign(1.0, x[0]), 1.0],
    ), promotes_inputs=["x"])  # fmt: skip
    aim = om.ExecComp("y = x[1] + 0.2 * x[0]", x=np.zeros(2))
    prob.model.add_subsystem("aim", aim, promotes=["*"])
    prob.model.add_design_var("x", lower=-10, upper=10)
    prob.model.add_objective("y")
    prob.model.add_constraint("plane.f", lower=0.0)
    for start, success in (([0.0, 0.0], True), ([1e-6, 2e-6], True), ([0.5, 0.75], False)):
        prob.setup()
        prob.set_val("x", start)
        result = prob.run_driver()
        assert result.success == success, result.exit_status


def test_states_that_change_are_named():
    driver = sm.UnoDriver()
    prob = om.Problem(driver=driver, reports=None)
    prob.model.add_subsystem("plane", WallComp(f=valley, df=d_valley), promotes=["*"])
    prob.model.add_design_var("x", lower=-10, upper=10)
    prob.model.add_objective("f")
    prob.setup()
    prob.set_val("x", [2.3, -4.0])
    assert prob.run_driver().success
    assert driver.kink.changes in (["the wall: left or right"], ["the wall: right or left"])
    named = f"just begin to touch, stick or slip ({driver.kink.changes[0]})"
    assert named in driver.exit_message


def test_an_equality_has_multipliers_of_one_sign():
    """Constraint gradients (1, 0.5) and (1, -0.5): their mean is along x0, their difference along x1."""
    driver = om.ScipyOptimizeDriver()
    prob = om.Problem(driver=driver, reports=None)
    prob.model.add_subsystem("aim", om.ExecComp("f = x[0]", x=np.zeros(2)), promotes=["*"])
    equality = om.ExecComp("h = x[0]", x=np.zeros(2))
    prob.model.add_subsystem("equality", equality, promotes=["*"])
    prob.model.add_design_var("x", lower=-10, upper=10)
    prob.model.add_objective("f")
    prob.model.add_constraint("h", equals=0.0)
    prob.setup()
    prob.run_model()
    layout, normals = read_layout(driver), (np.array([[1.0, 0.5]]), np.array([[1.0, -0.5]]))

    def conditions(*gradient):
        sides = [(np.array(gradient), normal) for normal in normals]
        return Optimality.at(layout, np.zeros(2), np.zeros(1), *sides[0], sides[1:])

    # g = mu1 J1 + mu2 J2 with mu1 = mu2 = 1/2
    assert conditions(1.0, 0.0).stationarity < 1e-9
    assert conditions(1.0, 0.0).multipliers == pytest.approx(1.0)
    assert conditions(-1.0, 0.0).stationarity < 1e-9
    # g = J1 - J2 would need both signs
    assert conditions(0.0, 1.0).stationarity > 0.1

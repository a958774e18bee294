"""The measure of optimality, and the rule for the best point."""

from __future__ import annotations

import numpy as np
import pytest
from driver_models import constrained_problem, d_quadratic, plane_problem

from seal_mdao.drivers.evaluation import Evaluation
from seal_mdao.drivers.incumbent import Incumbent
from seal_mdao.drivers.layout import read_layout
from seal_mdao.drivers.optimality import kkt_residuals
from seal_mdao.drivers.slsqp_driver import ResilientSLSQPDriver


def _optimality_at(x, **scaling):
    driver = ResilientSLSQPDriver(disp=False)
    prob = plane_problem(driver, x)
    prob.model.set_design_var_options("x", lower=-10, upper=10, **scaling)
    prob.setup()
    prob.set_val("x", np.array(x, dtype=float))
    prob.run_model()
    return driver.optimality()


def test_free_point():
    found = _optimality_at((3.0, 1.0))
    assert found.stationarity == pytest.approx(1.0)
    assert found.infeasibility == 0.0
    assert not found.satisfied(0.5)
    assert _optimality_at((0.0, 1.0)).satisfied(1e-12)
    assert _optimality_at((0.01, 1.0)).stationarity == pytest.approx(0.02)


def test_multiplier_of_a_bound_has_a_sign():
    """At the upper bound of x[0] the objective falls inwards: the bound does not hold it."""
    assert _optimality_at((10.0, 1.0)).stationarity == pytest.approx(1.0)
    assert _optimality_at((-10.0, 1.0)).stationarity == pytest.approx(1.0)


def test_active_constraint():
    driver = ResilientSLSQPDriver(disp=False)
    prob = constrained_problem(driver, (2.0, 1.0), "x[0]", 2.0)
    prob.run_model()
    found = driver.optimality()
    assert found.satisfied(1e-12)
    prob.set_val("x", np.array([1.0, 1.0]))
    prob.run_model()
    assert driver.optimality().infeasibility == pytest.approx(0.5)


def test_residuals_against_known_multipliers():
    prob = constrained_problem(ResilientSLSQPDriver(disp=False), (2.0, 1.0), "x[0]", 2.0)
    prob.run_model()
    layout = read_layout(prob.driver)
    x = np.array([2.0, 3.0])
    gradient, jacobian = np.array(d_quadratic(x)), np.array([[1.0, 0.0]])
    residual, products = kkt_residuals(layout, x, np.array([2.0]), gradient, jacobian)
    assert residual == pytest.approx([0.0, 20.0])
    assert products.tolist() == [0.0]
    residual, products = kkt_residuals(layout, x, np.array([5.0]), gradient, jacobian)
    assert residual == pytest.approx(gradient)
    assert products.size == 0


def test_distance_from_an_active_bound_is_complementarity():
    """An interior-point solution: multiplier 4, distance 1e-3."""
    prob = constrained_problem(ResilientSLSQPDriver(disp=False), (2.001, 1.0), "x[0]", 2.0)
    prob.run_model()
    found = prob.driver.optimality()
    assert found.stationarity < 1e-5
    assert found.complementarity == pytest.approx(1e-3, rel=1e-3)
    assert not found.satisfied(1e-4)


def test_model_is_not_run():
    driver = ResilientSLSQPDriver(disp=False)
    prob = plane_problem(driver, (3.0, 1.0))
    prob.run_model()
    calls = prob.model.plane.calls
    driver.optimality()
    assert prob.model.plane.calls == calls


def test_needs_a_problem():
    with pytest.raises(RuntimeError, match="needs a problem that has been run"):
        ResilientSLSQPDriver().optimality()


def _point(objective, violation):
    return Evaluation(np.zeros(1), objective, np.zeros(0), violation)


def test_incumbent_prefers_feasible_points():
    incumbent = Incumbent(1e-6)
    assert incumbent.offer(_point(5.0, 0.4))
    assert not incumbent.feasible
    assert incumbent.offer(_point(9.0, 0.2))
    assert not incumbent.offer(_point(1.0, 0.3))
    assert incumbent.offer(_point(50.0, 0.0))
    assert incumbent.feasible
    assert not incumbent.offer(_point(-3.0, 0.1))
    assert incumbent.offer(_point(40.0, 1e-7))
    assert incumbent.best.objective == 40.0

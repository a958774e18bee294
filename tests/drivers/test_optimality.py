"""The measure of optimality."""

from __future__ import annotations

import numpy as np
import openmdao.api as om
import pytest
from driver_models import constrained_problem, d_quadratic, plane_problem

from seal_mdao.drivers.layout import read_layout
from seal_mdao.drivers.optimality import Optimality, measure_optimality


def _optimality_at(x, **scaling):
    driver = om.ScipyOptimizeDriver()
    prob = plane_problem(driver, x)
    prob.model.set_design_var_options("x", lower=-10, upper=10, **scaling)
    prob.setup()
    prob.set_val("x", np.array(x, dtype=float))
    prob.run_model()
    return measure_optimality(driver)


def test_free_point():
    found = _optimality_at((3.0, 1.0))
    assert found.stationarity == pytest.approx(1.0)
    assert found.infeasibility == 0.0
    assert not found.satisfied(0.5, 1e-6)
    assert _optimality_at((0.0, 1.0)).satisfied(1e-12, 1e-6)
    assert _optimality_at((0.01, 1.0)).stationarity == pytest.approx(0.02)


def test_multiplier_of_a_bound_has_a_sign():
    """At the upper bound of x[0] the objective falls inwards: the bound does not hold it."""
    assert _optimality_at((10.0, 1.0)).stationarity == pytest.approx(1.0)
    assert _optimality_at((-10.0, 1.0)).stationarity == pytest.approx(1.0)


def test_active_constraint():
    driver = om.ScipyOptimizeDriver()
    prob = constrained_problem(driver, (2.0, 1.0), "x[0]", 2.0)
    prob.run_model()
    found = measure_optimality(driver)
    assert found.satisfied(1e-12, 1e-6)
    prob.set_val("x", np.array([1.0, 1.0]))
    prob.run_model()
    assert measure_optimality(driver).infeasibility == pytest.approx(0.5)


def test_residuals_against_known_multipliers():
    prob = constrained_problem(om.ScipyOptimizeDriver(), (2.0, 1.0), "x[0]", 2.0)
    prob.run_model()
    layout = read_layout(prob.driver)
    x = np.array([2.0, 3.0])
    gradient, jacobian = np.array(d_quadratic(x)), np.array([[1.0, 0.0]])
    found = Optimality.at(layout, x, np.array([2.0]), gradient, jacobian)
    assert found.stationarity == pytest.approx(1.0)  # (0, 20) over 20
    assert found.complementarity == 0.0
    assert found.multipliers == pytest.approx(4.0)
    away = Optimality.at(layout, x, np.array([5.0]), gradient, jacobian)
    assert away.stationarity == pytest.approx(1.0)
    assert away.multipliers == 0.0


def test_distance_from_an_active_bound_is_complementarity():
    """An interior-point solution: multiplier 4, distance 1e-3."""
    prob = constrained_problem(om.ScipyOptimizeDriver(), (2.001, 1.0), "x[0]", 2.0)
    prob.run_model()
    found = measure_optimality(prob.driver)
    assert found.stationarity < 1e-5
    assert found.complementarity == pytest.approx(1e-3, rel=1e-3)
    assert not found.satisfied(1e-4, 1e-6)


def test_model_is_not_run():
    driver = om.ScipyOptimizeDriver()
    prob = plane_problem(driver, (3.0, 1.0))
    prob.run_model()
    calls = prob.model.plane.calls
    measure_optimality(driver)
    assert prob.model.plane.calls == calls

"""What is special to ResilientSLSQPDriver: move limits, settings, the kernel's steps."""

from __future__ import annotations

import numpy as np
import openmdao.api as om
import pytest
from driver_models import (
    d_rosenbrock,
    failing_where,
    plane_problem,
    rosenbrock,
)
from hock_schittkowski import PROBLEMS, build

from seal_mdao.drivers import slsqp_loop
from seal_mdao.drivers.slsqp_driver import ResilientSLSQPDriver
from seal_mdao.drivers.slsqp_kernel import NEEDS_VALUES, SlsqpKernel, SlsqpValues


def _accepted_steps(driver):
    return [row.step for row in driver.history]


def test_is_a_scipy_driver():
    driver = ResilientSLSQPDriver()
    theirs = om.ScipyOptimizeDriver()
    assert isinstance(driver, om.ScipyOptimizeDriver)
    for name in ("tol", "maxiter", "disp", "singular_jac_behavior", "singular_jac_tol"):
        assert driver.options[name] == theirs.options[name]
    with pytest.raises(ValueError, match="'optimizer'"):
        driver.options["optimizer"] = "COBYLA"


def test_same_points_as_scipy():
    visited = []
    for kind in (ResilientSLSQPDriver, om.ScipyOptimizeDriver):
        prob = plane_problem(kind(disp=False), (-1.2, 1), rosenbrock, d_rosenbrock)
        prob.run_driver()
        visited.append(np.array(prob.model.plane.visited))
    ours, scipys = visited
    assert ours == pytest.approx(scipys[1:], abs=1e-14)
    assert scipys[0].tolist() == scipys[1].tolist()


def test_scipys_driver_does_not_survive():
    """The reason for this driver, to be removed when ScipyOptimizeDriver learns it."""
    prob = plane_problem(
        om.ScipyOptimizeDriver(disp=False), (5, 5), hook=failing_where(lambda x: 1 < x[0] < 3)
    )
    with pytest.raises(om.AnalysisError):
        prob.run_driver()


@pytest.mark.parametrize("limit", [0.05, 0.3, 2.0])
def test_move_limit_holds(limit):
    driver = ResilientSLSQPDriver(disp=False, move_limit=limit, maxiter=500)
    prob = plane_problem(driver, (-1.2, 1), rosenbrock, d_rosenbrock)
    result = prob.run_driver()
    visited = np.array(prob.model.plane.visited)
    assert result.success, result.exit_status
    assert prob.get_val("x") == pytest.approx([1.0, 1.0], abs=0.02)
    assert max(_accepted_steps(driver)) <= limit * (1 + 1e-9)
    assert np.abs(visited[1] - visited[0]).max() <= limit * (1 + 1e-9)
    if limit < 1:
        assert max(_accepted_steps(driver)) >= 0.5 * limit


def test_move_limit_is_in_driver_scaling():
    driver = ResilientSLSQPDriver(disp=False, move_limit=0.5)
    prob = plane_problem(driver, (5, 5))
    prob.model.set_design_var_options("x", lower=-10, upper=10, ref=10.0)
    prob.setup()
    prob.set_val("x", np.array([9.0, 9.0]))
    prob.run_driver()
    steps = np.abs(np.diff(prob.model.plane.visited, axis=0)).max(axis=1)
    assert max(_accepted_steps(driver)) <= 0.5
    assert 0.5 < steps.max() <= 5.0 * (1 + 1e-9)


def test_move_limit_with_a_huge_gradient():
    """The kernel alone cannot solve a subproblem whose solution is far outside the box."""

    def f(x):
        return 1e9 * ((x[0] - 0.5) ** 2 + (x[1] - 1) ** 2)

    def df(x):
        return [2e9 * (x[0] - 0.5), 2e9 * (x[1] - 1)]

    driver = ResilientSLSQPDriver(disp=False, move_limit=0.4)
    prob = plane_problem(driver, (5, 5), f=f, df=df)
    result = prob.run_driver()
    assert result.success, result.exit_status
    assert prob.get_val("x") == pytest.approx([0.5, 1.0], abs=1e-4)
    assert max(_accepted_steps(driver)) <= 0.4 * (1 + 1e-9)


def test_small_steps_in_a_small_box_are_not_convergence():
    """Each step changes the objective by half the tolerance, but there are twenty to go.

    The end comes when a step to the bound itself would gain less than the tolerance.
    """
    driver = ResilientSLSQPDriver(disp=False, tol=1e-6, move_limit=5e-5)

    def f(x):
        return 0.005 * x[0] ** 2 + (x[1] - 1) ** 2

    prob = plane_problem(driver, (1, 1), f=f, df=lambda x: [0.01 * x[0], 2 * (x[1] - 1)])
    prob.model.set_design_var_options("x", lower=0.999, upper=2.0)
    prob.setup()
    prob.set_val("x", np.ones(2))
    result = prob.run_driver()
    assert result.success
    assert result.iter_count >= 17
    assert prob.get_val("x") == pytest.approx([0.999, 1.0], abs=1.01e-4)


def test_steps_grow_again_after_failures():
    def hook(x, call):
        if 2 <= call <= 7:
            raise om.AnalysisError("for a while")

    driver = ResilientSLSQPDriver(disp=False)
    prob = plane_problem(driver, (-1.2, 1), rosenbrock, d_rosenbrock, hook=hook)
    result = prob.run_driver()
    assert result.success, result.exit_status
    assert driver.failed_analyses == 6
    assert driver.history[0].failed == 6
    assert driver.history[-1].radius > 1000 * driver.history[0].radius


@pytest.mark.parametrize("number", PROBLEMS)
def test_move_limit_and_required_optimality(number):
    driver = ResilientSLSQPDriver(
        disp=False,
        move_limit=0.3,
        require_optimality=True,
        maxiter=500,
        singular_jac_behavior="ignore",
        invalid_desvar_behavior="ignore",
    )
    prob = build(number, driver)
    result = prob.run_driver()
    optimum = PROBLEMS[number].optimum
    assert result.success, result.exit_status
    assert prob.get_val("f")[0] == pytest.approx(optimum, rel=2e-6, abs=1e-6)
    assert driver.optimality().satisfied(1e-6)
    assert max(_accepted_steps(driver), default=0.0) <= 0.3 * (1 + 1e-9)


def test_required_optimality_goes_on_where_scipy_stops():
    stationarity = {}
    for required in (False, True):
        driver = ResilientSLSQPDriver(disp=False, tol=1e-3, require_optimality=required)
        prob = plane_problem(driver, (-1.2, 1), rosenbrock, d_rosenbrock)
        assert prob.run_driver().success
        stationarity[required] = driver.optimality().stationarity
    assert stationarity[True] < 1e-6
    assert stationarity[False] > 1e-4


@pytest.mark.parametrize("limit", [0.0, -1.0])
def test_move_limit_must_be_positive(limit):
    with pytest.raises(ValueError, match="move_limit"):
        plane_problem(ResilientSLSQPDriver(move_limit=limit), (5, 5)).run_driver()


def test_opt_settings_win_over_options():
    driver = ResilientSLSQPDriver(disp=False, tol=1e-12, maxiter=100)
    driver.opt_settings.update(maxiter=2, ftol=1e-3)
    result = plane_problem(driver, (-1.2, 1), rosenbrock, d_rosenbrock).run_driver()
    assert result.iter_count == 2
    assert result.exit_status == "Iteration limit reached"
    assert not result.success


def test_unknown_opt_settings():
    driver = ResilientSLSQPDriver(disp=False)
    driver.opt_settings["trust"] = 3
    with pytest.raises(ValueError, match=r"unknown \['trust'\]; SLSQP takes"):
        plane_problem(driver, (5, 5)).run_driver()


def test_scipy_result_and_output(capsys):
    driver = ResilientSLSQPDriver()
    prob = plane_problem(driver, (-1.2, 1), rosenbrock, d_rosenbrock)
    prob.run_driver()
    found = driver._scipy_optimize_result
    assert found.success
    assert found.x == pytest.approx(prob.get_val("x"))
    assert found.fun == pytest.approx(prob.get_val("f")[0])
    assert found.nfev == prob.model.plane.calls
    assert found.njev == prob.model.plane.partials_calls
    printed = capsys.readouterr().out
    assert "Optimization terminated successfully    (Exit mode 0)" in printed
    assert f"Function evaluations: {found.nfev}" in printed
    assert "Optimization Complete" in printed


def _start_kernel(gradient):
    kernel = SlsqpKernel(2, 0, 1, 50)
    values = SlsqpValues(
        x=np.zeros(2),
        f=1.0,
        d=np.array([1.0]),
        g=np.array(gradient),
        C=np.array([[1.0, 0.0]]),
    )
    return kernel, values


def test_kernel_takes_a_step_back():
    kernel, values = _start_kernel([3.0, -4.0])
    bounds = np.full(2, -np.inf), np.full(2, np.inf)
    before = kernel.snapshot()
    assert kernel.call(values, *bounds, 1e-6) == NEEDS_VALUES
    first = kernel.x.copy()
    kernel.restore(before)
    assert kernel.x.tolist() == [0.0, 0.0]
    assert kernel.call(values, *bounds, 1e-6) == NEEDS_VALUES
    assert kernel.x.tolist() == first.tolist()
    assert first == pytest.approx([-1.0, 4.0])


def test_kernel_respects_the_box():
    kernel, values = _start_kernel([3.0, -4.0])
    kernel.call(values, np.full(2, -0.5), np.full(2, 0.5), 0.0)
    assert kernel.x == pytest.approx([-0.5, 0.5])


def test_kernel_contracts_by_halves():
    kernel, values = _start_kernel([3e7, -4e7])
    bounds = np.full(2, -np.inf), np.full(2, np.inf)
    kernel.call(values, *bounds, 1e-6)
    full = kernel.x.copy()
    assert kernel.contract(values, *bounds, 0.5) == NEEDS_VALUES
    assert 0.25 < np.abs(kernel.x).max() <= 0.5
    halvings = np.log2(full[1] / kernel.x[1])
    assert halvings == pytest.approx(round(halvings), abs=1e-9)
    assert kernel.x[0] / kernel.x[1] == pytest.approx(full[0] / full[1])


def test_kernel_goes_on_from_another_trial_point():
    """Where nothing is gained the line search halves the step: from the point that was put in."""
    kernel, values = _start_kernel([3.0, -4.0])
    bounds = np.full(2, -np.inf), np.full(2, np.inf)
    kernel.call(values, *bounds, 1e-6)
    kernel.move(np.array([-2.0, 3.0]))
    assert kernel.x.tolist() == [-2.0, 3.0]
    assert kernel.call(values, *bounds, 1e-6) == NEEDS_VALUES
    assert kernel.x == pytest.approx([-1.0, 1.5])


def _scattered(x):
    """Return whether x is one of the failing designs: half of all, in stripes of 1e-4."""
    return np.sin(3e4 * x[0] + 2e4 * x[1]) > 0.0 and not np.array_equal(x, [-1.2, 1.0])


def _solve_among_scattered_failures():
    driver = ResilientSLSQPDriver(
        disp=False, require_optimality=True, optimality_tol=1e-2, move_limit=0.5
    )
    hook = failing_where(_scattered)
    prob = plane_problem(driver, (-1.2, 1), rosenbrock, d_rosenbrock, hook=hook)
    return prob, prob.run_driver()


def test_scattered_failures():
    prob, result = _solve_among_scattered_failures()
    assert result.success, result.exit_status
    assert prob.get_val("x") == pytest.approx([1.0, 1.0], abs=0.03)
    assert prob.driver.failed_analyses > 10
    assert result.model_evals < 200


def test_scattered_failures_want_neighbours(monkeypatch):
    _, with_neighbours = _solve_among_scattered_failures()
    monkeypatch.setattr(slsqp_loop, "NEIGHBOURS", (0,))
    _, without = _solve_among_scattered_failures()
    assert not without.success or without.iter_count > with_neighbours.iter_count


def test_runs_are_repeatable():
    first, second = (_solve_among_scattered_failures()[0].model.plane.visited for _ in range(2))
    np.testing.assert_array_equal(first, second)


def _ridged(x):
    """Return a function with kinks x0 - x1**2 = k pi / 2 and its minimum 0 at (0, 0)."""
    return (x[0] ** 2 + x[1] ** 2) * (1 + abs(np.sin(2 * (x[0] - x[1] ** 2))))


def _d_ridged(x):
    square, phase = x[0] ** 2 + x[1] ** 2, 2 * (x[0] - x[1] ** 2)
    factor = 1 + abs(np.sin(phase))
    slope = 2 * square * np.sign(np.sin(phase)) * np.cos(phase)
    return [2 * x[0] * factor + slope, 2 * x[1] * (factor - slope)]


@pytest.mark.parametrize("start", [(2.0, 1.7), (1.0, 2.5)])
def test_begins_again_where_steps_creep_along_a_kink(monkeypatch, start):
    """SLSQP alone crawls along a kink of this start with steps that come to nothing."""
    successes = []
    for ways_out in (slsqp_loop.MAX_WAYS_OUT, 0):
        monkeypatch.setattr(slsqp_loop, "MAX_WAYS_OUT", ways_out)
        driver = ResilientSLSQPDriver(
            disp=False, require_optimality=True, optimality_tol=1e-2, move_limit=0.5, maxiter=60
        )
        prob = plane_problem(driver, start, _ridged, _d_ridged)
        successes.append(prob.run_driver().success)
    assert successes == [True, False]

"""What is special to IpoptDriver: ipyopt, Ipopt's options and return codes."""

from __future__ import annotations

import sys

import numpy as np
import openmdao.api as om
import pytest
from driver_models import d_rosenbrock, failing_where, plane_problem, rosenbrock

import seal_mdao as sm


def _run(start=(-1.2, 1), f=rosenbrock, df=d_rosenbrock, **settings):
    driver = sm.IpoptDriver()
    driver.opt_settings.update(settings)
    prob = plane_problem(driver, start, f, df)
    return prob, prob.run_driver()


def test_missing_ipyopt_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "ipyopt", None)
    with pytest.raises(ImportError) as caught:
        sm.IpoptDriver()
    assert 'pip install "seal_mdao[ipopt]"' in str(caught.value)
    assert "\n" not in str(caught.value)


def test_settings_win_over_options():
    _, result = _run(max_iter=3)
    assert result.iter_count == 3
    assert result.exit_status.startswith(
        "Maximum number of iterations exceeded (Ipopt code -1); the best feasible"
    )


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("max_iter", np.int64(50)),
        ("tol", 1),
        ("tol", np.float32(0.5)),
        ("check_derivatives_for_naninf", True),
        ("mu_strategy", "adaptive"),
    ],
)
def test_values_are_converted(name, value):
    assert _run(**{name: value})[1].success


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("max_itr", 3),
        ("tol", -1.0),
        ("mu_strategy", "fast"),
        ("max_iter", 2.5),
        ("tol", "small"),
        ("tol", None),
    ],
)
def test_refused_settings_are_named_before_the_model_runs(name, value):
    driver = sm.IpoptDriver()
    driver.opt_settings[name] = value
    prob = plane_problem(driver, (-1.2, 1))
    with pytest.raises(ValueError, match=rf"opt_settings\['{name}'\] = .* is not accepted"):
        prob.run_driver()
    assert prob.model.plane.calls == 0


def test_ipopts_own_output(capfd):
    _run(print_level=5)
    assert "Number of Iterations" in capfd.readouterr().out


def test_solver_that_is_not_there():
    _, result = _run(linear_solver="ma57")
    assert not result.success
    assert "Invalid option" in result.exit_status


def test_acceptable_level_is_success():
    _, result = _run(acceptable_tol=1e-2, acceptable_iter=1, tol=1e-12)
    assert result.success
    assert result.exit_status == "Solved to acceptable level"


def test_unbounded_problem():
    driver = sm.IpoptDriver()
    prob = plane_problem(driver, (1, 1), lambda x: -(x[0] ** 3), lambda x: [-3 * x[0] ** 2, 0])
    prob.model.set_design_var_options("x", lower=-1e30, upper=1e30)
    prob.setup()
    prob.set_val("x", np.ones(2))
    assert not prob.run_driver().success


def test_too_many_equalities():
    prob = om.Problem(driver=sm.IpoptDriver(), reports=None)
    for name, formula in (("c", "f = x**2"), ("d", "g = 2 * x"), ("e", "h = x**3")):
        prob.model.add_subsystem(name, om.ExecComp(formula), promotes=["*"])
    prob.model.add_design_var("x", lower=-5.0, upper=5.0)
    prob.model.add_objective("f")
    prob.model.add_constraint("g", equals=1.0)
    prob.model.add_constraint("h", equals=1.0)
    prob.setup()
    result = prob.run_driver()
    assert not result.success
    assert "Too few degrees of freedom" in result.exit_status


def test_failure_at_the_point_ipopt_starts_from():
    """Ipopt moves a start that lies on a bound into the interior."""
    hook = failing_where(lambda x: -9.999 < x[0] < -9)
    prob = plane_problem(sm.IpoptDriver(), (-10, 1), hook=hook)
    result = prob.run_driver()
    assert not result.success
    assert "not a number" in result.exit_status
    assert "the analysis does not converge here" in result.exit_status
    assert prob.get_val("x").tolist() == [-10.0, 1.0]


@pytest.mark.parametrize("tol", [2e-2, 1e-4])
def test_stalled_run_is_a_success_only_at_an_optimum(tol):
    """Around the optimum everything fails; Ipopt itself is asked for more than can be had."""
    driver = sm.IpoptDriver(tol=tol)
    driver.opt_settings["dual_inf_tol"] = 1e-12
    hook = failing_where(lambda x: np.hypot(x[0], x[1] - 1) < 1e-3)
    result = plane_problem(driver, (5, 5), hook=hook).run_driver()
    assert driver.failed_analyses > 0
    assert result.success == (tol > 1e-2)
    assert ("optimality conditions hold" in result.exit_status) == (tol > 1e-2)

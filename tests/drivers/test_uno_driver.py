"""What is special to UnoDriver: unopy, Uno's options and statuses."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from driver_models import (
    constrained_problem,
    d_rosenbrock,
    failing_where,
    plane_problem,
    rosenbrock,
)

import seal_mdao as sm
from seal_mdao.drivers.uno_driver import CHOICES


def _run(start=(-1.2, 1), f=rosenbrock, df=d_rosenbrock, options=None, **settings):
    driver = sm.UnoDriver(**(options or {}))
    driver.opt_settings.update(settings)
    prob = plane_problem(driver, start, f, df)
    return prob, prob.run_driver()


def test_missing_unopy_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "unopy", None)
    with pytest.raises(ImportError) as caught:
        sm.UnoDriver()
    assert "pip install unopy" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_settings_win_over_options():
    _, result = _run(max_iterations=3)
    assert result.iter_count == 3
    assert result.exit_status.startswith("Maximum number of iterations exceeded; the best feasible")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("max_iterations", np.int64(90)),
        ("TR_radius", 1),
        ("TR_radius", np.float32(0.5)),
        ("print_solution", False),
        ("hessian_model", "LSR1"),
        ("preset", "funnelsqp"),
        ("residual_norm", "INF"),
    ],
)
def test_values_are_converted(name, value):
    assert _run(**{name: value})[1].success


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("max_itr", 3),
        ("max_iterations", 2.5),
        ("TR_radius", "small"),
        *((name, "wrong") for name in CHOICES),
    ],
)
def test_refused_settings_are_named_before_the_model_runs(name, value):
    driver = sm.UnoDriver()
    driver.opt_settings[name] = value
    prob = plane_problem(driver, (-1.2, 1))
    with pytest.raises(ValueError, match=rf"opt_settings\['{name}'\]"):
        prob.run_driver()
    assert prob.model.plane.calls == 0


def test_unos_own_output(capfd):
    _run(logger="INFO")
    assert "Number of subproblems solved" in capfd.readouterr().out


def test_unbounded_problem():
    driver = sm.UnoDriver()
    prob = plane_problem(driver, (1, 1), lambda x: -(x[0] ** 3), lambda x: [-3 * x[0] ** 2, 0])
    prob.model.set_design_var_options("x", lower=-1e30, upper=1e30)
    prob.setup()
    prob.set_val("x", np.ones(2))
    assert not prob.run_driver().success


def test_first_step_is_the_trust_radius():
    prob, _ = _run(options={"trust_radius": 0.25})
    start, first = prob.model.plane.visited[:2]
    assert np.abs(first - start).max() == pytest.approx(0.25)


def test_restoration_of_feasibility():
    """Linearised at the start, the constraint cannot be met inside the trust region."""
    driver = sm.UnoDriver(trust_radius=0.1, disp=True)
    prob = constrained_problem(driver, (0.1, 0.1), "x[0] * x[1]", 9.0)
    assert prob.run_driver().success
    assert prob.get_val("g") == pytest.approx([9.0], rel=1e-6)


def test_begins_once_more_beyond_a_slab():
    """The trust region shrinks in front of the slab; a larger one leads across."""
    driver = sm.UnoDriver()
    prob = plane_problem(driver, (5, 5), hook=failing_where(lambda x: 1 < x[0] < 3))
    result = prob.run_driver()
    assert result.success
    assert driver.failed_analyses >= driver.options["max_failures"]
    assert result.iter_count <= driver.options["maxiter"]

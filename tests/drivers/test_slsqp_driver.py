"""SlsqpDriver: OpenMDAO's SLSQP, step by step, and failed analyses on the way."""

from __future__ import annotations

import numpy as np
import openmdao.api as om
import pytest
from driver_models import (
    constrained_problem,
    d_rosenbrock,
    failing_where,
    plane_problem,
    rosenbrock,
)
from hock_schittkowski import build
from test_failed_analyses import REGIONS, region_problem

import seal_mdao as sm
from seal_mdao.drivers.slsqp_driver import FAILED_OBJECTIVE


@pytest.mark.parametrize("number", [1, 6, 35, 71])
def test_takes_the_steps_of_openmdaos_driver(number):
    found = []
    for kind in (sm.SlsqpDriver, om.ScipyOptimizeDriver):
        prob = build(number, kind(tol=1e-9, disp=False))
        result = prob.run_driver()
        found.append((prob.get_val("x").tolist(), result.model_evals, result.deriv_evals))
    assert found[0] == found[1]


@pytest.mark.parametrize("region", REGIONS)
def test_values_fail_in_a_region(region):
    condition, driver = REGIONS[region][2], sm.SlsqpDriver(tol=1e-10)
    prob, solution = region_problem(driver, region, hook=failing_where(condition))
    assert prob.run_driver().success
    assert prob.get_val("x") == pytest.approx(np.array(solution, dtype=float), abs=0.03)
    assert not condition(prob.get_val("x"))


def test_failed_analysis_shortens_the_step_and_is_recorded_as_failed():
    driver = sm.SlsqpDriver(tol=1e-10)
    prob = plane_problem(driver, (5, 5), hook=failing_where(lambda x: 1 < x[0] < 3))
    driver.add_recorder(om.SqliteRecorder("./cases.sql"))
    result = prob.run_driver()
    prob.cleanup()
    reader = om.CaseReader("cases.sql")
    cases = [reader.get_case(name) for name in reader.list_cases("driver", out_stream=None)]
    assert result.success
    assert len(cases) == prob.model.plane.calls == result.model_evals
    failed = [case for case in cases if not case.success]
    assert len(failed) == driver.failed_analyses > 0
    for case in failed:
        assert 1 < case.get_design_vars()["x"][0] < 3
        assert "the analysis does not converge here" in case.msg


def test_outputs_that_are_nan_after_a_failure_do_not_reach_the_optimiser():
    """As the outputs of a seal are."""
    values = []

    class Observed(sm.SlsqpDriver):
        def _objfunc(self, x_new):
            value = super()._objfunc(x_new)
            values.append(np.ravel(value).item())
            return value

    def fail(x, call):
        if 1 < x[0] < 3:
            prob.model.plane._outputs.set_val(np.nan)
            raise om.AnalysisError("the analysis does not converge here")

    prob = plane_problem(Observed(tol=1e-10), (5, 5), hook=fail)
    assert prob.run_driver().success
    assert np.isfinite(values).all()
    assert values.count(FAILED_OBJECTIVE) == prob.driver.failed_analyses > 0


def test_state_after_the_run_is_that_of_a_good_analysis():
    """The optimum lies where nothing can be analysed."""
    prob = plane_problem(sm.SlsqpDriver(), (5, 5), hook=failing_where(lambda x: x[0] < 0.3))
    prob.run_driver()
    assert prob.get_val("x")[0] >= 0.3
    assert prob.get_val("f")[0] == prob.model.plane.options["f"](prob.get_val("x"))


def test_failure_at_the_start_is_raised():
    prob = plane_problem(sm.SlsqpDriver(), (5, 5), hook=failing_where(lambda x: x[0] > 4))
    with pytest.raises(om.AnalysisError, match="does not converge here"):
        prob.run_driver()
    prob.set_val("x", np.array([3.0, 3.0]))
    assert prob.run_driver().success  # nothing of the first run is left


def test_a_failed_run_names_the_violated_constraints(capsys):
    driver = sm.SlsqpDriver(disp=False)
    prob = om.Problem(driver=driver, reports=None)
    prob.model.add_subsystem(
        "c", om.ExecComp(["f = x**2", "low = x", "high = x + 1"]), promotes=["*"]
    )
    prob.model.add_design_var("x", lower=-10, upper=10)
    prob.model.add_objective("f")
    prob.model.add_constraint("low", upper=1.0)
    prob.model.add_constraint("high", lower=5.0)
    prob.setup()
    result = prob.run_driver()
    assert not result.success
    # the model is at x = 1 to 4: (5 - 1 - x) / 5 or x - 1
    x = prob.get_val("x").item()
    parts = [("low", x - 1.0), ("high", (4.0 - x) / 5.0)]
    named = ", ".join(f"{name} by {size:.2g}" for name, size in parts if size > 1e-6)
    assert result.exit_status.endswith(f"; violated constraints, in driver scaling: {named}")
    assert result.exit_status in capsys.readouterr().out
    # a run that succeeds has OpenMDAO's status
    prob.model.set_constraint_options("high", lower=0.0)
    prob.setup()
    result = prob.run_driver()
    assert result.success
    assert result.exit_status == "SUCCESS"


def test_line_per_analysis_on_request(capsys):
    driver = sm.SlsqpDriver(disp=True)
    prob = constrained_problem(driver, (6, 6), "x[0] + x[1]**2", 20.0)
    result = prob.run_driver()
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("analysis")]
    assert len(lines) == result.model_evals
    prob = plane_problem(sm.SlsqpDriver(), (-1.2, 1), rosenbrock, d_rosenbrock)
    prob.run_driver()
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("scaled", ["x", "y"])
def test_negative_scaler_is_an_error(scaled):
    """OpenMDAO would keep y above its upper bound, which the start satisfies, and report a success."""
    prob = om.Problem(driver=sm.SlsqpDriver(disp=False), reports=None)
    prob.model.add_subsystem("f", om.ExecComp(["f = (x - 3)**2", "y = x"]), promotes=["*"])
    prob.model.add_design_var("x", lower=-10.0, upper=10.0, ref=-1.0 if scaled == "x" else 1.0)
    prob.model.add_constraint("y", upper=1.0, ref=-1.0 if scaled == "y" else 1.0)
    prob.model.add_objective("f")
    prob.setup()
    with pytest.raises(ValueError, match=f"negative scaler of '.*{scaled}'.*UnoDriver"):
        prob.run_driver()

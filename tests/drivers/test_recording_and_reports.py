"""Case recording, DriverResult, the iteration table and OpenMDAO's reports."""

from __future__ import annotations

import openmdao.api as om
import pytest
from driver_models import (
    constrained_problem,
    d_rosenbrock,
    failing_where,
    plane_problem,
    projection_problem,
    rosenbrock,
)
from test_failed_analyses import REGIONS, region_problem

BEYOND = REGIONS["beyond the optimum"][2]
"""Where the analyses of these tests fail."""


def _record(prob, name="cases.sql"):
    prob.driver.add_recorder(om.SqliteRecorder(name))
    prob.driver.recording_options["record_derivatives"] = True
    result = prob.run_driver()
    prob.cleanup()
    reader = om.CaseReader(prob.get_outputs_dir() / name)
    names = reader.list_cases("driver", recurse=False, out_stream=None)
    return result, [reader.get_case(case) for case in names]


def test_every_analysis_is_recorded(make_driver):
    prob = plane_problem(make_driver(), (-1.2, 1), rosenbrock, d_rosenbrock)
    result, cases = _record(prob)
    assert len(cases) == result.model_evals == prob.model.plane.calls
    assert cases[0].get_design_vars()["x"].tolist() == [-1.2, 1.0]
    assert cases[0].get_objectives()["f"][0] == pytest.approx(rosenbrock([-1.2, 1.0]))
    assert all(case.success == 1 for case in cases)
    best = min(cases, key=lambda case: case.get_objectives()["f"][0])
    assert best.get_design_vars()["x"] == pytest.approx([1.0, 1.0], abs=1e-3)


def test_constraints_and_derivatives_are_recorded(make_driver):
    prob = constrained_problem(make_driver(), (6, 6), "x[0] + x[1]**2", 20.0)
    result, cases = _record(prob)
    assert result.success
    assert cases[-1].get_constraints()["g"] == pytest.approx([20.0], abs=1e-4)
    derivatives = [case.derivatives for case in cases if case.derivatives is not None]
    assert derivatives
    assert derivatives[0]["g", "x"].ravel() == pytest.approx([1.0, 12.0])


def test_failed_points_are_recorded_as_failed(make_driver):
    prob, _ = region_problem(make_driver(), "beyond the optimum", hook=failing_where(BEYOND))
    result, cases = _record(prob)
    failed = [case for case in cases if not case.success]
    assert result.success
    assert len(failed) == prob.driver.failed_analyses > 0
    assert len(cases) == result.model_evals
    for case in failed:
        assert BEYOND(case.get_design_vars()["x"])
        assert "the analysis does not converge here" in case.msg
    for case in cases:
        assert case.success or BEYOND(case.get_design_vars()["x"])


def test_last_recorded_case_restarts(make_driver):
    prob = plane_problem(make_driver(maxiter=8), (-1.2, 1), rosenbrock, d_rosenbrock)
    result, cases = _record(prob)
    assert not result.success
    again = plane_problem(make_driver(), (0, 0), rosenbrock, d_rosenbrock)
    again.load_case(min(cases, key=lambda case: case.get_objectives()["f"][0]))
    assert again.get_val("f")[0] < rosenbrock([-1.2, 1.0])
    result = again.run_driver()
    assert result.success
    assert again.get_val("x") == pytest.approx([1.0, 1.0], abs=1e-3)


def test_driver_result(make_driver):
    prob = plane_problem(make_driver(), (-1.2, 1), rosenbrock, d_rosenbrock)
    result = prob.run_driver()
    comp = prob.model.plane
    assert result is prob.driver.result
    assert result.success
    assert result.model_evals == comp.calls
    assert result.deriv_evals == comp.partials_calls
    assert 5 < result.iter_count <= result.model_evals
    assert result.runtime > result.model_time > 0.0
    assert result.deriv_time > 0.0
    assert result.exit_status in (
        "Optimal solution found",
        "Optimization terminated successfully",
    )


def test_failed_analyses_count_as_evaluations(make_driver):
    prob, _ = region_problem(make_driver(), "beyond the optimum", hook=failing_where(BEYOND))
    result = prob.run_driver()
    assert prob.driver.failed_analyses > 0
    assert result.model_evals == prob.model.plane.calls


def test_quiet_by_request(make_driver, capfd):
    prob = plane_problem(make_driver(disp=False), (-1.2, 1), rosenbrock, d_rosenbrock)
    prob.run_driver()
    assert capfd.readouterr().out == ""


def test_debug_print(make_driver, capsys):
    driver = make_driver(debug_print=["desvars", "objs", "nl_cons", "ln_cons", "totals"])
    prob = projection_problem(driver)
    prob.model.add_constraint("s", indices=[0], upper=4.0)
    prob.setup()
    driver.options["singular_jac_behavior"] = "ignore"
    prob.run_driver()
    printed = capsys.readouterr().out
    for heading in ("Design Vars", "Objectives", "Nonlinear constraints", "Driver total deriv"):
        assert heading in printed


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_reports(make_driver, monkeypatch):
    monkeypatch.delenv("TESTFLO_RUNNING", raising=False)
    monkeypatch.setenv("OPENMDAO_REPORTS", "1")
    driver = make_driver()
    prob = om.Problem(driver=driver, reports=["optimizer", "scaling"])
    model = prob.model
    model.add_subsystem("c", om.ExecComp(["f = (x - 3)**2 + y**2"]), promotes=["*"])
    model.add_subsystem("d", om.ExecComp("g = x * y"), promotes=["*"])
    model.add_subsystem("e", om.ExecComp("h = x + y"), promotes=["*"])
    model.add_design_var("x", lower=0.0, upper=5.0, ref=5.0)
    model.add_design_var("y", lower=0.0, upper=5.0)
    model.add_objective("f")
    model.add_constraint("g", lower=1.0)
    model.add_constraint("h", upper=4.5, linear=True)
    prob.setup()
    prob.set_val("x", 1.0)
    prob.set_val("y", 2.0)
    result = prob.run_driver()
    assert result.success
    reports = prob.get_reports_dir()
    optimizer = (reports / "opt_report.html").read_text(encoding="utf-8")
    assert result.exit_status in optimizer
    assert driver._get_name() in optimizer
    assert (reports / "driver_scaling_report.html").stat().st_size > 1000


def test_line_per_iteration_on_request(make_driver, capsys):
    prob = constrained_problem(make_driver(disp=True), (6, 6), "x[0] + x[1]**2", 20.0)
    result = prob.run_driver()
    head, *lines, _, _, _ = capsys.readouterr().out.splitlines()
    assert head.split() == ["iteration", "analyses", "objective", "infeasibility", "optimality"]
    table = [[float(cell) for cell in line.split()] for line in lines]
    assert [row[0] for row in table] == list(range(1, result.iter_count + 1))
    assert table[-1][1] == result.model_evals
    assert table[-1][2] == pytest.approx(prob.get_val("f")[0], rel=1e-5)
    assert max(table[-1][3:]) < 1e-6


@pytest.mark.parametrize("terminal", [True, False])
def test_lines_by_themselves_on_a_terminal_only(make_driver, capsys, monkeypatch, terminal):
    prob = plane_problem(make_driver(), (-1.2, 1), rosenbrock, d_rosenbrock)
    monkeypatch.setattr("sys.stdout.isatty", lambda: terminal)
    prob.run_driver()
    assert ("Optimal solution found" in capsys.readouterr().out) == terminal

"""The report as a part of OpenMDAO: after run_driver, and from the command line."""

import argparse
import subprocess
import sys
from pathlib import Path

import openmdao.api as om
import pytest
from penalty_warnings import further_warnings

import seal_mdao as sm
from seal_mdao.report import openmdao_command

OPENMDAO = Path(sys.executable).with_name("openmdao")


def openmdao(*arguments):
    return subprocess.run(
        [OPENMDAO, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300
    )


@pytest.fixture
def reports_on(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TESTFLO_RUNNING", raising=False)
    monkeypatch.setenv("OPENMDAO_REPORTS", "1")


def seal_problem_of_a_user(recorder):
    """A seal that is not promoted, one of whose inputs is set by hand and not recorded."""
    seal = sm.door_seal(n_steps=21)
    problem = om.Problem(driver=om.ScipyOptimizeDriver(maxiter=1, disp=False), reports=["seal"])
    problem.model.add_subsystem("rubber", sm.SealGroup(seal=seal, parameters=("friction",)))
    problem.model.add_design_var("rubber.boundary_offsets", lower=-0.5, upper=0.5)
    problem.model.add_design_var("rubber.friction", lower=0.2, upper=0.3)
    problem.model.add_objective("rubber.gap_square_sum", ref=0.1)
    problem.model.add_constraint("rubber.area", upper=110.0, ref=110.0)
    if recorder:
        problem.driver.add_recorder(sm.RestartRecorder("cases.sql"))
    problem.setup()
    problem.set_val("rubber.door_radius", 4.2)
    return problem


def test_report_after_run_driver(reports_on, capsys):
    problem = seal_problem_of_a_user(recorder=True)
    problem.run_driver()
    text = (problem.get_reports_dir() / "seal_report.html").read_text(encoding="utf-8")
    assert "Not converged" in text
    # the pictures are those of the run, with the radius and the friction that it had
    assert not further_warnings(text)
    assert '<th scope="row">corner radius of the door</th><td>4.2</td>' in text
    problem.cleanup()


def test_report_needs_a_recorder(reports_on):
    problem = seal_problem_of_a_user(recorder=False)
    with pytest.warns(
        om.DriverWarning, match="the OpenMDAO report 'seal' needs an SQLite recorder"
    ):
        problem.run_driver()
    assert not list(Path().rglob("seal_report.html"))


def test_driver_that_does_not_optimise_has_no_report(reports_on):
    problem = om.Problem(reports=["seal"])
    problem.model.add_subsystem("c", om.ExecComp("y = x"), promotes=["*"])
    problem.setup()
    problem.run_driver()
    assert not list(Path().rglob("seal_report.html"))


@pytest.fixture
def called():
    """The command as ``openmdao`` calls it, in this process."""
    add_arguments, execute, _ = openmdao_command.setup()
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    return lambda *arguments: execute(parser.parse_args([*map(str, arguments)]), [])


def test_openmdao_lists_the_report():
    assert "seal" in openmdao("list_reports").stdout


def test_command_line(other_page, tmp_path):
    out = tmp_path / "shown.html"
    done = openmdao("seal_report", other_page.cases / "cases.sql", "-o", out, "--no-display")
    assert done.returncode == 0
    assert done.stdout.split() == [str(out)]
    assert "Optimisation of f" in out.read_text(encoding="utf-8")


def test_wrong_file_is_named_in_one_line(called, tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        called(tmp_path / "nowhere.sql", "--no-display")
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line == f"openmdao seal_report: {tmp_path / 'nowhere.sql'} is not a file"


def test_command_opens_a_browser_unless_told_otherwise(called, other_page, tmp_path, monkeypatch):
    shown = []
    monkeypatch.setattr("openmdao.utils.webview.webview", shown.append)
    cases, out = other_page.cases / "cases.sql", tmp_path / "page.html"
    called(cases, "-o", out)
    assert shown == [str(out)]
    called(cases, "-o", out, "--no-display")
    assert shown == [str(out)]


def test_command_module_is_light():
    heavy = ("numpy", "openmdao", "matplotlib", "numba")
    code = (
        "import seal_mdao.report.openmdao_command, seal_mdao.report.openmdao_report, sys;"
        f"print([n for n in {heavy} if n in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"

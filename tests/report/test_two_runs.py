"""Report and figures of a recorder file with two runs of one problem."""

import json
import re

import numpy as np
import pytest
from restart.valley import record, valley_problem

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.report.write import write_report

STARTS = [[-1.0, 0.5, 0.3], [0.2, 0.1, 0.4]]


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    """Recorder file of two runs from different starts."""
    path = tmp_path_factory.mktemp("two") / "cases.sql"
    problem = record(valley_problem(sm.SlsqpDriver()), path)
    for start in STARTS:
        problem.set_val("x", start)
        problem.run_driver()
    problem.cleanup()
    return path


def test_runs_are_separate_in_the_report(cases, browser):
    history = read_optimization(cases)
    # the second run begins at its own start
    (second,) = history.run_starts
    np.testing.assert_allclose(history.design["x"][[0, second]], STARTS, rtol=1e-12)
    page = write_report(cases)
    text = page.read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="report-data">(.*?)</script>', text, re.DOTALL)[1])
    assert data["history"]["run_starts"] == [second]
    assert "contains 2 runs of the driver" in text
    # the column of the table
    runs = re.findall(r"<td>(\d)</td></tr>", text.partition("<caption>History</caption>")[2])
    assert runs == ["1"] * second + ["2"] * (len(history.objective) - second)
    browser.get(page.as_uri())
    for chart in ("objective", "constraints", "design-x"):
        lines = browser.execute_script(
            "return [...document.querySelectorAll(`#${arguments[0]} path.line`)].map("
            "(line) => line.getAttribute('d').match(/M/g).length)", chart,
        )  # fmt: skip
        assert set(lines) == {2}, chart
    assert "run 2" in browser.find_element("id", "objective").text
    assert browser.get_log("browser") == []


def test_runs_are_separate_in_figures(cases):
    history = read_optimization(cases)
    (second,) = history.run_starts
    for figure in (plotting.objective_history(history), plotting.constraint_history(history)):
        line = figure.axes[0].lines[0]
        assert np.flatnonzero(np.isnan(line.get_ydata())).tolist() == [second]
        assert " run 2" in [text.get_text() for text in figure.axes[0].texts]


def test_a_continued_run_is_one_run(tmp_path):
    path = tmp_path / "cases.sql"
    problem = record(valley_problem(sm.UnoDriver(maxiter=2)), path)
    problem.run_driver()
    problem.cleanup()
    points = len(read_optimization(path).objective)
    problem = valley_problem(sm.UnoDriver())
    sm.restart(problem, path)
    problem.run_driver()
    problem.cleanup()
    history = read_optimization(path)
    assert len(history.runs) == 2
    assert len(history.objective) > points
    assert history.run_starts == []

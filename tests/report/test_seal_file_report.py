"""The report of a seal file: all that the report of the door seal has, for any profiles and stages."""

import json
import re
import sqlite3
from contextlib import closing

import numpy as np
import pytest
from seal_file.coarse_bulb import BULB, COARSE, changed

import seal_mdao as sm
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.file_optimization import file_task
from seal_mdao.optimization import RunOptions, optimization_problem, uno_driver
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.report.write import write_report
from seal_mdao.seals.settings import seal_of

QUICK = COARSE | {
    "lower = 40.0": "lower = 15.0", "upper = 60.0": "upper = 18.0", "parameters = 12": "parameters = 4",
}  # fmt: skip
STOP = """
[[measure]]
type = "reaction"
profile = "door"
[[measure]]
type = "contact_width"
name = "width_at_stop"
profile = "stop"
[[profile]]
name = "stop"
friction = 0.2
contact = ["seal"]
start = [9.0, 0.0]
normal_penalty = 1e4
tangent_penalty = 1e2
[[profile.segment]]
line = [[0.0, 30.0], [0.0, -30.0]]
"""


def text_of(path):
    text = path.read_text(encoding="utf-8")
    return text, json.loads(re.search(r'id="report-data">(.*?)</script>', text, re.DOTALL)[1])


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """An optimisation of two iterations, whose seal file is gone when it is over; and its analyses."""
    folder = tmp_path_factory.mktemp("bulb")
    text = changed(BULB.read_text(encoding="utf-8"), QUICK)
    path = folder / "bulb.toml"
    path.write_text(text + STOP, encoding="utf-8")
    file, cache = sm.read_seal_file(path), AnalysisCache()
    seal = sm.build_seal(file)
    run = RunOptions(uno_driver(2), folder / "cases.sql", cache=cache, work_dir=folder)
    problem = optimization_problem(file_task(file, run.analyze(seal)), run)
    problem.run_driver()
    problem.cleanup()
    path.unlink()
    return folder / "cases.sql", seal, cache


def test_seal_is_made_again_from_the_recorder_file_alone(run):
    cases, seal, _ = run
    (recorded,) = read_optimization(cases).seals
    assert recorded.drawable
    assert recorded.seal.key == seal.key
    np.testing.assert_array_equal(recorded.seal.nominal_particles, seal.nominal_particles)
    assert recorded.seal.settings() == seal.settings()
    other = seal.with_parameters({"door_friction": 0.1})
    again = seal_of(other.settings())
    assert again.key == other.key != seal.key
    assert again.scalars["door_friction"].value == 0.1


def test_shapes_curves_and_measures_of_every_profile(run):
    cases, seal, _ = run
    history = read_optimization(cases)
    text, data = text_of(write_report(cases))
    assert 'class="warning">The shapes' not in text
    start, end = data["shapes"]["paths"]
    result = sm.analyze(seal, history.design_at(-1)[0])
    assert [own["name"] for own in end["curves"]] == ["door", "stop"]
    for own, label in zip(end["curves"], ("door", "stop"), strict=True):
        assert np.array(own["reaction"]) == pytest.approx(result.path.reaction(label), abs=1e-4)
    assert end["captions"] == [result.caption(step) for step in range(6)]
    assert end["captions"][-1] == "stage 2, travel 0.4 mm"
    assert len(end["frames"]) == len(start["frames"]) == 6
    assert [len(frame["poses"]) for frame in end["frames"]] == [2] * 6
    assert len(data["shapes"]["designs"]) == len(history.objective)
    for words in ("vertical force on the profile, stop", "largest gap between contacts, door"):
        assert f'<th scope="row">{words}</th>' in text
    # charts of the offsets by the edges that they move
    labels = [part["label"] for part in data["history"]["design"]]
    assert labels == ["seal offsets", "cavity offsets"]


def test_recorded_values_are_compared_with_the_analyses(run, tmp_path):
    cases, _, _ = run
    text, _ = text_of(write_report(cases, tmp_path / "report.html"))
    assert "the same, as recorded" in text
    assert "do not give the recorded values" not in text
    changed = tmp_path / "cases.sql"
    changed.write_bytes(cases.read_bytes())
    with closing(sqlite3.connect(changed)) as connection, connection:
        rows = connection.execute("SELECT id, outputs FROM driver_iterations").fetchall()
        for row, outputs in rows:
            values = json.loads(outputs)
            name = next(n for n in values if n.startswith("contact.") and np.size(values[n]) == 1)
            values[name] = (1.001 * np.array(values[name])).tolist()
            update = "UPDATE driver_iterations SET outputs=? WHERE id=?"
            connection.execute(update, (json.dumps(values), row))
    text, _ = text_of(write_report(changed))
    assert "do not give the recorded values" in text


def test_analyses_of_the_run_are_those_of_the_report(run, tmp_path):
    cases, _, cache = run
    before = cache.made
    write_report(cases, tmp_path / "report.html", cache=cache)
    assert cache.made == before


def test_page_in_a_browser(run, browser, tmp_path):
    page = write_report(run[0], tmp_path / "report.html")
    browser.get(page.as_uri())
    assert browser.execute_script("return document.documentElement.dataset.ready") == "true"
    choice = browser.find_element("id", "profile")
    assert choice.is_displayed()
    before = browser.find_element("id", "end-text").text
    browser.execute_script(
        "arguments[0].value = 1; arguments[0].dispatchEvent(new Event('change'));", choice
    )
    assert browser.find_element("id", "end-text").text != before
    assert "stage 2" in browser.find_element("id", "step-value").text
    assert browser.get_log("browser") == []

"""A recorded optimisation of a user's own model: a seal file in several scenarios."""

import re
from html import unescape

import numpy as np
import openmdao.api as om
import pytest
from seal_file.block_files import DESIGN, FIXED, LID, seal_of

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.recording.recorded_optimization import label, read_optimization
from seal_mdao.recording.recorded_scenarios import RecordedScenarios, read_scenarios
from seal_mdao.recording.recorder_file import RecordedModel
from seal_mdao.report.html_tables import number
from seal_mdao.report.scenarios_table import scenarios_table
from seal_mdao.report.write import write_report


def recorded(folder, name):
    """Recorder file of a minimum of area, with a least force in two scenarios."""
    seal = seal_of(folder, FIXED, DESIGN, LID.replace('"lid"', f'"{name}"'), spacing=1.3)
    varied = sm.Variation(f"{name}_friction"), sm.Variation(f"{name}_y", "shift")
    scenarios = sm.Scenarios(varied, np.array([[0.1, 0.0], [0.3, -0.1]]))
    group = sm.ScenarioGroup(seal=seal, scenarios=scenarios, workers=0)
    driver = sm.SlsqpDriver(maxiter=2)
    problem = om.Problem(driver=driver, reports=None, work_dir=folder)
    problem.model.add_subsystem("block", group)
    problem.model.add_design_var("block.boundary_offsets", lower=-0.3, upper=0.3, units="mm")
    problem.model.add_objective("block.area", ref=30.0)
    problem.model.add_constraint("block.reaction_lowest", lower=600.0, ref=600.0)
    driver.add_recorder(sm.RestartRecorder(folder / "cases.sql"))
    driver.recording_options["includes"] = ["*"]
    driver.recording_options["record_derivatives"] = True
    problem.setup()
    problem.run_driver()
    problem.cleanup()
    return folder / "cases.sql"


# a profile named as that of the door seal, too
@pytest.fixture(scope="module", params=["lid", "door"])
def run(request, tmp_path_factory):
    return request.param, recorded(tmp_path_factory.mktemp(request.param), request.param)


def test_history_of_an_own_model_is_drawn(run, tmp_path, run_script, capsys):
    name, cases = run
    code, summary = run_script("history", tmp_path, cases)
    assert code == 0
    assert summary["objective"]["name"] == "block.area"
    assert summary["constraints"]["block.reaction_lowest"]["lower"] == 600.0
    assert list(summary["largest_gap_mm"]) == [name]
    for figure in ("objective_history", "constraint_history", "designs", "start", "optimum"):
        assert (tmp_path / f"{figure}.png").stat().st_size > 1000
    assert "reaction, lowest: " in capsys.readouterr().out


def test_figures_of_designs_name_the_nominal_condition(run, tmp_path, run_script, monkeypatch):
    saved = {}
    monkeypatch.setattr(plotting, "save", lambda figure, path: saved.update({path.stem: figure}))
    run_script("history", tmp_path, run[1])
    titles = {name: figure.get_suptitle() for name, figure in saved.items()}
    assert titles == {
        "objective_history": "", "constraint_history": "",
        **dict.fromkeys(("designs", "start", "optimum"), "nominal condition"),
    }  # fmt: skip


def table_of(text, caption):
    """Headings and rows of the table with a caption."""
    (part,) = re.findall(rf"<table><caption>{caption}</caption>(.*?)</table>", text)
    head, body = part.split("<tbody>")
    cells = r"<t[hd](?: [^>]*)?>(.*?)</t[hd]>"
    rows = [re.findall(cells, row) for row in re.findall(r"<tr>(.*?)</tr>", body)]
    return re.findall(cells, head), rows


def test_aggregates_are_described_in_words():
    assert label("block.reaction_q97_5[3]") == "reaction 4, 97.5 % quantile"
    assert label("gap_square_sum_std") == "sum of squared gaps, standard deviation"
    assert label("von_mises[2]") == "stress 3"


def test_report_tabulates_the_scenarios(run, tmp_path):
    name, cases = run
    text = unescape(write_report(cases, tmp_path / "page.html").read_text(encoding="utf-8"))
    head, rows = table_of(text, "Scenarios")
    assert head == [
        "scenario", f"{name}_friction", f"{name}_y (shift, mm)", "reaction (N/m), start → end",
    ]  # fmt: skip
    assert [row[:3] for row in rows] == [["1", "0.1", "0"], ["2", "0.3", "−0.1"]]
    # as recorded, and as analysed for this test
    (seal,) = read_optimization(cases).seals
    _, values = seal.scenarios.measures["reaction"]
    for i, row in enumerate(rows):
        assert row[3] == f"{number(values[0, i, 0])} → {number(values[-1, i, 0])}"
    for index in (0, -1):
        offsets, _ = seal.design(index)
        parameters = {f"{name}_friction": 0.1, f"{name}_y": 0.0}
        alone = sm.analyze(seal.seal, offsets, parameters)
        assert alone.value("reaction").tolist() == values[index, 0].tolist()
    assert values[0, 0, 0] != values[-1, 0, 0]


def test_report_says_that_pictures_are_nominal(run, tmp_path):
    _, cases = run
    text = write_report(cases, tmp_path / "page.html").read_text(encoding="utf-8")
    note = "Pictures and curves of block show the nominal condition"
    assert note in text
    assert "The 2 scenarios are in the table of scenarios." in text
    assert "<span>vertical force, nominal condition</span>" in text
    assert "First and last design of block in the nominal condition, from their analyses" in text


def test_many_values_of_a_measure_are_one_column():
    measures = {
        "gap": ("mm", np.arange(24.0).reshape(2, 2, 6)),
        "force": (None, np.array([[[1.0, 2.0], [np.nan, np.nan]]])),
    }
    recorded = RecordedScenarios(["<grip>"], np.array([[0.1], [0.2]]), measures)
    text = scenarios_table(recorded, "lid & co")
    assert "<grip>" not in text
    head, rows = table_of(unescape(text), "Scenarios of lid & co")
    assert head == [
        "scenario", "<grip>", "gap, largest of 6 (mm), start → end", "force 1, start → end",
        "force 2, start → end",
    ]  # fmt: skip
    assert rows == [["1", "0.1", "5 → 17", "1", "2"], ["2", "0.2", "11 → 23", "–", "–"]]


def test_table_of_many_scenarios_is_closed_at_first():
    few, many = (RecordedScenarios(["a"], np.zeros((n, 1)), {}) for n in (20, 21))
    start = '<div class="scroll"><table>'
    assert scenarios_table(few).startswith(start)
    assert scenarios_table(many).startswith(f"<details><summary>Scenarios: 21</summary>{start}")


@pytest.mark.parametrize(
    "text",
    [
        "[", "3", '{"columns": ["a"]}', '{"columns": ["a"], "rows": []}',
        '{"columns": "a", "rows": [[1]]}', '{"columns": ["a"], "rows": [[1, 2]]}',
        '{"columns": ["a"], "rows": [["x"]]}', '{"columns": [1], "rows": [[1]]}',
        '{"columns": ["a"], "rows": [[1' + 400 * "0" + "]]}",
    ],
)  # fmt: skip
def test_table_that_is_none_is_refused(text):
    model = RecordedModel({}, {}, {}, {}, {}, {}, {}, {"": {"scenarios_table": text}})
    with pytest.raises(ValueError, match="the recorded option scenarios_table is damaged"):
        read_scenarios(model, "", "scenarios.", [])

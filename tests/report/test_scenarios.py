"""A recorded optimisation of a user's own model: a seal file in several scenarios."""

import numpy as np
import openmdao.api as om
import pytest
from seal_file.block_files import DESIGN, FIXED, seal_of

import seal_mdao as sm

LID = """[[profile]]
name = "NAME"
friction = 0.3
contact = ["top"]
line = [[-9, 0], [9, 0]]
start = [0, 4.02]
normal_penalty = 1e4
tangent_penalty = 1e3
stage = [{ translate = [0, -0.5], steps = 3 }]
[[measure]]
type = "reaction"
"""


def recorded(folder, name):
    """Recorder file of a minimum of area, with a least force in two scenarios."""
    seal = seal_of(folder, FIXED, DESIGN, LID.replace("NAME", name), spacing=1.3)
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
    assert "reaction lowest: " in capsys.readouterr().out

"""The recorder file holds all that is needed to set up the seal problem again."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import openmdao.api as om
import pytest

import seal_mdao as sm
from seal_mdao.door_optimization import DoorProblem, door_task
from seal_mdao.optimization import (
    RunOptions,
    continue_run,
    optimization_problem,
    uno_driver,
)
from seal_mdao.recording.recorded_seals import PROBLEM_OPTION, recorded_problem
from seal_mdao.recording.recorder_file import open_model
from seal_mdao.seals.settings import seal_of

SEAL = {"n_steps": 21, "friction": 0.3, "segments": 32, "newton": sm.NewtonOptions(max_cuts=7)}


def problem_of(seal, flags, folder, recorder=None):
    """Problem (71) of one iteration."""
    run = RunOptions(uno_driver(1), recorder, work_dir=folder)
    return optimization_problem(door_task(run.analyze(seal), flags), run)


def test_every_setting_of_the_problem_is_recorded(tmp_path):
    seal = sm.door_seal(**SEAL)
    first = problem_of(seal, DoorProblem(keep_force=True), tmp_path, tmp_path / "cases.sql")
    settings = json.loads(first.model.options[PROBLEM_OPTION])
    assert settings == asdict(DoorProblem(keep_force=True))
    first.run_driver()
    first.cleanup()
    recorded = recorded_problem(open_model(tmp_path / "cases.sql"))
    assert recorded.seal.key == seal.key
    assert recorded.settings == settings
    again = problem_of(recorded.seal, DoorProblem(**recorded.settings), tmp_path)
    again.final_setup()
    for name, limit in first.driver._cons.items():
        other = again.driver._cons[name]
        for side in ("lower", "upper"):
            assert np.array_equal(limit[side], other[side])  # those of the nominal seal


def test_a_seal_file_of_many_bytes_is_recorded(tmp_path):
    """OpenMDAO drops options of more than 10 kB, as those of a seal file with a CAD drawing are."""
    pytest.importorskip("netgen")
    text = (Path(__file__).parents[1] / "seal_file" / "bulb.toml").read_text(encoding="utf-8")
    path = tmp_path / "bulb.toml"
    path.write_text(f"# {'a long drawing ' * 2000}\n{text}", encoding="utf-8")
    seal = sm.build_seal(
        sm.read_seal_file(path), penalties={"door_normal_penalty": 1e4, "door_tangent_penalty": 1e2}
    )
    assert len(seal.settings()) > 3e4
    group = sm.SealGroup(seal=seal, measures=("section_area",))
    problem = om.Problem(group, reports=None, work_dir=tmp_path)
    problem.driver.add_recorder(om.SqliteRecorder(tmp_path / "cases.sql"))
    problem.setup()
    problem.final_setup()
    problem.cleanup()
    assert recorded_problem(open_model(tmp_path / "cases.sql")).seal.key == seal.key


def test_another_problem_is_not_continued(tmp_path):
    cases, seal = tmp_path / "cases.sql", sm.door_seal(**SEAL)
    first = problem_of(seal, DoorProblem(), tmp_path, cases)
    first.run_driver()
    first.cleanup()
    with pytest.raises(ValueError, match="recorded in the optimisation of another problem"):
        continue_run(problem_of(seal, DoorProblem(stress_norm=True), tmp_path), cases)
    same = problem_of(seal, DoorProblem(), tmp_path)
    continue_run(same, cases)
    same.run_driver()
    same.cleanup()
    assert same.driver.reused_evaluations > 0


def test_file_without_a_seal(tmp_path):
    problem = om.Problem(reports=None, work_dir=tmp_path)
    problem.add_recorder(om.SqliteRecorder(tmp_path / "cases.sql"))
    problem.setup()
    problem.run_model()
    problem.cleanup()
    assert recorded_problem(open_model(tmp_path / "cases.sql")) is None


def test_settings_of_another_version():
    text = sm.door_seal().settings()
    for wrong in (
        text.replace('"friction":', '"rubbing":'),
        text.replace('"c10":', '"c100":'),
        text.replace('"newton":', '"newtons":'),
        json.dumps({"door_seal": 3}),
    ):
        with pytest.raises(ValueError, match="the recorded settings of a door seal are not valid"):
            seal_of(wrong)
    assert seal_of(text).key == sm.door_seal().key

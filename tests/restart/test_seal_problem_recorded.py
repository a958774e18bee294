"""The recorder file holds all that is needed to set up the seal problem again."""

import inspect
import json

import numpy as np
import openmdao.api as om
import pytest

import seal_mdao as sm
from seal_mdao.optimization import seal_problem, uno_driver
from seal_mdao.recording.settings import PROBLEM_OPTION, open_model, recorded_problem
from seal_mdao.seals.settings import seal_of

NOT_THE_PROBLEM = {"seal", "driver", "recorder", "callback", "kept", "work_dir", "reports"}
"""Arguments of ``seal_problem`` that do not say what is optimised."""
SEAL = {"n_steps": 21, "friction": 0.3, "segments": 32, "newton": sm.NewtonOptions(max_cuts=7)}


def test_every_setting_of_the_problem_is_recorded(tmp_path):
    seal = sm.door_seal(**SEAL)
    first = seal_problem(
        seal, keep_force=True, driver=uno_driver(1), recorder=tmp_path / "cases.sql",
        work_dir=tmp_path,
    )  # fmt: skip
    settings = json.loads(first.model.options[PROBLEM_OPTION])
    assert settings.keys() == inspect.signature(seal_problem).parameters.keys() - NOT_THE_PROBLEM
    first.run_driver()
    first.cleanup()
    recorded = recorded_problem(open_model(tmp_path / "cases.sql"))
    assert recorded.seal.key == seal.key
    assert recorded.settings == settings
    again = seal_problem(recorded.seal, driver=uno_driver(1), **recorded.settings)
    again.final_setup()
    for name, limit in first.driver._cons.items():
        other = again.driver._cons[name]
        for side in ("lower", "upper"):
            assert np.array_equal(limit[side], other[side])  # those of the drawn seal


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
        with pytest.raises(ValueError, match="not those of this version's door seal"):
            seal_of(wrong)
    assert seal_of(text).key == sm.door_seal().key

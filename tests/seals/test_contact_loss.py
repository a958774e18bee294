"""Contact that is lost before the end of a closing stage is a warning, not in an opening stage."""

from pathlib import Path

import pytest
from seal_file import block_files
from two_profiles import two_profiles

import seal_mdao as sm
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.seals.contact_loss import closes

LIP = Path(__file__).parents[2] / "examples" / "slipping_lip.toml"
ONE_STAGE = "[[profile.stage]]\ntranslate = [9.0, 0.0]\nsteps = 72"
START = "start = [-2.12, 9.6]"


def lost(result):
    """The warnings that contact is lost."""
    return tuple(text for text in result.warnings if "loses contact" in text)


def analyzed(tmp_path, stages, start=START):
    """Analyse the lip with a rod on another path."""
    text = LIP.read_text(encoding="utf-8").replace("friction = 0.0\n", "friction = 0.3\n")
    assert ONE_STAGE in text
    assert START in text
    path = tmp_path / "lip.toml"
    path.write_text(text.replace(ONE_STAGE, stages).replace(START, start), encoding="utf-8")
    result = sm.analyze(sm.build_seal(sm.read_seal_file(path)))
    assert result.converged, result.failure
    return result


def lip(tmp_path, stages, start=START):
    """Warnings of contact that is lost by the lip with a rod on another path, and its last forces."""
    result = analyzed(tmp_path, stages, start)
    return lost(result), result.path.reaction("rod")[-1]


def stage(translate, steps):
    return f"[[profile.stage]]\ntranslate = {translate}\nsteps = {steps}\n"


def test_a_lip_that_slips_off_is_reported_with_the_travel(tmp_path):
    (text,), force = lip(tmp_path, stage([9.0, 0.0], 72))
    assert not force.any()
    assert text.startswith(
        "the seal loses contact with the profile 'rod' between travels of 8.0000 and 8.1250"
    )


def test_the_stage_is_named_where_there_are_several(tmp_path):
    (text,), _ = lip(tmp_path, stage([3.0, 0.0], 24) + stage([6.0, 0.0], 48))
    assert "travels of 5.0000 and 5.1250 mm in stage 2" in text


def test_a_rod_that_still_touches_is_not(tmp_path):
    warnings, force = lip(tmp_path, stage([4.0, 0.0], 32))
    assert force.any()
    assert warnings == ()


def test_a_rod_that_goes_back_is_not(tmp_path):
    """Contact ends in the opening stage, and is there again at the end of the next closing one."""
    warnings, force = lip(tmp_path, stage([3.0, 0.0], 24) + stage([-3.0, 0.0], 24))
    assert not force.any()
    assert warnings == ()


def test_a_rod_that_never_comes_near_is_not(tmp_path):
    warnings, force = lip(tmp_path, stage([1.0, 0.0], 4), "start = [-6.0, 9.6]")
    assert not force.any()
    assert warnings == ()


@pytest.mark.parametrize(("travel", "how"), [(1.0, "approaches"), (-1.0, "moves away from")])
def test_a_profile_that_never_touches_is_reported(tmp_path, travel, how):
    result = analyzed(tmp_path, stage([travel, 0.0], 4), "start = [-6.0, 9.6]")
    (text,) = [own for own in result.warnings if "at no load step" in own]
    gap = min(own.gap.min() for own in result.path.responses("rod"))
    assert f"'rod' touches the seal at no load step, and comes no nearer than {gap:.3g} mm" in text
    assert f"its motion (stage) {how} the seal" in text


def test_a_profile_that_has_touched_is_not_reported(tmp_path):
    result = analyzed(tmp_path, stage([3.0, 0.0], 24) + stage([-3.0, 0.0], 24))
    assert not [own for own in result.warnings if "at no load step" in own]


BLOCK = """
[material.rubber]
shore_a = 60
[section]
spacing = 1.2
outer = [
  {{ edge = "base", line = [[0, 0], [6, 0]] }},
  {{ edge = "right", line = [[6, 0], [6, 3]] }},
  {{ edge = "top", line = [[6, 3], [0, 3]] }},
  {{ edge = "left", line = [[0, 3], [0, 0]] }},
]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.3
contact = ["top"]
line = [[-30, 0], [30, 0]]
start = [3, 3]
normal_penalty = 1e5
tangent_penalty = 1e4
stage = [{{ translate = [0, {travel}], steps = 2 }}]
[[profile]]
name = "stop"
friction = 0.3
contact = ["right"]
line = [[0, 30], [0, -30]]
start = [9, 0]
normal_penalty = 1e5
tangent_penalty = 1e4
"""


@pytest.mark.parametrize(("travel", "reported"), [(-0.3, set()), (0.3, {"plate", "stop"})])
def test_a_profile_at_rest_is_reported_where_none_touches(tmp_path, travel, reported):
    (tmp_path / "block.toml").write_text(BLOCK.format(travel=travel))
    result = sm.analyze(sm.build_seal(tmp_path / "block.toml"))
    lines = [own for own in result.warnings if "at no load step" in own]
    assert {own.split("'")[1] for own in lines} == reported
    assert all(("does not move" in own) == ("'stop'" in own) for own in lines)


def test_profiles_that_come_turn_and_go():
    assert lost(sm.analyze(two_profiles(0.3))) == ()


def test_stages_close_unless_they_lead_back():
    stages = [
        *(Stage(1, way) for way in ((0.0, -3.0), (0.0, 0.0), (1.0, 0.0), (0.0, 2.0))),
        *(Stage(1, rotate=turn) for turn in (9.0, -5.0)),
    ]
    motion = staged_motion(stages)
    assert [closes(motion, i) for i in range(6)] == [True, True, True, False, True, False]


def test_a_profile_that_stands_still_has_the_stages_of_moved_edges(tmp_path):
    """A strip is pressed against it, and then lifted: only a stage of pressing can lose the contact."""
    (tmp_path / "strip.toml").write_text(
        block_files.BLOCK.format(bulk=2000.0, spacing=1.0) + MOVED_UNDER_PLATE
    )
    result = sm.analyze(sm.build_seal(sm.read_seal_file(tmp_path / "strip.toml")))
    assert result.converged, result.failure
    touching = [own.branch.any() for own in result.path.responses("plate")]
    assert touching == [False] + [True] * 5 + [False] * 2
    assert lost(result) == ()


MOVED_UNDER_PLATE = """[[moved]]
edges = ["base"]
stage = [{ translate = [0.0, 0.4], steps = 4 }, { translate = [0.0, -0.35], steps = 4 }]
[[profile]]
name = "plate"
contact = ["top"]
line = [[-40.0, 4.15], [40.0, 4.15]]
friction = 0.2
"""

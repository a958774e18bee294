"""Which profile has the stages of the path: the first one that moves or has several stages."""

import numpy as np
import pytest
from block_files import FIXED, LID, seal_of, text
from test_viscoelastic import SERIES

import seal_mdao as sm
from seal_mdao.cli.analyze import stage_times

WALL = """[[profile]]
name = "wall"
friction = 0.3
contact = ["right"]
line = [[5, 9], [5, -9]]
normal_penalty = 1e4
tangent_penalty = 1e3
stage = [{}]
"""
MOVES = "stage = [{ translate = [0, -0.5], steps = 3 }]"
FORCE = '[[measure]]\ntype = "reaction"\nprofile = "lid"\nname = "force_{0}"\nstage = {0}\n'


def lid(stages):
    return LID.split("[[measure]]")[0].replace(MOVES, f"stage = [{stages}]")


def test_one_dwell_of_the_first_profile_is_no_stage_of_the_path(tmp_path):
    """The lid, which moves, has them."""
    stages = "{ translate = [0, -0.3], steps = 2 }, { translate = [0, -0.1], steps = 1 }"
    measures = FORCE.format(1) + FORCE.format(2)
    seal = seal_of(tmp_path, FIXED, WALL.format("{ steps = 3 }"), lid(stages), measures)
    result = sm.analyze(seal)
    forces = result.path.reaction("lid")[:, 1]
    assert [result.value(f"force_{n}")[0] for n in (1, 2)] == [forces[1], forces[2]]


def test_a_force_after_the_only_stage_of_a_seal_that_swells(tmp_path):
    swelling = text(FIXED, lid("{ steps = 2 }"), FORCE.format(1)).replace(
        "c10 = 80.0", "c10 = 80.0\nswelling = 1.3"
    )
    path = tmp_path / "seal.toml"
    path.write_text(swelling)
    result = sm.analyze(sm.build_seal(path))
    assert result.value("force_1")[0] == result.path.reaction("lid")[-1, 1] > 0.0


def test_two_dwells_of_the_first_profile_beside_one_stage_of_another(tmp_path):
    dwells = "{ steps = 1, duration = 1 }, { steps = 2, duration = 10 }"
    given = text(FIXED, WALL.format(dwells), lid("{ translate = [0, -0.3], steps = 3 }"))
    path = tmp_path / "seal.toml"
    path.write_text(given.replace("[section]", SERIES + "[section]"))
    seal = sm.build_seal(path)
    found = stage_times(seal)["stage_times"]
    assert [own["end_s"] for own in found] == pytest.approx([1.0, 11.0], rel=1e-14)
    assert not any(own["dwell"] for own in found)
    np.testing.assert_array_equal(seal.terms()[0].environment.time.stages[[0, 1, 3]], [0, 1, 2])

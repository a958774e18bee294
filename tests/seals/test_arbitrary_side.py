"""A symmetric strip pressed along its axis buckles to an arbitrary side, which is reported."""

from dataclasses import replace

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.arbitrary_side import arbitrary_side

STRIP = """
[material.rubber]
shore_a = 60
[section]
material = "rubber"
spacing = 0.7
layers = 4
outer = [
  { edge = "base", line = [[-1, 0], [1, 0]] },
  { edge = "right", line = [[1, 0], [1, 18]] },
  { edge = "tip", line = [[1, 18], [-1, 18]] },
  { edge = "left", line = [[-1, 18], [-1, 0]] },
]
[fixed]
edges = ["base"]
[[profile]]
name = "glass"
friction = 0.0
normal_penalty = 1e4
contact = ["tip"]
line = [[-60, 0], [60, 0]]
start = [0, 18]
stage = [{ translate = [0, -0.5], steps = 5 }]
"""
RUBBED = ("friction = 0.0", "friction = 0.3\ntangent_penalty = 1e2")


def pressed(tmp_path, *changes):
    text = STRIP
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "strip.toml"
    path.write_text(text, encoding="utf-8")
    result = sm.analyze(sm.build_seal(sm.read_seal_file(path)))
    assert result.converged
    return result


def test_a_symmetric_strip_that_buckles_is_reported(tmp_path):
    result = pressed(tmp_path)
    sideways = np.abs(result.displacement()[:, 0]).max()
    assert sideways > 2.0
    text = arbitrary_side(result.path)
    assert f"deflects sideways by up to {sideways:.3g} mm" in text
    assert "turn the profile by about one degree (angle)" in text
    assert text in result.warnings
    # nothing else is symmetric about this line, and no result means less
    assert result.trustworthy


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("start = [0, 18]", "start = [0, 18.1]\nangle = 1.0"),
        ("[0, -0.5]", "[0.05, -0.5]"),
        ("[1, 18]", "[1.2, 18]"),
        (*RUBBED[:1], "friction = { tip = 0.0 }\ntangent_penalty = 1e2"),
        ('contact = ["tip"]', 'contact = ["right", "tip"]'),
        ("line = [[-60, 0], [60, 0]]", "circle = { centre = [1, 2], radius = 3 }"),
    ],
)
def test_a_side_that_is_decided_is_not(tmp_path, old, new):
    start = ("start = [0, 18]", "start = [0, 19]") if "circle" in new else (old, new)
    result = pressed(tmp_path, (old, new), *([start] if "circle" in new else []))
    assert arbitrary_side(result.path) == ""


def test_friction_keeps_the_strip_on_its_symmetric_branch(tmp_path):
    result = pressed(tmp_path, RUBBED, ("-0.5], steps = 5", "-1.2], steps = 12"))
    assert np.abs(result.displacement()[:, 0]).max() < 0.5
    assert [point.kind for point in result.critical_points] == ["unsymmetric"]
    text = arbitrary_side(result.path)
    assert "may not be stable from load step" in text
    assert "a real seal may buckle to either side" in text
    # a symmetric mode, as of a shallow arch, has no side
    (point,) = result.path.critical_points
    upwards = replace(point, mode=np.ones_like(point.mode) * [0.0, 1.0])
    assert arbitrary_side(replace(result.path, critical_points=(upwards,))) == ""


def test_a_strip_that_is_only_compressed_is_not_reported(tmp_path):
    result = pressed(tmp_path, ("-0.5], steps = 5", "-0.05], steps = 2"))
    assert arbitrary_side(result.path) == ""


CLOSES = "stage = [{ translate = [0, -0.5], steps = 5 }]"
ROLL = "circle = { centre = [0, 2], radius = 3 }\npivot = [0, 2]"


@pytest.mark.parametrize(
    ("then", "changes"),
    [
        ("translate = [0.8, 0]", ()),
        (
            "rotate = 20.0",
            (("line = [[-60, 0], [60, 0]]", ROLL), ("start = [0, 18]", "start = [0, 19]")),
        ),
    ],
)
def test_a_seal_that_is_dragged_to_one_side_is_not_reported(tmp_path, then, changes):
    """By a plate that slides or a roll that turns, of which the gaps do not tell."""
    stages = f"stage = [{{ translate = [0, -0.1], steps = 2 }}, {{ {then}, steps = 3 }}]"
    result = pressed(tmp_path, RUBBED, (CLOSES, stages), *changes)
    assert np.abs(result.displacement()[:, 0]).max() > 0.1
    assert arbitrary_side(result.path) == ""

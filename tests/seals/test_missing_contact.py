"""Edges that may not touch a profile and come to lie inside it: found, measured, and the cure named."""

import re
from dataclasses import replace

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.analysis.path_result import Status
from seal_mdao.seals import checks
from seal_mdao.seals.checks import findings
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.seals.missing_contact import buried_edges, missing_contact

BUMPER = """
model = {{ kinematics = "axisymmetric" }}
[material.rubber]
shore_a = 60
[section]
spacing = 2.5
outer = [
  {{ edge = "base", line = [[0, 0], [12.5, 0]] }},
  {{ edge = "side", line = [[12.5, 0], [12.5, 18]] }},
  {{ edge = "top", line = [[12.5, 18], [0, 18]] }},
  {{ edge = "axis", line = [[0, 18], [0, 0]] }},
]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.5
{contact}
line = [[-60, 0], [60, 0]]
start = [0, 18]
normal_penalty = 1e6
tangent_penalty = 1e5
stage = [{{ translate = [0, -{travel}], steps = 20 }}]
"""
"""A cylinder whose corner rolls onto the plate."""


def pressed(path, contact="", travel=6.0, change=lambda text: text):
    path.write_text(change(BUMPER.format(contact=contact, travel=travel)))
    return sm.analyze(sm.build_seal(path))


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    return pressed(tmp_path_factory.mktemp("top") / "alone.toml", 'contact = ["top"]')


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    return pressed(tmp_path_factory.mktemp("free") / "both.toml")


def of_side(result):
    return [found for found in findings(result.path) if "may not touch" in found.text]


def test_edge_without_contact_is_reported_with_travel_depth_and_cure(alone):
    (found,) = of_side(alone)
    assert "edge 'side' may not touch the rigid profile 'plate'" in found.text
    assert 'contact = ["side", "top"], or leave out contact' in found.text
    assert found.meaningless
    assert not alone.trustworthy
    # gaps of the particles of the side, but for the corner that touches, after every load step
    own = alone.path.discretization.body.edges["side"].particles[:-1]
    plate = 18.0 - 0.3 * np.arange(1, 21)
    depths = np.array([(alone.deformed(k)[own, 1] - plate[k]).max() for k in range(20)])
    first = int((depths > 0.01 * 6.0).argmax())
    assert 0 < first < 19
    assert f"from a travel of {0.3 * (first + 1):.3g} mm on" in found.text
    assert f"by up to {depths.max():.3g} mm" in found.text
    # said once, not as a fault of contact points
    assert not any("only at the contact points" in text for text in alone.warnings)


def test_free_neighbours_touch_unless_contact_is_given(alone, both):
    assert of_side(both) == []
    assert list(buried_edges(both.path, 0.0)) == []
    # the side carries a part of the force
    assert alone.reaction[-1, 1] < 0.97 * both.reaction[-1, 1]


def test_depth_is_compared_with_parts_of_the_wall(alone, monkeypatch):
    """The side lies 0.74 mm inside, 10 % of the wall of 7.4 mm."""
    (own,) = buried_edges(alone.path, 0.0)
    assert list(buried_edges(alone.path, own.depth)) == []
    part = own.depth / EvaluationPoints(alone.path).wall
    for missed, meaningless in ((0.99 * part, True), (1.01 * part, False)):
        monkeypatch.setattr(checks, "MISSED", missed)
        (found,) = of_side(replace(alone, path=replace(alone.path)))
        assert found.meaningless == meaningless


def test_path_that_fails_names_the_edge_that_came_near(alone):
    """As far as the load step before the side lies inside."""
    (own,) = buried_edges(alone.path, 0.0)
    steps = [step for step in alone.path.steps if step.fraction < 20.0]
    early = replace(alone.path, steps=steps, status=Status.NOT_CONVERGED)
    text = replace(alone, path=early).failure
    assert re.search(
        r"The edge 'side' has no contact with the profile 'plate' .key contact., but (penetrates|came)",
        text,
    )
    assert own.cure in text


def test_path_that_fails_for_another_reason_says_nothing_of_edges(both):
    assert missing_contact(both.path) == ""


RIBS = """
[material.rubber]
shore_a = 60
[section]
spacing = 1.0
outer = [
  { edge = "base", line = [[0, 0], [12, 0]] },
  { edge = "side", line = [[12, 0], [12, 3], [11, 3]] },
  { edge = "right", line = [[11, 3], [10.5, 5], [8.5, 5], [8, 3]] },
  { edge = "groove", line = [[8, 3], [4, 3]] },
  { edge = "left", line = [[4, 3], [3.5, 5], [1.5, 5], [1, 3]] },
  { edge = "other_side", line = [[1, 3], [0, 3], [0, 0]] },
]
[fixed]
edges = ["base"]
"""
PRESSING = """[[profile]]
name = "{edge}_plate"
friction = 0.3
contact = ["{edge}"]
line = [[-60, {tilt}], [60, 0]]
start = [6, 5]
normal_penalty = 1e5
tangent_penalty = 1e4
stage = [{{ translate = [0, -0.6], steps = 4 }}]
"""


@pytest.mark.parametrize("tilt", [0.0, 0.01])
def test_profiles_of_the_same_curve_and_motion_are_one(tmp_path, monkeypatch, tilt):
    """The other rib touches the same plate as another contact; with another curve it would not."""
    plates = PRESSING.format(edge="left", tilt=0.0) + PRESSING.format(edge="right", tilt=tilt)
    (tmp_path / "ribs.toml").write_text(RIBS + plates)
    result = sm.analyze(sm.build_seal(tmp_path / "ribs.toml"))
    buried = {(own.edge, own.profile) for own in buried_edges(result.path, 1e-4)}
    expected = {("left", "right_plate"), ("right", "left_plate")} if tilt else set()
    assert buried == expected
    # the penetration of a rib is said of its own contact
    monkeypatch.setattr(checks, "SLIGHT", 1e-5)
    where = [
        (found.text.split("'")[1], float(re.search(r"near x = ([0-9.]+)", found.text)[1]) > 6.0)
        for found in findings(replace(result, path=replace(result.path)).path)
        if "inside the rigid profile" in found.text and "may not touch" not in found.text
    ]
    assert ("left_plate", False) in where
    assert ("right_plate", True) in where
    assert len(where) == 2

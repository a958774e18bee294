"""Pictures of a surface that two profiles touch side by side: what touches one is not open."""

from pathlib import Path

import numpy as np
import pytest
from seal_file.block_files import FIXED, text

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.contact.friction import OPEN
from seal_mdao.measures.selection import open_points
from seal_mdao.report.picture_data import BETWEEN, Pictures, contact_points
from seal_mdao.seals.gaps import open_between

FOLDED_LIP = Path(__file__).parents[1] / "contact" / "folded_lip.toml"
PROFILE = """\
[[profile]]
name = "{name}"
friction = 0.0
contact = ["top"]
line = {line}
start = [0.0, 4.0]
normal_penalty = 1e4
tangent_penalty = 1e3
stage = [{{ translate = [0.0, -0.3], steps = 2 }}]
"""
LID = [[-9.0, 0.0], [-1.9, 0.0], [-1.9, 1.0], [1.9, 1.0], [1.9, 0.0], [9.0, 0.0]]
"""With a notch of 3.8 mm, in which five contact points lie."""
STAMP = [[-0.5, 3.0], [-0.5, 0.0], [0.5, 0.0], [0.5, 3.0]]
"""In the middle of the notch, above one of them."""


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    pytest.importorskip("netgen")
    path = tmp_path_factory.mktemp("pressed") / "block.toml"
    profiles = (PROFILE.format(name=n, line=own) for n, own in (("lid", LID), ("stamp", STAMP)))
    path.write_text(text(FIXED, *profiles), encoding="utf-8")
    result = sm.analyze(sm.build_seal(path))
    result.require_converged()
    return result


def test_points_that_touch_another_profile_are_not_open(pressed):
    lid, stamp = (pressed.response(name) for name in ("lid", "stamp"))
    assert np.sum(stamp.state != OPEN) == 1
    (middle,) = np.flatnonzero(stamp.state != OPEN)
    assert open_points(lid.state).tolist() == list(range(middle - 2, middle + 3))
    assert open_between(pressed, "lid").tolist() == [middle - 2, middle - 1, middle + 1, middle + 2]
    assert not open_between(pressed, "stamp").size


def test_markers_of_pictures_and_report(pressed):
    axes = plotting.deformed_shapes(pressed).axes
    lines = [{own.get_label(): own.get_xydata() for own in panel.lines} for panel in axes]
    shown = [own for own in lines if "in contact" in own][-1]
    opened, touching = shown["open between contacts"], shown["in contact"]
    assert len(opened) == 4
    # no point is marked twice
    assert np.linalg.norm(opened[:, None] - touching, axis=2).min() > 0.5
    frame = Pictures(pressed, pressed, []).as_data()["paths"][0]["frames"][-1]
    assert frame["marks"].count(str(BETWEEN)) == 4


def test_gaps_are_shaded_where_nothing_touches(pressed):
    axes = plotting.gap_profile(pressed, profile="lid").axes[0]
    assert "4 open points (shaded)" in axes.get_title(loc="left")
    # one region on either side of the stamp
    assert len(axes.patches) == 2


def test_walls_between_two_regions_of_self_contact_are_not_open_between_contacts():
    result = sm.analyze(sm.build_seal(FOLDED_LIP))
    branch = result.response("self_contact").branch
    assert open_points(branch).size
    points, marks = contact_points(result, -1)
    assert str(BETWEEN) not in marks
    assert len(points) == np.sum(branch != OPEN) + np.sum(result.response("rod").branch != OPEN)

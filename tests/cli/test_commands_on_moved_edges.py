"""Commands on a block without profiles whose upper edge is moved."""

import json

import numpy as np
import pytest
from PIL import Image

import seal_mdao as sm
from seal_mdao.cli.subcommands import main
from seal_mdao.measures.reaction import Reaction
from seal_mdao.plotting.several_seals import force_against_travel
from seal_mdao.seals.profiles import profile_histories

BLOCK = """\
[material.rubber]
law = "neo_hookean"
c10 = 100.0
bulk_modulus = 8000.0
[section]
material = "rubber"
spacing = 1.0
outer = [
  { edge = "base", line = [[-4, 0], [4, 0]] }, { edge = "right", line = [[4, 0], [4, 4]] },
  { edge = "top", line = [[4, 4], [-4, 4]] }, { edge = "left", line = [[-4, 4], [-4, 0]] },
]
[fixed]
edges = ["base"]
[[moved]]
name = "lid"
edges = ["top"]
stage = [{ translate = [0.3, -0.4], steps = 4 }]
"""
STILL = """\
[[profile]]
name = "plate"
friction = 0.5
contact = ["top"]
line = [[-40, 4], [40, 4]]
"""


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    path = tmp_path_factory.mktemp("moved") / "block.toml"
    path.write_text(BLOCK)
    return path


@pytest.fixture(scope="module")
def force(block):
    """Fx, Fy on the moved edge at the end, N/m."""
    return sm.analyze(sm.build_seal(sm.read_seal_file(block))).value(Reaction("lid"))


def test_the_force_is_printed_and_in_the_summary(block, force, tmp_path, capsys):
    main(["analyze", str(block), "--out", str(tmp_path), "--no-vtu"])
    printed = capsys.readouterr().out
    assert f"lid: force {force[0]:.2f}, {force[1]:.2f} N/m (x, y)\n" in printed
    # a row for each of the four load steps, the last one with the same force
    _, _, table = printed.partition(
        "lid, stage 1: travel (mm), horizontal and vertical force (N/m)\n"
    )
    last = table.splitlines()[3].split()
    assert last[:3] == ["0.500", f"{force[0]:.2f}", f"{force[1]:.2f}"]
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["moved_edges"]["lid"]["force_N_per_m"] == pytest.approx(list(force), rel=1e-12)
    assert summary["profiles"] == {}


def test_the_force_is_compared_and_drawn(block, force, tmp_path, capsys):
    stiffer = block.with_name("stiffer.toml")
    stiffer.write_text(BLOCK.replace("c10 = 100.0", "c10 = 200.0"))
    main(["compare", str(block), str(stiffer), "--out", str(tmp_path)])
    assert f"block    force on lid {force[0]:.2f}, {force[1]:.2f} N/m" in capsys.readouterr().out
    with Image.open(tmp_path / "comparison.png") as picture:
        assert min(picture.size) > 600


def test_the_motion_is_animated(block, tmp_path):
    main(["animate", str(block), "-o", "block.gif", "--out", str(tmp_path)])
    with Image.open(tmp_path / "block.gif") as frames:
        assert frames.n_frames >= 4


def test_a_profile_that_stands_still_has_the_travel_of_moved_edges(block):
    """The lower edge presses the block against a plate that stands still."""
    text = BLOCK.replace('[fixed]\nedges = ["base"]\n', "").replace('"top"]', '"base"]')
    assert text.count('edges = ["base"]') == 1
    path = block.with_name("still.toml")
    path.write_text(text.replace("0.3, -0.4", "0.3, 0.4") + STILL)
    result = sm.analyze(sm.build_seal(sm.read_seal_file(path)))
    (plate,) = profile_histories(result)
    np.testing.assert_allclose(plate.travel, [0.125, 0.25, 0.375, 0.5], rtol=1e-12)
    travel, force, _, words = force_against_travel(result)
    np.testing.assert_allclose(travel, [0.0, *plate.travel], rtol=1e-12)
    assert words == "force on lid against its travel"
    # the plate holds the block: the forces on both are opposite
    np.testing.assert_allclose(
        force[1:], -plate.force @ [-0.6, -0.8], rtol=1e-6, atol=1e-6 * force.max()
    )


def test_edges_that_stand_still_hold_a_block_that_expands(block, tmp_path):
    """Nothing moves, and there is no profile: the temperature alone changes."""
    path = block.with_name("heated.toml")
    text = BLOCK.replace("translate = [0.3, -0.4], steps = 4", "steps = 2")
    text = text.replace("bulk_modulus = 8000.0", "bulk_modulus = 8000.0\nexpansion = 2e-4")
    path.write_text(f"[model]\ntemperature = 60.0\n{text}")
    main(["analyze", str(path), "--out", str(tmp_path), "--no-vtu"])
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["converged"]
    assert summary["moved_edges"]["lid"]["force_N_per_m"][1] > 1.0

"""Commands on a block without profiles whose upper edge is moved."""

import json

import pytest
from PIL import Image

import seal_mdao as sm
from seal_mdao.cli.subcommands import main
from seal_mdao.measures.reaction import Reaction

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

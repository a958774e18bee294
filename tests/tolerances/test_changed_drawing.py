"""A tolerance study continues only with the same files beside the seal file."""

import pytest

import seal_mdao as sm
from seal_mdao.cli.subcommands import main

STRIP = """\
[material.rubber]
law = "neo_hookean"
c10 = 200.0
bulk_modulus = 8000.0
[section]
material = "rubber"
spacing = 1.0
{outline}
[fixed]
edges = ["foot"]
[[profile]]
name = "lid"
friction = 0.2
contact = ["top"]
normal_penalty = 2e4
tangent_penalty = 2e4
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, {height}]
stage = [{{ translate = [0.0, -0.2], steps = 1 }}]
[[measure]]
type = "reaction"
[tolerance.vary.c10]
distribution = "normal"
mean = 200.0
std = 10.0
"""
OUTLINE = """outer = [
  {{ edge = "foot", line = [[-2.0, 0.0], [2.0, 0.0]] }},
  {{ edge = "right", line = [[2.0, 0.0], [2.0, {height}]] }},
  {{ edge = "top", line = [[2.0, {height}], [-2.0, {height}]] }},
  {{ edge = "left", line = [[-2.0, {height}], [-2.0, 0.0]] }},
]"""


def draw(folder, height) -> None:
    """Write the drawing of a strip of another height."""
    path = folder / "outline.toml"
    outline = OUTLINE.format(height=height)
    path.write_text(STRIP.format(outline=outline, height=3.0), encoding="utf-8")
    sm.write_dxf(sm.read_seal_file(path).section.outline, folder / "strip.dxf")


def test_a_changed_drawing_is_another_study(tmp_path, capsys):
    pytest.importorskip("ezdxf")
    pytest.importorskip("netgen")
    draw(tmp_path, 3.0)
    file = tmp_path / "strip.toml"
    file.write_text(STRIP.format(outline='dxf = "strip.dxf"', height=3.0), encoding="utf-8")
    study = ["study", str(file), "--samples", "2", "--workers", "0", "--out", str(tmp_path)]
    assert main(study) == 0
    # the same files: nothing is left to do
    assert main(study) == 0
    assert "2 of 2 samples are already" in capsys.readouterr().out
    # the same text of the seal file, a lower section
    draw(tmp_path, 2.9)
    with pytest.raises(SystemExit) as ended:
        main(study)
    assert ended.value.code == 2
    assert "another seal" in capsys.readouterr().err

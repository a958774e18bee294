"""Narrow notches of a section are named with their angle and the reach of the supports."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.outline.notches import narrowest_notch

NOTCHED = """
[material.rubber]
shore_a = 60
[section]
material = "rubber"
spacing = 1.0
outer = [
  {{ edge = "base", line = [[0, 0], [10, 0], [10, 6]] }},
  {{ edge = "top", line = [[10, 6], [{right}, 6], [5, 3], [{left}, 6], [0, 6]] }},
  {{ edge = "base", line = [[0, 6], [0, 0]] }},
]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.2
contact = ["top"]
line = [[-30, 0], [30, 0]]
start = [5, 6]
stage = [{{ translate = [0, -0.5], steps = 2 }}]
"""
HOLE = 'hole = [{ edge = "hole", line = [[4, 1], [5, 4.2], [6, 1], [4, 1]] }]'
"""A triangle whose corners are wedges of rubber's void, one of 35 degrees."""


def seal_of(tmp_path, degrees, change=lambda text: text):
    half = 3.0 * np.tan(0.5 * np.radians(degrees))
    path = tmp_path / "notched.toml"
    path.write_text(change(NOTCHED.format(left=5.0 - half, right=5.0 + half)))
    return unchosen_seal(sm.read_seal_file(path))


@pytest.mark.parametrize("degrees", [20.0, 55.0])
def test_a_narrow_notch_is_reported(tmp_path, degrees):
    seal = seal_of(tmp_path, degrees)
    (text,) = [own for own in seal.warnings if "notch" in own]
    assert f"the notch at x = 5, y = 3 has an angle of {degrees:.0f} degrees" in text
    vertex = int(np.flatnonzero((seal.nominal_particles == [5.0, 3.0]).all(axis=1))[0])
    assert f"{seal.body.support_radius[vertex]:.2g} mm from the vertex" in text
    assert "edge_spacing" in text


def test_wide_notches_and_convex_corners_are_not(tmp_path):
    assert not [own for own in seal_of(tmp_path, 65.0).warnings if "notch" in own]


def test_corners_of_holes_are_notches(tmp_path):
    def change(text):
        block = 'top", line = [[10, 6], [0, 6]] }},\n'.replace("}}", "}")
        begin, end = text.index('top", line'), text.index('  { edge = "base", line = [[0, 6]')
        return (text[:begin] + block + text[end:]).replace("[fixed]", f"{HOLE}\n[fixed]")

    seal = seal_of(tmp_path, 60.0, change)
    notch = narrowest_notch(seal.boundaries, seal.loops, seal.body.support_radius)
    assert notch.place == pytest.approx([5.0, 4.2])
    assert notch.angle == pytest.approx(2.0 * np.arctan(1.0 / 3.2))

"""Seals made again from their settings alone."""

import base64
import json
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.settings import seal_of

EXAMPLES = Path(__file__).parents[2] / "examples"
PAPER = EXAMPLES / "paper_seal.toml"
DRAWING = """
[material.rubber]
law = "neo_hookean"
c10 = 100.0
bulk_modulus = 80000.0
[section]
material = "rubber"
spacing = 1.0
dxf = 'drawings/plate.dxf'
[[profile]]
name = "punch"
friction = 0.2
normal_penalty = 1e4
tangent_penalty = 1e2
contact = ["top"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 3.2]
[[profile.stage]]
translate = [0.0, -0.4]
steps = 2
[fixed]
edges = ["bottom"]
"""


def same(one, other):
    assert one.key == other.key
    np.testing.assert_array_equal(one.nominal_particles, other.nominal_particles)
    assert one.settings() == other.settings()
    for own, again in zip(one.terms(), other.terms(), strict=True):
        if hasattr(own, "motion"):
            np.testing.assert_array_equal(own.motion.clearance, again.motion.clearance)
            np.testing.assert_array_equal(own.motion.retraction, again.motion.retraction)
            assert own.motion.names == again.motion.names


@pytest.mark.parametrize("change", [
    lambda seal: seal,
    lambda seal: seal.with_parameters({"door_friction": 0.125, "c10": 90.0}),
    lambda seal: seal.with_placements().with_parameters({"door_x": 0.5}),
    lambda seal: seal.with_placements().with_clearances({"door": (0.0, 0.25)}),
    lambda seal: seal.with_clearances({"door": (0.0, 0.25)}).with_retractions(
        {"door": [(0.0, 0.25), (0.0, 0.5)]}
    ),
])  # fmt: skip
def test_seal_of_a_file_and_what_is_made_of_it(change):
    seal = change(sm.build_seal(PAPER))
    same(seal, seal_of(seal.settings()))


def test_choice_that_is_missing_is_not_made_anew():
    file = EXAMPLES / "d_bulb.toml"
    seal = sm.read_seal_file(file)
    assert seal.leaves_open
    settings = {"seal_file": file.read_text(encoding="utf-8"), "beside": {}, "chosen": {}}
    with pytest.raises(ValueError, match="lacks the particles, load steps or contact penalties"):
        seal_of(json.dumps(settings))


def test_door_seal():
    seal = sm.door_seal(friction=0.3, door_radius=4.2)
    same(seal, seal_of(seal.settings()))


def test_file_with_a_drawing_beside_it_that_is_gone(tmp_path):
    corners = {
        "bottom": (0, 0, 4, 0),
        "right": (4, 0, 4, 3),
        "top": (4, 3, 0, 3),
        "left": (0, 3, 0, 0),
    }
    outer = "".join(
        f'[[section.outer]]\nedge = "{name}"\nline = [[{a}, {b}], [{c}, {d}]]\n'
        for name, (a, b, c, d) in corners.items()
    )
    plain = DRAWING.replace("dxf = 'drawings/plate.dxf'\n", "")
    head, tail = plain.split("[[profile]]\n", 1)
    path, folder = tmp_path / "seal.toml", tmp_path / "drawings"
    path.write_text(f"{head}{outer}[[profile]]\n{tail}")
    folder.mkdir()
    sm.write_dxf(sm.read_seal_file(path).section.outline, folder / "plate.dxf")
    path.write_text(DRAWING)
    seal = sm.build_seal(path)
    path.unlink()
    (folder / "plate.dxf").unlink()
    same(seal, seal_of(seal.settings()))


TARGET = '[[measure]]\ntype = "load_deflection_error"\nname = "{}"\ndata = {}\n'


@pytest.mark.parametrize("written", ['"Kräfte.csv"', "'Kräfte.csv'", r'"Kr\u00e4fte.csv"'])
def test_file_beside_it_whose_name_is_written_in_several_forms(tmp_path, written):
    text = PAPER.read_text(encoding="utf-8")
    text += TARGET.format("one", "'Kräfte.csv'") + TARGET.format("two", written)
    (tmp_path / "Kräfte.csv").write_text("travel_mm,force\n1.0,20\n")
    path = tmp_path / "seal.toml"
    path.write_text(text, encoding="utf-8")
    seal = sm.build_seal(path)
    assert seal.settings()
    same(seal, seal_of(seal.settings()))


def test_seal_that_is_not_that_of_the_file_has_no_settings():
    file = sm.read_seal_file(PAPER)
    seal = sm.build_seal(file)
    assert replace(seal, newton=sm.NewtonOptions(max_cuts=3)).settings() == ""
    other = sm.build_seal(replace(file, measures=()))
    assert other.settings() == ""
    assert other.key != seal.key != sm.build_seal(replace(file)).key


def packed(content):
    return base64.b64encode(zlib.compress(content)).decode("ascii")


@pytest.mark.parametrize(("wrong", "words"), [
    ({"seal_file": "["}, "the recorded seal file is not valid in this version"),
    ({"seal_file": 3}, "the recorded seal file is not valid in this version"),
    ({"seal_file": ""}, "the recorded seal file is not valid in this version"),
    ({"beside": None}, "the recorded seal file is not valid in this version"),
    ({"beside": {"../out.dxf": packed(b"")}}, "the recorded file name .* is not valid"),
    ({"beside": {"out.dxf": "!"}}, "the recorded seal file is not valid in this version"),
    ({"beside": {"out.dxf": packed(bytes(51 * 2**20))}}, "is larger than"),
    ({"chosen": {"step_ends": [1.0]}}, "lacks the particles, load steps or contact penalties"),
    ({"chosen": {"callback": "print"}}, "the recorded seal file is not valid in this version"),
    ({"parameters": {"nothing": 1.0}}, "the seal has no parameter"),
    ({"clearances": 3}, "settings do not describe a seal"),
    ({"retractions": 3}, "settings do not describe a seal"),
])  # fmt: skip
def test_settings_that_are_none(wrong, words):
    settings = json.loads(sm.build_seal(PAPER).settings()) | wrong
    with pytest.raises(ValueError, match=words):
        seal_of(json.dumps(settings))


def test_a_file_that_names_others_does_not_read_them_from_the_machine():
    settings = json.loads(sm.build_seal(PAPER).settings())
    text = settings["seal_file"].replace("[section]\n", '[section]\ncloud = "/etc/hostname"\n')
    with pytest.raises(ValueError, match="lacks a file to which the seal file refers"):
        seal_of(json.dumps(settings | {"seal_file": text}))


@pytest.mark.parametrize("text", ["", "{", "[" * 10**5, "[]", "3", '{"seal": 1}'])
def test_text_that_is_no_settings(text):
    with pytest.raises(ValueError, match=r"settings (do not describe a seal|describe neither)"):
        seal_of(text)

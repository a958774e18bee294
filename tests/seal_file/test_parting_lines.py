"""Regions of different rubber from the layers and texts of a drawing."""

import tomllib

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.file.export import write_design
from seal_mdao.seals.result import frozen_measures

ezdxf = pytest.importorskip("ezdxf")
pytest.importorskip("netgen")

FILE = """
[material.soft]
law = "neo_hookean"
c10 = 100.0
bulk_modulus = 4e4
[material.stiff]
law = "neo_hookean"
c10 = 400.0
bulk_modulus = 16e4
[section]
material = "soft"
spacing = 1.2
dxf = "block.dxf"
parting = ["split"]
[[section.region]]
material = "stiff"
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.2
normal_penalty = 1e4
tangent_penalty = 1e3
contact = ["top"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 5.2]
stage = [{ translate = [0.0, -0.6], steps = 2 }]
[[design]]
edges = ["top"]
parameters = 4
bound = 0.3
[[measure]]
type = "reaction"
"""


@pytest.fixture
def block(tmp_path):
    """A block of 8 mm by 5 mm; its rubbers meet in two lines that form a roof."""
    document = ezdxf.new("R2010", units=4)
    model = document.modelspace()
    corners = [(0, 0), (8, 0), (8, 5), (0, 5)]
    for name, i in (("base", 0), ("right", 1), ("top", 2), ("left", 3)):
        model.add_line(corners[i], corners[(i + 1) % 4], {"layer": name})
    model.add_lwpolyline([(0, 2), (4, 3), (8, 2)], dxfattribs={"layer": "split"})
    model.add_text("Stiff", dxfattribs={"layer": "notes"}).set_placement((3.0, 1.0))
    document.saveas(tmp_path / "block.dxf")
    return tmp_path / "block.toml"


def read(path, *changes):
    text = FILE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return sm.read_seal_file(path)


def roof(x):
    return 3.0 - 0.25 * np.abs(x - 4.0)


@pytest.mark.parametrize("at", ["", "at = [1.0, 1.0]"])
def test_parting_lines_divide_the_section(block, at):
    """At the text with the name of the material, or at a point."""
    file = read(block, ('material = "stiff"\n', f'material = "stiff"\n{at}\n'))
    assert file.section.regions[0].at == ((1.0, 1.0) if at else (3.0, 1.0))
    assert file.section.notice.endswith("1 entities on layer 'notes' (1)")
    seal = unchosen_seal(file)
    soft, stiff = seal.definitions[0].regions
    assert (soft.prefix, stiff.prefix) == ("soft_", "stiff_")
    corners = seal.nominal_particles[seal.body.cells]
    above = corners[..., 1] - roof(corners[..., 0])
    assert above[soft.cells].min() > -1e-9
    assert above[stiff.cells].max() < 1e-9


def test_a_design_of_two_rubbers_keeps_its_parting_line(block, tmp_path):
    pytest.importorskip("meshio")
    pytest.importorskip("tomli_w")
    file = read(block)
    seal = sm.build_seal(file)
    offsets = np.array([0.2, -0.1, 0.15, 0.1])
    result = sm.analyze(seal, offsets)
    assert result.converged, result.failure
    written = write_design(file, seal, offsets, frozen_measures(seal), tmp_path, "best")[0]
    again = sm.build_seal(written)
    # the same particles and parts, the line where they have moved it
    best = sm.analyze(again)
    assert best.reaction[-1] == pytest.approx(result.reaction[-1], rel=1e-9)
    assert tomllib.loads(written.read_text())["section"]["parting"] == ["split"]
    line = sm.read_seal_file(written).section.parting[0]
    on = np.abs(seal.nominal_particles[:, 1] - roof(seal.nominal_particles[:, 0])) < 1e-9
    assert len(line) == on.sum()
    assert np.abs(line[:, 1] - roof(line[:, 0])).max() > 1e-3
    # with new particles in place of the cloud
    text = written.read_text().replace('cloud = "best.vtu"', "spacing = 1.2")
    (tmp_path / "new.toml").write_text(text)
    fresh = sm.analyze(sm.build_seal(tmp_path / "new.toml"))
    assert fresh.reaction[-1, 1] == pytest.approx(result.reaction[-1, 1], rel=0.02)


ACROSS = [(0.0, 3.0), (4.0, 2.8), (8.0, 3.0)]
"""A line through a hole of radius 1 mm about (4, 2.5)."""


@pytest.fixture(params=["layer", "line"])
def across(block, request):
    """The block with a hole that the line between its rubbers crosses: in the drawing or the file."""
    document = ezdxf.readfile(block.with_suffix(".dxf"))
    model = document.modelspace()
    model.delete_entity(model.query("LWPOLYLINE").first)
    model.add_circle((4.0, 2.5), 1.0, {"layer": "cavity"})
    changes = []
    if request.param == "layer":
        model.add_lwpolyline(ACROSS, dxfattribs={"layer": "split"})
    else:
        line = f'material = "stiff"\nline = {[*map(list, ACROSS)]}\n'
        changes = [('parting = ["split"]\n', ""), ('material = "stiff"\n', line)]
    document.saveas(block.with_suffix(".dxf"))
    return read(block, *changes)


def test_a_line_between_rubbers_is_trimmed_at_a_hole(across):
    """The line is not divided elsewhere, its ends on the hole are those of the drawing."""
    left, right = across.section.cuts
    # |(4 - 4 t, 2.8 + 0.2 t) - (4, 2.5)| = 1:  16.04 t^2 + 0.12 t - 0.91 = 0
    t = (np.sqrt(0.12**2 + 4.0 * 16.04 * 0.91) - 0.12) / (2.0 * 16.04)
    ends = np.array([[4.0 - 4.0 * t, 2.8 + 0.2 * t], [4.0 + 4.0 * t, 2.8 + 0.2 * t]])
    np.testing.assert_allclose(left, [ACROSS[0], ends[0]], rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(right, [ends[1], ACROSS[2]], rtol=0.0, atol=1e-5)
    seal = unchosen_seal(across)
    soft, stiff = seal.definitions[0].regions
    corners = seal.nominal_particles[seal.body.cells]
    above = corners[..., 1] - 2.8 - 0.05 * np.abs(corners[..., 0] - 4.0)
    middles = corners[..., 0].mean(axis=1)
    beside = np.abs(middles - 4.0) > 1.0
    assert beside[soft.cells].any()
    assert beside[stiff.cells].any()
    assert above[soft.cells][beside[soft.cells]].min() > -1e-5
    assert above[stiff.cells][beside[stiff.cells]].max() < 1e-5


def test_a_design_keeps_a_line_across_a_hole(across, tmp_path):
    pytest.importorskip("meshio")
    pytest.importorskip("tomli_w")
    seal = sm.build_seal(across)
    offsets = np.array([0.2, -0.1, 0.15, 0.1])
    written = write_design(across, seal, offsets, frozen_measures(seal), tmp_path, "best")[0]
    design = sm.read_seal_file(written)
    again = sm.build_seal(design)
    np.testing.assert_array_equal(again.parts, seal.parts)
    # two parts, from the sides to the particles on the hole
    moved = seal.particles(offsets)
    for line, nominal in zip(design.section.cuts, across.section.cuts, strict=True):
        for end in (0, -1):
            own = np.hypot(*(seal.nominal_particles - nominal[end]).T).argmin()
            np.testing.assert_allclose(line[end], moved[own], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize(("changes", "words"), [
    ([('[[section.region]]\nmaterial = "stiff"\n', "")], "no effect without [[section.region]]"),
    ([('parting = ["split"]\n', "")], "layers read as boundary"),
    ([('parting = ["split"]', 'ignore = ["split"]')],
     "[[section.region]] 1: the key 'line' is missing; give the line"),
    ([('parting = ["split"]', 'parting = ["splt"]')], "'splt', but the drawing has no such layer"),
    ([('material = "stiff"\n', 'material = "hard"\n'), ("material.stiff", "material.hard")],
     "[[section.region]] 1: the key 'at' is missing, and the drawing has no text 'hard'; give a point"),
    ([('parting = ["split"]', "parting = []")], "it must be a list of layers, such as"),
    ([('dxf = "block.dxf"', 'outer = [{ edge = "base", circle = { centre = [0, 0], radius = 4 } }]')],
     "parting names layers of a drawing"),
])  # fmt: skip
def test_what_does_not_fit_the_drawing_is_refused(block, changes, words):
    with pytest.raises(sm.SealFileError) as caught:
        read(block, *changes)
    assert words in str(caught.value)

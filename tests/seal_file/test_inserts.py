"""Inserts of another material inside a section, whose interface is a closed line."""

import tomllib

import numpy as np
import pytest
from exact_gradients import require_exact

import seal_mdao as sm
from seal_mdao.errors import SealFileError
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.seals.file.export import write_design
from seal_mdao.seals.result import frozen_measures

pytest.importorskip("netgen")

RING = [[-1.5, 1.5], [1.5, 1.5], [1.5, 2.5], [-1.5, 2.5], [-1.5, 1.5]]
BLOCK = """
[material.soft]
law = "neo_hookean"
c10 = 100.0
bulk_modulus = 2e4
[material.insert]
law = "neo_hookean"
c10 = C10
bulk_modulus = BULK
[section]
material = "soft"
spacing = 0.4
layers = 5
outer = [
  { edge = "base", line = [[LEFT, 0.0], [4.0, 0.0]] },
  { edge = "right", line = [[4.0, 0.0], [4.0, 4.0]] },
  { edge = "top", line = [[4.0, 4.0], [LEFT, 4.0]] },
  { edge = "left", line = [[LEFT, 4.0], [LEFT, 0.0]] },
]
region = [{ material = "insert", at = [0.5, 2.0], line = LINE }]
[[moved]]
edges = ["base"]
stage = [{ translate = [0.0, 0.3], steps = 3 }]
[[moved]]
edges = ["top"]
stage = [{ translate = [0.0, -0.3], steps = 3 }]
[[measure]]
type = "reaction"
profile = "top"
component = "y"
[[design]]
edges = ["right"]
parameters = 5
bound = 0.3
"""
REGION = 'region = [{ material = "insert", at = [0.5, 2.0], line = LINE }]\n'
HALF = [[0.0, 1.5], [1.5, 1.5], [1.5, 2.5], [0.0, 2.5]]
SIDE = '[[symmetry]]\nedges = ["left"]\nnormal = "x"\n'
INSERT_LAW = BLOCK[BLOCK.index("[material.insert]") : BLOCK.index("[section]")]


def read(tmp_path, text=BLOCK, line=RING, c10=100.0, bulk=2e4, left=-4.0):
    path = tmp_path / "block.toml"
    for name, value in (("LINE", line), ("C10", c10), ("BULK", bulk), ("LEFT", left)):
        text = text.replace(name, str(value))
    path.write_text(text, encoding="utf-8")
    return sm.read_seal_file(path)


def force(file) -> float:
    result = sm.analyze(sm.build_seal(file))
    result.require_converged()
    return result.value("reaction")[0]


def inside(seal) -> float:
    """Area of the cells of the insert, mm^2."""
    cells = seal.body.cells[seal.parts == 1]
    return sum(polygon_area(seal.nominal_particles[own])[0] for own in cells)


def test_the_interface_is_the_closed_line(tmp_path):
    seal = sm.build_seal(read(tmp_path, c10=400.0))
    assert inside(seal) == pytest.approx(3.0, rel=1e-12)
    assert not seal.warnings


def test_a_uniform_strain_passes_through_an_insert_of_the_same_rubber(tmp_path):
    """Confined on both sides: F = diag(1, 1 - 0.04 / 4), P_22 of the law, on all 8 mm."""
    sides = SIDE + SIDE.replace("left", "right")
    text = BLOCK[: BLOCK.index("[[design]]")].replace("0.3]", "0.02]") + sides
    found = force(read(tmp_path, text))
    stretch = 1.0 - 0.04 / 4.0
    # W = C10 (J^(-2/3) (1 + J^2 + 1) - 3) + K/2 (J - 1)^2 with J = stretch
    slope = 100.0 * (4.0 / 3.0 * stretch ** (1 / 3) - 4.0 / 3.0 * stretch ** (-5 / 3))
    slope += 2e4 * (stretch - 1.0)
    assert abs(found) == pytest.approx(8.0 * abs(slope), rel=1e-8)


@pytest.mark.parametrize("stiffer", [1.0, 10.0, 1e4])
def test_a_half_section_with_an_open_line_has_half_of_the_force(tmp_path, stiffer):
    """Of a soft, a stiff and a nearly rigid insert."""
    law = {"c10": 100.0 * stiffer, "bulk": 2e4 * stiffer}
    text = BLOCK.replace("spacing = 0.4", "spacing = 0.3")
    half = force(read(tmp_path, text + SIDE, HALF, left=0.0, **law))
    assert force(read(tmp_path, text, **law)) == pytest.approx(2.0 * half, rel=1e-2)


def test_gradients_of_a_section_with_an_insert(tmp_path):
    result = sm.analyze(sm.build_seal(read(tmp_path, c10=400.0, bulk=8e4)))
    require_exact(result, ["reaction"], 1e-3)


def test_a_design_keeps_its_insert(tmp_path):
    pytest.importorskip("meshio")
    pytest.importorskip("tomli_w")
    file = read(tmp_path, c10=400.0, bulk=8e4)
    seal = sm.build_seal(file)
    offsets = np.full(seal.n_offsets, 0.2)
    result = sm.analyze(seal, offsets)
    written = write_design(file, seal, offsets, frozen_measures(seal), tmp_path, "best")[0]
    (region,) = tomllib.loads(written.read_text(encoding="utf-8"))["section"]["region"]
    assert region["line"][0] == region["line"][-1]
    again = sm.analyze(sm.build_seal(written))
    assert again.value("reaction")[0] == pytest.approx(result.value("reaction")[0], rel=1e-9)
    # with new particles in place of the cloud
    text = written.read_text(encoding="utf-8")
    text = text.replace('cloud = "best.vtu"', "spacing = 0.4\nlayers = 5")
    (tmp_path / "new.toml").write_text(text, encoding="utf-8")
    fresh = sm.analyze(sm.build_seal(tmp_path / "new.toml"))
    assert fresh.value("reaction")[0] == pytest.approx(result.value("reaction")[0], rel=0.02)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (
            [[-1, 1], [1, 1], [1, 4], [-1, 4], [-1, 1]],
            "is closed, but touches or leaves the section",
        ),
        ([[-5, 1], [1, 1], [1, 2], [-5, 2], [-5, 1]], r"leaves the section at \(-"),
        ([[-1, 1], [1, 2], [1, 1], [-1, 2], [-1, 1]], "crosses itself"),
        ([[-1, 1], [1, 1], [-1, 1]], "crosses itself"),
        ([[-1, 1], [1, 1], [1, 1.001], [-1, 1]], "back to this point encloses no area"),
    ],
)
def test_closed_lines_that_are_no_interface_are_refused(tmp_path, line, words):
    with pytest.raises(SealFileError, match=rf"\[\[section.region\]\] 1: line .*{words}"):
        read(tmp_path, line=line)


def test_a_liner_around_a_hole(tmp_path):
    """A closed line around a hole: the region is the ring between them."""
    hole = 'hole = [{ edge = "bore", circle = { centre = [0.0, 2.0], radius = 0.8 } }]\n'
    text = BLOCK.replace(REGION, hole + REGION.replace("[0.5, 2.0]", "[1.2, 2.0]"))
    around = 1.4 * np.column_stack([f(np.linspace(0.0, 2.0 * np.pi, 25)) for f in (np.cos, np.sin)])
    line = (around + np.array([0.0, 2.0])).tolist()
    line[-1] = line[0]
    seal = sm.build_seal(read(tmp_path, text, line, 400.0))
    bore = seal.nominal_particles[seal.loops[1]]
    exact = polygon_area(np.array(line[:-1]))[0] - abs(polygon_area(bore)[0])
    assert inside(seal) == pytest.approx(exact, rel=1e-9)


def test_two_inserts(tmp_path):
    """Of which one lies inside the other, such as a wire in a tube."""
    outer = [[-2.5, 1.0], [2.5, 1.0], [2.5, 3.0], [-2.5, 3.0], [-2.5, 1.0]]
    more = INSERT_LAW.replace("insert", "tube")
    text = more + BLOCK.replace(
        REGION, REGION[:-2] + f', {{ material = "tube", at = [2.0, 2.0], line = {outer} }}]\n'
    )
    file = read(tmp_path, text, c10=200.0)
    seal = sm.build_seal(file)
    assert inside(seal) == pytest.approx(3.0, rel=1e-12)
    tube = seal.body.cells[seal.parts == 2]
    area = sum(polygon_area(seal.nominal_particles[own])[0] for own in tube)
    assert area == pytest.approx(10.0 - 3.0, rel=1e-12)

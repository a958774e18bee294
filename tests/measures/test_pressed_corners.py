"""Warning of a sharp corner whose contact point stands for both sides."""

import pytest

import seal_mdao as sm

BLOCK = """
{symmetry}
[material.rubber]
shore_a = 60
[section]
spacing = 0.8
outer = [
  {{ edge = "foot", line = [[0, 0], [4, 0]] }},
  {{ edge = "side", line = [[4, 0], [4, 3]] }},
  {{ edge = "head", line = [[4, 3], [0, 3]] }},
  {{ edge = "middle", line = [[0, 3], [0, 0]] }},
]
[fixed]
edges = ["foot"]
directions = ["y"]
[[profile]]
name = "top"
friction = 0.0
{contact}
contact_points = "{points}"
{shape}
start = [0, 3]
normal_penalty = 1e6
tangent_penalty = 1e5
stage = [{{ translate = [0, -0.3], steps = 3 }}]
[[measure]]
type = "{measure}"
"""
SYMMETRY = 'symmetry = [{ edges = ["middle"], normal = "x" }]'
ALL = 'contact = ["side", "head"]'
PRESSED = 'contact = ["head"]'


FLAT = "line = [[-40, 0], [40, 0]]"
NOSE = "arc = { start = [-6, 4], through = [0, 0], end = [6, 4] }"


def pressed(folder, contact, points="averages", measure="peak_pressure", shape=FLAT):
    path = folder / "block.toml"
    path.write_text(
        BLOCK.format(
            symmetry=SYMMETRY, contact=contact, points=points, measure=measure, shape=shape
        )
    )
    result = sm.analyze(sm.build_seal(path))
    return result, [own for own in result.warnings if "sharp corner" in own]


@pytest.mark.parametrize("points", ["averages", "particles"])
@pytest.mark.parametrize("contact", ["", ALL], ids=["filled in", "given"])
def test_a_corner_with_a_free_side_in_the_list_is_reported(tmp_path, contact, points):
    """The pressure of the block is uniform; the contact point at its corner has another."""
    result, (warning,) = pressed(tmp_path, contact, points)
    assert (
        "'top' presses on a sharp corner of the section, at x = 4, y = 3 (undeformed coordinates)"
        in warning
    )
    pressure = -result.response("top").gap * 1e6
    pressure = pressure[pressure > 0.0]
    assert pressure.max() > 1.03 * pressure.min()


def test_a_list_of_pressed_edges_gives_the_uniform_pressure(tmp_path):
    result, warnings = pressed(tmp_path, PRESSED)
    assert warnings == []
    pressure = -result.response("top").gap * 1e6
    assert pressure == pytest.approx(pressure.mean(), rel=1e-9)


@pytest.mark.parametrize(
    ("points", "measure"), [("edges", "peak_pressure"), ("averages", "reaction")]
)
def test_no_warning_without_a_corner_point_or_a_pressure(tmp_path, points, measure):
    assert pressed(tmp_path, ALL, points, measure)[1] == []


def test_a_corner_that_is_not_pressed_is_no_fault(tmp_path):
    result, warnings = pressed(tmp_path, ALL, "averages", shape=NOSE)
    assert warnings == []
    assert (result.response("top").gap < 0.0).any()

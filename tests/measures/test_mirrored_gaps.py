"""Gaps that a plane of symmetry or the axis of revolution cuts in the middle."""

import numpy as np
import pytest
from exact_gradients import require_exact

import seal_mdao as sm
from seal_mdao.measures.gap import open_between
from seal_mdao.measures.selection import contact_range, mirrored_ends
from seal_mdao.plotting.contact_curves import gap_profile

HOLLOW = """
HEAD
[material.rubber]
law = "mooney_rivlin"
c10 = 400.0
c01 = 100.0
bulk_modulus = 20000.0
[section]
spacing = 0.4
outer = [
  { edge = "base", line = [[LEFT, 0.0], [4.0, 0.0]] },
  { edge = "side", line = [[4.0, 0.0], [4.0, 1.5]] },
  { edge = "cap", line = CAP },
  { edge = "axis", line = [[LEFT, END], [LEFT, 0.0]] },
]
[fixed]
edges = ["base"]
[[profile]]
name = "lid"
friction = 0.3
normal_penalty = 1e4
tangent_penalty = 3e3
contact = ["side", "cap"]
CURVE
start = [0.0, 2.0]
stage = [{ translate = [0.0, -0.2], steps = 3 }]
[[measure]]
type = "largest_gap"
[[measure]]
type = "gap_square_integral"
[[measure]]
type = "gap"
[[design]]
edges = ["cap"]
parameters = 4
bound = 0.1
"""
LID = "line = [[-50.0, 0.0], [50.0, 0.0]]"
PLANE = 'symmetry = [{ edges = ["axis"], normal = "x" }]'
HALF = ("0.0", "[[4.0, 1.5], [2.0, 2.0], [0.0, 1.6]]", "1.6")
WHOLE = ("-4.0", "[[4.0, 1.5], [2.0, 2.0], [0.0, 1.6], [-2.0, 2.0], [-4.0, 1.5]]", "1.5")


def pressed(tmp_path, head, part, curve=LID):
    """A pad whose top is hollow in the middle, or its half, below a lid."""
    left, cap, end = part
    text = HOLLOW.replace("HEAD", head).replace("CURVE", curve)
    path = tmp_path / "pad.toml"
    path.write_text(text.replace("LEFT", left).replace("CAP", cap).replace("END", end))
    return sm.analyze(sm.build_seal(sm.read_seal_file(path)))


def test_a_half_has_the_gap_of_the_complete_section(tmp_path):
    whole, half = pressed(tmp_path, "", WHOLE), pressed(tmp_path, PLANE, HALF)
    whole.require_converged()
    half.require_converged()
    # other particles in both; the integral is that of the half
    assert half.largest_gap[0] == pytest.approx(whole.largest_gap[0], rel=0.1)
    assert half.largest_gap[0] > 0.1
    integral = half.gap_square_integral[0], whole.gap_square_integral[0]
    assert 2.0 * integral[0] == pytest.approx(integral[1], rel=0.2)
    # the points beside the plane, the last of the edge
    response = half.response("lid")
    np.testing.assert_array_equal(open_between(half, "lid")[-1], len(response.gap) - 1)
    assert half.gap.max() == response.gap[-1]
    # and in the figure
    (axes,) = gap_profile(half).axes
    drawn = np.concatenate([np.asarray(line.get_ydata(), float) for line in axes.lines])
    assert drawn.max() == response.gap[-1]
    require_exact(half, ["largest_gap", "gap_square_integral"], 1e-4)


def test_a_body_of_revolution_has_a_gap_at_its_axis(tmp_path):
    result = pressed(tmp_path, '[model]\nkinematics = "axisymmetric"', HALF)
    assert result.largest_gap[0] >= result.response("lid").gap[-1] > 0.1
    require_exact(result, ["largest_gap", "gap_square_integral"], 1e-4)


@pytest.mark.parametrize(
    ("curve", "mirrored"),
    [
        (LID, (False, True)),
        ("circle = { centre = [0.0, 31.0], radius = 30.0 }", (False, True)),
        ("circle = { centre = [2.0, 31.0], radius = 30.0 }", (False, False)),
        ("line = [[-50.0, 0.5], [50.0, 1.5]]", (False, False)),
    ],
)
def test_a_profile_that_is_not_its_own_mirror_image_closes_no_gap(tmp_path, curve, mirrored):
    result = pressed(tmp_path, PLANE, HALF, curve)
    assert mirrored_ends(result.term("lid")) == mirrored


@pytest.mark.parametrize(
    ("touching", "mirrored", "points"),
    [
        ([0, 0, 1, 0, 0], (False, False), [2]),
        ([0, 0, 1, 0, 0], (True, False), [0, 1, 2]),
        ([0, 0, 1, 0, 0], (False, True), [2, 3, 4]),
        # both halves form a closed boundary: all but its longest open part
        ([0, 0, 0, 1, 0], (True, True), [3, 4]),
        ([0, 1, 0, 0, 0], (True, True), [0, 1]),
        ([1, 0, 0, 1, 0], (True, True), [0, 1, 2, 3, 4]),
        ([0, 0, 0, 0, 0], (False, True), []),
    ],
)
def test_points_from_the_first_to_the_last_contact_and_its_mirror_image(touching, mirrored, points):
    assert contact_range(np.array(touching, bool), False, mirrored).tolist() == points

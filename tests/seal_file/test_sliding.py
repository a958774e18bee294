"""A body that nothing prevents from sliding along a line is refused: its position is arbitrary."""

import re
from dataclasses import replace

import numpy as np
import pytest
from ring_files import HEAD
from seal_file.block_files import BETWEEN_PLATES, FIXED, file_of, text

import seal_mdao as sm
from seal_mdao.analysis.path_result import Status
from seal_mdao.errors import SealFileError

PLATES = BETWEEN_PLATES[BETWEEN_PLATES.index("[[profile]]") :]
ROLLERS = FIXED + 'directions = ["y"]\n'
LID = '[[profile]]\nname = "lid"\nfriction = 0.0\nline = [[-9, 0], [9, 0]]\nstart = [0, 4]\n'
DOWN = "stage = [{ translate = [0, -0.05], steps = 2 }]\n"
MOVED = '[[moved]]\nedges = ["top"]\ndirections = ["y"]\n' + DOWN


@pytest.mark.parametrize("tables", [
    [PLATES.format(friction=0.0)], [ROLLERS, LID + DOWN], [ROLLERS, MOVED],
    [ROLLERS, LID + DOWN, '[self_contact]\nedges = ["left", "right"]\nfriction = 0.5\n'],
    [ROLLERS, LID.replace("0.0", "{ top = 0.0, right = 0.0, left = 0.0 }") + DOWN],
])  # fmt: skip
def test_a_section_that_can_slide_is_refused(tmp_path, tables):
    with pytest.raises(SealFileError, match="the section can slide along x without resistance"):
        file_of(tmp_path, *tables)


@pytest.mark.parametrize("tables", [
    [PLATES.format(friction=0.1)], [FIXED, LID + DOWN], [ROLLERS, LID.replace("0.0", "0.2") + DOWN],
    [ROLLERS, LID.replace("[9, 0]", "[9, 1]").replace("[0, 4]", "[0, 4.5]") + DOWN],
    [ROLLERS, '[[symmetry]]\nedges = ["left"]\nnormal = "x"\n', LID + DOWN],
    [ROLLERS, LID + DOWN.replace("steps", "rotate = 2.0, steps")],
])  # fmt: skip
def test_supports_friction_and_inclined_profiles_prevent_sliding(tmp_path, tables):
    assert file_of(tmp_path, *tables).fixed_edges is not None


UPPER = """outer = [
  { edge = "base", line = [[-4, 0], [4, 0]] }, { edge = "right", line = [[4, 0], [4, 2]] },
  { edge = "joint", line = [[4, 2], [-4, 2]] }, { edge = "left", line = [[-4, 2], [-4, 0]] },
  { body = 2, edge = "under", line = [[-4, 2.01], [4, JOINT]] },
  { body = 2, edge = "upper_right", line = [[4, JOINT], [4, 4]] },
  { body = 2, edge = "top", line = [[4, 4], [-4, 4]] },
  { body = 2, edge = "upper_left", line = [[-4, 4], [-4, 2.01]] },
]
"""
BETWEEN = '[self_contact]\nedges = ["joint", "under"]\n'
PAIR = '[[self_contact.pair]]\nedges = ["joint", "under"]\nfriction = {}\n'


def stack_of(folder, *tables, joint="2.01"):
    """The block of two bodies that lie on each other."""
    one = text(*tables)
    outer = one[one.index("outer = [") : one.index("]\n", one.index("left"))] + "]\n"
    path = folder / "stack.toml"
    path.write_text(one.replace(outer, UPPER.replace("JOINT", joint)), encoding="utf-8")
    return sm.read_seal_file(path)


@pytest.mark.parametrize(("tables", "joint"), [
    ([FIXED, LID + DOWN, BETWEEN + "friction = 0.0\n"], "2.01"),
    ([FIXED, LID + DOWN, BETWEEN + "friction = 0.3\n"], "2.01"),
    ([FIXED, LID + DOWN, BETWEEN + PAIR.format(0.3)], "2.01"),
    # an inclined joint
    ([FIXED, LID + DOWN, BETWEEN + "friction = 0.0\n"], "2.5"),
])  # fmt: skip
def test_a_body_that_only_contact_with_another_one_would_hold_is_refused(tmp_path, tables, joint):
    """They are apart at the start: rounding decided between 0.5 mm, 1.2 m and a failure."""
    what = re.escape("body 2 (edge 'under') can slide along x without resistance")
    with pytest.raises(SealFileError, match=what + ".* does not hold it at the start"):
        stack_of(tmp_path, *tables, joint=joint)


def test_the_first_of_two_bodies_that_can_slide_is_named(tmp_path):
    with pytest.raises(SealFileError, match=re.escape("body 1 (edge 'base') can slide along x")):
        stack_of(tmp_path, ROLLERS, LID + DOWN, BETWEEN + "friction = 0.3\n")


def test_a_profile_with_friction_prevents_a_body_from_sliding_on_another_one(tmp_path):
    lid = LID.replace("0.0", "0.2") + DOWN
    file = stack_of(tmp_path, FIXED, lid, BETWEEN + "friction = 0.0\n")
    assert len(file.section.outline.bodies) == 2


def test_a_body_that_slides_out_of_a_wedge_is_reported(tmp_path):
    """Nothing resists: it moves by u_x = 0.4 / tan 1 deg = 22.9 mm, and the plate by 0.4 mm."""
    lid = LID.replace("[[-9, 0], [9, 0]]", "[[-90, 0], [90, 0]]\nangle = 1").replace(
        "[0, 4]", "[-4, 4]"
    )
    down = "stage = [{ translate = [0, -0.4], steps = 8 }]\n"
    result = sm.analyze(sm.build_seal(file_of(tmp_path, ROLLERS, lid + down)))
    assert not result.trustworthy
    (said,) = [own for own in result.warnings if "nothing holds it" in own]
    assert "has moved by 22.9 mm, although no profile moves by more than 0.4 mm" in said
    # of a path that ends before: the same at its last converged step
    ended = replace(result.path, status=Status.NOT_CONVERGED, steps=result.path.steps[:-1])
    failed = replace(result, path=ended)
    assert re.search(
        r"At the last converged load step the body near .* has moved by ", failed.failure
    )


def test_the_line_between_inclined_plates_is_named(tmp_path):
    """The block and both plates are turned by 30 degrees."""
    turn = np.array([[0.75**0.5, -0.5], [0.5, 0.75**0.5]])
    corners = [(turn @ own).tolist() for own in ([-4, 0], [4, 0], [4, 4], [-4, 4])]
    outer = "".join(
        f'[[section.outer]]\nedge = "{name}"\nline = {[corners[k], corners[(k + 1) % 4]]}\n'
        for k, name in enumerate(("base", "right", "top", "left"))
    )
    material = text().partition("[section]")[0]
    plates = PLATES.format(friction=0.0).replace("[9, 0], [-9, 0]]", "[9, 0], [-9, 0]]\nangle = 30")
    plates = plates.replace("start = [0, 4]", f"start = {(turn @ [0.0, 4.0]).tolist()}\nangle = 30")
    path = tmp_path / "turned.toml"
    path.write_text(f"{material}[section]\nspacing = 1.0\n{outer}{plates}")
    with pytest.raises(SealFileError, match=r"can slide along the direction \(0.866, 0.5\)"):
        sm.read_seal_file(path)


def test_a_ring_can_slide_along_its_axis_only(tmp_path):
    block = HEAD.format(bulk=2e3, spacing=0.5) + (
        'outer = [\n  { edge = "base", line = [[4, 0], [6, 0]] },\n'
        '  { edge = "outer", line = [[6, 0], [6, 2]] },\n'
        '  { edge = "rest", line = [[6, 2], [4, 2], [4, 0]] },\n]\n'
    )
    bore = (
        '[[profile]]\nname = "bore"\ncontact = ["outer"]\nfriction = {friction}\n'
        "line = [[6, 9], [6, -9]]\nstage = [{{ translate = [-0.1, 0], steps = 2 }}]\n"
    )
    path = tmp_path / "ring.toml"
    path.write_text(block + bore.format(friction=0.0))
    with pytest.raises(SealFileError, match="can slide along y"):
        sm.read_seal_file(path)
    held = '[fixed]\nedges = ["base"]\ndirections = ["y"]\n'
    for tables in (bore.format(friction=0.1), bore.format(friction=0.0) + held):
        path.write_text(block + tables)
        assert sm.read_seal_file(path).axisymmetric

"""Half of a section on a plane of symmetry: which force belongs to half of the seal."""

from types import SimpleNamespace

import pytest
from block_files import FIXED, MOVED, text

import seal_mdao as sm
from seal_mdao.plotting.captions import seal_text
from seal_mdao.seals.file.file_tables import SealFile

PLANE = '[[symmetry]]\nedges = ["{}"]\nnormal = "{}"\n'


@pytest.mark.parametrize(("normals", "rotated", "words"), [
    ("", False, ""),
    ("x", False, "half of the section: double the vertical force for the complete one"),
    ("y", True, "half of the section: double the radial force for the complete one"),
    ("yx", False, "a quarter of the section: double the vertical and horizontal force for the "
     "complete one"),
])  # fmt: skip
def test_the_force_along_the_plane_is_that_of_half_a_seal(normals, rotated, words):
    planes = tuple(SimpleNamespace(normal=own) for own in normals)
    file = SimpleNamespace(symmetries=planes, axisymmetric=rotated)
    assert SealFile.part.fget(file) == words


def test_captions_say_so(tmp_path):
    path = tmp_path / "half.toml"
    path.write_text(text(FIXED, MOVED, PLANE.format("left", "x")), encoding="utf-8")
    assert "half of the section: double the vertical force" in seal_text(sm.read_seal_file(path))
    path.write_text(text(FIXED, MOVED), encoding="utf-8")
    assert "half" not in seal_text(sm.read_seal_file(path))

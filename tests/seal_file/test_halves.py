"""Half of a section on a plane of symmetry: which force belongs to half of the seal."""

from types import SimpleNamespace

import pytest

import seal_mdao as sm
from seal_mdao.plotting.captions import seal_text
from seal_mdao.seals.file.file_tables import SealFile


@pytest.mark.parametrize(("normals", "rotated", "words"), [
    ("", False, ""),
    ("x", False, "half section: double its vertical force"),
    ("y", True, "half section: double its radial force"),
    ("yx", False, "quarter section: double its vertical and horizontal force"),
])  # fmt: skip
def test_the_force_along_the_plane_is_that_of_half_a_seal(normals, rotated, words):
    planes = tuple(SimpleNamespace(normal=own) for own in normals)
    file = SimpleNamespace(symmetries=planes, axisymmetric=rotated)
    assert SealFile.part.fget(file) == words


def test_captions_say_so():
    """Beside the materials, before the conditions."""
    seal = SimpleNamespace(materials={"foam": sm.NeoHookean(1.0, 1e3)}, conditions=dict)
    assert seal_text(seal) == "foam (Neo-Hookean)"
    seal.part = "half section: double its vertical force"
    assert seal_text(seal) == "foam (Neo-Hookean), half section: double its vertical force"

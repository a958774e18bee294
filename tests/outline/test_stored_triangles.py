"""The triangles inside a section are stored for the next run, which does not call the mesher."""

import numpy as np
import pytest

from seal_mdao import user_cache
from seal_mdao.seals.outline import mesher

pytest.importorskip("netgen")

ANGLES = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
CIRCLE = 5.0 * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
CUT = CIRCLE[[0, 12]]


@pytest.fixture
def meshes(tmp_path, monkeypatch):
    """Meshes that Netgen makes while triangles are stored in a folder of the test."""
    monkeypatch.setenv(user_cache.FOLDER, str(tmp_path))
    made, netgen = [], mesher._netgen

    def counted():
        made.append(1)
        return netgen()

    monkeypatch.setattr(mesher, "_netgen", counted)
    return made


@pytest.mark.parametrize("cuts", [(), (CUT,)])
def test_stored_triangles_are_the_same_bits(meshes, cuts):
    first, again = (mesher.triangulate([CIRCLE], 1.0, cuts) for _ in range(2))
    assert len(meshes) == 1
    assert np.unique(first.parts).size == 1 + len(cuts)
    for own, other in zip(first, again, strict=True):
        assert own.dtype == other.dtype
        assert own.tobytes() == other.tobytes()


def test_other_points_sizes_and_cuts_have_other_triangles(meshes):
    given = [([CIRCLE], 1.0), ([CIRCLE], 1.1), ([CIRCLE], 1.0, [CUT])]
    moved = CIRCLE.copy()
    moved[3, 0] = np.nextafter(moved[3, 0], 0.0)
    for arguments in (*given, ([moved], 1.0)):
        mesher.triangulate(*arguments)
    assert len(meshes) == 4


def test_another_version_of_the_mesher_makes_other_triangles(meshes, monkeypatch):
    mesher.triangulate([CIRCLE], 1.0)
    monkeypatch.setattr(user_cache, "version", lambda name: f"another {name}")
    user_cache._code.cache_clear()
    mesher.triangulate([CIRCLE], 1.0)
    user_cache._code.cache_clear()
    assert len(meshes) == 2


def test_what_cannot_be_filled_is_not_stored(meshes, tmp_path):
    for _ in range(2):
        with pytest.raises(mesher.GeometryError):
            mesher.triangulate([CIRCLE], 1.0, [CIRCLE[[0, 0]]])
    assert not list(tmp_path.iterdir())

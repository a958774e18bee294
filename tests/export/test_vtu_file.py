"""VTU files, read back by meshio."""

import numpy as np
import pytest

from seal_mdao.export.vtu_file import write_vtu

meshio = pytest.importorskip("meshio")


def test_points_cells_and_data_are_read_back(tmp_path):
    random = np.random.default_rng(1)
    # more bytes than meshio would put into one block
    points = random.normal(size=(5000, 3))
    cells = [
        ("quad", random.integers(0, 5000, (700, 4))),
        ("triangle", random.integers(0, 5000, (300, 3))),
    ]
    data = {
        "displacement": random.normal(size=(5000, 3)),
        "stress": random.normal(size=5000),
        "number": np.arange(5000),
        "ones": np.ones(5000),
    }
    write_vtu(tmp_path / "made.vtu", points, cells, data)
    found = meshio.read(tmp_path / "made.vtu")
    assert np.array_equal(found.points, points)
    assert [own.type for own in found.cells] == ["quad", "triangle"]
    for own, (_, corners) in zip(found.cells, cells, strict=True):
        assert np.array_equal(own.data, corners)
    assert found.point_data.keys() == data.keys()
    for name, values in data.items():
        assert np.array_equal(found.point_data[name], values)
        assert found.point_data[name].dtype == values.dtype

"""Rays in a file have kernels, basis, pressure and integration of the door seal of their accuracy."""

from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.errors import GeometryError, SealFileError
from seal_mdao.seals.outline.cloud_file import read_cloud, write_cloud

PAPER = (Path(__file__).parents[2] / "examples" / "paper_seal.toml").read_text(encoding="utf-8")
RAYS = 'rays = { rays = 58, layers = 3, accuracy = "paper" }'


def file_with(folder, rays):
    assert RAYS in PAPER
    path = folder / "seal.toml"
    path.write_text(PAPER.replace(RAYS, rays), encoding="utf-8")
    return sm.read_seal_file(path)


@pytest.mark.parametrize(
    ("accuracy", "keys"), [("engineering", ""), ("fine", ', accuracy = "fine"')]
)
def test_its_path_is_that_of_the_accurate_door_seal(tmp_path, accuracy, keys):
    seal = sm.build_seal(file_with(tmp_path, f"rays = {{ rays = 58, layers = 4{keys} }}"))
    door = sm.door_seal(accuracy, rays=58, layers=4, contact_points="particles", n_steps=105)
    assert np.abs(seal.body.support_axes - door.body.support_axes).max() < 1e-13
    assert (seal.body.basis_order, seal.body.column) == (2, 3)
    assert seal.body.n_gauss == door.body.n_gauss
    mine, known = sm.analyze(seal), sm.analyze(door)
    # the particles of both differ in the last digit, of which tangents of condition 2e5 pass on as much
    rounding = 2e5 * np.finfo(float).eps
    assert np.abs(mine.displacement() - known.displacement()).max() < rounding * 10.0


def test_too_few_layers_are_refused_when_the_file_is_read(tmp_path):
    with pytest.raises(
        SealFileError, match=r"layers = 2 with the accuracy 'engineering'.*at least 3"
    ):
        file_with(tmp_path, "rays = { rays = 58, layers = 2 }")
    with pytest.raises(SealFileError, match="accuracy"):
        file_with(tmp_path, 'rays = { rays = 58, layers = 4, accuracy = "best" }')
    assert file_with(tmp_path, 'rays = { rays = 58, layers = 2, accuracy = "paper" }')


@pytest.mark.parametrize(
    ("name", "change", "match"),
    [
        ("basis_order", lambda values: values + 3, "basis_order"),
        ("basis_order", lambda values: values - np.arange(values.size) % 2, "basis_order"),
        ("column", lambda values: values % 5, "column"),
        ("n_gauss", lambda values: values - 1, "n_gauss .* from 2 to 10"),
        ("n_gauss", lambda values: values + np.arange(len(values))[:, None] % 2, "the same for all"),
    ],
)
def test_cells_that_make_no_columns_are_refused(tmp_path, name, change, match):
    meshio = pytest.importorskip("meshio")
    file = file_with(tmp_path, 'rays = { rays = 58, layers = 4, accuracy = "fine" }')
    seal = sm.build_seal(file)
    path = write_cloud(seal, np.zeros(seal.n_offsets), tmp_path / "cloud.vtu")
    kernels = read_cloud(path, file.section.outline).kernels
    assert (kernels.basis_order, kernels.column, kernels.n_gauss) == (2, 3, seal.body.n_gauss)
    assert seal.body.n_gauss == (3, 2)
    mesh = meshio.read(path)
    mesh.cell_data[name] = [change(values) for values in mesh.cell_data[name]]
    mesh.write(path)
    with pytest.raises(GeometryError, match=match):
        read_cloud(path, file.section.outline)

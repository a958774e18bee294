"""Patch tests and homogeneous deformations."""

import numpy as np
import pytest

from verification.patch import compress_block, patch_test
from verification.rotation import rotate_body
from verification.tolerances import TOLERANCES


@pytest.mark.parametrize("traction", [False, True], ids=["displacements", "tractions"])
@pytest.mark.parametrize("basis_order", [1, 2])
def test_linear_patch_test_on_an_irregular_cloud(figure, traction, basis_order):
    errors = patch_test(traction, basis_order)
    kind = "traction" if traction else "displacement"
    for quantity, error in errors._asdict().items():
        name = f"patch test, {kind} boundary, basis {basis_order}: {quantity}"
        figure(name, error, TOLERANCES["patch"])


@pytest.mark.parametrize("bulk_ratio", [1.0, 1e3])
def test_homogeneous_compression_to_half_the_height(figure, bulk_ratio):
    block = compress_block(bulk_ratio)
    pressure = np.abs(block.pressure / block.exact_pressure - 1.0).max()
    width = np.abs(block.width / block.exact_width - 1.0).max()
    assert block.stretch[-1] == 0.5
    name = f"plane-strain compression, K/mu = {bulk_ratio:g}: "
    figure(name + "platen force", pressure, TOLERANCES["compression"])
    figure(name + "width", width, TOLERANCES["compression"])


def test_compression_approaches_the_incompressible_limit(figure):
    # incompressible: l = 1/h, P_22 = mu (h - h^-3)
    block = compress_block(1e3, n_steps=4)
    limit = block.stretch**-3 - block.stretch
    away = np.abs(block.pressure / limit - 1.0).max()
    name = "plane-strain compression, K/mu = 1000: distance from incompressible"
    figure(name, away, TOLERANCES["incompressible"])


def test_rigid_rotation_through_170_degrees_gives_no_stress(figure):
    rotation = rotate_body(170.0, 17)
    assert rotation.angle[-1] == pytest.approx(np.radians(170.0))
    tolerance = TOLERANCES["rotation"]
    stress, place = rotation.stress.max(), rotation.misplacement.max()
    figure("rigid rotation by 170 degrees: stress over shear modulus", stress, tolerance)
    figure("rigid rotation by 170 degrees: misplacement", place, tolerance)

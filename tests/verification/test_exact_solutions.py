"""Closed forms of rubber elasticity: inflation, flexure; and Cook's membrane."""

import numpy as np
import pytest

from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.verification.cook import CONVERGED, MATERIAL, cook_deflection, cook_reference, limit
from seal_mdao.verification.cylinder import inflate_cylinder
from seal_mdao.verification.flexure import bend_block
from seal_mdao.verification.tolerances import TOLERANCES


def test_inflation_follows_the_closed_form_to_stretch_two(figure):
    ratios = (1e3, 1e4, 1e5, 1e6)
    studies = [inflate_cylinder(ratio) for ratio in ratios]
    for ratio, study in zip(ratios, studies, strict=True):
        assert study.stretch[-1] == 2.0
        worst = np.abs(study.error).max()
        figure(f"inflated cylinder, K/mu = {ratio:.0e}: pressure", worst, TOLERANCES["cylinder"])
    errors = np.array([study.error for study in studies])
    drift = np.ptp(errors, axis=0).max()
    figure("inflated cylinder: drift from K/mu = 1e3 to 1e6", drift, TOLERANCES["cylinder_drift"])
    # what is left of a drift is the compressibility of the material: it falls like mu/K
    away = np.abs(errors[:3] - errors[3]).max(axis=1)
    np.testing.assert_allclose(away[:-1] / away[1:], 10.0, rtol=0.15)


def test_inflation_converges_with_the_particles():
    coarse, fine = (inflate_cylinder(1e5, cells) for cells in ((4, 8), (8, 16)))
    assert np.all(np.abs(fine.error) < np.abs(coarse.error))
    assert abs(fine.error[-1]) < 0.5 * abs(coarse.error[-1])


def test_block_bent_to_a_ring_follows_rivlins_flexure(figure):
    coarse, fine = bend_block(cells=(30, 3)), bend_block(cells=(60, 6))
    assert fine.angle[-1] == pytest.approx(2 * np.pi)
    for ratio, ring in ((1e4, fine), (1e3, bend_block(bulk_ratio=1e3))):
        name = f"block bent to a ring, K/mu = {ratio:.0e}: "
        figure(name + "moment", np.abs(ring.error).max(), TOLERANCES["flexure"])
        place = TOLERANCES["flexure_place"]
        figure(name + "misplacement over thickness", ring.misplacement, place)
    assert np.abs(fine.error).max() < 0.4 * np.abs(coarse.error).max()


def test_cooks_membrane_converges_to_the_finite_element_value(figure):
    reference = limit(*(cook_reference(n) for n in (6, 12, 24)))
    away = abs(reference / CONVERGED - 1.0)
    figure("Cook's membrane: reference recomputed", away, TOLERANCES["cook_reference"])
    errors = [abs(cook_deflection(n) / CONVERGED - 1.0) for n in (8, 16, 32)]
    figure("Cook's membrane, 16 x 16 cells: corner deflection", errors[1], TOLERANCES["cook_16"])
    figure("Cook's membrane, 32 x 32 cells: corner deflection", errors[2], TOLERANCES["cook_32"])
    assert errors[2] < 0.5 * errors[1] < 0.25 * errors[0]


def test_the_split_of_the_shear_modulus_is_immaterial_in_plane_strain(figure):
    # I1 = I2 when F_33 = det F = 1, so that only C10 + C01 counts
    half = MooneyRivlin(0.5 * MATERIAL.c10, 0.5 * MATERIAL.c10, MATERIAL.bulk_modulus)
    ratio = cook_deflection(12, half) / cook_deflection(12)
    away = abs(ratio - 1.0)
    figure("Cook's membrane: neo-Hookean against Mooney-Rivlin", away, TOLERANCES["cook_constants"])

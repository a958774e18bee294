"""Closed forms of rubber elasticity: inflation, flexure; and Cook's membrane."""

import numpy as np
import pytest

from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from verification.cook import CONVERGED, MATERIAL, cook_deflection, cook_reference, limit
from verification.cylinder import inflate_cylinder
from verification.flexure import bend_block
from verification.tolerances import TOLERANCES


def test_inflation_follows_the_closed_form_to_stretch_two(figure):
    ratios = (1e3, 1e4, 1e5, 1e6)
    studies = [inflate_cylinder(ratio, cells=(4, 8)) for ratio in ratios]
    for ratio, study in zip(ratios, studies, strict=True):
        assert study.stretch[-1] == 2.0
        worst = np.abs(study.error).max()
        figure(f"inflated cylinder, K/mu = {ratio:.0e}: pressure", worst, TOLERANCES["cylinder"])
    errors = np.array([study.error for study in studies])
    drift = np.ptp(errors, axis=0).max()
    figure("inflated cylinder: drift from K/mu = 1e3 to 1e6", drift, TOLERANCES["cylinder_drift"])
    # what is left of a drift is the compressibility of the material: it is linear in mu/K up to
    # terms of second order, mu/K times smaller, whose factor is of order ten
    away = (errors[:3] - errors[3]) / (1.0 / np.array(ratios[:3]) - 1e-6)[:, None]
    np.testing.assert_allclose(away[:2], away[1:], rtol=1e-2)


def test_inflation_converges_with_the_particles(figure):
    coarse, fine = (inflate_cylinder(1e5, cells) for cells in ((8, 16), (16, 32)))
    worst = np.abs(coarse.error).max()
    figure("inflated cylinder, 8 x 16 cells: pressure", worst, TOLERANCES["cylinder"])
    assert np.all(np.abs(fine.error) < 0.5 * np.abs(coarse.error))


def test_block_bent_to_a_ring_follows_rivlins_flexure(figure):
    coarse, fine = bend_block(cells=(30, 3)), bend_block(cells=(60, 6))
    assert fine.angle[-1] == pytest.approx(2 * np.pi)
    check_ring(figure, 1e4, fine)
    assert np.abs(fine.error).max() < 0.4 * np.abs(coarse.error).max()


@pytest.mark.long
def test_softer_block_bent_to_a_ring(figure):
    check_ring(figure, 1e3, bend_block(bulk_ratio=1e3))


def check_ring(figure, ratio, ring):
    name = f"block bent to a ring, K/mu = {ratio:.0e}: "
    figure(name + "moment", np.abs(ring.error).max(), TOLERANCES["flexure"])
    place = TOLERANCES["flexure_place"]
    figure(name + "misplacement over thickness", ring.misplacement, place)


def cook_error(cells):
    return abs(cook_deflection(cells) / CONVERGED - 1.0)


def test_cooks_membrane_approaches_the_finite_element_value(figure):
    coarse, middle = map(cook_error, (8, 16))
    figure("Cook's membrane, 16 x 16 cells: corner deflection", middle, TOLERANCES["cook_16"])
    assert middle < 0.5 * coarse


@pytest.mark.long
def test_cooks_membrane_converges_to_the_finite_element_value(figure):
    reference = limit(*(cook_reference(n) for n in (6, 12, 24)))
    away = abs(reference / CONVERGED - 1.0)
    figure("Cook's membrane: reference recomputed", away, TOLERANCES["cook_reference"])
    middle, fine = map(cook_error, (16, 32))
    figure("Cook's membrane, 32 x 32 cells: corner deflection", fine, TOLERANCES["cook_32"])
    assert fine < 0.5 * middle


def test_the_split_of_the_shear_modulus_is_immaterial_in_plane_strain(figure):
    # I1 = I2 when F_33 = det F = 1, so that only C10 + C01 counts
    half = MooneyRivlin(0.5 * MATERIAL.c10, 0.5 * MATERIAL.c10, MATERIAL.bulk_modulus)
    ratio = cook_deflection(6, half) / cook_deflection(6)
    away = abs(ratio - 1.0)
    figure("Cook's membrane: neo-Hookean against Mooney-Rivlin", away, TOLERANCES["cook_constants"])

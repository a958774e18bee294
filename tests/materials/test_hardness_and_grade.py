"""Rubber by its hardness and sponge by its grade: published numbers, exact derivatives, range."""

import numpy as np
import pytest

from seal_mdao.materials.hardness import ShoreRubber, hardness_factor, shore_modulus
from seal_mdao.materials.material_lists import LISTS
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.sponge import GRADES, graded_sponge, pressure_range

T, J = np.array([2.0, 2.3, 3.1]), np.array([1.0, 0.98, 1.01])


def test_it_is_the_neo_hookean_law_of_gents_modulus():
    law, same = ShoreRubber(62.0, 2e5), NeoHookean(shore_modulus(62.0) / 6.0, 2e5)
    assert np.array_equal(law.energy(T, J), same.energy(T, J))
    assert np.array_equal(law.derivatives(T, J), same.derivatives(T, J))
    # E = 3 G
    assert 3.0 * law.shear_modulus == pytest.approx(shore_modulus(62.0), rel=1e-12)
    # published: 2.46 MPa at 50 Shore A, 5.5 MPa at 70
    assert 3.0 * ShoreRubber(50.0).shear_modulus == pytest.approx(2456.0, rel=1e-3)
    assert 3.0 * ShoreRubber(70.0).shear_modulus == pytest.approx(5521.0, rel=1e-3)


def test_derivatives_in_the_hardness_are_exact():
    """Those of the stresses against central differences, those of the energy against a complex step."""
    law, h = ShoreRubber(62.0), 1e-4
    exact = law.constant_derivatives(T, J)[0]
    higher, lower = (ShoreRubber(62.0 + s).derivatives(T, J)[:2] for s in (h, -h))
    assert exact == pytest.approx((higher - lower) / (2.0 * h), rel=1e-8, abs=1e-9)
    energies = [ShoreRubber(62.0 + s).energy(T, J) for s in (h, -h)]
    slope = (energies[0] - energies[1]) / (2.0 * h)
    assert law.constant_energies(T, J)[0] == pytest.approx(slope, rel=1e-7, abs=1e-9)


def test_the_factor_of_tolerances_is_that_of_the_law():
    """One relation of hardness: five Shore more is the factor of the energy."""
    ratio = ShoreRubber(55.0).energy(T, J)[1:] / ShoreRubber(50.0).energy(T, J)[1:]
    assert ratio == pytest.approx(hardness_factor(50.0, 5.0), rel=1e-12)


@pytest.mark.parametrize("shore", [19.9, 95.1, np.nan])
def test_hardness_beyond_the_relation_is_refused(shore):
    with pytest.raises(ValueError, match="shore_a"):
        ShoreRubber(shore)


@pytest.mark.parametrize("grade", GRADES)
def test_a_sponge_has_the_pressure_of_its_grade_at_25_per_cent(grade):
    low, high = pressure_range(grade)
    law = graded_sponge(grade)
    # uniaxial without lateral strain: P = tau / lambda
    pressure = -law.principal_stress([0.75, 1.0, 1.0])[0] / 0.75
    assert pressure == pytest.approx(0.5 * (low + high), rel=1e-12)
    assert law.principal_stress([0.75, 1.0, 1.0])[1:] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert pytest.approx(6.894757) == low / {"1": 2, "2": 5, "3": 9, "4": 13, "5": 17}[grade[2]]


def test_a_sponge_stays_one_when_a_constant_changes():
    law = graded_sponge("2A2").with_(mu_1=90.0)
    assert law.mu == (90.0,)
    assert law.valid == (0.5, 1.5)


def test_the_lists_have_sources_and_numbers():
    dense, sponge = (made() for made in LISTS)
    assert ("60", "3605", "600.8") in dense.rows
    assert [row[0] for row in sponge.rows] == list(GRADES)
    assert "Gent" in dense.notes[0]
    assert all(len(row) == len(made.head) for made in (dense, sponge) for row in made.rows)

"""Mooney-Rivlin rubber against its three-dimensional form in the invariants of C; simple shear."""

import numpy as np
import pytest
import solid
from laws import FAR

import seal_mdao as sm

MATERIALS = [sm.MooneyRivlin(c10, c01) for c10, c01 in ((80.0, 20.0), (50.0, 0.0), (0.0, 30.0))]


@pytest.fixture(params=MATERIALS, ids=lambda m: f"{m.c10:g}-{m.c01:g}")
def material(request):
    return request.param


@pytest.mark.parametrize("state", FAR)
def test_energy_and_stress_are_those_of_the_decoupled_invariants(material, state):
    full = solid.in_space(state.F)
    energy = solid.energy(full, material.c10, material.c01)
    stress = solid.stress(full, material.c10, material.c01)
    assert material.energy(*state.invariants) == pytest.approx(energy, rel=1e-12)
    across = material.across(*state.invariants)[0] * np.linalg.det(state.F)
    np.testing.assert_allclose(material.stress(state.F), stress[:2, :2], rtol=1e-12, atol=1e-11)
    assert across == pytest.approx(stress[2, 2], rel=1e-12, abs=1e-11)


def test_von_mises_stress_of_small_shear_is_sqrt_3_mu_gamma(material):
    for gamma in (1e-2, 1e-4):
        found = material.von_mises(np.float64(2.0 + gamma**2), np.float64(1.0))[0]
        exact = np.sqrt(3.0) * material.shear_modulus * gamma
        assert found == pytest.approx(exact, rel=gamma**2)


def test_simple_shear_stress_is_linear_in_the_shear(material):
    """P_12 = 2 (C10 + C01) gamma at any amount of shear."""
    for gamma in (0.1, 1.0, 3.0):
        F = np.array([[1.0, gamma], [0.0, 1.0]])
        shear = (material.stress(F) @ F.T)[0, 1]
        assert shear == pytest.approx(material.shear_modulus * gamma, rel=1e-13)

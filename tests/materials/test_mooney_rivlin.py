"""Energy, stress, tangent and von Mises stress of the rubber against its three-dimensional form."""

import numpy as np
import pytest
import solid

import seal_mdao as sm
from seal_mdao.materials.mooney_rivlin import cofactor, energy_derivatives, von_mises

RUBBER = sm.MooneyRivlin(c10=80.0, c01=20.0)
MATERIALS = [RUBBER, sm.MooneyRivlin(c10=50.0, c01=0.0), sm.MooneyRivlin(c10=0.0, c01=30.0)]


@pytest.fixture(params=MATERIALS, ids=lambda m: f"{m.c10:g}-{m.c01:g}")
def material(request):
    return request.param


@pytest.fixture
def gradients(rng):
    return solid.gradients(rng)


def in_plane(function, material):
    """A function of the three-dimensional F as one of the in-plane F."""
    return lambda F: function(solid.in_space(F), material.c10, material.c01)


def test_energy_is_that_of_the_decoupled_invariants(material, gradients):
    exact = [in_plane(solid.energy, material)(F) for F in gradients]
    np.testing.assert_allclose(material.energy(gradients), exact, rtol=1e-13)


def test_stress_is_the_complex_step_of_the_energy(material, gradients):
    exact = [solid.complex_step(in_plane(solid.energy, material), F) for F in gradients]
    np.testing.assert_allclose(material.stress(gradients), exact, rtol=1e-12, atol=1e-11)


def test_tangent_is_the_complex_step_of_the_stress(material, gradients):
    def stress(F):
        return in_plane(solid.stress, material)(F)[:2, :2]

    # complex_step puts the components of F first
    exact = [np.moveaxis(solid.complex_step(stress, F), (0, 1), (2, 3)) for F in gradients]
    scale = np.abs(exact).max()
    np.testing.assert_allclose(material.tangent(gradients), exact, rtol=1e-10, atol=1e-12 * scale)


def test_tangent_has_major_symmetry(material, gradients):
    tangent = material.tangent(gradients)
    turned = tangent.transpose(0, 3, 4, 1, 2)
    np.testing.assert_allclose(tangent, turned, rtol=0.0, atol=1e-12 * np.abs(tangent).max())


def test_energy_and_stress_are_objective(material, gradients):
    for angle in (0.4, 2.0, 3.0):
        turned = solid.rotation(angle) @ gradients
        np.testing.assert_allclose(material.energy(turned), material.energy(gradients), rtol=1e-12)
        np.testing.assert_allclose(
            material.stress(turned), solid.rotation(angle) @ material.stress(gradients), atol=1e-11
        )
        np.testing.assert_allclose(
            material.von_mises(turned), material.von_mises(gradients), rtol=1e-12
        )


def test_energy_and_stress_are_isotropic(material, gradients):
    for angle in (0.4, 2.0, 3.0):
        turned = gradients @ solid.rotation(angle)
        np.testing.assert_allclose(material.energy(turned), material.energy(gradients), rtol=1e-12)
        np.testing.assert_allclose(
            material.stress(turned), material.stress(gradients) @ solid.rotation(angle), atol=1e-11
        )


def test_undeformed_rubber_is_free_of_energy_and_stress(material):
    np.testing.assert_allclose(material.energy(np.eye(2)), 0.0, atol=1e-13)
    np.testing.assert_allclose(material.stress(np.eye(2)), 0.0, atol=1e-13)
    assert material.von_mises(np.eye(2)) == 0.0


def test_small_strain_limit_is_isochoric_elasticity(material):
    """At F = I the tangent is mu (d_ik d_jl + d_il d_jk - 2/3 d_ij d_kl), mu = 2 (C10 + C01)."""
    one = np.eye(2)
    exact = (
        np.einsum("ik,jl->ijkl", one, one)
        + np.einsum("il,jk->ijkl", one, one)
        - 2 / 3 * np.einsum("ij,kl->ijkl", one, one)
    )
    mu = 2.0 * (material.c10 + material.c01)
    assert material.shear_modulus == mu
    np.testing.assert_allclose(material.tangent(one), mu * exact, rtol=1e-13, atol=1e-12)


def test_von_mises_stress_of_small_shear_is_sqrt_3_mu_gamma(material):
    for gamma in (1e-2, 1e-4):
        F = np.array([[1.0, gamma], [0.0, 1.0]])
        exact = np.sqrt(3.0) * material.shear_modulus * gamma
        assert material.von_mises(F) == pytest.approx(exact, rel=gamma**2)


def test_simple_shear_stress_is_linear_in_the_shear(material):
    """Mooney-Rivlin: P_12 = 2 (C10 + C01) gamma at any amount of shear."""
    for gamma in (0.1, 1.0, 3.0):
        F = np.array([[1.0, gamma], [0.0, 1.0]])
        shear = (material.stress(F) @ F.T)[0, 1]
        assert shear == pytest.approx(material.shear_modulus * gamma, rel=1e-13)


def test_von_mises_stress_is_that_of_the_three_dimensional_cauchy_stress(material, gradients):
    exact = [in_plane(solid.von_mises, material)(F) for F in gradients]
    np.testing.assert_allclose(material.von_mises(gradients), exact, rtol=1e-12)


def test_von_mises_derivatives_are_the_complex_step(material, gradients):
    """In the chain d sigma / dF = 2 F d sigma/dT + cof F d sigma/dJ."""
    for F in gradients:
        exact = solid.complex_step(in_plane(solid.von_mises, material), F)
        _, by_t, by_j = von_mises(np.sum(F * F), np.linalg.det(F), material.c10, material.c01)
        np.testing.assert_allclose(2 * by_t * F + by_j * cofactor(F), exact, rtol=1e-10, atol=1e-9)


def test_energy_derivatives_are_derivatives_of_each_other():
    """W_J and W_T of the complex energy, W_TJ and W_JJ of the complex first derivatives."""
    t, j, h = 2.3, 0.9, 1e-30

    def first(t, j):
        return energy_derivatives.py_func(t, j, 80.0, 20.0)

    def total(t, j):
        return 80.0 * ((t + 1) * j ** (-2 / 3)) + 20.0 * ((t + j * j) * j ** (-4 / 3))

    w_t, w_j, w_tj, w_jj = energy_derivatives(t, j, 80.0, 20.0)
    by_j = first(t, j + 1j * h)
    assert w_t == pytest.approx(total(t + 1j * h, j).imag / h, rel=1e-13)
    assert w_j == pytest.approx(total(t, j + 1j * h).imag / h, rel=1e-13)
    assert w_tj == pytest.approx(by_j[0].imag / h, rel=1e-13)
    assert w_jj == pytest.approx(by_j[1].imag / h, rel=1e-13)
    assert first(t + 1j * h, j)[0].imag == 0.0


def test_cofactor_is_the_derivative_of_the_determinant(gradients):
    exact = np.linalg.det(gradients)[:, None, None] * np.linalg.inv(gradients).transpose(0, 2, 1)
    np.testing.assert_allclose(cofactor(gradients), exact, rtol=1e-12)


@pytest.mark.parametrize(
    "constants",
    [
        {"c10": -1.0},
        {"c01": -1.0},
        {"c10": 0.0, "c01": 0.0},
        {"bulk_modulus": 0.0},
        {"bulk_modulus": -1.0},
        {"c10": np.nan},
        {"c01": np.inf},
        {"bulk_modulus": np.inf},
    ],
)
def test_constants_without_a_stable_material_are_refused(constants):
    with pytest.raises(ValueError, match=next(iter(constants))):
        sm.MooneyRivlin(**constants)

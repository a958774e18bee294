"""Every law: energy, stress, tangent, von Mises stress and constants, from its principal stretches.

A state is R(left) diag(stretches) R(right), so no eigenvalues are computed and nothing is lost where
two stretches meet. Complex steps have no truncation: what is left is rounding, some 50 operations
on numbers of the size of the moduli times at most 30 (powers of stretches).
"""

import numpy as np
import pytest
from laws import FAR, STATES, UNDEFORMED, moved, principal_energy, principal_forces, rotation, size

from seal_mdao.materials.isotropic import cofactor, invariants
from seal_mdao.structure.elastic_body import elastic_body

STEP = 1e-30
ROUNDING = 50 * 30 * np.finfo(float).eps


def close(found, exact, law):
    bound = ROUNDING * max(size(law), np.abs(exact).max())
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=bound)


def test_energy_is_that_of_the_principal_stretches(law):
    for state in STATES:
        close(law.energy(*state.invariants), principal_energy(law, state.stretches), law)


def test_first_derivatives_are_the_complex_step_of_the_energy(law):
    for state in STATES:
        t, j = state.invariants
        w_t, w_j, *_ = law.derivatives(t, j)
        close(w_t, law.energy(t + 1j * STEP, j).imag / STEP, law)
        close(w_j, law.energy(t, j + 1j * STEP).imag / STEP, law)


def test_second_derivatives_are_the_complex_step_of_the_first(law):
    for state in STATES:
        t, j = state.invariants
        _, _, w_tt, w_tj, w_jj = law.derivatives(t, j)
        close([w_tt, w_tj], law.derivatives(t + 1j * STEP, j)[:2].imag / STEP, law)
        close([w_tj, w_jj], law.derivatives(t, j + 1j * STEP)[:2].imag / STEP, law)


def test_stress_is_that_of_the_principal_stretches(law):
    for state in STATES:
        forces = principal_forces(law, state.stretches)[:2]
        close(
            law.stress(state.F), rotation(state.left) @ np.diag(forces) @ rotation(state.right), law
        )


def test_tangent_is_the_complex_step_of_the_stress(law):
    for state in STATES:
        tangent = law.tangent(state.F)
        for k in range(2):
            for m in range(2):
                shifted = state.F.astype(complex)
                shifted[k, m] += 1j * STEP
                close(tangent[:, :, k, m], law.stress(shifted).imag / STEP, law)


def test_tangent_has_major_symmetry(law):
    for state in STATES:
        tangent = law.tangent(state.F)
        close(tangent, tangent.transpose(2, 3, 0, 1), law)


def test_energy_and_stress_are_objective_and_isotropic(law):
    for state in FAR:
        for angle in (0.4, 2.0, 3.0):
            turn = rotation(angle)
            stress = law.stress(state.F)
            close(law.stress(turn @ state.F), turn @ stress, law)
            close(law.stress(state.F @ turn), stress @ turn, law)
            close(law.energy(*invariants(turn @ state.F)), law.energy(*state.invariants), law)


def test_tangent_turns_with_the_axes(law):
    for state in FAR:
        turn = rotation(0.7)
        exact = np.einsum("ia,kb,ajbl->ijkl", turn, turn, law.tangent(state.F))
        close(law.tangent(turn @ state.F), exact, law)


def test_stress_across_the_plane_is_the_force_on_the_third_stretch(law):
    for state in STATES:
        t, j = state.invariants
        value, by_t, by_j = law.across(t, j)
        close(value, principal_forces(law, state.stretches)[2] / j, law)
        close(by_t, law.across(t + 1j * STEP, j)[0].imag / STEP, law)
        close(by_j, law.across(t, j + 1j * STEP)[0].imag / STEP, law)


def test_von_mises_stress_is_that_of_the_principal_cauchy_stresses(law):
    """Through the eigenvalues of the 3 x 3 Cauchy stress, which is built without W(T, J)."""
    for state in FAR:
        forces, full = principal_forces(law, state.stretches), np.eye(3)
        left, right = np.eye(3), np.eye(3)
        left[:2, :2], right[:2, :2] = rotation(state.left), rotation(state.right)
        full[:2, :2] = state.F
        cauchy = left @ np.diag(forces) @ right @ full.T / np.linalg.det(full)
        one, two, three = np.linalg.eigvalsh(0.5 * (cauchy + cauchy.T))
        exact = np.sqrt(0.5 * ((one - two) ** 2 + (two - three) ** 2 + (three - one) ** 2))
        close(law.von_mises(*invariants(state.F))[0], exact, law)


def test_von_mises_derivatives_are_the_complex_step(law):
    for state in FAR:
        t, j = state.invariants
        _, by_t, by_j = law.von_mises(t, j)
        close(by_t, law.von_mises(t + 1j * STEP, j)[0].imag / STEP, law)
        close(by_j, law.von_mises(t, j + 1j * STEP)[0].imag / STEP, law)


def test_energies_of_the_constants_are_those_of_the_principal_stretches(law):
    for state in STATES:
        found = law.constant_energies(*state.invariants)
        assert found.shape == (len(law.names),)
        for value, name in zip(found, law.names, strict=True):
            energy = principal_energy(moved(law, name, 1j * STEP), state.stretches)
            close(value, np.imag(energy) / STEP, law)


def test_constants_are_the_complex_step(law):
    """W_T, W_J, sigma_33 and sigma_vm with respect to every constant, also where stretches meet."""
    for state in STATES:
        t, j = (np.complex128(x) for x in state.invariants)
        rates = law.constant_derivatives(*state.invariants)
        across = law.across_constant_derivatives(*state.invariants)
        mises = law.von_mises_constants(*state.invariants)
        assert rates.shape == (len(law.names), 2)
        assert across.shape == mises.shape == (len(law.names),)
        for row, name in enumerate(law.names):
            other = moved(law, name, 1j * STEP)
            close(rates[row], other.derivatives(t, j)[:2].imag / STEP, law)
            close(across[row], other.across(t, j)[0].imag / STEP, law)
            if state in FAR:
                close(mises[row], other.von_mises(t, j)[0].imag / STEP, law)


def test_constants_move_the_principal_forces(law):
    """2 W_T lambda_1 + W_J lambda_2 = dW/dlambda_1, by differences of the published form.

    Five points, steps h of 1e-3 of the constant: truncation h^4/30 times the fifth derivative, largest
    for nu (1e-9 of it); rounding 1.5 / h times some 30 eps of the moduli.
    """
    for state in STATES:
        rates = law.constant_derivatives(*state.invariants)
        found = 2 * rates[:, 0] * state.first + rates[:, 1] * state.second
        for value, (name, constant) in zip(found, law.constants.items(), strict=True):
            h = 1e-3 * max(abs(constant), 0.1)
            two_left, left, right, two_right = (
                principal_forces(moved(law, name, k * h), state.stretches)[0]
                for k in (-2, -1, 1, 2)
            )
            exact = (two_left - 8 * left + 8 * right - two_right) / (12 * h)
            assert value == pytest.approx(exact, rel=1e-8, abs=1e-14 * size(law) / h)


def test_undeformed_state_is_free_of_energy_and_stress(law):
    """Exactly: the von Mises stress has a corner there and its derivatives are zero by definition."""
    t, j = UNDEFORMED.invariants
    assert law.energy(t, j) == pytest.approx(0.0, abs=ROUNDING * size(law))
    assert not law.stress(np.eye(2)).any()
    assert not law.across(t, j)[0].any()
    assert not law.von_mises(t, j).any()
    assert not law.von_mises_constants(t, j).any()


def test_small_strain_is_linear_elasticity(law):
    """A = (K - 2/3 G) 1(x)1 + G (I + I^T) at F = 1, the bulk modulus of the projection aside."""
    one = np.eye(2)
    shear, bulk = law.shear_modulus, law.initial_bulk_modulus - law.bulk_modulus
    exact = (bulk - 2 / 3 * shear) * np.einsum("ij,kl->ijkl", one, one) + shear * (
        np.einsum("ik,jl->ijkl", one, one) + np.einsum("il,jk->ijkl", one, one)
    )
    close(law.tangent(one), exact, law)


def test_shapes_are_kept(law):
    """Scalars, vectors and matrices of states give the same numbers."""
    t, j = (
        np.array(x).reshape(3, 9) for x in zip(*(s.invariants for s in STATES[:27]), strict=True)
    )
    n = len(law.names)
    shapes = {
        "energy": (), "derivatives": (5,), "constant_derivatives": (n, 2), "across": (3,),
        "across_constant_derivatives": (n,), "von_mises": (3,), "von_mises_constants": (n,),
    }  # fmt: skip
    for name, leading in shapes.items():
        whole, one = getattr(law, name)(t, j), getattr(law, name)(t[1, 2], j[1, 2])
        assert whole.shape == (*leading, 3, 9)
        assert np.shape(one) == leading
        close(one, whole[..., 1, 2], law)
        close(getattr(law, name)(t[1], j[1]), whole[..., 1, :], law)
    F = np.array([s.F for s in STATES[:27]]).reshape(3, 9, 2, 2)
    assert law.stress(F).shape == F.shape
    assert law.tangent(F).shape == (*F.shape, 2, 2)


def test_a_folded_state_has_no_value_and_no_warning(law):
    for name in ("energy", "derivatives"):
        assert np.isnan(getattr(law, name)(np.array([2.0]), np.array([-0.5]))).any()


def test_names_are_the_constants_with_the_bulk_modulus_last(law):
    assert law.names == tuple(law.constants)
    assert ("bulk_modulus" in law.names) == (law.bulk_modulus > 0.0)
    assert "bulk_modulus" not in law.names[:-1]


def test_with_changes_one_constant(law):
    for name in law.names:
        value = 1.01 * law.constants[name]
        assert law.with_(**{name: value}).constants == law.constants | {name: value}
    assert law.with_() == law
    with pytest.raises(ValueError, match="no constant stiffness"):
        law.with_(stiffness=1.0)


def test_cofactor_is_the_derivative_of_the_determinant():
    gradients = np.array([state.F for state in STATES])
    exact = np.linalg.det(gradients)[:, None, None] * np.linalg.inv(gradients).transpose(0, 2, 1)
    np.testing.assert_allclose(cofactor(gradients), exact, rtol=1e-12)


def test_moduli_are_the_constants_with_the_unit_of_stress(law):
    """W is linear in all of them together, since the other constants are dimensionless."""
    doubled = law.with_(**{name: 2.0 * law.constants[name] for name in law.moduli})
    for state in FAR:
        energy = law.energy(*state.invariants)
        close(doubled.energy(*state.invariants), 2.0 * energy, law)
        assert energy > 0.0


def test_moduli_are_inputs_in_kpa(law):
    units = {name: own.units for name, own in elastic_body(law).scalars.items()}
    assert units == {name: "kPa" if name in law.moduli else None for name in law.names}

"""Laws at a stretch across the plane, by complex steps of their energy in three principal stretches."""

import numpy as np
import pytest
from laws import LAWS, moved, principal_energy, size

from seal_mdao.materials import hoop_stretch
from seal_mdao.materials.sponge import graded_sponge

STEP = 1e-30
ROUNDING = 50 * 30 * np.finfo(float).eps
RANDOM = np.random.default_rng(7).uniform(0.6, 1.5, (4, 3))
STATES = ((0.8, 1.3, 1.1), (1.2, 1.2, 0.7), (0.95, 0.9, 1.0), (1.6, 0.7, 1.3), *map(tuple, RANDOM))
APART = [own for own in STATES if own[0] != own[1]]
"""Where both stretches in the plane are equal their roots have no derivatives."""
ALL = LAWS | {"sponge": graded_sponge("2A3")}


@pytest.fixture(params=ALL)
def law(request):
    return ALL[request.param]


def invariants(stretches):
    """T, J = h det F, and h of three principal stretches, the last across the plane."""
    one, two, h = stretches
    return one * one + two * two, one * two * h, h


def energy(law, t, j, h):
    """W of T, J, h, from the published form of the law."""
    # lambda^2 are the roots of z^2 - T z + (J / h)^2
    root = np.sqrt(t * t - 4.0 * (j / h) ** 2)
    return principal_energy(law, np.array([np.sqrt((t + root) / 2), np.sqrt((t - root) / 2), h]))


def close(found, exact, law, factor=1.0):
    bound = factor * ROUNDING * max(size(law), np.abs(exact).max())
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=bound)


@pytest.mark.parametrize("stretches", STATES)
def test_energy_is_the_published_one(law, stretches):
    exact = principal_energy(law, np.array(stretches))
    close(hoop_stretch.energy(law, *invariants(stretches)), exact, law)


@pytest.mark.parametrize("stretches", APART)
def test_first_derivatives_are_those_of_the_published_energy(law, stretches):
    state = np.array(invariants(stretches))
    found = hoop_stretch.derivatives(law, *state)[[0, 1, 5]]
    # numbers of the size 1 / (lambda_1^2 - lambda_2^2) cancel in the roots
    apart = abs(stretches[0] ** 2 - stretches[1] ** 2)
    for k, step in enumerate(1j * STEP * np.eye(3)):
        close(found[k], energy(law, *(state + step)).imag / STEP, law, 1.0 / apart)


@pytest.mark.parametrize("stretches", STATES)
def test_second_derivatives_are_complex_steps_of_the_first(law, stretches):
    state = np.array(invariants(stretches))
    _, _, w_tt, w_tj, w_jj, _, w_th, w_jh, w_hh = hoop_stretch.derivatives(law, *state)
    rows = np.array([[w_tt, w_tj, w_th], [w_tj, w_jj, w_jh], [w_th, w_jh, w_hh]])
    for k, step in enumerate(1j * STEP * np.eye(3)):
        slopes = hoop_stretch.derivatives(law, *(state + step))[[0, 1, 5]].imag / STEP
        close(rows[:, k], slopes, law, 10.0)


@pytest.mark.parametrize("stretches", STATES)
def test_von_mises_stress_is_that_of_the_principal_stresses(law, stretches):
    t, j, h = invariants(stretches)
    # Cauchy stresses tau / J of the three-dimensional contract
    s = law.principal_stress(np.array(stretches)) / j
    exact = np.sqrt(0.5 * ((s[0] - s[1]) ** 2 + (s[1] - s[2]) ** 2 + (s[2] - s[0]) ** 2))
    value, *slopes = hoop_stretch.von_mises(law, t, j, h)
    close(value, exact, law)
    for k, step in enumerate(1j * STEP * np.eye(3)):
        other = hoop_stretch.von_mises(law, *(np.array([t, j, h]) + step))[0]
        # where the derivative in T is that of a square root of rounding, it is not looked at
        if stretches[0] != stretches[1]:
            close(slopes[k], other.imag / STEP, law, 10.0)


@pytest.mark.parametrize("stretches", STATES)
def test_no_direction_is_preferred(law, stretches):
    """Energy and von Mises stress with h exchanged for each of the stretches in the plane."""
    one, two, h = stretches
    for function in (hoop_stretch.energy, lambda *state: hoop_stretch.von_mises(*state)[0]):
        value = function(law, *invariants(stretches))
        for other in ((h, two, one), (one, h, two)):
            close(function(law, *invariants(other)), value, law)


@pytest.mark.parametrize("stretches", STATES)
def test_derivatives_in_the_constants_are_complex_steps(law, stretches):
    state = invariants(stretches)
    complex_state = tuple(map(np.complex128, state))
    energies = hoop_stretch.constant_energies(law, *state)
    found = hoop_stretch.constant_derivatives(law, *state)
    stress = hoop_stretch.von_mises_constants(law, *state)
    for k, name in enumerate(law.names):
        other, scale = moved(law, name, 1j * STEP), max(1.0, 1.0 / abs(law.constants[name] or 1.0))
        close(energies[k], principal_energy(other, np.array(stretches)).imag / STEP, law, scale)
        rows = hoop_stretch.derivatives(other, *complex_state)[[0, 1, 5]]
        close(found[k], rows.imag / STEP, law, scale)
        if stretches[0] != stretches[1]:
            value = hoop_stretch.von_mises(other, *complex_state)[0]
            close(stress[k], value.imag / STEP, law, scale)


def test_the_undeformed_state_is_free_of_stress_to_the_bit(law):
    """Where the von Mises stress has no derivatives: they are zero, not rounding over rounding."""
    state = tuple(map(np.float64, (2.0, 1.0, 1.0)))
    assert hoop_stretch.energy(law, *state) == 0.0
    np.testing.assert_array_equal(hoop_stretch.von_mises(law, *state), 0.0)
    np.testing.assert_array_equal(hoop_stretch.von_mises_constants(law, *state), 0.0)
    # P = 2 W_T F + W_J cof F,  P_h = W_h + W_J
    w_t, w_j, *_, w_h, _, _, _ = hoop_stretch.derivatives(law, *state)
    assert 2.0 * w_t + w_j == 0.0 == w_h + w_j
    # T < 2 J by rounding
    assert np.all(np.isfinite(hoop_stretch.von_mises(law, np.nextafter(2.0, 0.0), *state[1:])))


@pytest.mark.parametrize("name", [name for name in ALL if not ALL[name].bulk_modulus])
def test_stress_across_the_plane_is_the_slope_of_the_volumetric_energy(name):
    law, j = ALL[name], np.array([0.4, 0.9, 1.0, 1.7])
    close(law.volumetric(j + 1j * STEP).imag / STEP, law.across(j, j)[0], law)


def test_arrays_are_evaluated_entry_by_entry(law):
    states = np.array([invariants(own) for own in STATES]).T
    for name in ("energy", "derivatives", "von_mises", "constant_derivatives", "constant_energies"):
        function = getattr(hoop_stretch, name)
        rows = np.moveaxis([function(law, *map(np.float64, own)) for own in states.T], 0, -1)
        close(function(law, *states), rows, law)


def test_without_a_stretch_across_the_plane_it_is_the_law_of_plane_strain(law):
    t, j, _ = map(np.float64, invariants((0.9, 1.2, 1.0)))
    for name in ("energy", "derivatives", "constant_derivatives", "von_mises"):
        plane = getattr(law, name)(t, j)
        np.testing.assert_array_equal(getattr(hoop_stretch, name)(law, t, j), plane)
    every = hoop_stretch.derivatives(law, t, j, 1.0)
    np.testing.assert_array_equal(every[:5], law.derivatives(t, j))
    rates = hoop_stretch.constant_derivatives(law, t, j, 1.0)
    np.testing.assert_array_equal(rates[:, :2], law.constant_derivatives(t, j))
    np.testing.assert_array_equal(hoop_stretch.energy(law, t, j, 1.0), law.energy(t, j))
    # the stress across the plane is computed from W_h here
    close(hoop_stretch.von_mises(law, t, j, 1.0)[:3], law.von_mises(t, j), law)
    rates = hoop_stretch.von_mises_constants(law, t, j, 1.0)
    close(rates, law.von_mises_constants(t, j), law)

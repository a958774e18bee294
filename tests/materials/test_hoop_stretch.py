"""Laws at a stretch across the plane, by complex steps of their energy in three principal stretches."""

import numpy as np
import pytest
from laws import ISOCHORIC, LAWS, principal_energy, size

from seal_mdao.materials import hoop_stretch

STEP = 1e-30
ROUNDING = 50 * 30 * np.finfo(float).eps
STATES = ((0.8, 1.3, 1.1), (1.2, 1.2, 0.7), (0.95, 0.9, 1.0), (1.6, 0.7, 1.3))


@pytest.fixture(params=ISOCHORIC)
def law(request):
    return LAWS[request.param]


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


# where both stretches in the plane are equal their roots have no derivatives
@pytest.mark.parametrize("stretches", [own for own in STATES if own[0] != own[1]])
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
    w_t, w_j, w_tt, w_tj, w_jj, w_h, w_th, w_jh, w_hh = hoop_stretch.derivatives(law, *state)
    rows = np.array([[w_tt, w_tj, w_th], [w_tj, w_jj, w_jh], [w_th, w_jh, w_hh]])
    for k, step in enumerate(1j * STEP * np.eye(3)):
        (a, b), h = hoop_stretch.plane_state(*(state + step)), (state + step)[2]
        w_a, w_b = law.derivatives(a, b)[:2]
        moved = np.array([w_a / h**2, w_b / h**3, -(2.0 * a * w_a + 3.0 * b * w_b) / h])
        close(rows[:, k], moved.imag / STEP, law, 10.0)
    assert np.all(np.isfinite([w_t, w_j, w_h]))


@pytest.mark.parametrize("stretches", STATES)
def test_von_mises_stress_is_that_of_the_principal_stresses(law, stretches):
    t, j, h = invariants(stretches)
    # Cauchy stresses tau / J of the three-dimensional contract
    s = law.principal_stress(np.array(stretches)) / j
    exact = np.sqrt(0.5 * ((s[0] - s[1]) ** 2 + (s[1] - s[2]) ** 2 + (s[2] - s[0]) ** 2))
    value, *slopes = hoop_stretch.von_mises(law, t, j, h)
    close(value, exact, law)
    for k, step in enumerate(1j * STEP * np.eye(3)):
        moved = hoop_stretch.von_mises(law, *(np.array([t, j, h]) + step))[0]
        # where the derivative in T is that of a square root of rounding, it is not looked at
        if stretches[0] != stretches[1]:
            close(slopes[k], moved.imag / STEP, law, 10.0)


@pytest.mark.parametrize("stretches", STATES)
def test_derivatives_in_the_constants_are_central_differences(law, stretches):
    """Of the second order in the step; laws are linear in moduli and smooth in exponents."""
    state = invariants(stretches)
    found = hoop_stretch.constant_derivatives(law, *state)
    stress = hoop_stretch.von_mises_constants(law, *state)
    for k, name in enumerate(law.names):
        step = 1e-5 * abs(law.constants[name])
        sides = [law.with_(**{name: law.constants[name] + s * step}) for s in (1, -1)]
        quotient = np.subtract(*(hoop_stretch.derivatives(own, *state)[[0, 1, 5]] for own in sides))
        quotient /= 2.0 * step
        scale = size(law) / abs(law.constants[name])
        np.testing.assert_allclose(found[k], quotient, rtol=1e-8, atol=1e-8 * scale)
        quotient = np.subtract(*(hoop_stretch.von_mises(own, *state)[0] for own in sides))
        np.testing.assert_allclose(stress[k], quotient / (2.0 * step), rtol=1e-8, atol=1e-8 * scale)


def test_without_a_stretch_across_the_plane_it_is_the_law_of_plane_strain(law):
    t, j, _ = invariants((0.9, 1.2, 1.0))
    every = hoop_stretch.derivatives(law, t, j, 1.0)
    np.testing.assert_array_equal(every[:5], law.derivatives(t, j))
    np.testing.assert_array_equal(hoop_stretch.derivatives(law, t, j), law.derivatives(t, j))
    np.testing.assert_array_equal(hoop_stretch.von_mises(law, t, j, 1.0)[:3], law.von_mises(t, j))

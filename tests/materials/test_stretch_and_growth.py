"""Laws under an axial stretch, growth and a factor of the moduli, by complex steps of their energy."""

import numpy as np
import pytest
from laws import LAWS, size

from seal_mdao.materials import hoop_stretch, stretch_and_growth
from seal_mdao.materials.stretch_and_growth import Conditions

STEP = 1e-30
ROUNDING = 500 * 30 * np.finfo(float).eps
STATE = np.array([0.9**2 + 1.3**2, 0.9 * 1.3])
HOOP = 1.1
# h, theta, m
CONDITIONS = np.array([1.07, 1.04, 0.8])
KNOWN = [name for name, law in LAWS.items() if hoop_stretch.is_known(law)]


@pytest.fixture(params=KNOWN)
def law(request):
    return LAWS[request.param]


@pytest.fixture(params=["plane", "ring"])
def state(request):
    """T and J, or T, J = h det F and h with a body of revolution, whose axial stretch is none."""
    return STATE if request.param == "plane" else np.array([STATE[0], STATE[1] * HOOP, HOOP])


@pytest.fixture
def given(state):
    return CONDITIONS * (1.0, 1.0, 1.0) if len(state) == 2 else np.array([1.0, *CONDITIONS[1:]])


def close(found, exact, law):
    bound = ROUNDING * max(size(law), np.abs(exact).max())
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=bound)


def slopes(function, at):
    """Derivatives of a function of an array in each of its entries, first index."""
    return [function(at + step).imag / STEP for step in 1j * STEP * np.eye(len(at))]


def first(rows):
    """W_T, W_J, and W_h where there is one."""
    return rows[[0, 1, 5]] if len(rows) == hoop_stretch.ROWS else rows[:2]


def test_energy_is_that_of_the_grown_section_by_its_stretched_length(law, state, given):
    """From principal stretches over theta; the volume of what has grown over the length."""
    h, theta, m = given
    theta = 1.0 if hoop_stretch.is_isochoric(law) else theta
    across = h if len(state) == 2 else state[2]
    volume = state[1] * (h if len(state) == 2 else 1.0)
    grown = hoop_stretch.energy(law, state[0] / theta**2, volume / theta**3, across / theta)
    found = stretch_and_growth.energy(law, state, Conditions(*given))
    close(found, m * theta**3 / h * grown, law)


def test_derivatives_are_those_of_the_energy(law, state, given):
    conditions = Conditions(*given)
    rows = stretch_and_growth.derivatives(law, state, conditions)
    exact = slopes(lambda own: stretch_and_growth.energy(law, own, conditions), state)
    close(first(rows), exact, law)
    second = slopes(lambda own: first(stretch_and_growth.derivatives(law, own, conditions)), state)
    named = ("tt", "tj", "th"), ("tj", "jj", "jh"), ("th", "jh", "hh")
    place = {"tt": 2, "tj": 3, "jj": 4, "th": 6, "jh": 7, "hh": 8}
    for row, names in zip(second, named, strict=False):
        close(row, [rows[place[name]] for name in names[: len(state)]], law)


def test_rates_are_derivatives_in_the_conditions(law, state, given):
    conditions = Conditions(*given)
    own = stretch_and_growth
    for found, function in (
        (own.rates, lambda at: first(own.derivatives(law, state, Conditions(*at)))),
        (own.energy_rates, lambda at: own.energy(law, state, Conditions(*at))),
        (own.von_mises_rates, lambda at: own.von_mises(law, state, Conditions(*at))[0]),
    ):
        exact = np.array(slopes(function, given))
        if len(state) == 3:
            # a body of revolution has no axial stretch
            exact[0] = 0.0
        close(found(law, state, conditions), exact, law)


def test_stress_of_grown_material_is_that_of_its_elastic_stretches(law, state, given):
    conditions = Conditions(*given)
    value, *by_state = stretch_and_growth.von_mises(law, state, conditions)
    exact = slopes(lambda own: stretch_and_growth.von_mises(law, own, conditions)[0], state)
    close(by_state, exact, law)
    h, theta, m = given
    theta = 1.0 if hoop_stretch.is_isochoric(law) else theta
    across = h if len(state) == 2 else state[2]
    volume = state[1] * (h if len(state) == 2 else 1.0)
    elastic = state[0] / theta**2, volume / theta**3, across / theta
    close(value, m * hoop_stretch.von_mises(law, *elastic)[0], law)


def test_constants_scale_as_the_energy_does(law, state, given):
    """By the complex steps of the energy in a constant that the law has for itself."""
    conditions = Conditions(*given)
    rows = stretch_and_growth.constant_derivatives(law, state, conditions)
    for k, row in enumerate(rows):

        def slope(own, k=k):
            return stretch_and_growth.constant_energies(law, own, conditions)[k]

        # d(dW/dc)/dT by central differences, of the fourth order in 1e-3 of the state
        step = 1e-3 * np.eye(len(state))
        exact = [
            (
                8 * (slope(state + s) - slope(state - s))
                - slope(state + 2 * s)
                + slope(state - 2 * s)
            )
            / 12e-3
            for s in step
        ]
        np.testing.assert_allclose(row, exact, rtol=1e-6, atol=1e-6 * np.abs(exact).max() + 1e-9)


def test_without_growth_and_stretch_nothing_changes(law):
    plain, one = law.derivatives(*STATE), Conditions(1.0, 1.0, 1.0)
    np.testing.assert_array_equal(stretch_and_growth.derivatives(law, STATE, one), plain)
    np.testing.assert_array_equal(stretch_and_growth.derivatives(law, STATE, None), plain)


def test_volumetric_energy_of_a_grown_section():
    """theta^3 K/2 (h J / theta^3 - 1)^2 / h, with its derivatives in the conditions."""
    bulk, jacobian = 1e3, 1.02

    def energy(given):
        h, theta, _ = given
        return theta**3 * bulk / 2 * (h * jacobian / theta**3 - 1) ** 2 / h

    own = stretch_and_growth.volumetric(Conditions(*CONDITIONS))
    stiff, change = bulk * own.bulk, jacobian - 1.0 + own.offset
    assert stiff / 2 * change**2 == pytest.approx(energy(CONDITIONS), rel=1e-13)
    found = bulk * own.bulk_rates / 2 * change**2 + stiff * change * own.offset_rates
    np.testing.assert_allclose(found, slopes(energy, CONDITIONS), rtol=1e-12, atol=1e-9)

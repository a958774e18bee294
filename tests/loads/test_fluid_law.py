"""How far a fluid gets along an edge: limits, one solution, exact derivatives."""

import numpy as np
import pytest

from seal_mdao.loads.fluid_law import accumulated, smooth_step, wetting

SHARE = 0.05


def weights(closing, pressure, share=SHARE):
    return wetting(np.asarray(closing, float), float(pressure), share)[0]


def test_it_wets_up_to_the_first_point_that_presses_with_more():
    closing = [0.0, 0.0, 300.0, 1100.0, 300.0, 0.0]
    wet = weights(closing, 1000.0)
    assert wet[:2].tolist() == [1.0, 1.0]
    assert 0.0 < wet[2] < 1.0
    assert wet[3:].tolist() == [0.0, 0.0, 0.0]
    assert (weights(closing, 5000.0)[3:] > 0.0).all()
    assert (np.diff(weights(closing, 5000.0)) <= 0.0).all()


def test_the_limits_of_the_front():
    """Dry from 1 + share times the pressure on, to the last bit; wetted where nothing presses."""
    for pressure in (1e-3, 1.0, 4e3):
        assert weights([pressure * (1.0 + SHARE)], pressure) == 0.0
        assert weights([pressure * (1.0 + SHARE) * (1.0 - 1e-9)], pressure) >= 0.0
        assert weights([0.0], pressure) == 1.0


def test_without_pressure_nothing_is_divided():
    wet, *slopes = wetting(np.array([0.0, 2.0, 0.0]), 0.0, SHARE)
    assert wet.tolist() == [1.0, 0.0, 0.0]
    assert np.isfinite(slopes).all()


@pytest.mark.parametrize("share", [0.01, 0.05, 1.0])
def test_both_equations_hold(share):
    """w_i = w_{i-1} (1 - s(u_i)) with the pressure c_i + p w_i on the profile in u_i."""
    rng, pressure = np.random.default_rng(3), 700.0
    closing = pressure * rng.uniform(0.0, 1.0, 12)
    wet = weights(closing, pressure, share)
    before = np.concatenate([[1.0], wet[:-1]])
    excess = (closing + pressure * wet - pressure) / (share * pressure)
    stepped = np.array([smooth_step(u)[0] for u in excess])
    # the slope of the step, at most 15 / 8, times what rounding leaves of its argument
    rounding = 8.0 * np.finfo(float).eps * 15.0 / 8.0 / share
    np.testing.assert_allclose(wet, before * (1.0 - stepped), rtol=0.0, atol=rounding)


def test_a_pressure_on_the_profile_belongs_to_one_state():
    """c + p w grows with c: no state is both wet and dry, and the front need not jump."""
    closing = np.linspace(0.0, 1500.0, 4001)
    whole = closing + 1000.0 * np.array([weights([c], 1000.0)[0] for c in closing])
    assert (np.diff(whole) > 0.0).all()


@pytest.mark.parametrize("share", [0.05, 0.5])
def test_derivatives_of_all_weights(share):
    rng, pressure = np.random.default_rng(5), 900.0
    closing = pressure * np.array([0.0, 0.1, *rng.uniform(0.2, 0.9, 4), 0.0, 0.3])
    on_closing, on_pressure = accumulated(*wetting(closing, pressure, share)[1:])

    def quotient(way, by):
        h = 1e-3
        found = [
            weights(closing + a * h * way, pressure + a * h * by, share) for a in (-2, -1, 1, 2)
        ]
        return np.array([1, -8, 8, -1]) @ found / (12 * h)

    # rounding of a weight over the step is 1e-12; a weight changes by about 1 over the pressure
    for j in range(1, closing.size):
        if closing[j] > 0.0:
            np.testing.assert_allclose(
                on_closing[:, j], quotient(np.eye(closing.size)[j], 0.0), rtol=1e-6, atol=1e-10
            )
    np.testing.assert_allclose(on_pressure, quotient(0.0, 1.0), rtol=1e-6, atol=1e-10)
    assert np.abs(on_closing).max() > 1e-4

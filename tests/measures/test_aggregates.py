"""Aggregates: bounds, limits, derivatives."""

import numpy as np
import pytest

from seal_mdao.measures.boundary_line import opened_square_integral
from seal_mdao.measures.smooth_peaks import lehmer_mean, p_norm


def central(function, x, step=1e-6):
    return np.array(
        [
            (function(x + step * e)[0] - function(x - step * e)[0]) / (2 * step)
            for e in np.eye(x.size)
        ]
    )


@pytest.mark.parametrize("aggregate", [p_norm, lehmer_mean])
def test_aggregates_are_homogeneous_with_exact_derivatives(aggregate, rng):
    values = rng.uniform(0.5, 1.5, 12)
    value, by_value = aggregate(values)
    assert aggregate(7.0 * values)[0] == pytest.approx(7.0 * value, rel=1e-13)
    assert by_value @ values == pytest.approx(value, rel=1e-13)
    np.testing.assert_allclose(by_value, central(aggregate, values), atol=1e-8)


def test_norm_is_above_and_mean_below_the_largest(rng):
    values = rng.uniform(0.0, 1.0, 30)
    assert values.max() <= p_norm(values)[0] <= values.max() * 30 ** (1 / 40)
    assert 0.7 * values.max() <= lehmer_mean(values)[0] <= values.max()
    assert lehmer_mean(np.full(5, 3.0))[0] == pytest.approx(3.0)


@pytest.mark.parametrize("aggregate", [p_norm, lehmer_mean])
def test_nothing_but_zeros_gives_zero(aggregate):
    value, by_value = aggregate(np.zeros(4))
    assert value == 0.0
    assert not by_value.any()


def test_large_values_do_not_overflow():
    assert np.isfinite(p_norm(np.array([1e12, 2e12]))[0])


def test_opened_integral_of_a_straight_gap_is_exact():
    """g = x - 1/3 on [0, 1], in uneven pieces: the integral of its opened part is (2/3)^3 / 3."""
    x = np.array([0.0, 0.2, 0.55, 0.9, 1.0])
    value, _, _ = opened_square_integral(x - 1 / 3, np.diff(x))
    assert value == pytest.approx((2 / 3) ** 3 / 3, rel=1e-13)
    mirrored, _, _ = opened_square_integral((x - 1 / 3)[::-1], np.diff(x)[::-1])
    assert mirrored == pytest.approx(value, rel=1e-13)


def test_opened_integral_has_exact_derivatives(rng):
    gap, length = rng.standard_normal(15), rng.uniform(0.5, 1.0, 14)
    _, by_gap, by_length = opened_square_integral(gap, length)
    np.testing.assert_allclose(
        by_gap, central(lambda g: opened_square_integral(g, length), gap), atol=1e-8
    )
    np.testing.assert_allclose(
        by_length, central(lambda s: opened_square_integral(gap, s), length), atol=1e-8
    )


def test_opened_integral_of_a_closed_stretch_is_zero():
    value, by_gap, _ = opened_square_integral(np.array([-1.0, -2.0, -1e-9]), np.ones(2))
    assert value == 0.0
    assert not by_gap.any()

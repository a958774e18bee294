"""Aggregates over scenarios: derivatives by complex step, bounds, limits."""

from functools import partial

import numpy as np
import pytest
from scipy.special import ndtri

from seal_mdao.scenarios import scenario_statistics as statistics

FUNCTIONS = {
    "mean": statistics.mean,
    "deviation": statistics.deviation,
    "highest": statistics.highest,
    "lowest": statistics.lowest,
    "q50": partial(statistics.quantile, level=0.5),
    "q95": partial(statistics.quantile, level=0.95),
}
STEP = 1e-30


@pytest.fixture
def values(rng):
    """Three columns of very different sizes; in the last, two scenarios have the largest value."""
    found = rng.normal(size=(13, 3)) * [1.0, 1e-6, 1e4] + [0.0, 1.0, -3e4]
    found[4, 2] = found[9, 2] = found[:, 2].max()
    return found


@pytest.mark.parametrize("name", FUNCTIONS)
def test_derivatives_are_those_of_complex_steps(name, values):
    """Rounding: sums of 13 terms, divided by a spread that is 1e-6 of the values in one column."""
    function = FUNCTIONS[name]
    value, gradient = function(values)
    assert value.shape == (3,)
    for row in range(len(values)):
        stepped = values.astype(complex)
        stepped[row] += 1j * STEP
        np.testing.assert_allclose(
            np.imag(function(stepped)[0]) / STEP, gradient[row], rtol=1e-8, atol=1e-9
        )


@pytest.mark.parametrize("name", FUNCTIONS)
def test_units_and_origin_do_not_matter(name, values):
    function = FUNCTIONS[name]
    sign = -1.0 if name == "deviation" else 1.0
    moved, _ = function(1000.0 * values + 7.0)
    shift = 0.0 if sign < 0 else 7.0
    np.testing.assert_allclose(moved, 1000.0 * function(values)[0] + shift, rtol=1e-10)


def test_smooth_worst_cases_bound_the_true_ones(values):
    slack = np.log(len(values)) / statistics.SHARPNESS * statistics.deviation(values)[0]
    high, low = statistics.highest(values)[0], statistics.lowest(values)[0]
    assert np.all((high >= values.max(axis=0)) & (high <= values.max(axis=0) + slack))
    assert np.all((low <= values.min(axis=0)) & (low >= values.min(axis=0) - slack))


@pytest.mark.parametrize("level", [0.05, 0.5, 0.95])
def test_quantile_of_a_normal_distribution(level):
    """Of its own quantiles, so that only the kernel is in error: the variance grows by its square."""
    count = 1000
    column = ndtri((np.arange(count) + 0.5) / count)[:, None]
    found = statistics.quantile(column, level)[0][0]
    spread = np.sqrt(1.0 + count ** (-2 / 3))
    assert found == pytest.approx(spread * ndtri(level), abs=2e-3)


def test_quantile_is_smooth_where_two_scenarios_change_places():
    column = np.linspace(0.0, 1.0, 9)
    ends = []
    for shift in (-1e-7, 1e-7):
        own = column.copy()
        own[7] = own[8] + shift
        ends.append(statistics.quantile(own[:, None], 0.9)[1][:, 0])
    assert np.abs(ends[0] - ends[1]).max() < 1e-5


@pytest.mark.parametrize("name", FUNCTIONS)
def test_equal_values_are_no_special_case(name):
    value, gradient = FUNCTIONS[name](np.full((4, 1), 3.0))
    assert value[0] == (0.0 if name == "deviation" else 3.0)
    assert np.isfinite(gradient).all()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_single_scenario_is_its_own_mean_and_has_no_deviation(name):
    value, gradient = FUNCTIONS[name](np.array([[3.0, -2.0]]))
    spread = name == "deviation"
    assert value.tolist() == ([0.0, 0.0] if spread else [3.0, -2.0])
    np.testing.assert_allclose(gradient, 0.0 if spread else 1.0, rtol=1e-14)


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("last", [0.0, 2.0**-52])
def test_equal_values_have_no_deviation(name, last):
    """Also where their mean is rounded, and where one value differs in its last digit."""
    column = np.full((3, 1), 0.1)
    assert column.mean() != 0.1
    column[2] += last * 0.1
    value, gradient = FUNCTIONS[name](column)
    # a change of all values by the same amount changes location by this amount and no deviation
    assert gradient.sum() == pytest.approx(0.0 if name == "deviation" else 1.0, abs=1e-14)
    assert np.abs(value - (0.0 if name == "deviation" else 0.1)).item() <= 1e-16
    if last == 0.0 and name == "deviation":
        assert value.item() == 0.0
        np.testing.assert_array_equal(gradient, 0.0)

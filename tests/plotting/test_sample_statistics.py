"""Histograms of samples: every sample is counted, also where all are equal to rounding."""

import numpy as np
import pytest

from seal_mdao.plotting.sample_statistics import distributions


@pytest.mark.parametrize(
    "values",
    [
        np.array([1.0, 1.0 + 2e-16, 1.0 - 1e-16]), np.zeros(3), np.full(3, -7.3),
        np.array([0.1, 0.3, 0.7]), np.array([1e-320, 0.0, 5.0]),
    ],
)  # fmt: skip
def test_every_sample_is_in_a_bin(values):
    figure = distributions(values[:, None], ["reaction"], ["N/m"])
    heights = [patch.get_height() for patch in figure.axes[0].patches]
    assert sum(heights) == len(values)


@pytest.mark.parametrize(("count", "bins"), [(4, 5), (16, 5), (100, 10), (5000, 30)])
def test_few_samples_have_few_bins(count, bins):
    values = np.linspace(1.0, 2.0, count)[:, None]
    axes = distributions(values, ["reaction"], ["N/m"]).axes[0]
    assert len(axes.patches) == bins
    # the estimate for the same samples does not make them finer
    assert len(distributions(values, ["reaction"], ["N/m"], values).axes[0].patches) == bins + 1


def test_the_tolerance_of_the_solver_is_no_scatter():
    values = 92.9333 * (1.0 + 3e-7 * np.linspace(-1.0, 1.0, 8))[:, None]
    axes = distributions(values, ["area"], ["mm**2"]).axes[0]
    assert sum(own.get_height() > 0 for own in axes.patches) == 1


@pytest.mark.parametrize("value", [-7.3, 0.0, 92.9333])
def test_a_constant_quantity_is_one_bar_in_the_middle(value):
    axes = distributions(np.full((5, 1), value), ["area"], ["mm**2"]).axes[0]
    (bar,) = (own for own in axes.patches if own.get_height())
    assert bar.get_height() == 5
    assert bar.get_x() + 0.5 * bar.get_width() == pytest.approx(value, abs=1e-12)
    low, high = axes.get_xlim()
    # numbers on the axis are those of the quantity, not differences of rounding
    assert high - low == pytest.approx(0.2 * abs(value) or 1.0, rel=0.15)
    axes.figure.canvas.draw()
    assert axes.xaxis.get_offset_text().get_text() == ""


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("count", [2, 5])
def test_infinite_samples_are_counted_beside_the_others(count):
    """Such as the leak rate of a seal without contact, in all or in some of the samples."""
    values = np.full(5, np.inf)
    values[: 5 - count] = np.arange(5.0 - count)
    figure = distributions(values[:, None], ["leak_rate"], [None], np.ones((5, 1)))
    (axes,) = figure.axes
    sampled = axes.containers[0]
    assert sum(own.get_height() for own in sampled) == 5 - count
    assert axes.get_xlabel() == f"leak rate, infinite in {count}"

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

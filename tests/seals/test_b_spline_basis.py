"""Values of B-splines against those of scipy."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from seal_mdao.seals.b_spline_basis import b_spline_values


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
@pytest.mark.parametrize("ends", ["clamped", "uniform", "double"])
def test_values_are_those_of_scipy(degree, ends):
    inner = np.sort(np.random.default_rng(degree).random(6))
    if ends == "clamped":
        knots = np.concatenate([[0.0] * (degree + 1), inner, [1.0] * (degree + 1)])
    elif ends == "uniform":
        knots = np.arange(-degree, 8 + degree) / 7
    else:
        # double knots in the interior: splines with a jump in a derivative
        knots = np.concatenate([[-0.1] * degree, [0.0], np.repeat(inner, 2), [1.0] * (degree + 1)])
    first, last = knots[degree], knots[-degree - 1]
    within = knots[(knots >= first) & (knots <= last)]
    points = np.concatenate([np.linspace(first, last, 101), within])
    expected = BSpline.design_matrix(points, knots, degree).toarray()
    np.testing.assert_allclose(b_spline_values(points, knots, degree), expected, rtol=0, atol=1e-15)

"""Golden-section search against scipy's bounded minimisation and at the ends of an interval."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from seal_mdao.seals.least_value import least_between


@pytest.mark.parametrize("function", [
    lambda s: (s - 0.3) ** 2, lambda s: np.cosh(3.0 * (s - 0.81)), lambda s: abs(s - 0.45),
    lambda s: s**4 - s,
])  # fmt: skip
def test_minimum_is_that_of_scipy(function):
    found = minimize_scalar(function, bounds=(0.0, 1.0), method="bounded", options={"xatol": 1e-10})
    at = least_between(function, 0.0, 1.0)
    assert at == pytest.approx(found.x, abs=3e-8)
    assert function(at) == pytest.approx(found.fun, abs=1e-8)


@pytest.mark.parametrize(("slope", "end"), [(1.0, 2.0), (-1.0, 5.0)])
def test_minimum_at_an_end(slope, end):
    assert least_between(lambda s: slope * s, 2.0, 5.0) == pytest.approx(end, abs=1e-8)


def test_smaller_errors_need_more_evaluations():
    counted = []

    def function(s):
        counted.append(s)
        return (s - 0.6) ** 2

    assert abs(least_between(function, 0.0, 1.0, 1e-2) - 0.6) <= 1e-2
    few = len(counted)
    assert abs(least_between(function, 0.0, 1.0, 1e-6) - 0.6) <= 1e-6
    assert few < len(counted) - few < 40

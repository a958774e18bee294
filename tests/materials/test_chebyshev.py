"""C(c) = cosh(a arccosh c) against polynomials, and across the switch from series to closed form.

For a = n / 2 it is T_n(x) with x = sqrt((1 + c) / 2), smooth at c = 1: an exact reference on both
sides, and for odd n one whose series in v does not end.
"""

import numpy as np
import pytest
from numpy.polynomial import chebyshev as polynomial

from seal_mdao.materials.chebyshev import SWITCH, _coefficients, closed_form, stretch_power

EPS = np.finfo(float).eps
V = np.concatenate([[0.0], np.geomspace(1e-12, 5.0, 120), SWITCH * (1 + np.array([-1e-9, 1e-9]))])


def reference(n, v):
    """C, C' and C'' of T_n(x(v)): x' = 1 / (4 x), x'' = -1 / (16 x^3)."""
    x = np.sqrt(1 + 0.5 * v)
    series = np.eye(n + 1)[n]
    t, t1, t2 = (polynomial.chebval(x, polynomial.chebder(series, m)) for m in range(3))
    return np.array([t, t1 / (4 * x), t2 / (16 * x**2) - t1 / (16 * x**3)])


def bound(a, values):
    """50 roundings of the largest of what is summed: 1, a^2 and C; C'' divides by 2 v >= SWITCH."""
    return 50 * EPS * (1 + a * a) ** 2 * np.maximum(1.0, np.abs(values[0]))


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 6, 9, 10, 13])
@pytest.mark.parametrize("sign", [1, -1])
def test_half_integer_exponents_are_chebyshev_polynomials(n, sign):
    exact = reference(n, V)
    found = stretch_power(V, 0.5 * sign * n)
    assert np.all(np.abs(found - exact) <= bound(0.5 * n, exact))


@pytest.mark.parametrize("a", [0.01, 0.35, 0.65, 1.0, 2.5, -1.7, 4.2, 9.7, 15.3])
def test_series_and_closed_form_agree_at_the_switch(a):
    """All five values, so energy, stress, tangent and constants go on smoothly."""
    closed = np.array(closed_form(SWITCH, a))
    series = stretch_power(np.array([SWITCH * (1 - 0.5 * EPS)]), a, 5)[:, 0]
    assert np.all(np.abs(series - closed) <= bound(a, closed))


@pytest.mark.parametrize("a", [0.35, -1.7, 4.2, 9.7, 15.3])
def test_derivatives_are_complex_steps(a):
    h = 1e-30
    found = stretch_power(V[1:], a, 5)
    by_v, by_a = (
        stretch_power(V[1:] + 1j * h, a).imag / h,
        stretch_power(V[1:], a + 1j * h).imag / h,
    )
    assert np.all(np.abs(found[1:3] - by_v[:2]) <= bound(a, found))
    assert np.all(np.abs(found[3:] - by_a[:2]) <= bound(a, found))


def test_limits_where_the_stretches_meet():
    for a in (0.3, 1.0, -2.5, 7.0):
        exact = [1.0, a * a, a * a * (a * a - 1) / 3, 0.0, 2 * a]
        np.testing.assert_allclose(stretch_power(0.0, a, 5), exact, rtol=4 * EPS)


def test_rounding_below_one_is_continued():
    """c = 1 - 1e-16 has no arccosh; C continues with its slope."""
    v = -1e-12
    np.testing.assert_allclose(stretch_power(v, 2.5)[0], 1 + 6.25 * v, rtol=2 * EPS)


@pytest.mark.parametrize("a", [0.35, 1.0, 2.5, 9.7])
def test_series_is_as_long_as_rounding_asks(a):
    """Its last terms are below rounding beside the first, those five before them are not."""
    table = np.abs(_coefficients(a)[:, 2]) * SWITCH ** np.arange(len(_coefficients(a)))
    assert table[-1] < 10 * EPS * a * a
    assert len(table) < 16 + 2 * a

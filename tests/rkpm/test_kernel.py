"""The cubic B-spline kernel against truncated powers, and its derivatives against complex step."""

import numpy as np
import pytest
from clouds import product_kernel, spline

from seal_mdao.rkpm.kernel import (
    cubic_b_spline,
    kernel_derivatives,
    product_kernel_derivatives,
)

STEP = 1e-30


@pytest.mark.parametrize("z", [0.0, 0.1, 0.3, 0.5, 0.51, 0.8, 0.999, 1.0, 1.7])
def test_kernel_is_the_cubic_b_spline(z):
    w, w1, w2 = cubic_b_spline(z)
    assert w == pytest.approx(spline(z + 0j).real, abs=1e-15)
    assert z * w1 == pytest.approx(spline(z + 0j, 1).real, abs=1e-14)
    assert w2 + w1 == pytest.approx(spline(z + 0j, 2).real, abs=1e-13)


@pytest.mark.parametrize("knot", [0.5, 1.0])
def test_kernel_is_twice_continuously_differentiable_at_its_knots(knot):
    left, right = cubic_b_spline(np.nextafter(knot, 0.0)), cubic_b_spline(np.nextafter(knot, 2.0))
    np.testing.assert_allclose(left, right, rtol=0.0, atol=1e-14)


def test_kernel_vanishes_with_two_derivatives_at_the_end_of_its_support():
    """w ~ (1 - z)^3 there, so each derivative loses one order."""
    for gap in (1e-3, 1e-5):
        w, w1, w2 = cubic_b_spline(1.0 - gap)
        assert w == pytest.approx(4.0 / 3.0 * gap**3, rel=1e-9)
        assert w1 == pytest.approx(-4.0 * gap**2 / (1.0 - gap), rel=1e-9)
        assert w1 + w2 == pytest.approx(8.0 * gap, rel=1e-9)
    assert cubic_b_spline(1.0) == (0.0, 0.0, 0.0)


def reference_gradient(rx, ry, a):
    distance = np.sqrt(rx * rx + ry * ry)
    slope = spline(distance / a, 1) / (a * distance)
    return slope * rx, slope * ry


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0, 4.0])
@pytest.mark.parametrize("z", [0.05, 0.3, 0.49, 0.6, 0.95])
def test_kernel_gradient_and_hessian_by_complex_step(z, angle):
    a = 2.3
    rx, ry = a * z * np.cos(angle), a * z * np.sin(angle)
    value, fx, fy, fxx, fxy, fyy = kernel_derivatives(rx, ry, a)
    assert value == pytest.approx(spline(z + 0j).real, rel=1e-13)
    steps = ((rx + 1j * STEP, ry + 0j), (rx + 0j, ry + 1j * STEP))
    first = [spline(np.sqrt(x * x + y * y) / a).imag / STEP for x, y in steps]
    second = [[c.imag / STEP for c in reference_gradient(x, y, a)] for x, y in steps]
    np.testing.assert_allclose((fx, fy), first, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose([[fxx, fxy], [fxy, fyy]], second, rtol=1e-12, atol=1e-13)


def test_kernel_is_smooth_at_its_centre():
    a = 1.7
    at_centre = kernel_derivatives(0.0, 0.0, a)
    np.testing.assert_allclose(at_centre, (2 / 3, 0.0, 0.0, -8 / a**2, 0.0, -8 / a**2), rtol=1e-15)
    for direction in (0.3, 1.9):
        beside = kernel_derivatives(1e-9 * np.cos(direction), 1e-9 * np.sin(direction), a)
        np.testing.assert_allclose(beside, at_centre, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.3, -0.8), (-0.9, 0.4), (0.2, 1.2), (-1.1, -0.3)])
def test_product_kernel_gradient_and_hessian_by_complex_step(place):
    axes, r = np.array([[0.7, 0.2], [-0.1, 0.5]]), np.array(place)
    value, fx, fy, fxx, fxy, fyy = product_kernel_derivatives(*r, *axes.ravel())
    found = [product_kernel(r + 1j * STEP * e, axes) for e in np.eye(2)]
    assert value == pytest.approx(found[0][0].real, rel=1e-13)
    np.testing.assert_allclose((fx, fy), [w.imag / STEP for w, _ in found], atol=1e-14)
    second = [slope.imag / STEP for _, slope in found]
    np.testing.assert_allclose([[fxx, fxy], [fxy, fyy]], second, rtol=1e-12, atol=1e-13)

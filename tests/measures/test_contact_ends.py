"""Where a contact ends between two contact points: Hertz's contact, limits, derivatives."""

import numpy as np
import pytest

from seal_mdao.measures.boundary_line import contact_fractions

MODULUS, PENALTY = 400.0, 1e5


def fraction(gap, length=1.0, modulus=MODULUS, penalty=PENALTY):
    """Fraction in contact of one segment."""
    found = contact_fractions(np.array(gap), np.array([length]), np.full(2, modulus), penalty)
    return found.fraction[0]


@pytest.mark.parametrize("inside", [0.2, 0.5, 0.9])
def test_ends_of_a_hertz_contact(inside):
    """K. L. Johnson, Contact Mechanics, 1985, section 4.2; errors of order spacing over half-width."""
    half, peak, errors = 1.0, 50.0, []
    for spacing in (0.02, 0.01):
        x, away = half - inside * spacing, half + (1.0 - inside) * spacing
        pressure = peak * np.sqrt(1.0 - (x / half) ** 2)
        ratio = away / half
        # g = (p0 a / E*) [t (t^2 - 1)^(1/2) - arcosh t],  t = x / a
        gap = peak * half / MODULUS * (ratio * np.sqrt(ratio**2 - 1.0) - np.arccosh(ratio))
        errors.append(abs(fraction([-pressure / PENALTY, gap], spacing) - inside))
    assert errors[0] < 0.01
    assert errors[1] < 0.6 * errors[0]


def test_the_end_passes_continuously_over_a_point():
    """An open point that is about to touch is the end; so is a point that is about to lift off."""
    assert fraction([-1e-4, 0.0]) == 1.0
    assert fraction([-1e-4, 1e-14]) == pytest.approx(1.0, abs=1e-6)
    assert fraction([-1e-14, 1e-2]) == pytest.approx(0.0, abs=1e-12)
    assert fraction([0.0, 1e-2]) == 0.0
    assert fraction([-1e-4, -1e-14]) == 1.0
    assert fraction([1e-2, -1e-4]) == fraction([-1e-4, 1e-2])


@pytest.mark.parametrize("gap", [(-1e-4, 1e-2), (3e-4, -2e-3), (-1e-9, 0.3), (-0.1, 1e-9)])
def test_derivatives(gap):
    """Against central differences, of all inputs; relative steps, so that no gap changes its sign."""
    values = np.array([*gap, 0.7, MODULUS, PENALTY])

    def of(v):
        return contact_fractions(v[:2], v[2:3], np.full(2, v[3]), v[4])

    found = of(values)
    by_log = found.by_log[0]
    exact = np.array(
        [found.by_first[0] * gap[0], found.by_second[0] * gap[1], -by_log, by_log, -by_log]
    )
    for number in range(5):
        step = np.where(np.arange(5) == number, 1e-5, 0.0)
        quotient = (of(values * (1 + step)).fraction - of(values * (1 - step)).fraction)[0] / 2e-5
        # truncation of relative order 1e-10, rounding of phi 1e-16 / 1e-5
        assert quotient == pytest.approx(exact[number], rel=1e-8, abs=1e-10)


def test_root_is_exact_for_any_gap():
    pressed = 1e-5
    for opened in np.geomspace(1e-14, 1e3, 60):
        phi = fraction([-pressed, opened])
        c = (0.75 * MODULUS * opened / (PENALTY * pressed)) ** (2.0 / 3.0)
        assert phi + c * np.cbrt(phi) == pytest.approx(1.0, abs=1e-13)

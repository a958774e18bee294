"""Roughness in contact: spectrum, contact area, separation of the critical constriction."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import beta, erf

from seal_mdao.measures.roughness import (
    GAMMA,
    PERCOLATION,
    Roughness,
    pressure_integral,
    pressure_integrand,
)

PLAIN, PLATEAU = Roughness(6.0, 500.0, 1.0), Roughness(2.0, 300.0, 0.5, 0.6, 2000.0)
BOTH = pytest.mark.parametrize("rough", [PLAIN, PLATEAU, Roughness(1.0, 10.0, 1e-3, 0.99)])


def spectral(rough, power, first, last):
    """Integrate 2 pi int q^power C dq over ln q, divided where the spectrum has a corner."""
    ends = sorted({first, last, *(q for q in rough.wavenumbers if first < q < last)})
    parts = [
        quad(lambda x: np.exp((power + 1.0) * x) * rough.spectrum(np.exp(x)), *np.log(pair),
             epsabs=0.0, epsrel=1e-12)[0]
        for pair in pairwise(ends)
    ]  # fmt: skip
    return 2.0 * np.pi * sum(parts)


@BOTH
def test_spectrum_has_the_height_and_the_slope(rough):
    ends = rough.wavenumbers[0], rough.wavenumbers[2]
    assert spectral(rough, 1, *ends) == pytest.approx(rough.rms_roughness**2, rel=1e-10)
    assert spectral(rough, 3, *ends) == pytest.approx(rough.rms_slope**2, rel=1e-10)
    for q in np.geomspace(*ends, 7)[1:]:
        half = 0.5 * spectral(rough, 3, ends[0], q)
        assert rough.half_squared_slope(q) == pytest.approx(half, rel=1e-10)
        assert rough.wavenumber_at(half) == pytest.approx(q, rel=1e-9)


@BOTH
def test_contact_area_of_small_large_and_percolating_pressures(rough):
    """sqrt(8 / pi) p / (E* slope) for small ones, complete for large ones."""
    small = 1e-4 * rough.rms_slope
    assert rough.contact_area(small) == pytest.approx(np.sqrt(8.0 / np.pi) * 1e-4, rel=1e-7)
    assert rough.contact_area(10.0 * rough.rms_slope) == 1.0
    assert rough.contact_area(rough.percolation_ratio) == pytest.approx(PERCOLATION, rel=1e-14)


@pytest.mark.parametrize("a", [1e-4, 0.03, 0.4, 1.0, 2.5, 6.0])
def test_integral_over_the_pressures_above(a):
    def part(first, last):
        return quad(
            lambda x: pressure_integrand(np.exp(x)), np.log(first), np.log(last), epsabs=0.0,
            epsrel=1e-13, limit=200,
        )[0]  # fmt: skip

    found = part(a, a + 1.0) + part(a + 1.0, a + 9.0)
    assert pressure_integral(np.array(a)) == pytest.approx(found, rel=1e-12)


def separation(rough, q, ratio):
    """Mean separation where roughness up to q is flat, and the contact area there, as Yang and Persson
    (2008) print it: two integrals, over the wavenumbers above q and the pressures above p A_0 / A."""
    first, corner, last = rough.wavenumbers
    area = erf(ratio / np.sqrt(0.5 * spectral(rough, 3, first, q)))

    def over_pressures(s):
        low = np.log(ratio / area)

        def integrand(x):
            p = s * np.exp(x)
            return (GAMMA + 3.0 * (1.0 - GAMMA) * erf(p) ** 2) * np.exp(-(p**2))

        return quad(integrand, low, max(low, -np.log(s)) + 2.2, epsrel=1e-10, limit=200)[0]

    def over_wavenumbers(x):
        k = q + np.exp(x)
        w = (0.5 * spectral(rough, 3, q, k)) ** -0.5
        return k**2 * rough.spectrum(k) * w * over_pressures(w) * np.exp(x)

    ends = np.append(np.linspace(np.log(1e-5 * q), np.log(last - q), 9), np.log(max(corner - q, q)))
    ends = np.unique(ends[ends <= np.log(last - q)])
    parts = [quad(over_wavenumbers, *pair, epsrel=1e-9)[0] for pair in pairwise(ends)]
    return np.sqrt(np.pi) * sum(parts), area


@pytest.mark.parametrize(("rough", "fraction"), [(PLAIN, 0.3), (PLATEAU, 0.05), (PLATEAU, 0.6)])
def test_constriction_is_that_of_the_published_integrals(rough, fraction):
    """u_1 = u + A du/dA at the wavenumber at which the contact area is that of percolation."""
    ratio = fraction * rough.percolation_ratio
    first, _, last = rough.wavenumbers

    def excess(q):
        return erf(ratio / np.sqrt(0.5 * spectral(rough, 3, first, q))) - PERCOLATION

    critical = brentq(excess, first * (1.0 + 1e-9), last, rtol=1e-13)
    step = 3e-4
    (below, less), (here, area), (above, more) = (
        separation(rough, critical * z, ratio) for z in (1.0 - step, 1.0, 1.0 + step)
    )
    published = here + area * (above - below) / (more - less)
    assert rough.constriction(np.array([ratio]))[0][0] == pytest.approx(published, rel=3e-7)


@pytest.mark.parametrize("hurst", [0.6, 0.8, 0.9])
def test_small_pressures_decay_exponentially_with_the_separation(hurst):
    """p ~ exp(-u / u_0), with the closed form of u_0 for roughness without end at short wavelengths."""
    rough = Roughness(3.0, 1e3, 1e-5, hurst)
    # u_0 = gamma rms sqrt(2 H (1 - H) / pi) B(H / (2 (1 - H)), 1/2) / (2 (1 - H))
    known = beta(0.5 * hurst / (1.0 - hurst), 0.5) / (2.0 * (1.0 - hurst))
    known *= GAMMA * 3.0 * np.sqrt(2.0 * hurst * (1.0 - hurst) / np.pi)
    ratio = np.array([1e-8, 1e-9]) * rough.rms_slope / 1e3
    height, slope = rough.constriction(ratio)
    assert -ratio * slope == pytest.approx(known, rel=1e-3)
    assert (height[1] - height[0]) / np.log(10.0) == pytest.approx(known, rel=1e-3)


@BOTH
def test_derivative_and_how_it_vanishes_at_percolation(rough):
    """The error of central differences falls with the square of their step."""
    ratio = np.array([1e-5, 1e-3, 0.03, 0.2, 0.5, 0.8]) * rough.percolation_ratio
    _, slope = rough.constriction(ratio)
    errors = []
    for step in (1e-2, 1e-3, 1e-4):
        above, below = (rough.constriction(ratio * z)[0] for z in (1.0 + step, 1.0 - step))
        errors.append(np.abs((above - below) / (2.0 * step * ratio) / slope - 1.0))
    assert (errors[1] <= 0.0101 * errors[0] + 1e-9).all()
    assert (errors[2] <= 0.0101 * errors[1] + 1e-9).all()
    assert errors[2].max() <= 1e-5
    height, slope = rough.constriction(np.array([0.97, 1.0, 3.0]) * rough.percolation_ratio)
    assert height[0] <= 1e-8 * rough.rms_roughness
    assert not height[1:].any()
    assert not slope[1:].any()


def test_heights_scale_with_the_roughness_and_the_wavelengths():
    ratio = 0.1 * PLATEAU.percolation_ratio
    height = PLATEAU.constriction(np.array([ratio]))[0]
    rougher = Roughness(6.0, 300.0, 0.5, 0.6, 2000.0).constriction(np.array([3.0 * ratio]))[0]
    longer = Roughness(2.0, 900.0, 1.5, 0.6, 6000.0).constriction(np.array([ratio / 3.0]))[0]
    assert rougher == pytest.approx(3.0 * height, rel=1e-12)
    assert longer == pytest.approx(height, rel=1e-12)


@pytest.mark.parametrize(("wrong", "words"), [
    ((0.0, 500.0, 1.0), "rms_roughness must be a number above 0, got 0.0"),
    ((6.0, 500.0, float("nan")), "shortest_wavelength must be a number above 0"),
    ((6.0, 500.0, 1.0, 1.0), "hurst_exponent must be a number above 0 and below 1, got 1.0"),
    ((6.0, 500.0, 500.0), "got 500, 500, 500 um"),
    ((6.0, 500.0, 1.0, 0.8, 400.0), "got 1, 500, 400 um"),
    ((6.0, 500.0, 1.0, 0.8, 1e10), "longest_wavelength <= 1e.09 shortest_wavelength"),
])  # fmt: skip
def test_wrong_roughness(wrong, words):
    with pytest.raises(ValueError, match=words):
        Roughness(*wrong)

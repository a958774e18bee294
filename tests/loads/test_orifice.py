"""Flow through an orifice: derivatives, choking, the incompressible limit."""

from decimal import Decimal, localcontext

import numpy as np
import pytest

from seal_mdao.loads.orifice import CHOKED, RATIO, SMALL, SMOOTH, _expansion, orifice_flow

PLACES, WEIGHTS = np.array([-2, -1, 1, 2]), np.array([1, -8, 8, -1]) / 12.0


@pytest.mark.parametrize("gamma", [1.0, 1.4])
@pytest.mark.parametrize("y", [-0.4, -1e-3, -1e-5, -1e-7, 1e-6, 1e-5, 6e-5, 1e-3, 0.3, 0.7])
def test_derivatives_against_central_differences(y, gamma):
    """Below and above the linear range, on both sides of the series, and choked."""
    flow, h = orifice_flow(y, gamma), 1e-3 * abs(y)
    slope = WEIGHTS @ [orifice_flow(y + k * h, gamma).value for k in PLACES] / h
    assert slope == pytest.approx(flow.by_density, rel=1e-9)
    h = 1e-3
    slope = WEIGHTS @ [orifice_flow(y, gamma + k * h).value for k in PLACES] / h
    assert slope == pytest.approx(flow.by_gamma, rel=1e-9)


@pytest.mark.parametrize("part", [1e-3, 0.1, 0.99, 1.01, 100.0])
def test_the_expansion_has_all_digits_on_both_sides_of_the_series(part):
    """psi(z) / z = exp(-2 z / k) (1 - exp(-b z)) / (b z), b = (k - 1) / k, and the derivative of its
    logarithm, with 50 digits."""
    size = part * SMALL * RATIO / (RATIO - 1.0)
    with localcontext() as digits:
        digits.prec = 50
        k, z = Decimal(RATIO), Decimal(size)
        b = (k - 1) / k
        value = (-2 * z / k).exp() * (1 - (-b * z).exp()) / (b * z)
        growth = b / ((b * z).exp() - 1) - 1 / z - 2 / k
    found = _expansion(size)
    assert found[0] == pytest.approx(float(value), rel=1e-12)
    assert found[1] == pytest.approx(float(growth), rel=1e-11)


@pytest.mark.parametrize("ratio", [0.2, 0.5, 0.6, 0.95, 1.02, 1.5, 1.8, 2.5])
def test_the_flow_is_that_of_an_isentropic_nozzle(ratio):
    """From the Mach number in the throat, for inside over outside pressures ``ratio``."""
    gamma, k = 1.3, RATIO
    inside = ratio ** (1.0 / gamma)  # density
    # pressure and density upstream; p_u / p = (1 + (k - 1) / 2 Ma^2)^(k / (k - 1)), Ma <= 1
    pressure, density = (ratio, inside) if ratio > 1.0 else (1.0, 1.0)
    drop = max(ratio, 1.0 / ratio)
    mach = min(1.0, np.sqrt(2.0 / (k - 1.0) * (drop ** ((k - 1.0) / k) - 1.0)))
    warm = 1.0 + 0.5 * (k - 1.0) * mach**2
    # rho v over rho_a sqrt(2 p_a / rho_a)
    throat = density * warm ** (-1.0 / (k - 1.0))
    velocity = mach * np.sqrt(k * pressure / density / warm)
    found = orifice_flow(np.log(inside), gamma).value
    assert found == pytest.approx(np.sign(ratio - 1.0) * throat * velocity / np.sqrt(2.0), rel=1e-7)
    assert (mach == 1.0) == (abs(np.log(ratio)) > CHOKED)


def test_a_small_pressure_drives_an_incompressible_flow():
    """Phi = sqrt(p / p_a), and linear well below the pressure that smooths the root."""
    for excess in (1e-3, -1e-3):
        flow = orifice_flow(np.log1p(excess), 1.0).value
        assert flow == pytest.approx(np.copysign(np.sqrt(1e-3), excess), rel=2e-3)
    assert orifice_flow(1e-9, 1.0).value == pytest.approx(1e-9 / np.sqrt(SMOOTH), rel=1e-6)
    assert orifice_flow(0.0, 1.4).value == 0.0

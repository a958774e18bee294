"""Flow of a gas through an orifice between a cavity and the outside, isentropic and compressible.

With y the logarithm of the density over that outside, the pressure ratio is exp(L), L = gamma y, and the
mass flow per area of the orifice, over rho_a sqrt(2 p_a / rho_a), is

    Phi = sign(L) sqrt(u psi(|L|)),
    psi(l) = k / (k - 1) (exp(-2 l / k) - exp(-(k + 1) l / k)),    l <= l_c = k / (k - 1) ln((k + 1) / 2)

(de Saint-Venant and Wantzel 1839) with u = exp((1 + gamma) y), pressure times density upstream, for
outflow and 1 for inflow. Beyond l_c the flow is choked: psi stays. At L = 0, where the root has no
derivative, sign(L) sqrt(|L|) is replaced by L / (L^2 + SMOOTH^2)^(1/4).
"""

import math
from typing import NamedTuple

RATIO = 1.4
"""Ratio k of the specific heats of air: the flow through an orifice has no time for heat."""

SMOOTH = 1e-5
"""Relative excess pressure (1 Pa in air) below which the flow is linear in it, as laminar flow is."""

SMALL = 1e-4
"""Of b l, below which the first terms of a series take the place of a difference."""

_B = (RATIO - 1.0) / RATIO
CHOKED = math.log((RATIO + 1.0) / 2.0) / _B
"""Logarithm of the pressure ratio at which the velocity is that of sound: 1.893 for air."""


class Flow(NamedTuple):
    """Phi and its derivatives with respect to y and gamma."""

    value: float
    by_density: float
    by_gamma: float


def orifice_flow(y: float, gamma: float) -> Flow:
    """Compute the mass flow out of a cavity, relative to the area times rho_a sqrt(2 p_a / rho_a).

    Parameters
    ----------
    y : float
        Logarithm of the density inside over that outside.
    gamma : float
        Polytropic exponent of the air inside.
    """
    ratio = gamma * y
    # h = L / (L^2 + e^2)^(1/4),  h' = (1 - L^2 / (2 (L^2 + e^2))) / (L^2 + e^2)^(1/4)
    square = ratio * ratio + SMOOTH * SMOOTH
    root = square**-0.25
    smooth, slope = ratio * root, (1.0 - 0.5 * ratio * ratio / square) * root
    # s = sqrt(u psi / l)
    per_ratio, growth = _expansion(abs(ratio))
    upstream = max(0.0, y)
    size = math.exp(0.5 * (1.0 + gamma) * upstream) * math.sqrt(per_ratio)
    # Phi = h s,  dPhi/dL = h' s + h s sign(L) / 2 d ln(psi / l)/dl at fixed u
    value = smooth * size
    by_ratio = size * (slope + 0.5 * growth * abs(smooth))
    # d ln u / dy = 1 + gamma, d ln u / dgamma = y for outflow
    by_upstream = 0.5 * value if y > 0.0 else 0.0
    return Flow(
        value, gamma * by_ratio + (1.0 + gamma) * by_upstream, y * by_ratio + upstream * by_upstream
    )


def _expansion(size: float) -> tuple[float, float]:
    """Compute psi(l) / l, and the derivative of its logarithm, at ``size`` l >= 0."""
    if size > CHOKED:
        # psi stays at its largest value
        return _psi(CHOKED) / size, -1.0 / size
    exponent = _B * size
    if exponent < SMALL:
        # (1 - exp(-z)) / z = 1 - z / 2 + z^2 / 6,  its logarithm has the derivative -1/2 + z / 12
        steady, growth = 1.0 - exponent / 2.0 + exponent**2 / 6.0, _B * (exponent / 12.0 - 0.5)
        return math.exp(-2.0 * size / RATIO) * steady, growth - 2.0 / RATIO
    # d ln(psi / l) / dl = b / (exp(b l) - 1) - 1 / l - 2 / k
    return _psi(size) / size, _B / math.expm1(exponent) - 1.0 / size - 2.0 / RATIO


def _psi(size: float) -> float:
    """Compute psi(l) = exp(-2 l / k) (1 - exp(-b l)) / b with b = (k - 1) / k."""
    return math.exp(-2.0 * size / RATIO) * -math.expm1(-_B * size) / _B

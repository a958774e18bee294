"""Blocks of an incompressible viscoelastic rubber in homogeneous states: the exact convolution.

Finite linear viscoelasticity (J. C. Simo, Comput. Methods Appl. Mech. Engrg. 60 (1987) 153;
G. A. Holzapfel, Nonlinear Solid Mechanics, 2000, Sec. 6.10) with the long-term isochoric energy W:

    Q_i(t) = beta_i int_0^t exp(-(t - s) / tau_i) dS_iso(s)/ds ds,   beta_i = g_i / (1 - sum g),
    P = P_long + F sum_i Q_i.
"""

from typing import NamedTuple

import numpy as np

POINTS = 40
"""Gauss points of a piece of the program."""


class Rubber(NamedTuple):
    """Mooney-Rivlin constants of the long term, kPa, and the Prony terms: g without unit, tau in s."""

    c10: float
    c01: float
    g: tuple[float, ...]
    tau: tuple[float, ...]


class Program(NamedTuple):
    """Axial stretch over the time, s, linear between its corners; it starts undeformed at time zero."""

    time: tuple[float, ...]
    stretch: tuple[float, ...]


def free_stretches(axial, kind: str) -> np.ndarray:
    """Principal stretches (3, n): axial, of the free side, of the third direction.

    ``kind``: "uniaxial", or "plane" for plane strain.
    """
    axial = np.asarray(axial, float)
    if kind == "plane":
        return np.array([axial, 1.0 / axial, np.ones_like(axial)])
    return np.array([axial, axial**-0.5, axial**-0.5])


def isochoric_stress(stretches: np.ndarray, c10: float, c01: float) -> np.ndarray:
    """S_iso,a = (dW/dl_a) / l_a of W = C10 (I1 J^-2/3 - 3) + C01 (I2 J^-4/3 - 3) at J = 1, kPa."""
    square = stretches**2
    one, two = square.sum(axis=0), (1.0 / square).sum(axis=0)
    first = 2.0 * c10 * (1.0 - one / (3.0 * square))
    return first + 2.0 * c01 * (one - square - 2.0 * two / (3.0 * square))


def _overstress(rubber: Rubber, program: Program, kind: str, at: float) -> np.ndarray:
    """sum_i Q_i of the principal directions (3,) at a time, s."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)

    def stress(times):
        axial = np.interp(times, program.time, program.stretch)
        return isochoric_stress(free_stretches(axial, kind), rubber.c10, rubber.c01)

    total, long_term = np.zeros(3), 1.0 - sum(rubber.g)
    pieces = zip(program.time[:-1], program.time[1:], np.diff(program.stretch), strict=True)
    for start, end, change in pieces:
        if start >= at or change == 0.0:
            continue
        end = min(end, at)
        for g, tau in zip(rubber.g, rubber.tau, strict=True):
            # what is older than 40 tau is forgotten to exp(-40)
            both = np.array([max(start, min(end, at - 40.0 * tau)), end])
            half = 0.5 * (both[1] - both[0])
            times = both[0] + half * (1.0 + nodes)
            # int e S' ds = [e S] - (1/tau) int e S ds,   e = exp(-(t - s) / tau)
            kernel = np.exp(-(at - times) / tau)
            ends = np.exp(-(at - both) / tau) * stress(both)
            inner = half * (weights * kernel * stress(times)).sum(axis=1)
            total += g / long_term * (ends[:, 1] - ends[:, 0] - inner / tau)
    return total


def nominal_stress(rubber: Rubber, program: Program, kind: str, times) -> np.ndarray:
    """Axial nominal stress at ``times`` (n,), kPa, with a stress-free side.

    P = (l_1^2 (S_1 + Q_1) - l_2^2 (S_2 + Q_2)) / l_1: the pressure frees direction 2.
    """
    found = []
    for at in times:
        stretches = free_stretches(np.interp(at, program.time, program.stretch), kind)
        own = isochoric_stress(stretches, rubber.c10, rubber.c01)
        own = own + _overstress(rubber, program, kind, at)
        found.append((stretches[0] ** 2 * own[0] - stretches[1] ** 2 * own[1]) / stretches[0])
    return np.array(found)

"""Mullins effect: softening of rubber below its largest previous energy.

With the isochoric energy W per volume of a point and the largest one W_max that it has had, the law of
R. W. Ogden and D. G. Roxburgh, Proc. R. Soc. Lond. A 455 (1999) 2861, in the form with beta of Abaqus:

    P = eta dW/dF,    eta = 1 - erf(z) / r,    z = (W_max - W) / s,    s = m + beta W_max

below W_max, and eta = 1 at it. With W_max of the load steps before, the law of a step is that of the
potential

    phi = W + (s / r) (z erf(z) + (exp(-z^2) - 1) / sqrt(pi)),    phi = W at and above W_max,

which is continuous with its slope eta in W.
"""

import math
from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np
from scipy.special import erf

from seal_mdao import values

PREFIX = "softening_"
"""Before the names of the constants as parameters."""
MOST = 1e12
"""Largest constant."""
_ROOT = math.sqrt(math.pi)


@dataclass(frozen=True)
class OgdenRoxburgh:
    """Law of Ogden and Roxburgh for softening, with its constants.

    Attributes
    ----------
    r : float
        Above 1; eta is at least 1 - 1 / r.
    m : float
        Energy per volume below W_max within which rubber softens, kPa.
    beta : float
        Fraction of W_max that adds to ``m``.

    Raises
    ------
    ValueError
        For other constants, and where both m and beta are zero.
    """

    r: float
    m: float
    beta: float

    def __post_init__(self):
        least = {"r": {"above": 1.0}, "m": {"low": 0.0}, "beta": {"low": 0.0}}
        for name, bound in least.items():
            own = values.real(f"{name} of softening", getattr(self, name), high=MOST, **bound)
            object.__setattr__(self, name, own)
        if self.m == 0.0 and self.beta == 0.0:
            raise ValueError(
                "the constants m and beta of Mullins softening are both zero, but m + beta W_max "
                "must be positive; give m or beta a value above 0"
            )

    @property
    def constants(self) -> dict[str, float]:
        """Parameters by name: ``softening_r``, ``softening_m``, ``softening_beta``."""
        return {PREFIX + field.name: getattr(self, field.name) for field in fields(self)}

    def with_(self, **constants) -> "OgdenRoxburgh":
        """Return the same law with some of the ``constants`` changed."""
        return replace(self, **{n.removeprefix(PREFIX): value for n, value in constants.items()})


UNITS = {"softening_m": "kPa"}
"""Of the constants that have one, as OpenMDAO writes them."""


class Softened(NamedTuple):
    """Factor eta of the law and its derivatives; arrays of the shape of the energies.

    Attributes
    ----------
    factor : ndarray
        eta.
    by_energy, by_largest : ndarray
        Derivatives in W and in W_max; zero at and above W_max.
    by_constants : ndarray, shape (3, ...)
        Derivatives in r, m and beta.
    """

    factor: np.ndarray
    by_energy: np.ndarray
    by_largest: np.ndarray
    by_constants: np.ndarray


def is_below(energy, largest) -> np.ndarray:
    """Return where rubber is below its largest previous energy."""
    return energy < largest


def _distance(energy, largest, m, beta):
    """Compute s, and z, which is 0 at and above W_max."""
    width = m + beta * largest
    # a point that has had no energy yet may have s = 0, and by rounding W < 0 = W_max
    below = is_below(energy, largest) & (width > 0.0)
    width = np.where(below, width, 1.0)
    return below, width, np.where(below, largest - energy, 0.0) / width


def softened(energy, largest, r, m, beta) -> Softened:
    """Evaluate eta and its derivatives; arrays broadcast against each other.

    Parameters
    ----------
    energy, largest : ndarray
        W, and W_max before, kPa.
    r, m, beta : ndarray or float
        Constants; an infinite r is rubber that does not soften.
    """
    below, width, z = _distance(energy, largest, m, beta)
    # d erf(z)/dz = 2 exp(-z^2) / sqrt(pi),  dz/dW = -1 / s,  dz/dW_max = (1 - beta z) / s
    slope = np.where(below, 2.0 / _ROOT * np.exp(-z * z) / (r * width), 0.0)
    # d eta/dr
    on_r = erf(z) / (r * r)
    # dz/dm = -z / s,  dz/dbeta = -z W_max / s
    return Softened(
        1.0 - erf(z) / r, slope, -slope * (1.0 - beta * z),
        np.array([on_r, slope * z, slope * z * largest]),
    )  # fmt: skip


def step_potential(energy, largest, r, m, beta) -> np.ndarray:
    """Evaluate phi."""
    _, width, z = _distance(energy, largest, m, beta)
    # phi = W + (s / r) (z erf z + (exp(-z^2) - 1) / sqrt(pi))
    return energy + width / r * (z * erf(z) + np.expm1(-z * z) / _ROOT)

"""Foam rubber (sponge) by its grade of ASTM D1056, often the only number stated by suppliers.

A grade is a range of the pressure that compresses a sheet by 25 %. One number determines one modulus,
so the law is the hyperfoam of one term with alpha = 2 and nu = 0: W = mu/2 (I1 - 3 - 2 ln J), the
compressible neo-Hookean solid without lateral strain. Uniaxially P = mu (lambda - 1/lambda).
"""

from dataclasses import dataclass
from typing import ClassVar

from seal_mdao.materials.hyperfoam import Hyperfoam

PSI = 6.894757
"""kPa."""
COMPRESSED = 0.75
"""Stretch at which a grade states the pressure."""
GRADES = {
    "2A1": (2.0, 5.0), "2A2": (5.0, 9.0), "2A3": (9.0, 13.0), "2A4": (13.0, 17.0),
    "2A5": (17.0, 25.0),
}  # fmt: skip
"""Pressure at 25 % of compression, psi, of closed-cell foam (2) of rubber that need not resist oil,
such as EPDM (A): ASTM D1056, Standard Specification for Flexible Cellular Materials - Sponge or
Expanded Rubber."""


@dataclass(frozen=True)
class GradedSponge(Hyperfoam):
    """Hyperfoam of a grade, valid up to the compression at which ASTM D1056 tests its set."""

    valid: ClassVar = (0.5, 1.5)
    """Stretches; tension is no part of the specification."""


def pressure_range(grade: str) -> tuple[float, float]:
    """Return the pressures at 25 % of compression between which a grade lies, kPa."""
    low, high = GRADES[grade]
    return PSI * low, PSI * high


def graded_sponge(grade: str) -> GradedSponge:
    """Make the foam in the middle of a grade of ``GRADES``."""
    # p = mu (1 / lambda - lambda) at lambda = 0.75
    pressure = 0.5 * sum(pressure_range(grade))
    return GradedSponge((pressure / (1.0 / COMPRESSED - COMPRESSED),), (2.0,), (0.0,))

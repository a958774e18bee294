"""The laws under test, one of them from outside, and each once more from its principal stretches."""

from copy import copy
from typing import NamedTuple

import numpy as np
from arruda_boyce import SERIES, ArrudaBoyce

from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.yeoh import Yeoh

LAWS = {
    "neo_hookean": NeoHookean(c10=90.0),
    "mooney_rivlin": MooneyRivlin(c10=80.0, c01=20.0),
    "yeoh": Yeoh(c10=100.0, c20=-8.0, c30=3.0),
    "gent": Gent(shear_modulus=190.0, limit=12.0),
    "outside": ArrudaBoyce(modulus=170.0, links=8.0),
    "ogden_1": Ogden(mu=(140.0,), alpha=(2.7,)),
    # Treloar's rubber by Ogden, in kPa
    "ogden_3": Ogden(mu=(630.0, 1.2, -10.0), alpha=(1.3, 5.0, -2.0)),
    "foam_0": Hyperfoam(mu=(60.0, 25.0), alpha=(6.2, -3.1), nu=(0.0, 0.0)),
    "foam_3": Hyperfoam(mu=(60.0, 25.0), alpha=(6.2, -3.1), nu=(0.3, 0.2)),
}
ISOCHORIC = [name for name in LAWS if not name.startswith("foam")]


def principal_energy(law, stretches):
    """W of three principal stretches (real or complex), from the published form of the law."""
    stretches = np.asarray(stretches)
    j = np.prod(stretches)
    if isinstance(law, Hyperfoam):
        total = 0.0
        for mu, alpha, nu in zip(law.mu, law.alpha, law.nu, strict=True):
            b = nu / (1 - 2 * nu)
            volume = np.expm1(-alpha * b * np.log(j)) / b if b else -alpha * np.log(j)
            total += 2 * mu / alpha**2 * (np.sum(stretches**alpha) - 3 + volume)
        return total
    bar = stretches / j ** (1 / 3)
    x, second = np.sum(bar**2) - 3, np.sum(bar**-2.0) - 3
    if isinstance(law, Ogden):
        terms = zip(law.mu, law.alpha, strict=True)
        return sum(mu / alpha * (np.sum(bar**alpha) - 3) for mu, alpha in terms)
    if isinstance(law, MooneyRivlin):
        return law.c10 * x + law.c01 * second
    if isinstance(law, NeoHookean):
        return law.c10 * x
    if isinstance(law, Yeoh):
        return law.c10 * x + law.c20 * x**2 + law.c30 * x**3
    if isinstance(law, ArrudaBoyce):
        powers = (((x + 3) / law.links) ** i - (3 / law.links) ** i for i in range(1, 6))
        return law.modulus * law.links * sum(c * p for c, p in zip(SERIES, powers, strict=True))
    return -0.5 * law.shear_modulus * law.limit * np.log(1 - x / law.limit)


def principal_forces(law, stretches, h=1e-30):
    """dW / d lambda_i by complex step, three of them."""
    shifts = 1j * h * np.eye(3)
    return np.array([principal_energy(law, stretches + s).imag / h for s in shifts])


class State(NamedTuple):
    """F = R(left) diag(stretches) R(right) in the plane."""

    first: float
    second: float
    left: float = 0.0
    right: float = 0.0

    @property
    def stretches(self):
        return np.array([self.first, self.second, 1.0])

    @property
    def F(self):
        return rotation(self.left) @ np.diag(self.stretches[:2]) @ rotation(self.right)

    @property
    def invariants(self):
        return np.float64(self.first**2 + self.second**2), np.float64(self.first * self.second)


def rotation(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def apart(u, volume=1.0, left=0.3, right=-1.1):
    """Two stretches with ln(lambda_1 / lambda_2) = u and the product ``volume``."""
    return State(np.sqrt(volume) * np.exp(0.5 * u), np.sqrt(volume) * np.exp(-0.5 * u), left, right)


UNDEFORMED = State(1.0, 1.0)
FAR = [State(1.4, 0.6, 0.4, 1.2), State(0.55, 1.5, -2.0, 0.3), State(2.1, 0.9, 1.0, -0.4)]
# around the switch of Ogden's series, v = cosh u - 1 = 0.1 at u = 0.4436, and where stretches meet
NEAR = [
    apart(u, j) for u in (0.0, 1e-3, 1e-2, 0.1, 0.4, 0.4435, 0.4437, 0.5) for j in (0.8, 1.0, 1.3)
]
STATES = [UNDEFORMED, *NEAR, *FAR]


def size(law):
    """Sum of the moduli without their signs: what rounding is measured in."""
    if isinstance(law, Ogden | Hyperfoam):
        return sum(abs(m) * max(1.0, abs(a)) for m, a in zip(law.mu, law.alpha, strict=True))
    return sum(
        abs(v)
        for name, v in law.constants.items()
        if name not in ("bulk_modulus", "limit", "links")
    )


def moved(law, name, by):
    """The law with a constant changed by any number, a complex one too."""
    other = copy(law)
    field, _, number = name.rpartition("_")
    if number.isdigit():
        values = list(getattr(law, field))
        values[int(number) - 1] += by
        object.__setattr__(other, field, tuple(values))
    else:
        object.__setattr__(other, name, getattr(law, name) + by)
    return other

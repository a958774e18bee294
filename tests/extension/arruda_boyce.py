"""A material: Arruda and Boyce's eight chains, by their polynomial.

W = mu sum_i C_i / N^(i-1) (I1^i - 3^i), the series of the inverse Langevin function to its fifth
term, N the chain links between crosslinks (J. Mech. Phys. Solids 41 (1993) 389).
"""

from dataclasses import dataclass
from typing import ClassVar

import seal_mdao as sm
from seal_mdao.materials.first_invariant import FirstInvariant
from seal_mdao.materials.isotropic import checked

SERIES = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)


@sm.register("materials", "arruda_boyce")
@dataclass(frozen=True)
class ArrudaBoyce(FirstInvariant):
    modulus: float
    links: float
    bulk_modulus: float = 80_000.0

    moduli: ClassVar = ("modulus", "bulk_modulus")

    def __post_init__(self):
        checked(self, positive=("modulus", "links", "bulk_modulus"))

    def invariant_energy(self, x):
        return self.modulus * sum(
            c / self.links**i * ((x + 3) ** (i + 1) - 3 ** (i + 1)) for i, c in enumerate(SERIES)
        )

    def invariant_derivatives(self, x):
        terms = [(c / self.links**i, i) for i, c in enumerate(SERIES)]
        first = sum(c * (i + 1) * (x + 3) ** i for c, i in terms)
        second = sum(c * (i + 1) * i * (x + 3) ** (i - 1) for c, i in terms[1:])
        return self.modulus * first, self.modulus * second

    def invariant_constants(self, x):
        first, _ = self.invariant_derivatives(x)
        by_links = sum(
            -i * c / self.links ** (i + 1) * (i + 1) * (x + 3) ** i for i, c in enumerate(SERIES)
        )
        return first / self.modulus, self.modulus * by_links

"""Neo-Hookean rubber, W = C10 x with x = I1 J^(-2/3) - 3."""

from dataclasses import dataclass
from typing import ClassVar

from seal_mdao.materials.first_invariant import FirstInvariant
from seal_mdao.materials.isotropic import check_bulk, checked


@dataclass(frozen=True)
class NeoHookean(FirstInvariant):
    """Neo-Hookean law of Gaussian chains (L. R. G. Treloar, The Physics of Rubber Elasticity,
    chapter 4).

    Attributes
    ----------
    c10 : float
        Half the shear modulus, positive.
    bulk_modulus : float
        K of the volumetric energy K/2 (J - 1)^2 with the projected volume ratio J, positive.
    """

    c10: float = 100.0
    bulk_modulus: float = 80_000.0

    moduli: ClassVar = ("c10", "bulk_modulus")

    def __post_init__(self):
        checked(self, positive=("c10", "bulk_modulus"))
        check_bulk(self)

    def invariant_energy(self, x):
        """Evaluate f = C10 x."""
        return self.c10 * x

    def invariant_derivatives(self, x):
        """Evaluate f' = C10 and f'' = 0."""
        return self.c10, 0.0

    def invariant_constants(self, x):
        """Evaluate df'/dC10 = 1."""
        return (1.0,)

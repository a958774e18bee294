"""Yeoh rubber, W = C10 x + C20 x^2 + C30 x^3 with x = I1 J^(-2/3) - 3."""

from dataclasses import dataclass
from typing import ClassVar

from seal_mdao.materials.first_invariant import FirstInvariant
from seal_mdao.materials.isotropic import check_bulk, checked


@dataclass(frozen=True)
class Yeoh(FirstInvariant):
    """Yeoh law, cubic in the first invariant, for filled rubbers (O. H. Yeoh, Rubber Chem. Technol.
    66 (1993) 754).

    Attributes
    ----------
    c10 : float
        Half the initial shear modulus, positive.
    c20, c30 : float
        Coefficients of x^2 and x^3 in W, with x = I_1 - 3 (isochoric); c20 is mostly negative
        (softening at medium strain) and c30 positive. dW/dx must be positive at all strains that occur.
    bulk_modulus : float
        K of the volumetric energy K/2 (J - 1)^2 with the projected volume ratio J, positive.
    """

    c10: float = 100.0
    c20: float = 0.0
    c30: float = 0.0
    bulk_modulus: float = 80_000.0

    moduli: ClassVar = ("c10", "c20", "c30", "bulk_modulus")

    def __post_init__(self):
        checked(self, positive=("c10", "bulk_modulus"), real=("c20", "c30"))
        check_bulk(self)

    def invariant_energy(self, x):
        """Evaluate f = C10 x + C20 x^2 + C30 x^3."""
        return x * (self.c10 + x * (self.c20 + x * self.c30))

    def invariant_derivatives(self, x):
        """Evaluate f' and f''."""
        # f' = C10 + 2 C20 x + 3 C30 x^2,  f'' = 2 C20 + 6 C30 x
        first = self.c10 + x * (2.0 * self.c20 + x * (3.0 * self.c30))
        return first, 2.0 * self.c20 + 6.0 * self.c30 * x

    def invariant_constants(self, x):
        """Evaluate df'/dC10 = 1, df'/dC20 = 2 x and df'/dC30 = 3 x^2."""
        return 1.0, 2.0 * x, 3.0 * x * x

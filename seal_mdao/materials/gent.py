"""Gent rubber, W = -(G Jm / 2) ln(1 - x / Jm) with x = I1 J^(-2/3) - 3 < Jm."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from seal_mdao.materials.first_invariant import FirstInvariant
from seal_mdao.materials.isotropic import check_bulk, checked


@dataclass(frozen=True)
class Gent(FirstInvariant):
    """Gent law of chains of limited extension (A. N. Gent, Rubber Chem. Technol. 69 (1996) 59).

    At x >= ``limit``, the limiting extension, the energy is not defined: energy and derivatives are NaN
    there, and a Newton iteration that meets them has to take a shorter step.

    Attributes
    ----------
    shear_modulus : float
        G of the undeformed rubber, positive.
    limit : float
        J_m, the value of x = I_1 - 3 (isochoric) at which the stress becomes infinite, positive; 30 to
        100 for rubbers. With increasing ``limit`` the law approaches the neo-Hookean one.
    bulk_modulus : float
        K of the volumetric energy K/2 (J - 1)^2 with the projected volume ratio J, positive.
    """

    shear_modulus: float = 200.0
    limit: float = 50.0
    bulk_modulus: float = 80_000.0

    moduli: ClassVar = ("shear_modulus", "bulk_modulus")

    def __post_init__(self):
        checked(self, positive=("shear_modulus", "limit", "bulk_modulus"))
        check_bulk(self)

    def invariant_energy(self, x):
        """Evaluate -(G Jm / 2) ln(1 - x / Jm)."""
        return -0.5 * self.shear_modulus * self.limit * np.log1p(-self._extension(x))

    def invariant_derivatives(self, x):
        """Evaluate f' and f''."""
        margin = 1.0 - self._extension(x)
        # f' = (G / 2) / (1 - x / Jm),  f'' = f' / (Jm (1 - x / Jm))
        first = 0.5 * self.shear_modulus / margin
        return first, first / (self.limit * margin)

    def invariant_constants(self, x):
        """Differentiate f' with respect to G and Jm."""
        margin = 1.0 - self._extension(x)
        # df'/dG = (1/2) / (1 - x / Jm),  df'/dJm = -(G x / 2) / (Jm - x)^2
        by_limit = -0.5 * self.shear_modulus * x / (self.limit * margin) ** 2
        return 0.5 / margin, by_limit

    def _extension(self, x):
        """Evaluate x / Jm, NaN at and beyond the limiting extension."""
        ratio = x / self.limit
        return np.where(ratio.real < 1.0, ratio, np.nan)

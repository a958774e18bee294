"""Ogden rubber, W = sum mu/alpha (lb_1^alpha + lb_2^alpha + lb_3^alpha - 3), lb = J^(-1/3) lambda."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.materials.isotropic import check_bulk, checked
from seal_mdao.materials.stretch_powers import PowerTerm, StretchPowers, checked_terms


@dataclass(frozen=True)
class Ogden(StretchPowers):
    """Ogden law of the isochoric stretches (R. W. Ogden, Proc. R. Soc. Lond. A 326 (1972) 565).

    The neo-Hookean law is mu = 2 C10, alpha = 2, the Mooney-Rivlin law mu = (2 C10, -2 C01),
    alpha = (2, -2). Constants by name: ``mu_1``, ``mu_2``, ..., ``alpha_1``, ``alpha_2``, ...,
    ``bulk_modulus``.

    Attributes
    ----------
    mu : tuple of float
        Moduli, of either sign; the initial shear modulus sum mu alpha / 2 must be positive.
    alpha : tuple of float
        Exponents, 1e-6 to 200 in size.
    bulk_modulus : float
        K of the volumetric energy K/2 (J - 1)^2 with the projected volume ratio J, positive.
    """

    mu: tuple[float, ...]
    alpha: tuple[float, ...]
    bulk_modulus: float = 80_000.0

    def __post_init__(self):
        checked_terms(self, ("mu", "alpha"))
        checked(self, positive=("bulk_modulus",))
        if not sum(m * a for m, a in zip(self.mu, self.alpha, strict=True)) > 0.0:
            raise ValueError(
                f"the initial shear modulus sum(mu alpha) / 2 of Ogden must be positive: "
                f"mu = {self.mu}, alpha = {self.alpha}"
            )
        check_bulk(self)

    @property
    def terms(self):
        """Terms of the sum over powers."""
        # lb_1^alpha + lb_2^alpha = 2 J^(alpha/6) C and h = lb_3^alpha - 3 = J^(-alpha/3) - 3:
        # k = 1 / alpha, q = alpha / 6, r = alpha / 3 and their derivatives in alpha
        return tuple(
            PowerTerm(m, a, 1.0 / a, a / 6.0, a / 3.0, -1.0 / (a * a), 1.0 / 6.0, 1.0 / 3.0)
            for m, a in zip(self.mu, self.alpha, strict=True)
        )

    def rest(self, term, log_j):
        """Evaluate h = J^(-alpha/3) - 3."""
        return np.exp(-term.r * log_j) - 3.0

    def further_constants(self, log_j, j):
        """Return zero: the isochoric energy does not depend on the bulk modulus."""
        return [np.zeros((2, *np.shape(j)))]

"""Stiffness of a rubber from its Shore A hardness, and the neo-Hookean law with hardness as constant."""

from dataclasses import dataclass
from typing import ClassVar

from seal_mdao.materials.first_invariant import FirstInvariant
from seal_mdao.materials.isotropic import check_bulk, checked
from seal_mdao.values import real

LEAST_SHORE, MOST_SHORE = 20.0, 95.0
"""Range of Gent's relation, Shore A."""
BULK_MODULUS = 1e6
"""Bulk modulus of dense rubber, kPa: 1.0 to 1.33 GPa between 30 and 75 IRHD (P. B. Lindley, Engineering
Design with Natural Rubber, 1978)."""
SCATTER = 0.25
"""Scatter of Young's moduli of compounds of equal hardness about the relation, between 50 and 70 Shore:
Lindley's table of natural rubbers has +-25 %. The relation of Qi, Joyce and Boyce (2003, Rubber
Chemistry and Technology 76, 419), log10 E = 0.0235 S - 0.6403 in MPa, gives 1.4 (50) to 1.8 (70) times
as much."""


def shore_modulus(shore: float) -> float:
    """Compute Young's modulus of a rubber from its Shore A hardness, kPa.

    E = 98.1 (56 + 7.62336 S) / (0.137505 (254 - 2.54 S)), Gent (1958), "On the relation between
    indentation hardness and Young's modulus", Rubber Chemistry and Technology 31.

    Raises
    ------
    ValueError
        Below 20 and above 95 Shore, where the formula does not hold.
    """
    return _gent(real("Shore hardness", shore, LEAST_SHORE, MOST_SHORE))


def _gent(s):
    """Evaluate E(S) of Gent (1958), kPa, real or complex."""
    return 98.1 * (56.0 + 7.62336 * s) / (0.137505 * (254.0 - 2.54 * s))


def hardness_factor(shore: float, change: float) -> float:
    """Compute the factor of all constants of a rubber except the bulk modulus, for a change of hardness.

    Parameters
    ----------
    shore, change : float
        Nominal hardness and its change, Shore A.

    Examples
    --------
    >>> round(hardness_factor(50.0, 5.0), 3)
    1.208
    """
    # E(S + dS) / E(S)
    return shore_modulus(shore + change) / shore_modulus(shore)


@dataclass(frozen=True)
class ShoreRubber(FirstInvariant):
    """Neo-Hookean rubber with its Shore A hardness as constant, C10 = E / 6 by ``shore_modulus``.

    A hardness is one number, and so is the constant of the neo-Hookean law, with which Qi, Joyce and
    Boyce (2003) map durometer readings, too.

    Attributes
    ----------
    shore_a : float
        Hardness, 20 to 95 Shore A.
    bulk_modulus : float
        Of the projected volumetric energy, positive, kPa.
    """

    shore_a: float
    bulk_modulus: float = BULK_MODULUS

    valid: ClassVar = (0.5, 1.5)
    """Range of principal stretches; the neo-Hookean law departs from tests in tension beyond it
    (L. R. G. Treloar, The Physics of Rubber Elasticity, 1975, chapter 5)."""

    def __post_init__(self):
        object.__setattr__(self, "shore_a", real("shore_a", self.shore_a, LEAST_SHORE, MOST_SHORE))
        checked(self, positive=("bulk_modulus",))
        check_bulk(self)

    @property
    def c10(self) -> float:
        """Half the shear modulus, kPa."""
        # E = 3 G = 6 C10 of an incompressible solid
        return _gent(self.shore_a) / 6.0

    def invariant_energy(self, x):
        """Evaluate f = C10 x."""
        return self.c10 * x

    def invariant_derivatives(self, x):
        """Evaluate f' = C10 and f'' = 0."""
        return self.c10, 0.0

    def invariant_constants(self, x):
        """Evaluate df'/dS = dC10/dS."""
        # C10 ~ n / d:  dC10/dS = C10 (n'/n - d'/d)
        s = self.shore_a
        return (self.c10 * (7.62336 / (56.0 + 7.62336 * s) + 2.54 / (254.0 - 2.54 * s)),)

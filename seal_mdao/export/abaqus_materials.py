"""Material laws in the form of Abaqus: ``*HYPERELASTIC`` and ``*HYPERFOAM``.

Abaqus has U = U_dev + sum 1/D_i (J - 1)^(2 i), so that D_1 = 2/K for the volumetric energy
K/2 (J - 1)^2; its Ogden law is sum 2 mu_i/alpha_i^2 (lb_1^alpha_i + ... - 3), so that its moduli are
mu_i alpha_i / 2 of those here. The laws of Yeoh, Mooney-Rivlin and Storakers have the same constants.
"""

from seal_mdao.materials.hardness import ShoreRubber
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.sponge import GradedSponge
from seal_mdao.materials.yeoh import Yeoh

PER_LINE = 8
"""Numbers in a line of data."""
RUBBER, FOAM = "CPE6MH", "CPE6M"
"""Modified quadratic triangles of plane strain for contact; hybrid ones where rubber hardly changes its
volume."""


def element_type(law: Isotropic, axisymmetric: bool = False) -> str:
    """Return the type of the elements of a law, in plane strain or of a body of revolution."""
    kind = FOAM if isinstance(law, Hyperfoam) else RUBBER
    return kind.replace("CPE", "CAX") if axisymmetric else kind


def material_lines(law: Isotropic) -> list[str]:
    """Write the keyword and the data of a law; stresses in kPa.

    Raises
    ------
    ValueError
        For a law that Abaqus does not have.
    """
    keyword, constants = _keyword(law)
    rows = [constants[i : i + PER_LINE] for i in range(0, len(constants), PER_LINE)]
    return [keyword, *(", ".join(f"{value:.12g}" for value in row) for row in rows)]


def _keyword(law) -> tuple[str, list[float]]:
    # no other subclasses: a law of one's own may differ from its base
    kind = type(law)
    if kind in (Hyperfoam, GradedSponge):
        terms = [value for pair in zip(law.mu, law.alpha, strict=True) for value in pair]
        return f"*HYPERFOAM, N={len(law.mu)}", [*terms, *law.nu]
    # D_1 = 2/K, and no further volumetric terms
    first = 2.0 / law.bulk_modulus if law.bulk_modulus else 0.0
    if kind in (NeoHookean, ShoreRubber):
        return "*HYPERELASTIC, NEO HOOKE", [law.c10, first]
    if kind is MooneyRivlin:
        return "*HYPERELASTIC, MOONEY-RIVLIN", [law.c10, law.c01, first]
    if kind is Yeoh:
        return "*HYPERELASTIC, YEOH", [law.c10, law.c20, law.c30, first, 0.0, 0.0]
    if kind is Ogden:
        # mu_i of Abaqus = mu_i alpha_i / 2
        pairs = zip(law.mu, law.alpha, strict=True)
        terms = [value for mu, alpha in pairs for value in (0.5 * mu * alpha, alpha)]
        none = [0.0] * (len(law.mu) - 1)
        return f"*HYPERELASTIC, OGDEN, N={len(law.mu)}", [*terms, first, *none]
    raise ValueError(
        f"the material law {kind.__name__} has no counterpart in Abaqus; use neo_hookean, "
        "mooney_rivlin, yeoh, ogden, hyperfoam, shore_a or sponge (seal-mdao fit fits them to "
        "tests)"
    )

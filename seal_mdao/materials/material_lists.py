"""Tables of materials without given constants: dense rubber by hardness, foam by grade."""

from typing import NamedTuple

from seal_mdao.materials.hardness import SCATTER, ShoreRubber, shore_modulus
from seal_mdao.materials.sponge import GRADES, GradedSponge, graded_sponge, pressure_range


class MaterialList(NamedTuple):
    """A list of materials.

    Attributes
    ----------
    title : str
        What they are, and the line of a seal file that takes one.
    head : tuple of str
        Names of the columns.
    rows : tuple of tuple of str
    notes : tuple of str
        Source, range of validity, scatter: a sentence each.
    """

    title: str
    head: tuple
    rows: tuple
    notes: tuple


def _range(law) -> str:
    least, largest = law.valid
    between = f"stretches from {least:g} to {largest:g}"
    return f"Range of the constants: {between}; strains beyond it are reported."


def dense_rubbers() -> MaterialList:
    """List Young's modulus and the constant of dense rubber by hardness."""
    shores = range(30, 91, 10)
    return MaterialList(
        "dense rubber by its hardness, shore_a = 60",
        ("Shore A", "E (kPa)", "c10 = E/6 (kPa)"),
        tuple(
            (str(s), f"{shore_modulus(s):.0f}", f"{ShoreRubber(float(s)).c10:.1f}") for s in shores
        ),
        (
            "Neo-Hookean; Young's modulus by A. N. Gent, Rubber Chemistry and Technology 31 (1958) 896.",
            f"Moduli of compounds of one hardness scatter by {SCATTER:.0%}; tests are more accurate.",
            _range(ShoreRubber),
            "Bulk modulus 1 GPa (P. B. Lindley, Engineering Design with Natural Rubber, 1978: 1.0 to "
            "1.33 GPa).",
        ),
    )


def sponges() -> MaterialList:
    """List the pressure and the constant of foam rubber by grade."""
    return MaterialList(
        'closed-cell foam rubber, such as EPDM, by its grade of ASTM D1056, sponge = "2A3"',
        ("grade", "pressure at 25 % of compression (kPa)", "mu_1 (kPa)"),
        tuple(
            (
                name,
                "{:.0f} to {:.0f}".format(*pressure_range(name)),
                f"{graded_sponge(name).mu[0]:.1f}",
            )
            for name in GRADES
        ),
        (
            "Hyperfoam of one term in the middle of the grade, alpha_1 = 2 and nu_1 = 0 by assumption: "
            "a grade determines one constant only.",
            "The pressure range of a grade is its scatter: vary mu_1 by a factor in [tolerance].",
            _range(GradedSponge),
            "Tension and lateral strain are not part of the specification; where they matter fit "
            "hyperfoam to tests.",
        ),
    )


LISTS = (dense_rubbers, sponges)
"""Functions that make the lists."""

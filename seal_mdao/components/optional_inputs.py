"""Scalar parameters of the analysis that a component can take as inputs."""

from seal_mdao.dsa.parameters import CONSTANTS
from seal_mdao.model import SealModel

OPTIONAL_INPUTS = {
    "c10": ("kPa", "Mooney-Rivlin constant C10."),
    "c01": ("kPa", "Mooney-Rivlin constant C01."),
    "bulk_modulus": ("kPa", "Bulk modulus K."),
    "friction": (None, "Coulomb friction coefficient."),
    "depth": ("mm", "Final depth of the door below the top of the drawn seal."),
    "normal_penalty": ("kPa/mm", "Normal penalty w_n."),
    "tangent_penalty": ("kPa/mm", "Tangential penalty w_t."),
}
"""Units and description by name."""


def check_parameters(name: str, value) -> None:
    """Option check: a sequence of different known names.

    Raises
    ------
    ValueError
        For an unknown or repeated name.
    """
    if isinstance(value, str):
        raise ValueError(f"option {name!r} must be a sequence of names, got the string {value!r}")
    unknown = [item for item in value if item not in OPTIONAL_INPUTS]
    if unknown:
        raise ValueError(
            f"option {name!r}: unknown parameter {unknown[0]!r}; known are "
            f"{', '.join(OPTIONAL_INPUTS)}"
        )
    if len(set(value)) < len(value):
        raise ValueError(f"option {name!r} names a parameter twice: {tuple(value)}")


def start_value(model: SealModel, name: str) -> float:
    """Value of a parameter in the model."""
    return getattr(model.material if name in CONSTANTS else model, name)

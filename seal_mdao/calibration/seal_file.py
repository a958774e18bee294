"""Write a fitted law as a table of a seal file (TOML)."""

import re
from dataclasses import fields

from seal_mdao.materials.isotropic import Isotropic

DIGITS = 8
"""Significant digits, far beyond the accuracy of tests."""


def material_table(law: Isotropic, name: str, material: str = "rubber", notes=()) -> str:
    """Format ``[material.<material>]`` with the constants of a law, kPa, for a seal file.

    Parameters
    ----------
    law : Isotropic
    name : str
        Name of the law in seal files.
    material : str
    notes : sequence of str
        Comments above the constants, one line each.

    Raises
    ------
    ValueError
        For a name of the material that requires quotes in TOML.
    """
    if not re.fullmatch(r"[A-Za-z0-9_-]+", material):
        raise ValueError(
            f"the name {material!r} of a material may only have letters, digits, _ and -"
        )
    lines = [f"[material.{material}]", *(f"# {note}" for note in notes), f'law = "{name}"']
    for field in fields(law):
        value = getattr(law, field.name)
        many = isinstance(value, tuple)
        text = f"[{', '.join(map(_number, value))}]" if many else _number(value)
        lines.append(f"{field.name} = {text}")
    return "\n".join(lines) + "\n"


def _number(value: float) -> str:
    """Format a float of TOML."""
    text = f"{value:.{DIGITS}g}"
    return text if any(sign in text for sign in ".e") else f"{text}.0"

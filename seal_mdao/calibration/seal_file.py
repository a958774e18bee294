"""Write fitted laws as tables of a seal file (TOML)."""

import re
from dataclasses import fields

import numpy as np

from seal_mdao.calibration.relaxation_result import RelaxationFit
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.materials.ogden_roxburgh import OgdenRoxburgh
from seal_mdao.values import one_of

DIGITS = 8
"""Significant digits, far beyond the accuracy of tests."""
MODULI = ("long_term", "instantaneous")
"""What the constants of the law are, beside which the relaxation stands."""


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
    return _table(material, "", notes, {"law": f'"{name}"', **_constants(law)})


def viscoelastic_table(
    fit: RelaxationFit, moduli: str = "long_term", material: str = "rubber", notes=()
) -> str:
    """Format ``[material.<material>.viscoelastic]`` with a Prony series for a seal file.

    Parameters
    ----------
    fit : RelaxationFit
    moduli : {"long_term", "instantaneous"}
        Which moduli the constants of ``[material.<material>]`` are.
    material : str
    notes : sequence of str
        Comments above the constants, one line each.

    Raises
    ------
    ValueError
        For a name of the material that requires quotes in TOML, or other moduli.
    """
    one_of("moduli", moduli, MODULI)
    values = {"g": _written(fit.g), "tau": f"{_written(fit.tau)}  # s", "moduli": f'"{moduli}"'}
    if fit.shift is not None:
        keys = ", ".join(f"{key} = {_written(value)}" for key, value in fit.shift.table().items())
        values[fit.shift.name] = f"{{ {keys} }}"
    return _table(material, ".viscoelastic", notes, values)


def softening_table(softening: OgdenRoxburgh, material: str = "rubber", notes=()) -> str:
    """Format ``[material.<material>.softening]`` for a seal file.

    Parameters
    ----------
    softening : OgdenRoxburgh
    material : str
    notes : sequence of str
        Comments above the constants, one line each.

    Raises
    ------
    ValueError
        For a name of the material that requires quotes in TOML.
    """
    return _table(material, ".softening", notes, _constants(softening))


def _table(material: str, part: str, notes, values: dict[str, str]) -> str:
    """Format a table of a material: its head, comments, and a line for every key."""
    if not re.fullmatch(r"[A-Za-z0-9_-]+", material):
        raise ValueError(
            f"the name of a material may contain only letters, digits, _ and -, got {material!r}"
        )
    lines = [f"[material.{material}{part}]", *(f"# {note}" for note in notes)]
    lines += [f"{key} = {value}" for key, value in values.items()]
    return "\n".join(lines) + "\n"


def _constants(law) -> dict[str, str]:
    """Write the fields of a dataclass."""
    return {field.name: _written(getattr(law, field.name)) for field in fields(law)}


def _written(value) -> str:
    """Format a number of TOML, or a list of them."""
    if np.ndim(value):
        return f"[{', '.join(map(_number, value))}]"
    return _number(value)


def _number(value: float) -> str:
    """Format a float of TOML."""
    text = f"{value:.{DIGITS}g}"
    return text if any(sign in text for sign in ".e") else f"{text}.0"

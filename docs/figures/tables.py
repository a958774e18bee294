"""Numbers and tables as MyST text."""

import re
from math import isfinite

SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
NONE = "\N{EN DASH}"
"""Stands where there is no number."""


def power(value: float, digits: int = 1) -> str:
    """A small or large number as text, such as 2.3 × 10⁻⁷."""
    if not isfinite(value):
        return NONE
    if value == 0.0:
        return "0"
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    ten = f"10{str(int(exponent)).translate(SUPERSCRIPT)}"
    return ten if mantissa == "1" else f"{mantissa} × {ten}"


def percent(value: float, digits: int = 2) -> str:
    """A share as text."""
    return NONE if not isfinite(value) else f"{100 * value:.{digits}f} %"


def _cell(value) -> str:
    """With a real minus sign before a number."""
    return re.sub(r"^-(?=[\d.])", "\N{MINUS SIGN}", str(value))


def table(header, rows, name: str = "") -> str:
    """A pipe table; no cell may hold a pipe."""
    lines = [header, ["---"] * len(header), *rows]
    text = "\n".join("| " + " | ".join(map(_cell, line)) + " |" for line in lines)
    return f"{{.{name}}}\n{text}\n" if name else text + "\n"

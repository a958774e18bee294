"""Reading tolerances from TOML."""

import tomllib
from dataclasses import MISSING, fields
from pathlib import Path

from seal_mdao.errors import SealFileError
from seal_mdao.input_files import read_text
from seal_mdao.scenarios.variation import KINDS, VALUE, Variation
from seal_mdao.seals.file.checks import NAMES, Key, known, number, one_of, shown, table
from seal_mdao.tolerances.boundary import BoundaryTolerance
from seal_mdao.tolerances.distributions import DISTRIBUTIONS
from seal_mdao.tolerances.tolerances import Tolerance, Tolerances

OF_THE_DOOR = Path(__file__).with_name("door_seal.toml")
"""Tolerances of the door seal that are taken when none are given."""
VARY_KEYS = {
    "distribution": Key(one_of(*DISTRIBUTIONS)),
    "kind": Key(one_of(*KINDS), VALUE),
    "parameters": Key(NAMES, ()),
}
BOUNDARY_KEYS = {"std": Key(number(above=0.0)), "length": Key(number(above=0.0))}


def read_tolerances(path) -> Tolerances:
    """The tolerances of a file.

    Raises
    ------
    SealFileError
        One line that says what is wrong, in which table and key, and what is allowed.
    """
    try:
        given = tomllib.loads(read_text(path))
        return _read(given)
    except OSError as error:
        raise SealFileError(f"{path}: cannot be read: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise SealFileError(f"{path}: this is not TOML: {error}") from None
    except ValueError as error:
        raise SealFileError(f"{path}: {error}") from None


def _read(given: dict) -> Tolerances:
    for name in given:
        known("the file", "table", name, ("vary", "boundary"), "table of tolerances")
    vary, boundary = given.get("vary", {}), given.get("boundary")
    if not isinstance(vary, dict):
        raise SealFileError("vary must be tables, each written [vary.name]")
    if not vary and boundary is None:
        raise SealFileError("nothing varies; write [vary.name] for a parameter, or [boundary]")
    scattered = tuple(_tolerance(name, own) for name, own in vary.items())
    if boundary is None:
        return Tolerances(scattered)
    return Tolerances(scattered, BoundaryTolerance(**table("[boundary]", boundary, BOUNDARY_KEYS)))


def _tolerance(name: str, given) -> Tolerance:
    if not name.strip() or not name.isprintable():
        raise SealFileError(f"[vary]: {shown(name)} is no name; use printable characters")
    where = f"[vary.{name}]"
    kind = given.get("distribution") if isinstance(given, dict) else None
    own = DISTRIBUTIONS.get(kind) if isinstance(kind, str) else None
    keys = VARY_KEYS | ({} if own is None else _number_keys(own))
    if own is None and isinstance(given, dict):  # that is what is wrong, whatever else there is
        given = {key: value for key, value in given.items() if key in keys}
    found = table(where, given, keys)
    variation = Variation(name, found["kind"], found["parameters"])
    try:
        return Tolerance(variation, own(**{f.name: found[f.name] for f in fields(own)}))
    except ValueError as error:
        raise SealFileError(f"{where}: {error}") from None


def _number_keys(distribution) -> dict:
    return {
        own.name: Key(number()) if own.default is MISSING else Key(number(), own.default)
        for own in fields(distribution)
    }

"""Read tolerances from TOML files."""

import tomllib
from dataclasses import MISSING, asdict, fields
from pathlib import Path

from pydantic import TypeAdapter

from seal_mdao.errors import SealFileError
from seal_mdao.input_files import read_text
from seal_mdao.scenarios.variation import KINDS, VALUE, Variation
from seal_mdao.seals.file.forms import Names, number, one_of
from seal_mdao.seals.file.schema import Table, checked, chosen_by, key, known, table, table_of
from seal_mdao.tolerances.boundary_errors import BoundaryTolerance
from seal_mdao.tolerances.distributions import DISTRIBUTIONS
from seal_mdao.tolerances.tolerance_set import Tolerance, Tolerances
from seal_mdao.values import formatted

OF_THE_DOOR = Path(__file__).with_name("door_seal.toml")
"""Default tolerances, those of the door seal."""


@table(kw_only=True)
class VaryTable(Table):
    """Scatter of a parameter."""

    distribution: one_of(*DISTRIBUTIONS) = key("of what varies")
    kind: one_of(*KINDS) = key("what it does to the parameters", VALUE)
    parameters: Names = key("that vary together; that of the name of the table unless given", ())


@table
class BoundaryTable(Table):
    """Error of an extruded boundary."""

    std: number("mm", above=0.0) = key("root mean square of its error")
    length: number("mm", above=0.0) = key("of correlation along the boundary")


def _vary_table(name: str) -> type[Table]:
    """Make the table of a distribution with its numbers as keys."""
    # one key per field of the distribution, with its default
    keys = {"distribution": (one_of(name), key("of what varies"))}
    for own in fields(DISTRIBUTIONS[name]):
        default = () if own.default is MISSING else (own.default,)
        keys[own.name] = number(), key(f"of the {name} distribution", *default)
    return table_of(VaryTable, f"{DISTRIBUTIONS[name].__name__}Table", keys)


AnyVary = chosen_by("distribution", {name: _vary_table(name) for name in DISTRIBUTIONS})


@table
class Written(Table):
    """Tables of a file of tolerances."""

    vary: dict[str, AnyVary] = key("parameters that scatter", {})
    boundary: BoundaryTable | None = key("what an extruded boundary does", None)


def read_tolerances(path) -> Tolerances:
    """Read the tolerances of a file.

    Raises
    ------
    SealFileError
        One line with the error, its table and key, and what is allowed.
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
    # messages for the tables first, then the schema checks their keys
    for name in given:
        known("the file", "table", name, ("vary", "boundary"), "table of tolerances")
    # names of [vary.NAME] are free
    vary = given.get("vary", {})
    if not isinstance(vary, dict):
        raise SealFileError("vary must be tables, each written [vary.name]")
    if not given.get("vary") and "boundary" not in given:
        raise SealFileError("nothing varies; write [vary.name] for a parameter, or [boundary]")
    for name in vary:
        if not name.strip() or not name.isprintable():
            raise SealFileError(f"[vary]: {formatted(name)} is no name; use printable characters")
    written = checked(TypeAdapter(Written), given)
    scattered = tuple(_tolerance(name, own) for name, own in written.vary.items())
    # the boundary is optional
    if written.boundary is None:
        return Tolerances(scattered)
    return Tolerances(scattered, BoundaryTolerance(**asdict(written.boundary)))


def _tolerance(name: str, own: VaryTable) -> Tolerance:
    # the distribution checks its own numbers; the message names the table
    law = DISTRIBUTIONS[own.distribution]
    variation = Variation(name, own.kind, own.parameters)
    try:
        return Tolerance(variation, law(**{f.name: getattr(own, f.name) for f in fields(law)}))
    except ValueError as error:
        raise SealFileError(f"[vary.{name}]: {error}") from None

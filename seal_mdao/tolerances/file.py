"""Tolerances from TOML: a file of their own, or table ``[tolerance]`` of a seal file."""

import tomllib
from dataclasses import asdict
from pathlib import Path

from pydantic import TypeAdapter

from seal_mdao.distributions import VALUE
from seal_mdao.errors import SealFileError
from seal_mdao.input_files import read_text
from seal_mdao.scenarios.variation import Variation
from seal_mdao.seals.file.schema import checked
from seal_mdao.seals.file.tolerance_table import ToleranceTable
from seal_mdao.tolerances.boundary_errors import BoundaryTolerance
from seal_mdao.tolerances.tolerance_set import Tolerance, Tolerances

OF_THE_DOOR = Path(__file__).with_name("door_seal.toml")
"""Default tolerances, those of the door seal."""


def read_tolerances(path) -> Tolerances:
    """Read the tolerances of a file.

    Raises
    ------
    SealFileError
        As of ``read_tolerance_table``.
    """
    return tolerances_of(read_tolerance_table(path))


def read_tolerance_table(path) -> ToleranceTable:
    """Read the tables of a file of tolerances.

    Raises
    ------
    SealFileError
        One line with the error, its table and key, and what is allowed.
    """
    try:
        given = tomllib.loads(read_text(path))
        return checked(TypeAdapter(ToleranceTable), given)
    except OSError as error:
        raise SealFileError(f"{path}: cannot be read: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise SealFileError(f"{path}: not valid TOML: {error}") from None
    except ValueError as error:
        raise SealFileError(f"{path}: {error}") from None


def tolerances_of(written: ToleranceTable) -> Tolerances:
    """Make the tolerances that a table describes."""
    scattered = tuple(
        Tolerance(Variation(name, own.kind or VALUE, own.parameters), own.law)
        for name, own in written.vary.items()
    )
    # the boundary is optional
    boundary = written.boundary and BoundaryTolerance(**asdict(written.boundary))
    return Tolerances(scattered, boundary)

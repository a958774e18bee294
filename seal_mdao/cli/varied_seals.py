"""Seals with tolerances, for the subcommands ``study`` and ``robust``."""

from pathlib import Path

import seal_mdao as sm
from seal_mdao.cli.arguments import (
    SEAL_OPTIONS,
    WrongArgumentError,
    existing_file,
    positive_integer,
    seal_from,
)
from seal_mdao.cli.seal_files import file_of, filled, seal_of
from seal_mdao.seals.file.tolerance_table import ToleranceTable
from seal_mdao.tolerances.file import OF_THE_DOOR, read_tolerance_table, tolerances_of
from seal_mdao.tolerances.placement import with_clearance
from seal_mdao.tolerances.tolerance_set import Tolerances


def door_with_tolerances(arguments) -> tuple[sm.Seal, Tolerances]:
    """Build the door seal that the options describe, and read its tolerances."""
    # profiles start farther back: scattered seals begin free of contact
    seal = with_clearance(seal_from(arguments))
    return seal, _from_file(arguments.tolerances or OF_THE_DOOR, seal)


def file_with_tolerances(arguments, others: tuple) -> tuple[sm.SealFile, sm.Seal, Tolerances]:
    """Read a seal file, build its seal with placements of the profiles, and read its tolerances.

    ``others`` are options of the subcommand that only the door seal has. Everything is checked before
    load steps and penalties are chosen by analyses.

    Raises
    ------
    SealFileError
        For a wrong seal file or file of tolerances; for tolerances of parameters that there are not.
    WrongArgumentError
        For an option of the door seal; without tolerances.
    """
    wrong = sorted(arguments.given.intersection((*SEAL_OPTIONS, "accuracy", *others)))
    if wrong:
        name = wrong[0].replace("_", "-")
        raise WrongArgumentError(
            f"--{name} is an option of the built-in door seal and cannot be combined with a seal "
            f"file ({arguments.file}); leave out this option"
        )
    file, unchosen = file_of(arguments.file), None
    if arguments.tolerances is not None:
        # placements of the profiles are parameters, too
        unchosen = filled(file)
        tolerances = _from_file(arguments.tolerances, unchosen.with_placements())
    elif file.tolerance is not None:
        # checked where the seal is built
        tolerances = tolerances_of(file.tolerance)
    else:
        raise sm.SealFileError(
            f"{arguments.file}: [tolerance] is missing; add a table [tolerance.vary.NAME] for each "
            "parameter that scatters, or give a separate file of tolerances (--tolerances "
            "FILE.toml)"
        )
    file, seal = seal_of(file, unchosen=unchosen)
    return file, seal.with_placements(), tolerances


def _from_file(path: Path, seal: sm.Seal) -> Tolerances:
    """Read the tolerances of a file and check that they fit the seal."""
    table: ToleranceTable = read_tolerance_table(path)
    table.check(f"{path}: [", seal)
    return tolerances_of(table)


def add_tolerance_arguments(made) -> None:
    """Add the arguments for seal, tolerances and samples."""
    add = made.add_argument
    add(
        "file",
        type=Path,
        nargs="?",
        metavar="FILE",
        help="seal file (TOML); default: the built-in door seal",
    )
    add(
        "--tolerances", type=existing_file, metavar="FILE",
        help="file (TOML) of manufacturing tolerances that replaces [tolerance] of the seal file "
        "or the tolerances of the built-in door seal",
    )  # fmt: skip
    add("--samples", type=positive_integer, default=1000, metavar="N", help="number of samples")

"""Common parts of the subcommands: seal options, output folder, one-line errors, summary.json."""

import argparse
import io
import json
import math
import os
import sqlite3
import sys
import tempfile
import warnings
from collections.abc import Callable
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path

import numpy as np

import seal_mdao as sm
from seal_mdao.analysis import cost as cost_of
from seal_mdao.cli.garbage_collection import collect_less
from seal_mdao.cli.one_line_parser import OneLineParser
from seal_mdao.input_files import read_text
from seal_mdao.plotting.captions import captioned, name_seal
from seal_mdao.seals.door.door_options import DoorOptions
from seal_mdao.seals.door.door_seal import ACCURACIES
from seal_mdao.seals.penalty_error import not_estimable
from seal_mdao.standard_streams import make_writable
from seal_mdao.values import fraction

SEAL_OPTIONS = (
    "friction", "friction_history", "door", "corner_x", "segments", "rays", "layers",
    "refinement", "support", "n_steps", "depth", "normal_penalty", "tangent_penalty",
)  # fmt: skip
"""Options of the seal that are arguments of the same name."""
OF_ACCURACY = {name for changes in ACCURACIES.values() for name in changes}
"""Options that ``--accuracy`` decides."""

CASES = "cases.sql"
"""Recorder file in the output folder."""
SAMPLES = "samples.sqlite"
"""Samples of a tolerance study there."""


CTRL_C = 130
"""Exit status after Ctrl-C: 128 + SIGINT, as shells report it."""
NAME_OF_FILE = "NAME_OF_FILE"
"""Part of the name of a default output folder that stands for the name of the seal file; without a file
it is left out."""


FILE_SUFFIXES = {
    ".csv", ".dxf", ".gif", ".htm", ".html", ".inp", ".json", ".mp4", ".pdf", ".png", ".sql",
    ".sqlite", ".svg", ".toml", ".txt", ".vtu",
}  # fmt: skip
"""Endings of files that commands read or write: a folder with such a name is a mistake."""


class WrongArgumentError(Exception):
    """Raised for arguments with which a subcommand cannot start."""


@contextmanager
def checked_arguments():
    """Turn errors of the package about wrong values into errors of the arguments."""
    try:
        yield
    except (ValueError, TypeError, ImportError) as error:
        raise WrongArgumentError(" ".join(str(error).split())) from error


class _HelpFormatter(argparse.ArgumentDefaultsHelpFormatter):
    """Help formatter that names defaults only where an option has one."""

    def _get_help_string(self, action):
        # flags without a value, and options without a default, show none
        silent = action.default in (None, argparse.SUPPRESS) or action.nargs == 0
        return action.help if silent else super()._get_help_string(action)


def parser(
    description: str, out: str, positional: str = "", example: str = ""
) -> argparse.ArgumentParser:
    """Make an argument parser with ``--out`` and its default folder, ``--quiet`` and ``--json``; usage
    errors take one line, an example of use ends the help."""
    # usage in one line: positional arguments, then options
    usage = " ".join(["%(prog)s", *positional.split(), "[options]"])
    made = OneLineParser(
        description=description, formatter_class=_HelpFormatter, usage=usage,
        epilog=f"example: {example}" if example else None,
    )  # fmt: skip
    # options common to all subcommands
    made.add_argument("--out", type=Path, default=Path(out), metavar="DIR", help="folder to write")
    made.add_argument(
        "--quiet", action="store_true", help="print error messages only, no progress lines"
    )
    made.add_argument(
        "--json",
        action="store_true",
        help="print the contents of summary.json (JSON) instead of text lines",
    )
    return made


def add_seal_arguments(made: argparse.ArgumentParser) -> None:
    """Add the options of the door seal; an omitted option has the value of the example, or of the
    accuracy."""
    # defaults are those of the nominal door seal
    nominal = DoorOptions()
    group = made.add_argument_group("door seal of the paper (without a seal file)")

    def add(name: str, kind, text: str, **more):
        flag, default = f"--{name.replace('_', '-')}", getattr(nominal, name)
        # None lets the accuracy choose; an explicit value overrides it
        if name in OF_ACCURACY:
            default, text = None, f"{text}; default: that of --accuracy"
        group.add_argument(flag, type=kind, default=default, help=text, **more)

    # preset of discretisation and load steps
    group.add_argument(
        "--accuracy", choices=tuple(ACCURACIES), default=next(iter(ACCURACIES)),
        help="number of particles and load steps: as in the paper of Kim et al. (2000), with the "
        "best accuracy for the computing time, or finer",
    )  # fmt: skip
    # friction law
    add("friction", float, "Coulomb coefficient", metavar="MU")
    rules = ("accumulated", "incremental")
    add(
        "friction_history",
        str,
        "elastic slip of sticking points: accumulated over the load "
        "steps, or zero at the start of every load step",
        choices=rules,
    )
    # geometry of the door
    add("door", str, "shape of the door that compresses the seal", choices=("corner", "flat"))
    # short form of one value of --door
    group.add_argument(
        "--flat-door", dest="door", action="store_const", const="flat", default=argparse.SUPPRESS,
        help="the same as --door flat",
    )  # fmt: skip
    add(
        "corner_x",
        float,
        "x coordinate (mm) at which the flat part of the corner door ends",
        metavar="MM",
    )
    add(
        "segments",
        int,
        "number of straight segments that approximate the door; default: the exact curve",
        metavar="N",
    )
    # particles, kernels
    add(
        "rays",
        int,
        "number of particles around the circumference of the section, a multiple of 58",
        metavar="N",
    )
    add("layers", int, "number of particles across the wall of the section", metavar="N")
    add(
        "refinement",
        int,
        "number of parts into which every interval between radial rows under the door is divided",
        metavar="N",
    )
    add(
        "support",
        float,
        "support size of the particle kernels as a multiple of the longest cell edge",
        metavar="S",
    )
    # load path
    add("n_steps", int, "number of load steps", metavar="N")
    add(
        "depth",
        float,
        "compression of the seal: final depth of the door below the top of the nominal seal (mm)",
        metavar="MM",
    )
    # contact penalties
    add("normal_penalty", float, "penalty of normal contact, kPa/mm", metavar="W_N")
    add("tangent_penalty", float, "penalty of tangential contact, kPa/mm", metavar="W_T")


def positive_integer(text: str) -> int:
    """Parse a positive integer for argparse."""
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not an integer of at least 1")
    return int(text)


def travel(text: str) -> float:
    """Parse a travel of the door for argparse, mm."""
    try:
        value = float(text)
    except ValueError:
        # nan fails the range test below: one message for both faults
        value = math.nan
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a valid travel of the door; it must be a number of at least 0 (mm)"
        )
    return value


def percentage(text: str) -> float:
    """Parse a percentage for argparse, such as 1 or "1 %"; returns a fraction."""
    try:
        return fraction(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a percentage above 0 and at most 50"
        ) from error


def existing_file(text: str) -> Path:
    """Parse the path of an existing file for argparse; a missing file is a usage error."""
    if not Path(text).is_file():
        raise argparse.ArgumentTypeError(f"{text} is not a file")
    return Path(text)


def seal_from(arguments: argparse.Namespace, **more) -> sm.Seal:
    """Build the door seal that the options describe."""
    with checked_arguments():
        # only given options are passed on: the rest is decided by the accuracy
        options = {name: getattr(arguments, name) for name in SEAL_OPTIONS}
        given = {name: value for name, value in options.items() if value is not None}
        seal = sm.door_seal(arguments.accuracy, **given, **more)
    name_seal("door seal", seal)
    return seal


def run(made: argparse.ArgumentParser, main: Callable, argv=None) -> int:
    """Parse, make the output folder, run ``main(arguments)``; known errors become one line.

    Returns
    -------
    int
        What ``main`` returns, 1 when an analysis could not be completed or a file not be written, 2
        for a seal file that cannot be used, 130 after Ctrl-C. Wrong arguments exit with 2.
    """
    make_writable()
    collect_less()
    # parse, then note which options were given explicitly
    arguments = made.parse_args(argv)
    arguments.given = _given(made, argv)
    if "out" in arguments.given:
        _require_name_of_folder(made, arguments.out)
    # a restart writes beside its recorder file unless --out is given
    if "out" not in arguments.given and isinstance(getattr(arguments, "restart", None), Path):
        arguments.out = arguments.restart.parent
    elif "out" not in arguments.given and NAME_OF_FILE in arguments.out.name:
        # a folder for every seal file, so that none overwrites the results of another one
        name = arguments.out.name
        if arguments.file is not None and not arguments.file.stem:
            made.error(f"argument FILE: {arguments.file} is a folder; give a seal file (TOML)")
        own = (
            name.removeprefix(f"{NAME_OF_FILE}_")
            if arguments.file is None
            else name.replace(NAME_OF_FILE, arguments.file.stem)
        )
        arguments.out = arguments.out.with_name(own)
    # fail on an unwritable folder before any analysis
    _require_folder(made, arguments.out)
    before = _files(arguments.out)
    try:
        code = _printed_as_asked(main, arguments, before)
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        # what reads the output has ended, such as head; Python would write the rest when it ends
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115
        return _ended(made, f"the output is no longer read; {_saved(arguments.out, before)}", 1)
    except sm.SealFileError as error:
        # the seal file is wrong: exit status 2
        return _ended(made, str(error), 2)
    except (WrongArgumentError, sm.GeometryError) as error:
        # usage error: argparse prints the usage and exits with 2
        made.error(str(error))
    except sm.LoadPathError as error:
        # the load path could not be completed
        return _ended(made, str(error), 1)
    except (OSError, sqlite3.DatabaseError) as error:
        # the disk is full, or a database is locked or damaged
        return _ended(made, f"{_cause(error, arguments.out)}; {_saved(arguments.out, before)}", 1)
    except KeyboardInterrupt:
        return _ended(made, f"interrupted; {_saved(arguments.out, before)}", CTRL_C)


def _printed_as_asked(main: Callable, arguments: argparse.Namespace, before: dict[str, int]) -> int:
    """Run with its lines, with nothing (``--quiet``), or with ``summary.json`` (``--json``); ``before``
    are the files at its beginning."""
    with ExitStack() as stack:
        # figures name the seals that are read
        stack.enter_context(captioned())
        # with the end of the block Python shows warnings as before
        stack.enter_context(warnings.catch_warnings())
        warnings.showwarning = _show_warning
        if arguments.quiet or arguments.json:
            # normal output is discarded
            stack.enter_context(redirect_stdout(io.StringIO()))
        if arguments.quiet:
            # progress bars go to stderr
            stack.enter_context(redirect_stderr(io.StringIO()))
        code = main(arguments)
    if arguments.json:
        # --json: the summary alone on stdout, for other programs; else the files that were written
        written = [name for name, time in _files(arguments.out).items() if before.get(name) != time]
        if "summary.json" in written:
            print((arguments.out / "summary.json").read_text(encoding="utf-8"), end="")
        else:
            print(json.dumps({"files": sorted(written)}))
    return code


def _show_warning(message, *_) -> None:
    """Print a warning of Python, such as a ``KinkWarning``, as one line without its file."""
    print(f"WARNING: {message}", file=sys.stderr)


def _require_name_of_folder(made: argparse.ArgumentParser, out: Path) -> None:
    """Refuse a value of ``--out`` that is the name of a file, unless there is such a folder."""
    if out.suffix.lower() in FILE_SUFFIXES and not out.is_dir():
        made.error(
            f"argument --out: {out} is the name of a file, but --out names the folder of all results; "
            f"give a folder, such as {out.with_suffix('')}"
        )


def _require_folder(made: argparse.ArgumentParser, out: Path) -> None:
    """Make the output folder and try to write to it."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        made.error(f"argument --out: cannot make the folder {out}: {error.strerror}")
    try:
        # permissions alone do not show whether a file can be written
        with tempfile.TemporaryFile(dir=out) as probe:
            probe.write(b"?")
    except OSError as error:
        made.error(f"argument --out: cannot write to {out}: {error.strerror}")


def _ended(made: argparse.ArgumentParser, text: str, code: int) -> int:
    print(f"{made.prog}: {text}", file=sys.stderr)
    return code


def _cause(error: Exception, out: Path) -> str:
    """Describe which file could not be written, and why."""
    if isinstance(error, OSError):
        return f"{error.filename or out}: {error.strerror or error}"
    return f"{out / CASES}: {error}"


def _files(out: Path) -> dict[str, int]:
    """Return the times at which the files of a folder were written (ns), by their names; without hidden
    ones, such as the lock of a recorder file."""
    files = (own for own in out.iterdir() if own.is_file() and not own.name.startswith("."))
    return {own.name: own.stat().st_mtime_ns for own in files}


def _saved(out: Path, before: dict[str, int]) -> str:
    """Name the output files that exist after a run that ended early: those that it wrote, and recorder
    file, samples and summary of an earlier one; ``before`` are the files at its beginning."""
    there = _files(out)
    kept = {CASES, SAMPLES, "summary.json"} & there.keys()
    names = sorted(kept | {name for name, time in there.items() if before.get(name) != time})
    if not names:
        return f"nothing was saved in {out}"
    listed = " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
    return f"saved in {out}: {listed}"


def _given(made: argparse.ArgumentParser, argv) -> set[str]:
    """Return the names of the options given on the command line, even where equal to the default."""
    # parse again with a sentinel as every default: what differs from it was given
    left_out = object()
    names = {action.dest for action in made._actions}
    parsed = made.parse_args(argv, argparse.Namespace(**dict.fromkeys(names, left_out)))
    return {name for name in names if getattr(parsed, name) is not left_out}


LONG = 10.0
"""Estimated time of an analysis (s) above which it is reported before the analysis begins."""


def announce(seal: sm.Seal) -> None:
    """Report the estimated time of a long analysis; refuse an analysis beyond the machine's means.

    Raises
    ------
    WrongArgumentError
        When it needs more memory than there is, or takes days.
    """
    with checked_arguments():
        # estimate from the numbers of unknowns and load steps
        cost = sm.estimate(seal)
        cost_of.require_means(cost, seal.body, seal.n_steps)
    cost_of.announce(cost, seal.body, seal.n_steps, LONG)


def print_warnings(result, further=()) -> None:
    """Print the warnings of a result and the ``further`` ones, one per line."""
    for text in (*result.warnings, *further):
        print(f"WARNING: {text}")


def print_design_warnings(first, last, further=()) -> None:
    """Print the warnings of the results of the first and of the last design of an optimisation, those of
    both designs once, and the ``further`` ones of the last design, one per line."""
    both = set(first.warnings).intersection(last.warnings)
    for text in first.warnings:
        print(f"WARNING{'' if text in both else ' (first design)'}: {text}")
    own = (text for text in last.warnings if text not in both)
    for text in (*own, *further):
        print(f"WARNING (last design): {text}")


def penalty_table(result) -> dict | None:
    """Tabulate the estimated penalty errors for summary.json; None for a path not completed.

    Where an error is not estimable, the table has the reason in place of a number.
    """
    if not result.converged:
        return None
    return {
        name: {"error": found.error[0] if found.error.size == 1 else found.error,
               "relative": found.relative}
        if found.estimable
        else {"error": None, "relative": None, "failure": not_estimable({name: found})}
        for name, found in result.penalty_error.items()
    }  # fmt: skip


def largest_penalty_error(result) -> tuple[tuple[str, float] | None, str]:
    """Find the measure with the largest relative penalty error, None where none is estimable, and say
    which measures have no estimate; empty where all have."""
    errors = result.penalty_error
    found = {name: abs(error.relative) for name, error in errors.items() if error.estimable}
    largest = max(found.items(), key=lambda item: item[1]) if found else None
    return largest, not_estimable(errors)


def print_penalty_errors(result) -> None:
    """Print the largest estimated penalty error in one line; nothing without contact."""
    largest, unknown = largest_penalty_error(result)
    parts = [] if largest is None else ["at most {1:.2%} ({0})".format(*largest)]
    # measures without an estimate are listed with the reason
    parts += [unknown] if unknown else []
    if parts:
        print(
            f"estimated numerical error due to the contact penalties alone: {'; '.join(parts)}; "
            "the errors due to particles and load steps are not included"
        )


def print_critical_points(result) -> None:
    """Print the critical points at which the seal lost stability, one per line."""
    for point in result.critical_points:
        print(f"STABILITY: {point.text}")


def critical_table(result) -> list[dict]:
    """Tabulate the critical points for summary.json."""
    return [
        {
            "stage": point.stage or None, "travel_mm": point.travel, "kind": point.kind,
            "moved_mm": point.moved,
            f"released_{result.seal.units.energy_key}": point.released,
        }
        for point in result.critical_points
    ]  # fmt: skip


def plain(value):
    """Convert numpy numbers and containers to those of JSON; nan and infinity become None."""
    if isinstance(value, dict):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray | list | tuple):
        return [plain(entry) for entry in value]
    # numpy scalar to a Python number
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _entry(value) -> str:
    """Format one entry as JSON: lists of lists or dictionaries with one element per line."""
    # one row of a table per line keeps the file readable
    if isinstance(value, list) and value and isinstance(value[0], list | dict):
        return "[\n  " + ",\n  ".join(json.dumps(element) for element in value) + "\n ]"
    return json.dumps(value)


def write_summary(out: Path, summary: dict) -> Path:
    """Write ``summary.json`` into the folder ``out``."""
    lines = [f" {json.dumps(key)}: {_entry(value)}" for key, value in plain(summary).items()]
    path = out / "summary.json"
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    return path


def design_from(path: Path, seal: sm.Seal) -> tuple[np.ndarray, dict]:
    """Read boundary offsets and door radius (mm) from the summary.json of an optimisation."""
    try:
        summary = json.loads(read_text(path))
        offsets, radius = summary["boundary_offsets"], summary["door_radius"]
    except OSError as error:
        raise WrongArgumentError(
            f"the file of the design {path} cannot be read: {error.strerror}"
        ) from None
    except (ValueError, KeyError, TypeError, RecursionError):
        # not JSON, or JSON of something else
        text = (
            f"{path} is not the summary.json of a door seal: boundary_offsets or door_radius is "
            "missing or invalid"
        )
        raise WrongArgumentError(text) from None
    with checked_arguments():
        # values are checked against the seal's shapes and ranges
        changed = seal.with_parameters({"door_radius": radius}).changed
        return seal.check_offsets(offsets), {"door_radius": changed["door_radius"]}

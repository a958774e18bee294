"""Choose the particles so that the estimated errors of the measures are at most PERCENT, and write
them into a copy of the seal file.

The particles are those that the key accuracy of [section] chooses.
"""

import json
import os
import re
import tomllib
from pathlib import Path

from seal_mdao import plotting
from seal_mdao.cli.arguments import (
    NAME_OF_FILE,
    WrongArgumentError,
    parser,
    percentage,
    write_summary,
)
from seal_mdao.cli.error_table import error_summary, print_errors
from seal_mdao.cli.seal_files import file_errors, file_of, filling_lines, seal_of
from seal_mdao.errors import SealFileError
from seal_mdao.input_files import read_text
from seal_mdao.seals.file.described import named_in
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.read import read_changed
from seal_mdao.seals.outline.rays import Rays
from seal_mdao.seals.outline.section_cloud import OutlineCloud
from seal_mdao.seals.result import unloaded
from seal_mdao.seals.steps_and_penalties import PENALTY_TOLERANCE, STEP_TOLERANCE

USUAL = 0.01
"""Error that is admissible where neither the command nor the file gives one."""


def main(arguments) -> int:
    written, tried = arguments.out / f"{arguments.file.stem}.toml", []
    if written.resolve() == arguments.file.resolve():
        raise WrongArgumentError(
            f"argument --out: {written} is the seal file itself and would be overwritten; choose "
            "another folder"
        )
    file = with_accuracy(file_of(arguments.file), arguments.to, arguments.measures)
    with file_errors(arguments.file):
        # a text in which the particles cannot be written is an error before the analyses
        refined_text(file, arguments.out)
    file, seal = seal_of(file, report=tried.append, anew=True)
    found = tried[-1]
    print_errors(found.estimates, found.result)
    plotting.save(plotting.error_parts(found.estimates), arguments.out / "errors.png")
    picture = plotting.section_cloud(unloaded(seal), found.estimates)
    plotting.save(picture, arguments.out / "section.png")
    written.write_text(refined_text(file, arguments.out), encoding="utf-8")
    clouds = [
        {
            "spacing_mm": cloud.file.section.spacing, "layers": cloud.file.section.layers,
            "n_particles": len(cloud.result.particles), "errors": error_summary(cloud.estimates),
        }
        for cloud in tried
    ]  # fmt: skip
    summary = {"accuracy": file.section.accuracy, "clouds": clouds, "file": written.name}
    write_summary(arguments.out, summary)
    print(
        f"{written} has these particles; errors.png, section.png and summary.json are in the same "
        "folder"
    )
    return 0


def with_accuracy(file: SealFile, most: float | None, measures: list[str] | None) -> SealFile:
    """Read a seal file again with another ``accuracy``: at most ``most``, of ``measures``.

    Without both, the accuracy of the file remains, ``USUAL`` for a file without.

    Raises
    ------
    SealFileError
        For unknown measures, and a section with rays or a cloud.
    """
    own, spacing = file.section.accuracy, file.section.spacing
    if isinstance(spacing, Rays | OutlineCloud):
        given = "rays" if isinstance(spacing, Rays) else "cloud"
        raise SealFileError(
            f"{file.path}: [section]: particles can be chosen for a section with spacing only, but "
            f"this one has {given}; replace {given} by a spacing"
        )
    if own is not None and most is None and measures is None:
        return file
    text = f"{100.0 * (USUAL if most is None else most):.9g} %"

    def change(tables: dict) -> None:
        tables["section"]["accuracy"] = dict.fromkeys(measures, text) if measures else text

    return read_changed(file.path, change)


LINE = re.compile(r"(?m)^(spacing|accuracy|layers|edge_spacing)\s*=.*\n")
"""Line of a seal file with a key that the chosen particles replace."""


def refined_text(file: SealFile, folder: Path) -> str:
    """Write the particles of a file, and its tolerances of load steps and penalties, into its text,
    whose other lines stay as they are.

    Paths of files beside it become relative to ``folder``.

    Raises
    ------
    ValueError
        For a text in which the keys are not on lines of their own.
    """
    path, text = file.path, read_text(file.path)
    tables = tomllib.loads(text)
    for name in named_in(tables):
        moved = Path(os.path.relpath(path.parent / name, folder)).as_posix()
        text = text.replace(json.dumps(name), json.dumps(moved)).replace(f"'{name}'", f"'{moved}'")
    # the new keys where the first old one was, or at the beginning of the table
    old, table = LINE.search(text), re.search(r"(?m)^\[section\].*\n", text)
    if old or table:
        first = old.start() if old else table.end()
        rest = LINE.sub("", text[first:])
        text = text[:first] + "\n".join([*filling_lines(file.section), rest])
    tolerances = {}
    if file.step_tolerance is not None:
        tolerances["steps"] = file.step_tolerance, STEP_TOLERANCE
    if file.open_penalties:
        tolerances["penalties"] = file.penalty_tolerance, PENALTY_TOLERANCE
    for name, (tolerance, usual) in tolerances.items():
        if tolerance != tables.get(name, {}).get("tolerance", usual):
            text = _with_tolerance(text, name, tolerance)
    _require_keys(text, file, tolerances)
    return text


def _with_tolerance(text: str, name: str, tolerance: float) -> str:
    """Write the tolerance of ``[steps]`` or ``[penalties]``; add the table where it is missing."""
    line = f"tolerance = {tolerance:.9g}"
    table = re.compile(rf"(?m)^(\[{name}\][^\[]*?^)tolerance\s*=.*$")
    if table.search(text):
        return table.sub(lambda found: found[1] + line, text, count=1)
    return f"{text.rstrip()}\n\n[{name}]\n{line}\n"


def _require_keys(text: str, file: SealFile, tolerances: dict) -> None:
    """Raise ValueError for a text that does not have the particles and tolerances of a file."""
    try:
        tables = tomllib.loads(text)
    except ValueError:
        tables = {"section": {}}
    section, filling = tables["section"], file.section.filling
    found = {name: section.get(name, {}) for name in filling}
    kept = all(
        tables.get(name, {}).get("tolerance", usual) == own
        for name, (own, usual) in tolerances.items()
    )
    if found != filling or "accuracy" in section or not kept:
        raise ValueError(
            "spacing, accuracy, layers and edge_spacing of [section] must be on lines of their own, "
            "such as spacing = 0.5, and so must tolerance of [steps] and [penalties], so that they "
            "can be replaced"
        )


def arguments_parser():
    made = parser(
        __doc__, f"out/{NAME_OF_FILE}_refined", "FILE", "seal-mdao refine bulb.toml --to 1"
    )
    made.add_argument(
        "file", type=Path, metavar="FILE",
        help="seal file (TOML) with spacing or accuracy in [section]",
    )  # fmt: skip
    made.add_argument(
        "--to", type=percentage, metavar="PERCENT",
        help="allowed estimated numerical error of every measure, in percent of its value; default: "
        "accuracy of the file, or 1",
    )  # fmt: skip
    made.add_argument(
        "--measures", nargs="+", metavar="NAME",
        help="measures of the seal file to which the allowed error applies; default: those of its "
        "accuracy, or all",
    )  # fmt: skip
    return made

"""Read a seal file (TOML): check every table, then all tables against each other."""

import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from pydantic import TypeAdapter

from seal_mdao.errors import SealFileError
from seal_mdao.input_files import read_text
from seal_mdao.seals.file.accuracy import with_tolerances
from seal_mdao.seals.file.clearance import (
    NEAR,
    nearest_at_start,
    nearest_free_edges,
    rests_along_a_segment,
)
from seal_mdao.seals.file.consistency import check, turning_work, unsupported_bodies
from seal_mdao.seals.file.described import note_contents
from seal_mdao.seals.file.file_tables import MOVING, SealFile, Written
from seal_mdao.seals.file.load_steps import with_steps
from seal_mdao.seals.file.optimize_table import implied_measures
from seal_mdao.seals.file.schema import checked, suggestion
from seal_mdao.seals.outline.rays import Rays
from seal_mdao.seals.wall_grid import WALL_SCHEMES

TABLES = tuple(Written.model_fields)
NEEDED = tuple(name for name, own in Written.model_fields.items() if own.is_required())


def read_seal_file(path) -> SealFile:
    """Read and check a seal file; nothing is analysed.

    Parameters
    ----------
    path : str or Path

    Raises
    ------
    SealFileError
        One line that says what is wrong, in which table and key, and what is allowed.
    """
    path = Path(path)
    try:
        file = _read(_parsed(path), path)
        note_contents(file)
        return file
    except SealFileError as error:
        raise SealFileError(f"{path}: {error}") from None


def read_changed(path, change: Callable[[dict], None]) -> SealFile:
    """Read a seal file whose tables are changed before they are checked, as ``read_seal_file``.

    Parameters
    ----------
    path : str or Path
    change : callable
        Called with the tables as they are written, which it changes.

    Raises
    ------
    SealFileError
        As of ``read_seal_file``.
    """
    path = Path(path)
    try:
        tables = _parsed(path)
        change(tables)
        return _read(tables, path)
    except SealFileError as error:
        raise SealFileError(f"{path}: {error}") from None


def _parsed(path) -> dict:
    """Parse the TOML of a file; what it cannot read, it says in one line."""
    # reading, decoding and parsing each have their own message
    try:
        content = read_text(path)
    except FileNotFoundError:
        raise SealFileError("there is no such file") from None
    except OSError as error:
        raise SealFileError(f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError as error:
        raise SealFileError(
            f"the seal file is not a text file in UTF-8 (first invalid byte: {error.start}); save "
            "it in this encoding"
        ) from None
    try:
        found = tomllib.loads(content)
    except (ValueError, RecursionError) as error:
        text = " ".join(str(error).split())
        twice = re.match(r"Cannot declare \('(\w+)',\) twice", text)
        if twice:
            name = twice[1]
            text += f"; a table that may be repeated has two pairs of brackets, as in [[{name}]]"
        raise SealFileError(f"the seal file is not valid TOML: {text}") from None
    if not found:
        raise SealFileError(
            f"the seal file is empty; it needs at least {_written((*NEEDED, MOVING[0]))}"
        )
    return found


def _written(names) -> str:
    """Write names of tables as they stand in a file."""
    forms = {"material": "[material.NAME]", "profile": "[[profile]]"}
    return ", ".join(forms.get(name, f"[{name}]") for name in names)


def _read(given, path) -> SealFile:
    # unknown tables first: they may be required ones, misspelt
    for name in given:
        if name not in TABLES:
            raise SealFileError(
                f"the seal file has an unknown table or key {name!r}{suggestion(name, TABLES)}; "
                "the tables are " + ", ".join(TABLES)
            )
    # tables that every seal needs
    missing = [name for name in NEEDED if name not in given]
    # something has to move
    missing += [] if any(name in given for name in MOVING) else [MOVING[0]]
    if missing:
        raise SealFileError(f"{_written(missing[:1])} is missing")
    file = _decided(checked(TypeAdapter(Written), given), given, path)
    check(file)
    return file


def _decided(written: Written, given: dict, path: Path) -> SealFile:
    """Decide what a file leaves to its other tables and files, and to defaults."""
    # labels and steps first: measures refer to profiles and their travels
    _check_profile_names(written.profile)
    profiles, moved, step_tolerance = with_steps(written.profile, written.moved, written.steps)
    moving = (*profiles, *moved)
    measures = tuple(
        own.read(f"[[measure]] {i}", path.parent).settled(f"[[measure]] {i}", moving)
        for i, own in enumerate(written.measure, 1)
    )
    # a problem may name types of measures that have no table of their own
    implied = {}
    if written.optimize is not None:
        implied = implied_measures(written.optimize, measures, moving)
    # constants may be fitted to tests, the section may be a drawing: files beside this one
    materials = {
        name: own.made(f"[material.{name}]", path.parent) for name, own in written.material.items()
    }
    section = written.section.read(path.parent, tuple(materials))
    file = SealFile(
        path, materials, section, written.fixed, written.symmetry, profiles, written.design,
        (*measures, *implied.values()), written.optimize, written.cavity, written.self_contact,
        written.fluid, step_tolerance, written.penalties.tolerance, written.term, moved,
        written.tolerance, written.model, written.material,
        {own.name: where for where, own in implied.items()}, given,
    )  # fmt: skip
    file = replace(file, measures=tuple(own.completed(file) for own in file.measures))
    file = replace(file, profiles=_with_contact(file))
    return with_tolerances(replace(file, profiles=_with_contact_points(file)))


def _check_profile_names(profiles) -> None:
    """Refuse names of profiles that are taken: they are labels of terms."""
    names = [profile.name for profile in profiles]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise SealFileError(
                f"[[profile]] {i + 1}: name = {name!r}, but an earlier [[profile]] has this name; "
                "give every profile a different name"
            )
        if name == "structure":
            raise SealFileError(
                f"[[profile]] {i + 1}: name = 'structure' is reserved for the seal itself; give "
                "this profile another name"
            )


def _with_contact(file: SealFile) -> tuple:
    """Choose the edges that may touch a profile where the file leaves them open."""
    return tuple(
        replace(own, contact=nearest_free_edges(f"[[profile]] {i} ({own.name!r})", own, file))
        if own.contact is None
        else own
        for i, own in enumerate(file.profiles, 1)
    )


def _with_contact_points(file: SealFile) -> tuple:
    """Choose the contact points of profiles where the file leaves them open.

    The averages, which reproduce a uniform pressure; on rays those of their scheme. The particles where
    something needs a particle at the contact: a fluid that contact stops, the work of a profile that
    turns, a body in plane strain that only profiles hold (``_at_particles``).
    """
    bodies = () if file.axisymmetric else unsupported_bodies(file)
    holding = {name for _, edges in bodies for name in _at_particles(file, edges)}
    spacing = file.section.spacing
    found = []
    for own in file.profiles:
        chosen = "averages"
        if file.penetrating_fluids or own.name in holding or turning_work(own, file.measures):
            chosen = "particles"
        elif isinstance(spacing, Rays) and not file.axisymmetric:
            chosen = WALL_SCHEMES[spacing.accuracy].contact_points
        found.append(replace(own, contact_points=own.contact_points or chosen))
    return tuple(found)


def _at_particles(file: SealFile, edges: set) -> list[str]:
    """List the profiles that hold a body with these edges at single particles: those that do not touch a
    complete segment of it at the start; all of them if one does not touch or nearly touch."""
    outline = file.section.outline
    profiles = [own for own in file.profiles if edges & set(own.contact)]
    every = isinstance(file.section.spacing, Rays) or any(
        nearest_at_start(own, outline).gap > NEAR * outline.size for own in profiles
    )
    return [own.name for own in profiles if every or not rests_along_a_segment(own, outline)]

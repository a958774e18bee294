"""Rebuild seals from their ``settings``, as stored in recorder files."""

import json
import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory

from seal_mdao.errors import SealFileError
from seal_mdao.seals.door.door_seal import DOOR_SEAL, described_door_seal
from seal_mdao.seals.file.accuracy import with_filling
from seal_mdao.seals.file.build import built
from seal_mdao.seals.file.described import FILE, named_in, unpacked
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.seal import Seal


def seal_of(text: str) -> Seal:
    """Build the seal from its ``settings``.

    Raises
    ------
    ValueError
        When they are not those of a seal of this version.
    """
    try:
        settings = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"the recorded settings do not describe a seal: {error}") from error
    if not isinstance(settings, dict) or not settings.keys() & {FILE, DOOR_SEAL}:
        raise ValueError(
            "the recorded settings describe neither a seal file nor the built-in door seal"
        )
    seal = _seal_of_file(settings) if FILE in settings else described_door_seal(settings)
    try:
        if settings.get("placements"):
            seal = seal.with_placements()
        if "clearances" in settings:
            seal = seal.with_clearances(settings["clearances"])
        if "retractions" in settings:
            seal = seal.with_retractions(settings["retractions"])
        return seal.with_parameters(settings.get("parameters", {}))
    except (TypeError, AttributeError) as error:
        raise ValueError(f"the recorded settings do not describe a seal: {error}") from error


def _seal_of_file(found: dict) -> OutlineSeal:
    """The seal of a ``description``."""
    try:
        with TemporaryDirectory() as folder:
            for name, packed in found["beside"].items():
                if Path(name).name != name:
                    raise ValueError(f"the recorded file name {name!r} is not valid")
                (Path(folder) / name).write_bytes(unpacked(packed))
            path = Path(folder) / "seal.toml"
            path.write_text(found[FILE], encoding="utf-8")
            if any(name not in found["beside"] for name in named_in(tomllib.loads(found[FILE]))):
                raise ValueError(
                    "the recorder file lacks a file to which the seal file refers (drawing, mesh, "
                    "tests or targets)"
                )
            file, chosen = _all_chosen(found["chosen"], read_seal_file(path))
            seal = built(file, **chosen)
            return seal.made_from({key: found[key] for key in (FILE, "beside", "chosen")})
    except (TypeError, KeyError, AttributeError, ValueError, SealFileError) as error:
        raise ValueError(
            f"the recorded seal file is not valid in this version of seal_mdao: {error}"
        ) from error


def _all_chosen(chosen: dict, file: SealFile) -> tuple[SealFile, dict]:
    """Take what was chosen for a file, when it is all that the file leaves open: nothing is analysed
    here. Return the file with its particles, and the rest."""
    left_open = {
        "filling": file.leaves_particles_open, "step_ends": file.step_tolerance is not None,
        "penalties": file.open_penalties,
    }  # fmt: skip
    if set(chosen) != {name for name, is_open in left_open.items() if is_open}:
        raise ValueError(
            "the recorder file lacks the particles, load steps or contact penalties that were chosen "
            "in the recorded optimisation"
        )
    rest = {name: own for name, own in chosen.items() if name != "filling"}
    return with_filling(file, chosen["filling"]) if "filling" in chosen else file, rest


def described(settings: dict) -> dict:
    """Format settings for readers: tables of a seal file or options of a door seal, chosen steps
    and penalties, changed parameters."""
    own = tomllib.loads(settings[FILE]) if FILE in settings else settings.get(DOOR_SEAL, {})
    made = (FILE, DOOR_SEAL, "beside")
    return own | {key: value for key, value in settings.items() if key not in made and value}

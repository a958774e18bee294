"""Quantities that a sweep can vary: a parameter of the seal, the travel of a profile, any number of
its file."""

import tomllib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from seal_mdao.cli.arguments import WrongArgumentError
from seal_mdao.cli.seal_files import file_errors, filled, seal_of
from seal_mdao.cli.varied_travel import set_travel
from seal_mdao.seals.file.accuracy import with_filling
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.read import read_changed
from seal_mdao.seals.file.reference import unit_of_key
from seal_mdao.seals.file.schema import suggestion
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.seal import Seal

TRAVEL = "travel"
"""Ending of the names of travels: ``door_travel``."""
MOST_LISTED = 60
"""Numbers of a file that are listed in an error."""


@dataclass(frozen=True, eq=False)
class Varied:
    """Varied quantity with its values.

    Attributes
    ----------
    name, unit : str
        The unit is empty for pure numbers.
    change : callable, or None
        ``change(tables, value)`` sets the number in the tables of the file, which then is read again;
        None for a parameter of the seal.
    unchosen : OutlineSeal, or None
        Seal of the file before load steps and penalties are chosen, of a parameter.
    beyond : dict
        Values at which measures are left out, by their names and the travels (mm) that are not reached.
    """

    name: str
    unit: str
    change: Callable | None = None
    unchosen: OutlineSeal | None = None
    beyond: dict = field(default_factory=dict)

    def notes(self) -> list[str]:
        """Say which measures are left out at which values, one line each; known once files are read."""
        return [
            f"{measure} needs the force at {farthest:g} mm of travel and is left empty where the "
            f"travel is shorter: {self.name} = {', '.join(f'{value:g}' for value in values)}"
            for (measure, farthest), values in self.beyond.items()
        ]

    def files(self, file: SealFile, values) -> list[SealFile]:
        """Read the file with every value; all are read before anything is analysed.

        Raises
        ------
        SealFileError
            For a value that the file cannot have.
        """
        if self.change is None:
            return [file] * len(values)
        return [read_changed(file.path, lambda own, v=v: self.change(own, v)) for v in values]

    def seals(self, file: SealFile, values) -> Iterator[tuple[Seal, dict]]:
        """Return the seal of every value, built when it is asked for, with its changed parameters.

        Load steps and penalties that the file leaves open are chosen once for a parameter, anew for a
        number of the file; particles once for the file.
        """
        files, seal = self.files(file, values), None
        if self.change is None:
            self._check(file.path, values)
            _, seal = seal_of(file, unchosen=self.unchosen)
        elif file.leaves_particles_open:
            filling = seal_of(file)[0].section.filling
            files = [with_filling(own, filling) for own in files]
        if seal is not None and self.name not in seal.scalars:
            seal = seal.with_placements()
        for own, value in zip(files, values, strict=True):
            if seal is not None:
                yield seal, {self.name: float(value)}
            else:
                yield seal_of(own)[1], {}

    def _check(self, path: Path, values) -> None:
        """Refuse values that the parameter cannot have, before load steps are chosen.

        Raises
        ------
        SealFileError
        """
        placed = self.unchosen.with_placements()
        with file_errors(path):
            for value in values:
                placed.with_parameters({self.name: float(value)})


def varied(file: SealFile, name: str) -> Varied:
    """Identify the quantity of a name: a parameter or the end of its name, a travel, a number of
    the file.

    Raises
    ------
    WrongArgumentError
        For a name of nothing, or of more than one; it lists what there is.
    SealFileError
        For a file whose section cannot be filled.
    """
    tables = tomllib.loads(file.path.read_text(encoding="utf-8"))
    if "." in name:
        if name.startswith("section.") and file.section.accuracy is not None:
            raise WrongArgumentError(
                f"--vary: {name} cannot be varied, because the particles are chosen for accuracy of "
                "[section]; give spacing without accuracy"
            )
        return _number_of(tables, name)
    unchosen = filled(file)
    # as for tolerances, placements of profiles are parameters
    scalars = unchosen.with_placements().scalars
    travels = {f"{own.name}_{TRAVEL}": own.name for own in file.profiles if own.travel}
    known = [*scalars, *travels]
    own = parameter_name("--vary", name, known, f"; numbers of the file are {_listed(tables)}")
    if own in travels and own not in scalars:
        return _varied_travel(own, travels[own], file.path.parent)
    return Varied(own, scalars[own].units or "", unchosen=unchosen)


def parameter_name(option: str, name: str, known: Iterable[str], further: str = "") -> str:
    """Find the parameter that a name, or the end of a name, identifies.

    Raises
    ------
    WrongArgumentError
        For a name of nothing, or of more than one; it begins with ``option`` and lists what there is,
        and ``further`` things for a name of nothing.
    """
    # a unique ending is enough: friction for plate_friction
    found = [name] if name in known else [own for own in known if own.endswith(f"_{name}")]
    listed = ", ".join(known)
    if len(found) > 1:
        raise WrongArgumentError(
            f"{option}: {name!r} is ambiguous, it matches {', '.join(found)}; give the full name "
            f"(all parameters: {listed})"
        )
    if not found:
        close = suggestion(name, [*known, *(own.rpartition("_")[2] for own in known)])
        raise WrongArgumentError(
            f"{option}: there is no parameter {name!r}{close}; the parameters are {listed}{further}"
        )
    return found[0]


def _varied_travel(name: str, profile: str, folder: Path) -> Varied:
    """Vary the travel of a profile, and note the measures that are beyond its end."""
    beyond = {}

    def change(tables, value):
        for own, farthest in set_travel(tables, profile, value, folder).items():
            beyond.setdefault((own, farthest), []).append(float(value))

    return Varied(name, "mm", change, beyond=beyond)


# ---- numbers of a file by their paths ----


def _number_of(tables: dict, path: str) -> Varied:
    """Find a number of a file by its dotted path: ``material.rubber.c10``, ``profile.door.start.2``."""
    *before, last = path.split(".")
    place = tables
    for step in before:
        place = _within(place, step)
        if place is None:
            raise _unknown(tables, path)
    value = _within(place, last)
    # a key that is not written may be one that holds a default
    is_new_key = isinstance(place, dict) and last not in place
    if not is_new_key and (isinstance(value, bool) or not isinstance(value, int | float)):
        raise _unknown(tables, path)
    return Varied(path, unit_of_key(tables, path), lambda own, v: _set(own, path, v))


def _unknown(tables, path) -> WrongArgumentError:
    return WrongArgumentError(
        f"--vary: the seal file has no number {path!r}{suggestion(path, _numbers(tables))}; its "
        f"numbers are {_listed(tables)}"
    )


def _within(place, step: str):
    """Take one step of a path: a key, the name of a row, or a number of a list from 1; None if it leads
    nowhere."""
    if isinstance(place, dict):
        return place.get(step)
    if not isinstance(place, list):
        return None
    named = [own for own in place if isinstance(own, dict) and own.get("name") == step]
    if named:
        return named[0]
    number = int(step) if step.isdecimal() else 0
    return place[number - 1] if 1 <= number <= len(place) else None


def _set(tables: dict, path: str, value: float) -> None:
    """Set a number of a file; a whole one is an integer, which every number may be."""
    *before, last = path.split(".")
    place = tables
    for step in before:
        place = _within(place, step)
    value = int(value) if float(value).is_integer() else float(value)
    place[int(last) - 1 if isinstance(place, list) else last] = value


def _numbers(place, path=()) -> Iterator[str]:
    """List the paths of the numbers that keys of a file have; coordinates and lists are left out."""
    for name, value in place.items():
        if isinstance(value, dict):
            yield from _numbers(value, (*path, name))
        elif isinstance(value, list):
            for number, row in enumerate(value, 1):
                if isinstance(row, dict):
                    yield from _numbers(row, (*path, name, str(row.get("name", number))))
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield ".".join((*path, name))


def _listed(tables) -> str:
    every = list(_numbers(tables))
    more = f", and {len(every) - MOST_LISTED} more" if len(every) > MOST_LISTED else ""
    return ", ".join(every[:MOST_LISTED]) + more

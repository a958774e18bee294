"""The contract of ``[[measure]]``: a table by its type, and the ``Measure`` that it becomes."""

from collections.abc import Callable
from dataclasses import fields, replace
from inspect import get_annotations
from pathlib import Path
from typing import Annotated

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.measures.contact_pressure import ContactPressure
from seal_mdao.measures.gap import BetweenContacts, Gap
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.measures.stress import VonMises
from seal_mdao.seals.file.forms import Form, Name, Text, many, one_of, whole
from seal_mdao.seals.file.schema import Table, key, known, table

Places = many(whole(0, 10**6), "a list of indices, from 0")
TypeName = Annotated[str, Form("the name of a type")]


@table(kw_only=True)
class MeasureTable(Table):
    """Measure, a result that can be an objective or a constraint, given by its type.

    A class for a type (``@kind``) has further keys as annotations, and ``single`` where it does not
    give one number.
    """

    type: TypeName = key("type of the measure")
    name: Name | None = key("name of the measure; default: its type", None)

    single = True
    """Whether it is a single number."""

    @property
    def count(self) -> int | None:
        """Number of values; None where it is known with the nominal seal only."""
        return 1 if self.single else None

    @property
    def arguments(self) -> dict:
        """Values of its keys beside ``type`` and ``name``."""
        # fields of the dataclass are the keys of the table
        every = {own.name: getattr(self, own.name) for own in fields(self)}
        return {name: own for name, own in every.items() if name not in ("type", "name")}

    def measure(self, particles: np.ndarray) -> Measure:
        """Make the measure, for a section with ``particles`` (n, 2)."""
        # keys that are not given are left to the measure
        return self.makes(**{name: v for name, v in self.arguments.items() if v is not None})

    def read(self, where: str, folder: Path) -> "MeasureTable":
        """Return the table with the content of the file in ``folder`` that it names, if any.

        SealFileError says why this cannot be read.
        """
        return self

    def settled(self, where: str, profiles: tuple) -> "MeasureTable":
        """Return the table completed with profiles and moved edges of the file, and its name.

        SealFileError says what it cannot leave to them.
        """
        return replace(self, name=self.type if self.name is None else self.name)

    def completed(self, file) -> "MeasureTable":
        """Return the table completed with names from the other tables of the file."""
        return self

    def check(self, where: str, file) -> None:
        """Raise SealFileError for a table that does not fit the other tables of the file."""


KINDS = {}
"""Class of the table of every type of measure, by its name in seal files."""


def kind(name: str, makes: Callable[..., Measure]):
    """Declare a class as the table of a type of measure.

    ``makes`` returns the measure for the keys of the table that are given.
    """

    def made(own: type) -> type:
        # the first key has one value, the name of the type
        own.__annotations__ = {"type": one_of(name)} | get_annotations(own)
        own.type, own.makes = key("type of the measure"), staticmethod(makes)
        KINDS[name] = table(kw_only=True)(own)
        return KINDS[name]

    return made


def simple_kind(name: str, makes: Callable[..., Measure], base: type, text: str) -> None:
    """Add a type of measure whose table has the keys of ``base``, with its docstring."""
    # no keys of its own: the annotations are those of the base
    attributes = {"__doc__": text, "__annotations__": {}, "__module__": base.__module__}
    kind(name, makes)(type(f"{name}_table", (base,), attributes))


@table(kw_only=True)
class OfProfile(MeasureTable):
    """A measure at a profile."""

    @staticmethod
    def takes(moving) -> bool:
        """Return whether a table of ``settled`` may be named: a profile, not moved edges."""
        return hasattr(moving, "contact")

    profile: Text | None = key("name of a profile; optional if there is only one", None)

    def settled(self, where, profiles):
        # the only profile, unless the table names one
        names = [own.name for own in profiles if self.takes(own)]
        if not names:
            raise SealFileError(
                f"{where}: type = {self.type!r} needs a [[profile]], but the seal file has none; "
                "add a [[profile]], or leave out this measure"
            )
        if self.profile is None and len(names) > 1:
            raise SealFileError(
                f"{where}: the key 'profile' is missing; with several profiles it must be one of "
                f"{', '.join(names)}"
            )
        name = names[0] if self.profile is None else self.profile
        known(where, "profile", name, names, "profile")
        return replace(super().settled(where, profiles), profile=name)


@table(kw_only=True)
class AtPlaces(OfProfile):
    """A measure at contact points of a profile."""

    places: Places | None = key(
        "with a cloud: indices of the contact points at which gaps are taken", None
    )


def only_name(given: str | None, tables: tuple, default: str) -> str:
    """Return the given name of a table; without one that of the only table, else the default."""
    if given is not None:
        return given
    return tables[0].name if len(tables) == 1 else default


def nearest(point, particles: np.ndarray) -> int:
    """Find the particle nearest to a point."""
    return int(np.hypot(*(particles - point).T).argmin())


def measure_of(entry: MeasureTable, particles: np.ndarray) -> Measure:
    """Make the measure of a table, for a section with ``particles`` (n, 2)."""
    return replace(entry.measure(particles), name=entry.name)


def places_of(measure: Measure):
    """Describe the evaluation points of a measure as ``places`` of a table does, or return None."""
    # a derived measure has the places of its base
    base = measure.base if isinstance(measure, Derived) else measure
    if isinstance(base, Gap | VonMises):
        return base.points
    if isinstance(base, BetweenContacts):
        return base.nominal
    return base.patches if isinstance(base, ContactPressure) else None

"""``[[measure]]``: what measures name in other tables, and the places that they have taken."""

from dataclasses import replace

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.measures.contact_pressure import ContactPressure
from seal_mdao.measures.gap import BetweenContacts, Gap
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.measures.stress import VonMises
from seal_mdao.seals.file.measure_kinds import EXTENSIONS, KINDS
from seal_mdao.seals.file.measure_table import MeasureTable
from seal_mdao.seals.file.schema import suggestion
from seal_mdao.seals.outline.cloud_file import GivenCloud


def implied_measure(where: str, key: str, name: str, declared, profiles):
    """The measure that ``[optimize]`` means by ``name``, and whether it is a new one.

    Raises
    ------
    SealFileError
        For a name that is neither a declared measure nor a type that needs nothing more.
    """
    for measure in declared:
        if measure.name == name:
            return measure, False
    kind = _kind_of(f"{where}: {key}", name)
    if kind is not None and _needs_nothing(kind):
        return kind(type=name).settled(where, profiles), True
    names = [measure.name for measure in declared]
    close = suggestion(name, [*names, *KINDS])
    raise SealFileError(
        f"{where}: {key} = {name!r}, but there is no such measure{close}; it must be the name of a "
        f"[[measure]] ({', '.join(names) or 'there is none'}) or a type of its own such as "
        "section_area or reaction"
    )


def _kind_of(where: str, name: str) -> type[MeasureTable] | None:
    """The table of a type of measure, of the package or an extension; None for an unknown one."""
    try:
        return EXTENSIONS.found(name) or KINDS.get(name)
    except ValueError as error:
        raise SealFileError(f"{where}: {error}") from None


def _needs_nothing(kind: type[MeasureTable]) -> bool:
    return all(own.default is None for name, own in kind.entries().items() if name != "type")


def check_measures(file) -> None:
    """Refuse names that are taken, places without a cloud, and what other tables do not have.

    Raises
    ------
    SealFileError
    """
    names = [measure.name for measure in file.measures]
    for number, measure in enumerate(file.measures, 1):
        where = f"[[measure]] {number}"
        if measure.name in names[: number - 1]:
            raise SealFileError(
                f"{where}: name = {measure.name!r}, but an earlier measure has it; give every measure "
                "a name of its own"
            )
        cloud = isinstance(file.section.spacing, GivenCloud)
        if getattr(measure, "places", None) is not None and not cloud:
            raise SealFileError(
                f"{where}: places are numbers of particles, which are known beside [section] cloud alone"
            )
        measure.check(where, file)


def measure_of(entry: MeasureTable, particles: np.ndarray) -> Measure:
    """The measure of a table, for a section with ``particles`` (n, 2)."""
    return replace(entry.measure(particles), name=entry.name)


def places_of(measure: Measure):
    """What ``places`` of a table says of a measure that has taken its places; None for another one."""
    base = measure.base if isinstance(measure, Derived) else measure
    named = {
        Gap: "points",
        BetweenContacts: "nominal",
        ContactPressure: "patches",
        VonMises: "points",
    }
    names = [name for kind, name in named.items() if isinstance(base, kind)]
    return getattr(base, names[0]) if names else None

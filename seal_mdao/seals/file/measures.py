"""``[[measure]]``: reading a table, and the ``Measure`` that it becomes."""

from dataclasses import replace

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.geometry.motion import ROUNDING
from seal_mdao.measures.contact import TRAVEL, BetweenContacts, Gap
from seal_mdao.measures.contact_pressure import ContactPressure
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.measures.stress import VonMises
from seal_mdao.registry import names as extension_names
from seal_mdao.seals.file.checks import NAME, TEXT, Key, known, one_of, suggestion, table
from seal_mdao.seals.file.extensions import extension, keys_of
from seal_mdao.seals.file.measure_kinds import KINDS, Kind, stress_points
from seal_mdao.seals.file.tables import MeasureTable, ProfileTable


def read_measure(where: str, given: dict, profiles: tuple[ProfileTable, ...]) -> MeasureTable:
    """A measure with its arguments; the profile may be left out where there is one only.

    Raises
    ------
    SealFileError
        For an unknown type, key or profile.
    """
    kind = given.get("type")
    found = kind_of(where, kind)
    if found is None:
        head = {name: given[name] for name in ("type",) if name in given}
        table(where, head, {"type": Key(one_of(*KINDS, *extension_names("measures")))})
    keys = found.keys
    values = table(where, given, {"type": Key(TEXT), "name": Key(NAME, kind), **keys})
    values.pop("type")
    name = values.pop("name")
    if "profile" in keys:
        values["profile"] = _profile(where, values["profile"], profiles)
    if kind == "reaction":
        _check_reaction(where, values, profiles)
    if kind == "von_mises":
        _check_stress(where, values)
    return MeasureTable(kind, name, values)


def kind_of(where: str, name) -> Kind | None:
    """The type of measure of a name, of the package or an extension; None for an unknown one.

    Raises
    ------
    SealFileError
        For an extension that cannot be used.
    """
    made = extension(where, "measures", name, KINDS)
    if made is None:
        return KINDS.get(name) if isinstance(name, str) else None
    return Kind(
        lambda a, particles: made(**a),
        keys_of(made, ("name",)),
        lambda a: made.scalar or made.size is Measure.size,
    )


def _check_stress(where, values) -> None:
    """Refuse more than one choice of where the stress is measured."""
    if values["at"] is not None and values["count"] is not None:
        raise SealFileError(f"{where}: at beside count; use one of them")
    if values["excess"] is not None and stress_points(values):
        raise SealFileError(
            f"{where}: excess belongs to the maximum of the complete section; leave it out beside "
            "at, count or places"
        )


def _check_reaction(where, values, profiles) -> None:
    """Refuse a travel that is not on the path; choose the component unless there is a direction."""
    own = next(p for p in profiles if p.name == values["profile"])
    if values["component"] is not None and values["direction"] is not None:
        raise SealFileError(f"{where}: component beside direction; use one of them")
    if values["component"] is None and values["direction"] is None:
        values["component"] = _main_axis(own)
    moving = next((p for p in (own, *profiles) if p.travel > 0.0), own)
    if values["direction"] == TRAVEL and not own.travel > 0.0:
        raise SealFileError(
            f"{where}: direction = {TRAVEL!r}, but the profile {own.name!r} does not travel; give the "
            "direction as [x, y]"
        )
    if values["travel"] is None:
        return
    farthest = np.max(values["travel"])
    if farthest > moving.travel * (1.0 + ROUNDING):
        raise SealFileError(
            f"{where}: travel = {farthest:g}, but the path of the profile {moving.name!r} is only "
            f"{moving.travel:.6g} mm long"
        )


def is_single(measure: MeasureTable) -> bool:
    """Whether a measure is a single number."""
    return kind_of(f"type = {measure.type!r}", measure.type).one(measure.arguments)


def _profile(where, name, profiles) -> str:
    names = [profile.name for profile in profiles]
    if name is None and len(names) > 1:
        raise SealFileError(
            f"{where}: the key 'profile' is missing; it must be one of {', '.join(names)}"
        )
    name = names[0] if name is None else name
    known(where, "profile", name, names, "profile")
    return name


def _main_axis(profile) -> str:
    """Along which axis the first stage of a profile that is a translation moves most; y for none."""
    for stage in profile.stages:
        if any(stage.translate):
            return "x" if abs(stage.translate[0]) > abs(stage.translate[1]) else "y"
    return "y"


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
    kind = kind_of(f"{where}: {key}", name)
    if kind is not None and all(k.default is None for k in kind.keys.values()):
        return read_measure(where, {"type": name}, profiles), True
    names = [measure.name for measure in declared]
    close = suggestion(name, [*names, *KINDS])
    raise SealFileError(
        f"{where}: {key} = {name!r}, but there is no such measure{close}; it must be the name of a "
        f"[[measure]] ({', '.join(names) or 'there is none'}) or a type of its own such as "
        "section_area or reaction"
    )


def measure_of(entry: MeasureTable, particles: np.ndarray) -> Measure:
    """The measure of a table, for a section with ``particles`` (n, 2)."""
    made = kind_of(f"type = {entry.type!r}", entry.type).make(entry.arguments, particles)
    return replace(made, name=entry.name)


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

"""``[[measure]]``: types by name, what each asks for, and the ``Measure`` that it becomes."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.measures.cavity import CavityPressure
from seal_mdao.measures.contact import (
    ContactPressure,
    ContactWidth,
    Gap,
    GapSquareIntegral,
    GapSquareSum,
    PeakPressure,
    Reaction,
)
from seal_mdao.measures.energy import StrainEnergy
from seal_mdao.measures.fluid import BlowOffPressure
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.measures.shape import CavityArea, Displacement, SectionArea
from seal_mdao.measures.stress import StressNorm, VonMises
from seal_mdao.measures.work import FrictionWork, ProfileWork
from seal_mdao.seals.file.checks import (
    NAME,
    POINT,
    TEXT,
    Key,
    known,
    many,
    one_of,
    suggestion,
    table,
    whole,
)
from seal_mdao.seals.file.tables import MeasureTable, ProfileTable

_PROFILE = {"profile": Key(TEXT, None)}
_ORDER = {"order": Key(whole(2, 1000), None)}
_AXES = {"x": 0, "y": 1}
_NUMBERS = many(whole(0, 10**6), "a list of numbers of particles, from 0 on")
_PLACES = {"places": Key(_NUMBERS, None)}
_PATCHES = {"places": Key(many(_NUMBERS, "a list of such lists, one for every patch"), None)}


class Kind(NamedTuple):
    """A type of measure.

    Attributes
    ----------
    make : callable
        Gives the measure from its arguments and the particles (n, 2).
    keys : dict of str to Key
        Of its table, beside ``type`` and ``name``.
    one : bool
        Whether it is a single number.
    """

    make: Callable
    keys: dict
    one: bool = True


def _given(arguments, *names):
    return {name: arguments[name] for name in names if arguments[name] is not None}


def _of_profile(measure):
    return lambda a, particles: measure(a["profile"])


def _pressure(measure):
    return lambda a, particles: measure(a["profile"], **_given(a, "order"))


def _at_places(measure):
    return lambda a, particles: measure(a["profile"], a["places"])


def _nearest(arguments, particles):
    away = np.hypot(*(particles - arguments["at"]).T)
    return Displacement(int(away.argmin()))


KINDS = {
    "section_area": Kind(lambda a, particles: SectionArea(), {}),
    "cavity_area": Kind(lambda a, particles: CavityArea(a["edge"]), {"edge": Key(TEXT)}),
    "cavity_pressure": Kind(
        lambda a, particles: CavityPressure(a["cavity"]), {"cavity": Key(TEXT, "air")}
    ),
    "blow_off_pressure": Kind(
        lambda a, particles: BlowOffPressure(a["fluid"]), {"fluid": Key(TEXT, "fluid")}
    ),
    "contact_width": Kind(_of_profile(ContactWidth), _PROFILE),
    "peak_pressure": Kind(_pressure(PeakPressure), _PROFILE | _ORDER),
    "contact_pressure": Kind(
        lambda a, particles: ContactPressure(a["profile"], a["places"], **_given(a, "order")),
        _PROFILE | _ORDER | _PATCHES,
        one=False,
    ),
    "reaction": Kind(
        lambda a, particles: Reaction(a["profile"], components=(_AXES[a["component"]],)),
        _PROFILE | {"component": Key(one_of(*_AXES), None)},
    ),
    "gap": Kind(_at_places(Gap), _PROFILE | _PLACES, one=False),
    "gap_square_sum": Kind(
        lambda a, particles: GapSquareSum(Gap(a["profile"], a["places"])), _PROFILE | _PLACES
    ),
    "gap_square_integral": Kind(_at_places(GapSquareIntegral), _PROFILE | _PLACES),
    "profile_work": Kind(_of_profile(ProfileWork), _PROFILE),
    "friction_work": Kind(lambda a, particles: FrictionWork(), {}),
    "strain_energy": Kind(lambda a, particles: StrainEnergy(), {}),
    "stress_norm": Kind(lambda a, particles: StressNorm(**_given(a, "order")), _ORDER),
    "von_mises": Kind(
        lambda a, particles: VonMises(a["places"], **_given(a, "count")),
        {"count": Key(whole(1, 1000), None)} | _PLACES,
        one=False,
    ),
    "displacement": Kind(_nearest, {"at": Key(POINT)}, one=False),
}


def read_measure(where: str, given: dict, profiles: tuple[ProfileTable, ...]) -> MeasureTable:
    """A measure with its arguments; the profile may be left out where there is one only.

    Raises
    ------
    SealFileError
        For an unknown type, key or profile.
    """
    kind = given.get("type")
    if not isinstance(kind, str) or kind not in KINDS:
        head = {name: given[name] for name in ("type",) if name in given}
        table(where, head, {"type": Key(one_of(*KINDS))})
    keys = KINDS[kind].keys
    values = table(where, given, {"type": Key(TEXT), "name": Key(NAME, kind), **keys})
    values.pop("type")
    name = values.pop("name")
    if "profile" in keys:
        values["profile"] = _profile(where, values["profile"], profiles)
    if "component" in keys and values["component"] is None:
        values["component"] = _main_axis(next(p for p in profiles if p.name == values["profile"]))
    return MeasureTable(kind, name, values)


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
    if name in KINDS and all(k.default is None for k in KINDS[name].keys.values()):
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
    made = KINDS[entry.type].make(entry.arguments, particles)
    return replace(made, name=entry.name)


def places_of(measure: Measure):
    """What ``places`` of a table says of a measure that has taken its places; None for another one."""
    base = measure.base if isinstance(measure, Derived) else measure
    named = {
        Gap: "points",
        GapSquareIntegral: "stretch",
        ContactPressure: "patches",
        VonMises: "points",
    }
    name = named.get(type(base))
    return None if name is None else getattr(base, name)

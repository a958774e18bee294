"""Types of measures of a seal file: the keys of each, and the ``Measure`` that it becomes."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from seal_mdao.measures.cavity import CavityPressure
from seal_mdao.measures.contact import (
    TRAVEL,
    Gap,
    GapSquareIntegral,
    GapSquareSum,
    LargestGap,
    OpenGapSquareSum,
    Reaction,
)
from seal_mdao.measures.contact_pressure import ContactPressure, ContactWidth, PeakPressure
from seal_mdao.measures.energy import StrainEnergy
from seal_mdao.measures.fluid import BlowOffPressure
from seal_mdao.measures.shape import CavityArea, Displacement, SectionArea
from seal_mdao.measures.stress import LargestVonMises, StressNorm, VonMises
from seal_mdao.measures.work import FrictionWork, ProfileWork
from seal_mdao.seals.file.checks import POINT, TEXT, Check, Key, many, number, one_of, whole

_PROFILE = {"profile": Key(TEXT, None)}
_ORDER = {"order": Key(whole(2, 1000), None)}
_AXES = {"x": 0, "y": 1}
_NUMBERS = many(whole(0, 10**6), "a list of numbers of particles, from 0 on")
_PLACES = {"places": Key(_NUMBERS, None)}
_PATCHES = {"places": Key(many(_NUMBERS, "a list of such lists, one for every patch"), None)}
_OF_DESIGN, _OF_NOMINAL = "design", "nominal"
_POINTS = {"points": Key(one_of(_OF_DESIGN, _OF_NOMINAL), None)}
_TRAVEL = number(least=0.0)
_TRAVELS = Check(
    "a travel along the path, a number of at least 0 in mm, or a list of them",
    lambda value: (
        many(_TRAVEL, "").convert(value) if isinstance(value, list) else _TRAVEL.convert(value)
    ),
)


def _direction(value):
    if value == TRAVEL:
        return value
    found = POINT.convert(value)
    if not any(found):
        raise ValueError
    return found


_DIRECTION = Check(f'a direction [x, y] that is not [0, 0], or "{TRAVEL}"', _direction)


class Kind(NamedTuple):
    """A type of measure.

    Attributes
    ----------
    make : callable
        Gives the measure from its arguments and the particles (n, 2).
    keys : dict of str to Key
        Of its table, beside ``type`` and ``name``.
    one : callable
        Whether it is a single number, from its arguments.
    """

    make: Callable
    keys: dict
    one: Callable = lambda arguments: True


def _given(arguments, *names):
    return {name: arguments[name] for name in names if arguments[name] is not None}


def _several(arguments) -> bool:
    return False


def _of_profile(measure, **more):
    return lambda a, particles: measure(a["profile"], **more)


def _peak_pressure(nominal):
    return Kind(
        lambda a, particles: PeakPressure(a["profile"], nominal=nominal, **_given(a, "order")),
        _PROFILE | _ORDER,
    )


def _contact_pressure(nominal):
    def make(a, particles):
        return ContactPressure(a["profile"], a["places"], nominal=nominal, **_given(a, "order"))

    return Kind(make, _PROFILE | _ORDER | _PATCHES, _several)


def _nearest(point, particles) -> int:
    return int(np.hypot(*(particles - point).T).argmin())


def _gap_square_sum(a, particles):
    """Where the nominal seal stands open as in Eq. (71), or wherever the design does."""
    if a["points"] != _OF_NOMINAL:
        return OpenGapSquareSum(a["profile"], a["places"])
    return GapSquareSum(Gap(a["profile"], a["places"]))


def _reaction(a, particles):
    travel, axis = a["travel"], a["component"]
    return Reaction(
        a["profile"], (travel,) if isinstance(travel, float) else travel,
        (0, 1) if axis is None else (_AXES[axis],), a["direction"], a["length"],
    )  # fmt: skip


def _von_mises(a, particles):
    """Of the complete section, or at chosen particles."""
    if not stress_points(a):
        return LargestVonMises(**_given(a, "excess"))
    places = a["places"]
    if places is None and a["at"] is not None:
        places = tuple(_nearest(point, particles) for point in a["at"])
    return VonMises(places, **_given(a, "count"))


def stress_points(a) -> bool:
    """Whether the arguments of ``von_mises`` choose particles."""
    return any(a[key] is not None for key in ("places", "at", "count"))


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
    "nominal_contact_width": Kind(_of_profile(ContactWidth, nominal=True), _PROFILE),
    "peak_pressure": _peak_pressure(False),
    "nominal_peak_pressure": _peak_pressure(True),
    "contact_pressure": _contact_pressure(False),
    "nominal_contact_pressure": _contact_pressure(True),
    "reaction": Kind(
        _reaction,
        _PROFILE
        | {
            "component": Key(one_of(*_AXES), None),
            "direction": Key(_DIRECTION, None),
            "travel": Key(_TRAVELS, None),
            "length": Key(number(above=0.0), None),
        },
        lambda a: not isinstance(a["travel"], tuple),
    ),
    "gap": Kind(lambda a, particles: Gap(a["profile"], a["places"]), _PROFILE | _PLACES, _several),
    "gap_square_sum": Kind(_gap_square_sum, _PROFILE | _PLACES | _POINTS),
    "gap_square_integral": Kind(
        lambda a, particles: GapSquareIntegral(a["profile"], a["places"]), _PROFILE | _PLACES
    ),
    "largest_gap": Kind(
        lambda a, particles: LargestGap(a["profile"], a["places"], **_given(a, "order")),
        _PROFILE | _ORDER | _PLACES,
    ),
    "profile_work": Kind(_of_profile(ProfileWork), _PROFILE),
    "friction_work": Kind(lambda a, particles: FrictionWork(), {}),
    "strain_energy": Kind(lambda a, particles: StrainEnergy(), {}),
    "stress_norm": Kind(lambda a, particles: StressNorm(**_given(a, "order")), _ORDER),
    "von_mises": Kind(
        _von_mises,
        {
            "excess": Key(number(above=0.0, most=1.0), None),
            "count": Key(whole(1, 1000), None),
            "at": Key(many(POINT, "a list of points [[x, y], ...]"), None),
        }
        | _PLACES,
        lambda a: not stress_points(a),
    ),
    "displacement": Kind(
        lambda a, particles: Displacement(_nearest(a["at"], particles)),
        {"at": Key(POINT)},
        _several,
    ),
}

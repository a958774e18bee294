"""Types of measures of a seal file for the tightness of a contact."""

from seal_mdao.measures.contact_integral import AXES, PressureCentre, PressureIntegral
from seal_mdao.measures.longest_contact import LongestContact
from seal_mdao.seals.file.forms import number, one_of
from seal_mdao.seals.file.leak_rate_table import KINDS
from seal_mdao.seals.file.measure_table import OfProfile, kind
from seal_mdao.seals.file.schema import key

__all__ = ["KINDS", "LongestContactTable", "PressureCentreTable", "PressureIntegralTable"]


@kind("longest_contact", LongestContact)
class LongestContactTable(OfProfile):
    """Deformed length of the longest connected part of a contact with a pressure above a limit."""

    pressure: number("kPa", least=0.0, most=1e9) | None = key(
        "lower limit of the contact pressure; default: 0", None
    )


@kind("pressure_integral", PressureIntegral)
class PressureIntegralTable(OfProfile):
    """Integral of (p / reference_pressure)^exponent along the deformed contact."""

    exponent: number(least=1.0, most=10.0) = key("power of the pressure")
    reference_pressure: number("kPa", above=0.0, most=1e9) = key(
        "pressure by which the contact pressure is divided"
    )


@kind("pressure_centre", PressureCentre)
class PressureCentreTable(OfProfile):
    """Mean coordinate of the deformed contact, weighted by a power of the contact pressure."""

    axis: one_of(*AXES) | None = key(
        "axis of the coordinate; default: x (the radius of a ring)", None
    )
    exponent: number(least=1.0, most=100.0) | None = key(
        "power of the pressure; default: 1, the centre of pressure; about 40 gives the position"
        " of the peak",
        None,
    )

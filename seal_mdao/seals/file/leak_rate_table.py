"""The type ``leak_rate`` of measures of a seal file."""

from pydantic import model_validator

from seal_mdao.measures.leak_rate import LeakRate
from seal_mdao.measures.roughness import Roughness
from seal_mdao.seals.file.forms import number
from seal_mdao.seals.file.measure_table import OfProfile, kind
from seal_mdao.seals.file.schema import key
from seal_mdao.seals.file.time_types import KINDS

__all__ = ["KINDS", "LeakRateTable"]

Wavelength = number("um", above=0.0, most=1e6)


@kind("leak_rate", LeakRate)
class LeakRateTable(OfProfile):
    """Leak rate of a liquid under a profile, by Persson's theory for given roughness."""

    rms_roughness: number("um", above=0.0, most=1e3) = key("root mean square of the roughness")
    roll_off_wavelength: Wavelength = key("wavelength below which the roughness is self-affine")
    shortest_wavelength: Wavelength = key("shortest wavelength of the roughness")
    pressure: number("kPa", above=0.0, most=1e9) = key("pressure difference of the liquid")
    hurst_exponent: number(least=0.01, most=0.99) | None = key(
        "Hurst exponent of the roughness; default: 0.8", None
    )
    viscosity: number("mPa s", above=0.0, most=1e9) | None = key(
        "viscosity of the liquid; default: 1 (water)", None
    )
    modulus: number("kPa", above=0.0, most=1e9) | None = key(
        "E / (1 - nu^2) of the rubber; default: 4 G of the material in contact", None
    )
    longest_wavelength: Wavelength | None = key(
        "longest wavelength of the roughness; default: the roll-off wavelength", None
    )

    @model_validator(mode="after")
    def _ordered(self):
        # shortest < roll-off <= longest wavelength
        Roughness(
            self.rms_roughness, self.roll_off_wavelength, self.shortest_wavelength,
            longest_wavelength=self.longest_wavelength,
        )  # fmt: skip
        return self

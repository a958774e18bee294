"""Leak rate of a liquid under a seal on a rough counterface, by Persson's critical-junction theory.

At a nominal contact pressure p the interface conducts as a slit of the height u_c(p) of its critical
constriction (``seal_mdao.measures.roughness``). Along the contact, whose points are in series,

    Q = dp / int ds / sigma(p(s)),    sigma = u_c(p)^3 / (12 eta),

is the volume per time and length of seal that a pressure difference dp drives through. In a body of
revolution the slit at s is as wide as the deformed circumference there, c = 2 pi r, and

    Q = dp / int ds / (c sigma)

is the volume per time of the complete ring: across a face seal, where r changes along s, as along a
shaft, where it does not.
"""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao import values
from seal_mdao.measures.boundary_line import add_deformed_seeds
from seal_mdao.measures.contact_modulus import ContactModulus
from seal_mdao.measures.contact_pressure import PointPressures
from seal_mdao.measures.measure import Measure
from seal_mdao.measures.roughness import Roughness
from seal_mdao.rkpm.cells import beside
from seal_mdao.terms.term import Scalar

MICRON = 1e-3
"""mm."""
MILLIPASCAL_SECOND = 1e-6
"""kPa s."""
METRE = 1e3
"""mm."""


@dataclass(frozen=True)
class LeakRate(Measure):
    """Volume of liquid that leaks under a profile per time and length of seal, of a ring in total.

    It is zero where the contact pressure somewhere closes all open paths, and infinite without contact.
    Roughness, viscosity, pressure and, if given, the modulus are scalar parameters with the name of the
    measure before theirs: ``leak_rate_rms_roughness``, ...

    Attributes
    ----------
    profile : str
    rms_roughness : float
        Of seal and profile together, um.
    roll_off_wavelength, shortest_wavelength : float
        Between which the roughness is self-affine, um.
    pressure : float
        Pressure difference of the liquid, kPa.
    hurst_exponent : float
    viscosity : float
        mPa s; that of water at 20 degrees Celsius by default.
    modulus : float, optional
        E / (1 - nu^2), kPa; 4 G of the nearly incompressible material in contact unless given.
    longest_wavelength : float, optional
        Of the roughness, um; without any beyond the roll-off unless given.

    Raises
    ------
    ValueError
        For a number outside of its range, or wavelengths in the wrong order.
    """

    profile: str
    rms_roughness: float
    roll_off_wavelength: float
    shortest_wavelength: float
    pressure: float
    hurst_exponent: float = 0.8
    viscosity: float = 1.0
    modulus: float | None = None
    longest_wavelength: float | None = None
    name: str = "leak_rate"
    units = "mm**3/s/m"
    text = "Leak rate of a liquid per length of seal, of a ring in total."

    def __post_init__(self):
        for own in ("viscosity", "pressure"):
            values.real(f"{own} of {self.name!r}", getattr(self, own), above=0.0)
        if self.modulus is not None:
            values.real(f"modulus of {self.name!r}", self.modulus, above=0.0)
        _ = self.roughness

    @property
    def roughness(self) -> Roughness:
        """Roughness of the interface."""
        return Roughness(
            self.rms_roughness, self.roll_off_wavelength, self.shortest_wavelength,
            self.hurst_exponent, self.longest_wavelength,
        )  # fmt: skip

    @property
    def scalars(self):
        units = {"rms_roughness": "um", "viscosity": "mPa*s", "pressure": "kPa", "modulus": "kPa"}
        return {
            f"{self.name}_{own}": Scalar(getattr(self, own), unit, f"{own} of {self.name}.")
            for own, unit in units.items()
            if getattr(self, own) is not None
        }

    def with_parameters(self, changes):
        start = len(self.name) + 1
        return replace(self, **{n[start:]: changes[n] for n in self.scalars if n in changes})

    def check(self, seal):
        if self.modulus is not None:
            return
        elastic = seal.terms()[0]
        where = next(term.where for term in seal.terms() if term.label == self.profile)
        touched = beside(seal.body.cells, where.points.anchors)
        of_cells = elastic.per_cell(range(len(elastic.regions)), len(touched), int)
        for number in np.unique(of_cells[touched]):
            _incompressible(self.name, elastic.regions[number].material)

    def least_scale(self, result):
        # it falls by orders of magnitude along the path: its own size is what counts
        return 0.0

    def evaluate(self, result, partials):
        # numbers that were changed as parameters of the seal
        own = self.with_parameters(result.seal.changed)
        return _Leak(own, result).evaluate(partials)


class _Leak:
    """Leak rate at the end of the path, and its partial derivatives.

    Parameters
    ----------
    measure : LeakRate
    result : SealResult
    """

    def __init__(self, measure: LeakRate, result):
        self.measure, self.modulus = measure, ContactModulus(result, measure.profile)
        self.points = PointPressures(result, measure.profile, nominal=False)
        self.where, self.deformed = result.term(measure.profile).where, result.deformed()
        self.pressed = np.flatnonzero(self.points.value > 0.0)

    def evaluate(self, partials) -> float:
        """Evaluate Q, mm^3/s/m or of a ring mm^3/s, and add its partial derivatives."""
        on, own = self.pressed, self.measure
        if on.size == 0:
            return np.inf
        pressure, length = self.points.value[on], self._slits()[on]
        modulus = self._moduli()[on]
        # u(p / E) and u', um
        height, slope = own.roughness.constriction(pressure / modulus)
        lowest = height.min()
        if lowest == 0.0:
            return 0.0
        # Q = dp / (12 eta) / sum_i s_i / u_i^3, scaled with the lowest u
        resistance = length * (lowest / height) ** 3
        fluidity = METRE * own.pressure / (12.0 * own.viscosity * MILLIPASCAL_SECOND)
        rate = fluidity * (MICRON * lowest) ** 3 / resistance.sum()
        # dQ/ds_i = -Q f_i / s_i, dQ/du_i = 3 Q f_i / u_i with the fractions f_i of the resistance
        fraction = resistance / resistance.sum()
        # u_i = u(p_i / E_i):  p dQ/dp = -E dQ/dE = 3 Q f_i (p / E) u' / u
        by_log = 3.0 * rate * fraction * (pressure / modulus) * slope / height
        self.points.add_partials(partials, 0, self._every(by_log / pressure))
        self._add_slits(partials, -rate * fraction / length)
        self._add_moduli(partials, -by_log / modulus)
        # u = rms f(p / (E rms)):  rms dQ/drms = 3 Q - sum_i p_i dQ/dp_i
        on_scalars = {
            "rms_roughness": (3.0 * rate - by_log.sum()) / own.rms_roughness,
            "viscosity": -rate / own.viscosity, "pressure": rate / own.pressure,
        }  # fmt: skip
        for name, by_scalar in on_scalars.items():
            partials.parameter(f"{own.name}_{name}")[0] += by_scalar
        return rate

    def _every(self, at_pressed: np.ndarray) -> np.ndarray:
        """Return values at the points in contact as values (k,) at all contact points."""
        out = np.zeros(len(self.where))
        out[self.pressed] = at_pressed
        return out

    def _slits(self) -> np.ndarray:
        """Length of the slit at every contact point, mm, of a ring over its width in m, shape (k,).

        With the deformed length l and area a = c l of a point, s = l / c = l^2 / a.
        """
        length = self.where.lengths(self.deformed)
        return (
            length if self.where.radial is None else length**2 / self.where.measures(self.deformed)
        )

    def _add_slits(self, partials, by_slit) -> None:
        where, deformed = self.where, self.deformed
        on_deformed, on_length = np.zeros_like(deformed), self._every(by_slit)
        if where.radial is not None:
            # ds/dl = 2 l / a,  ds/da = -s / a
            length, area = where.lengths(deformed), where.measures(deformed)
            # s/a = l^2/a^2
            on_area = -on_length * (length / area) ** 2
            where.add_measure_seeds(deformed, on_area[:, None], on_deformed[:, :, None])
            on_length = on_length * 2.0 * length / area
        where.add_length_seeds(deformed, on_length[:, None], on_deformed[:, :, None])
        add_deformed_seeds(partials, 0, on_deformed)

    # ---- plane strain modulus of the rubber ----

    def _moduli(self) -> np.ndarray:
        """E / (1 - nu^2) at every contact point, shape (k,)."""
        if self.measure.modulus is not None:
            return np.full(len(self.where), self.measure.modulus)
        for number in np.flatnonzero(self.modulus.shares[self.pressed].any(axis=0)):
            _incompressible(self.measure.name, self.modulus.regions[number].material)
        return self.modulus.values

    def _add_moduli(self, partials, by_modulus) -> None:
        if self.measure.modulus is not None:
            partials.parameter(f"{self.measure.name}_modulus")[0] += by_modulus.sum()
        else:
            self.modulus.add_partials(partials, 0, self._every(by_modulus))


def _incompressible(name: str, material) -> None:
    """Raise ValueError for a material whose modulus in a plane strain contact is not 4 G."""
    if material.bulk_modulus == 0.0:
        raise ValueError(
            f"the measure {name!r} needs the effective modulus of the rubber, which is not known, "
            f"because the material in contact is compressible ({type(material).__name__}); give "
            "the key modulus = E / (1 - nu^2) (kPa) of this measure"
        )

"""Integral of a power of the contact pressure along a contact, and the centre of that power."""

from dataclasses import dataclass

import numpy as np

from seal_mdao import values
from seal_mdao.measures.boundary_line import add_deformed_seeds
from seal_mdao.measures.contact_pressure import PointPressures
from seal_mdao.measures.measure import Measure


@dataclass(frozen=True)
class PressureIntegral(Measure):
    """Integral of (p / p_ref)^n along the deformed contact at the end of the path, mm.

    p is the true contact pressure. The value is the length of a contact under the uniform pressure p_ref
    with the same integral. With n = 1 it is the normal force per length of seal over p_ref.

    Attributes
    ----------
    profile : str
    exponent : float
        n, at least 1.
    reference_pressure : float
        p_ref, kPa.

    Raises
    ------
    ValueError
        For an exponent below 1 or a reference pressure that is not positive.
    """

    profile: str
    exponent: float
    reference_pressure: float
    name: str = "pressure_integral"
    units = "mm"
    text = "Integral of (p / reference_pressure)^exponent along the deformed contact."

    def __post_init__(self):
        values.real(f"exponent of {self.name!r}", self.exponent, 1.0)
        values.real(f"reference_pressure of {self.name!r}", self.reference_pressure, above=0.0)

    def evaluate(self, result, partials):
        points = PointPressures(result, self.profile, nominal=False)
        where, deformed = points.term.where, result.deformed()
        # I = sum_i r_i^n l_i,  r = p / p_ref,  l_i the deformed length of contact point i: with n = 1
        # the sum of the normal forces p_i l_i of the points over p_ref
        n, ratio = self.exponent, points.value / self.reference_pressure
        power, length = ratio**n, where.lengths(deformed)
        # dI/dp_i = n r_i^(n - 1) l_i / p_ref, zero at open points for n = 1, too: p is max(-w_n g, 0)
        on_pressure = n * ratio ** (n - 1.0) * length / self.reference_pressure
        points.add_partials(partials, 0, on_pressure)
        # dI/dl_i = r_i^n at constant pressures
        on_deformed = np.zeros_like(deformed)
        where.add_length_seeds(deformed, power[:, None], on_deformed[:, :, None])
        add_deformed_seeds(partials, 0, on_deformed)
        return length @ power


AXES = ("x", "y")
"""Coordinates of the section; of a body of revolution the radius and the axis."""


@dataclass(frozen=True)
class PressureCentre(Measure):
    """Mean coordinate of the deformed contact, weighted by a power of the contact pressure, mm.

    With n = 1 it is the centre of pressure, where the resultant of the normal forces on a flat profile
    acts; with a large n the position of the peak, as a smooth function of the design. Without contact it
    is not a number.

    Attributes
    ----------
    profile : str
    axis : {"x", "y"}
    exponent : float
        n, at least 1.

    Raises
    ------
    ValueError
        For another axis or an exponent below 1.
    """

    profile: str
    axis: str = "x"
    exponent: float = 1.0
    name: str = "pressure_centre"
    units = "mm"
    text = "Mean coordinate of the deformed contact, weighted by pressure^exponent."

    def __post_init__(self):
        values.one_of(f"axis of {self.name!r}", self.axis, AXES)
        values.real(f"exponent of {self.name!r}", self.exponent, 1.0)

    def least_scale(self, result):
        # positions are known in parts of the width in contact
        points = PointPressures(result, self.profile, nominal=False)
        length = points.term.where.lengths(result.deformed())
        return float(length[points.value > 0.0].sum())

    def missing(self, result):
        if (result.response(self.profile).gap < 0.0).any():
            return ""
        return (
            f"the measure {self.name} has no value, because the profile {self.profile!r} is not in "
            "contact with the seal at the end of the analysis"
        )

    def evaluate(self, result, partials):
        points = PointPressures(result, self.profile, nominal=False)
        where, deformed = points.term.where, result.deformed()
        peak = points.value.max()
        if peak == 0.0:
            return np.nan
        # c = sum_i r_i^n l_i x_i / sum_i r_i^n l_i,  r = p / p_max: a constant factor has no effect
        n, ratio, length = self.exponent, points.value / peak, where.lengths(deformed)
        row = AXES.index(self.axis)
        x, power = where.points.at(deformed)[:, row], ratio**n
        total = power @ length
        centre = (power * length) @ x / total
        # dc/dp_i = n r_i^(n - 1) l_i (x_i - c) / (p_max sum_j r_j^n l_j)
        away = (x - centre) / total
        points.add_partials(partials, 0, n * ratio ** (n - 1.0) * length * away / peak)
        # dc/dl_i = r_i^n (x_i - c) / sum,  dc/dx_i = r_i^n l_i / sum
        on_deformed, on_points = np.zeros_like(deformed), np.zeros((len(x), 2))
        where.add_length_seeds(deformed, (power * away)[:, None], on_deformed[:, :, None])
        on_points[:, row] = power * length / total
        where.points.add_seeds(deformed, on_points[:, :, None], on_deformed[:, :, None])
        add_deformed_seeds(partials, 0, on_deformed)
        return centre

"""Integral of a power of the contact pressure along a contact, an index of its tightness."""

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
        # p is proportional to w_n:  dI/dw_n = sum_i p_i dI/dp_i / w_n
        by_penalty = on_pressure @ points.value / points.penalty
        partials.parameter(points.term.names[0])[0] += by_penalty
        return length @ power

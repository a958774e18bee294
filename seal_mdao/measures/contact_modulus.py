"""Modulus of a half plane of the rubber at contact points, and its derivatives in the parameters."""

from functools import cached_property

import numpy as np

from seal_mdao.materials.hoop_stretch import is_isochoric
from seal_mdao.structure.relaxation import relaxed_modulus


class ContactModulus:
    """Compute the modulus 4 G of the contact points of a profile, kPa.

    It is the plane strain modulus E / (1 - nu^2) of incompressible rubber at small strain, nu = 1/2.
    With the factor m of the moduli and the growth theta after a load step, G is m G_0 / theta^3 of a
    nearly incompressible law, whose constants are per volume before growth, and m G_0 of a foam. Of a
    foam, for which the modulus is 2 G / (1 - nu), it is up to twice too large. Of rubber that relaxes
    it is the modulus of a strain that is kept since the start of the path, G(t): where the contact does
    not move, pressures decrease as G(t) and gaps do not change.

    Parameters
    ----------
    result : SealResult
    profile : str
    """

    def __init__(self, result, profile: str):
        self.where, self.structure = result.term(profile).where, result.term("structure")
        self.regions = self.structure.definition.regions
        # ends of the load steps that converged, of a path that was not completed, too
        self.ends = np.array([0.0, *(s.fraction for s in result.path.steps if s.fraction > 0.0)])
        self.fraction = self.ends[-1]

    @cached_property
    def shares(self) -> np.ndarray:
        """Fraction of every contact point that belongs to each material region, shape (k, r)."""
        anchors, weights = self.where.points.anchors, self.where.points.weights
        numbers = np.arange(len(self.regions))
        belongs = self.structure.particle_regions[anchors][..., None] == numbers
        return np.einsum("ka,kar->kr", weights, belongs)

    @cached_property
    def values(self) -> np.ndarray:
        """4 G at the contact points after the last load step, shape (k,), kPa."""
        return self.after(self.fraction)

    def after(self, fraction: float) -> np.ndarray:
        """Compute 4 G at the contact points after the load step that ends at a path parameter, (k,)."""
        return self.shares @ [
            4.0 * self._factor(region, fraction)[0] * region.material.shear_modulus
            for region in self.regions
        ]

    def _factor(self, region, fraction: float):
        """Ratio of G to that of the law after a load step, and its derivatives by parameter."""
        grown, by_growth = self._grown(region, fraction)
        relaxed, by_time = self._relaxed(region, fraction)
        # r = r_grown R:  dr = R dr_grown + r_grown dR
        rates = {name: relaxed * rate for name, rate in by_growth.items()}
        for name, rate in by_time.items():
            rates[name] = rates.get(name, 0.0) + grown * rate
        return grown * relaxed, rates

    def _relaxed(self, region, fraction: float):
        """Relaxation function R = G(t) / G of the law, and its derivatives by parameter."""
        if region.prony is None:
            return 1.0, {}
        ends = self.ends[self.ends <= fraction]
        return relaxed_modulus(region, self.structure.definition.environment, ends)

    def _grown(self, region, fraction: float):
        """Ratio by temperature, swelling and axial stretch, and its derivatives by parameter."""
        own = self.structure.conditions(region, [fraction])
        if own.conditions is None:
            return 1.0, {}
        factor, growth = own.conditions.factor.item(), own.conditions.growth.item()
        power = 3 if is_isochoric(region.material) else 0
        # r = m / theta^n:  dr = (dm - n m dtheta / theta) / theta^n
        rates = {
            name: float(by_name[2].item() - power * factor / growth * by_name[1].item())
            / growth**power
            for name, by_name in own.rates.items()
        }
        return factor / growth**power, rates

    def add_partials(self, partials, row: int, by_modulus: np.ndarray) -> None:
        """Add derivatives in the parameters of a function with derivatives ``by_modulus`` (k,)."""
        for region, on_region in zip(self.regions, by_modulus @ self.shares, strict=True):
            factor, rates = self._factor(region, self.fraction)
            # G = 2 W_T at T = 2, J = 1
            slopes = region.material.constant_derivatives(np.array(2.0), np.array(1.0))[:, 0]
            for name, slope in zip(region.names, slopes, strict=True):
                partials.parameter(name)[row] += on_region * 8.0 * factor * slope
            # 4 G_0 dr/dp
            for name, rate in rates.items():
                stiffness = 4.0 * region.material.shear_modulus
                partials.parameter(name)[row] += on_region * stiffness * rate

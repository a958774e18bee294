"""Modulus of a half plane of the rubber at contact points, and its derivatives in the parameters."""

from functools import cached_property

import numpy as np


class ContactModulus:
    """Compute the modulus 4 G of the contact points of a profile, kPa.

    It is the plane strain modulus E / (1 - nu^2) of incompressible rubber at small strain, nu = 1/2.
    Of a compressible foam, for which it is 2 G / (1 - nu), it is up to twice too large.

    Parameters
    ----------
    result : SealResult
    profile : str
    """

    def __init__(self, result, profile: str):
        self.where, self.structure = result.term(profile).where, result.term("structure")
        self.regions = self.structure.definition.regions
        # the last step that converged, of a path that was not completed, too
        steps = result.path.steps
        self.fraction = steps[-1].fraction if steps else 0.0

    @cached_property
    def shares(self) -> np.ndarray:
        """Fraction of every contact point that belongs to each material region, shape (k, r)."""
        anchors, weights = self.where.points.anchors, self.where.points.weights
        numbers = np.arange(len(self.regions))
        belongs = self.structure.particle_regions[anchors][..., None] == numbers
        return np.einsum("ka,kar->kr", weights, belongs)

    @cached_property
    def values(self) -> np.ndarray:
        """4 m G at the contact points, shape (k,), kPa."""
        return self.shares @ [
            4.0 * self._factor(region)[0] * region.material.shear_modulus for region in self.regions
        ]

    def _factor(self, region):
        """Factor m of the moduli after the last load step, and its derivatives by parameter."""
        own = self.structure.conditions(region, [self.fraction])
        if own.conditions is None:
            return 1.0, {}
        rates = {name: float(by_name[2].item()) for name, by_name in own.rates.items()}
        return float(own.conditions.factor.item()), rates

    def add_partials(self, partials, row: int, by_modulus: np.ndarray) -> None:
        """Add derivatives in the parameters of a function with derivatives ``by_modulus`` (k,)."""
        for region, on_region in zip(self.regions, by_modulus @ self.shares, strict=True):
            factor, rates = self._factor(region)
            # G = 2 W_T at T = 2, J = 1
            slopes = region.material.constant_derivatives(np.array(2.0), np.array(1.0))[:, 0]
            for name, slope in zip(region.names, slopes, strict=True):
                partials.parameter(name)[row] += on_region * 8.0 * factor * slope
            # 4 G dm/dp
            for name, rate in rates.items():
                stiffness = 4.0 * region.material.shear_modulus
                partials.parameter(name)[row] += on_region * stiffness * rate

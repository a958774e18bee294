"""Pressures of fluids along the load path of a seal."""

import numpy as np

from seal_mdao.loads.fluid_pressure import FluidPressure
from seal_mdao.terms.ramp import at_fraction


def fluid_pressures(seal, fractions) -> dict[str, np.ndarray]:
    """Evaluate the pressure of every fluid of a ``Seal``, shape (k,), kPa, by its label.

    ``fractions`` (k,) are path parameters: numbers of nominal steps completed.
    """
    # p(s) = r(s) p
    return {
        own.label: own.pressure * np.array([at_fraction(own.ramp, s) for s in fractions], float)
        for own in seal.terms()
        if isinstance(own, FluidPressure)
    }

"""A friction law: Coulomb's, with other coefficients for the one direction than for the other, as of a
brushed surface."""

import seal_mdao as sm


@sm.register("friction_laws", "directional")
def directional(pressure, forward, backward):
    """The seal slides towards growing and towards falling natural coordinate of the profile."""
    return forward * pressure, backward * pressure

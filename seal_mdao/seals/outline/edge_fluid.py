"""Fluid pressure that penetrates along edges of a section."""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body
from seal_mdao.geometry.motion import step_shares
from seal_mdao.loads.fluid_pressure import SHARE, FluidPressure


class EdgeFluid(NamedTuple):
    """A fluid at one end of a stretch of edges.

    Attributes
    ----------
    label : str
    edges : tuple of str
        In order along the boundary, the body on the left.
    end : {"start", "end"}
        Of the stretch, from which the fluid comes.
    pressure : float
        kPa.
    steps : int or tuple of float
        The last load steps of the path, over which it grows: a number of equal parts, or the fractions
        of the pressure at their ends.
    share : float
        As of ``FluidPressure``.
    """

    label: str
    edges: tuple
    end: str
    pressure: float
    steps: int | tuple[float, ...]
    share: float = SHARE

    def on(self, body: Body, contacts: tuple[RigidContact, ...], n_steps: int) -> FluidPressure:
        """Build the term; it acts behind the contacts that may touch the edges."""
        parts = [body.edge(name).particles for name in self.edges]
        # edges in succession share their end particles: each once, in order
        particles = np.array(list(dict.fromkeys(np.concatenate(parts).tolist())))
        closing = tuple(c for c in contacts if np.isin(particles, c.where.at_particles).any())
        # zero pressure up to the last steps, over which it grows
        grown = step_shares(self.steps)
        ramp = np.concatenate([np.zeros(n_steps + 1 - len(grown)), grown])
        return FluidPressure(
            self.label, particles, self.end, self.pressure, ramp, closing, self.share
        )

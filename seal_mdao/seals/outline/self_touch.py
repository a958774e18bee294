"""Edges of a section that may touch each other or themselves."""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.self_contact import SelfContact
from seal_mdao.equilibrium.discretization import Body

NEIGHBOURS = 3.0
"""Sides of the boundary along which two of its points are neighbours, which do not touch each other."""


class SelfTouch(NamedTuple):
    """Edges that may touch each other or themselves.

    Attributes
    ----------
    label : str
    edges : tuple of str
    law : ContactLaw
    """

    label: str
    edges: tuple
    law: ContactLaw

    def on(self, body: Body, loops) -> SelfContact:
        """The term, with the loops that the edges are parts of."""
        particles = np.unique(np.concatenate([body.edge(name).particles for name in self.edges]))
        own = tuple(loop for loop in loops if np.isin(loop, particles).any())
        sides = np.concatenate([body.edge(name).sides for name in self.edges])
        longest = np.hypot(*(body.drawn[sides[:, 1]] - body.drawn[sides[:, 0]]).T).max()
        touching = np.isin(np.concatenate(own), particles)
        return SelfContact(self.label, own, touching, body.drawn, self.law, NEIGHBOURS * longest)

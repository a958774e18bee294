"""Self-contact of edges of a section."""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.self_contact import SelfContact
from seal_mdao.equilibrium.discretization import Body

NEIGHBOURS = 3.0
"""Distance along the boundary, over its longest side, within which points are excluded from contact."""


class SelfTouch(NamedTuple):
    """Edges with self-contact, or contact with each other.

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
        """Build the term, with the loops that contain the edges."""
        particles = np.unique(np.concatenate([body.edge(name).particles for name in self.edges]))
        own = tuple(loop for loop in loops if np.isin(loop, particles).any())
        sides = np.concatenate([body.edge(name).sides for name in self.edges])
        # neighbours along the boundary are always close: exclude them by their distance along it
        longest = np.hypot(*(body.drawn[sides[:, 1]] - body.drawn[sides[:, 0]]).T).max()
        touching = np.isin(np.concatenate(own), particles)
        return SelfContact(self.label, own, touching, body.drawn, self.law, NEIGHBOURS * longest)

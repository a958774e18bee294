"""Edges on which a term of an extension acts."""

from typing import NamedTuple

import numpy as np

from seal_mdao.equilibrium.discretization import Body
from seal_mdao.terms.points import edge_points
from seal_mdao.terms.term import TermDefinition


class EdgeTerm(NamedTuple):
    """A term along edges.

    Attributes
    ----------
    label : str
    edges : tuple of str
    definition : type
        A dataclass with the fields ``label`` and ``where``, the Gauss points of the sides of the edges.
    arguments : dict
        Its other fields.
    """

    label: str
    edges: tuple
    definition: type
    arguments: dict

    def on(self, body: Body) -> TermDefinition:
        """The term."""
        sides = np.concatenate([body.edge(name).sides for name in self.edges])
        return self.definition(label=self.label, where=edge_points(sides), **self.arguments)

"""The discretised section, to which contributions are bound by the names of edges."""

from typing import NamedTuple

import numpy as np

from seal_mdao.equilibrium.discretization import Body
from seal_mdao.terms.averaged_points import averaged_points
from seal_mdao.terms.points import MaterialPoints, boundary_particles, edge_points


class SectionBody(NamedTuple):
    """Body with named edges, to which terms of the equilibrium equations are bound.

    A contribution is a function of it that returns the definition of a term:

        lambda section: RigidContact("door", section.contact_points(("seal",)), shape, motion, law)

    Attributes
    ----------
    body : Body
    loops : tuple of ndarray of int
        Boundary particles of every loop: outer contour, holes, outer contours of further bodies.
    n_steps : int
        Nominal load steps.
    contacts : tuple of RigidContact
        Those that have been bound already.
    """

    body: Body
    loops: tuple
    n_steps: int
    contacts: tuple = ()

    def in_order(self, edges) -> list[str]:
        """Sort neighbouring edges as they follow one another along the boundary."""
        own = [name for name in self.body.edges if name in edges]
        # edges of a body are in the order of its loops, which may begin amid the stretch
        ends = {int(self.body.edge(name).particles[-1]) for name in own}
        starts = (int(self.body.edge(name).particles[0]) not in ends for name in own)
        first = next((i for i, is_start in enumerate(starts) if is_start), 0)
        return own[first:] + own[:first]

    def sides(self, edges) -> np.ndarray:
        """Collect the straight sides of edges by the particles at their ends, shape (m, 2)."""
        return np.concatenate([self.body.edge(name).sides for name in edges])

    def particles(self, edges) -> np.ndarray:
        """Collect the particles of edges in order, each once, shape (k,)."""
        every = np.concatenate([self.body.edge(name).particles for name in edges])
        return np.array(list(dict.fromkeys(every.tolist())), int)

    def edge_numbers(self, edges, where: MaterialPoints) -> np.ndarray:
        """Find the edge at which every point lies, as its place in ``edges``, shape (k,).

        The one that has all sides of the point, such as those of one of two points at a sharp corner;
        else the first one that has all particles of the point, since a corner belongs to two.
        """
        found = np.full(len(where), -1)
        particles = [self.body.edge(name).particles for name in edges]
        for of_point in (where.points.anchors, where.edges.reshape(len(where), -1)):
            for number, own in reversed(list(enumerate(particles))):
                found[np.isin(of_point, own).all(axis=1)] = number
        return found

    def contact_points(self, edges, at: str = "particles") -> MaterialPoints:
        """Return contact points of neighbouring edges.

        Parameters
        ----------
        edges : sequence of str
        at : {"particles", "edges", "averages"}
            The free particles with their tributary lengths, the midpoints of the straight sides, or the
            free particles that move as the mean of the sides beside them, two at a sharp corner.

        Raises
        ------
        ValueError
            For a name that no edge has.
        """
        for name in edges:
            self.body.edge(name)
        sides, axisymmetric = self.sides(self.in_order(edges)), self.body.axisymmetric
        if at == "edges":
            points = edge_points(sides, 1)
            return points.around_axis() if axisymmetric else points
        which = np.array(list(dict.fromkeys(sides.ravel().tolist())), int)
        # particles before and after; a particle itself where it has no side
        neighbours = np.column_stack([np.arange(self.body.n_particles)] * 2)
        neighbours[sides[:, 1], 0] = sides[:, 0]
        neighbours[sides[:, 0], 1] = sides[:, 1]
        movable = which[~self.body.fixed[which].all(axis=1)]
        if at == "averages":
            return averaged_points(movable, neighbours[movable], self.body.nominal, axisymmetric)
        points = boundary_particles(movable, neighbours[movable])
        return points.around_axis() if axisymmetric else points

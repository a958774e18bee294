"""Self-contact in one linear step: the exact contact law with gaps and slips linear in the
displacements.

With the kinematics of the last linearisation

    g = g' + dg/du (u - u'),    xi = xi' + dxi/du (u - u'),

a point has the forces N = length w_n g along dg/du while it is closed, and T = length tau |t0| along
dxi/du, with the stick or slip of these g and xi. A linearised tangent has those of one state instead.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.boundary_curve import NODES
from seal_mdao.contact.self_friction import Before, resultants, touch
from seal_mdao.contact.self_mixed import Linearization


class LinearContact(NamedTuple):
    """The m points of a linearisation that have a segment opposite, in a linear step.

    Attributes
    ----------
    term : SelfContactTerm
    linearization : Linearization
    before : Before
        State of the points at the previous step.
    """

    term: object
    linearization: Linearization
    before: Before

    def __len__(self):
        return len(self.linearization.points)

    def motion(self, d) -> np.ndarray:
        """Compute (dg/du, dxi/du) (u - u') at displacements ``d`` (n, 2), shape (m, 2)."""
        term, last = self.term, self.linearization
        raw = term.discretization.transformation.coefficients(d)
        # u - u' of the seven positions of every point
        moved = (term.deformed(raw) - last.x)[last.nodes].reshape(len(self), -1)
        return np.einsum("mka,ma->mk", self._directions(), moved)

    def deviation(self, motion) -> tuple[np.ndarray, np.ndarray]:
        """Compute the forces (N, T) beyond the linearised ones after ``motion`` (m, 2).

        Returns
        -------
        deviation : ndarray, shape (m, 2)
        slopes : ndarray, shape (m, 2, 2)
            Their derivatives by the motion.
        """
        term, last = self.term, self.linearization
        gap = last.kinematics.gap + motion[:, 0]
        # g = g' + dg,  xi - xi0 = (xi - xi0)' + dxi
        before = self.before._replace(change=self.before.change + motion[:, 1])
        law, length = term.law_at(gap, last.points, last.nodes), term.length[last.points]
        found = touch(law, last.kinematics._replace(gap=gap), before)
        forces, slopes = resultants(law, gap, before, found, length)
        # q(g, xi) - q' - dq'/d(g, xi) (g - g', xi - xi')
        linear = last.forces + np.einsum("mij,mj->mi", last.slopes, motion)
        return forces - linear, slopes - last.slopes

    def loads(self, point: int) -> list:
        """Assemble the force buffers of N = 1 and of T = 1 at one of the points."""
        nodes, found = self.linearization.nodes[point], []
        for direction in self._directions()[point]:
            force, loaded = np.zeros((len(self.term.where), 2)), np.zeros(len(self.term.where), int)
            # dg/du of N = 1, dxi/du of T = 1, at the seven positions
            np.add.at(force, nodes, direction.reshape(NODES, 2))
            loaded[nodes] = 1
            found.append(self.term.point_loads(force, loaded))
        return found

    def _directions(self) -> np.ndarray:
        """dg/du and dxi/du, shape (m, 2, 14)."""
        now = self.linearization.kinematics
        return np.stack([now.gap_1, now.xi_1], axis=1)

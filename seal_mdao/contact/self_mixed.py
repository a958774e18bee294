"""Self-contact in mixed iterations (``analysis.mixed_newton``): gaps predicted by linearisation.

With g', u' of the last iterate the state of a point (open, stick, slip) is that at the gap

    g^ = g' + dg'/du (u - u'),

and w_n g^ is the pressure in its geometric stiffness. The gap g differs from g^ by terms quadratic in
the increment, which the penalty turns into forces many times those in equilibrium.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.boundary_curve import NODES, Kinematics, Rings
from seal_mdao.contact.kinematics import FARTHEST_MISS


class Linearization(NamedTuple):
    """The last linearised state of the k points of a boundary, m of which have a segment opposite.

    Attributes
    ----------
    x : ndarray, shape (k, 2)
        Deformed positions.
    points : ndarray of int, shape (m,)
    nodes : ndarray of int, shape (m, 7)
    kinematics : Kinematics
    direction : ndarray of int, shape (k,)
        Direction of slip of every point; 0 before the first iteration.
    forces : ndarray, shape (m, 2)
        Forces N, T of ``self_friction.resultants`` at the gaps g, as linearised at g^.
    slopes : ndarray, shape (m, 2, 2)
        Their derivatives by gap and natural coordinate.
    """

    x: np.ndarray
    points: np.ndarray
    nodes: np.ndarray
    kinematics: Kinematics
    direction: np.ndarray
    forces: np.ndarray
    slopes: np.ndarray

    def missed(self, x, points, now: Kinematics, ring: Rings) -> np.ndarray:
        """Compute g - g^ of points (n,) with the kinematics ``now`` at positions ``x``, shape (n,).

        0 for points without a segment opposite before, and where it exceeds ``FARTHEST_MISS`` times the
        distance that the point moved relative to the other wall: there g^ is not valid.
        """
        then = self.kinematics
        gap, xi, expected = np.full((3, len(x)), np.nan)
        moved = (x - self.x)[self.nodes]
        gap[self.points], xi[self.points] = then.gap, then.xi
        # g^ = g' + dg'/du (u - u')
        rate = then.gap_1.reshape(-1, NODES, 2)
        expected[self.points] = then.gap + np.einsum("mai,mai->m", rate, moved)
        known = np.isfinite(xi[points])
        # relative motion: |t| (xi - xi') along the wall, g - g' normal to it
        change = np.where(
            known, ring.coordinate_change(now.xi, np.where(known, xi[points], now.xi)), np.nan
        )
        far = np.hypot(now.size * change, now.gap - gap[points])
        # g - g^
        missed = now.gap - expected[points]
        return np.where(np.abs(missed) <= FARTHEST_MISS * far, missed, 0.0)

"""Self-contact in mixed iterations (``analysis.mixed_newton``): gaps that a linearisation expects.

With g', u' of the last iterate a point is taken to be open, to stick and to slip as it does at

    g^ = g' + dg'/du (u - u'),

and w_n g^ is the pressure in its geometric stiffness. Its gap g misses that by what is quadratic in the
increment, of which the penalty makes forces many times those of equilibrium.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.boundary_curve import NODES, Kinematics, Rings
from seal_mdao.contact.kinematics import FARTHEST_MISS


class Linearization(NamedTuple):
    """The last linearised state of the k points of a boundary, m of which face another stretch.

    Attributes
    ----------
    x : ndarray, shape (k, 2)
        Deformed places.
    points : ndarray of int, shape (m,)
    nodes : ndarray of int, shape (m, 7)
    kinematics : Kinematics
    direction : ndarray of int, shape (k,), or None
        Which way every point slipped; None before the first iteration.
    """

    x: np.ndarray
    points: np.ndarray
    nodes: np.ndarray
    kinematics: Kinematics
    direction: np.ndarray | None

    def missed(self, x, points, now: Kinematics, ring: Rings) -> np.ndarray:
        """g - g^ of points (n,) with the kinematics ``now`` at places ``x``, shape (n,).

        0 for points that faced no other stretch before, and where it is more than ``FARTHEST_MISS`` of
        how far the point went on along and off the other wall: there g^ means nothing.
        """
        then = self.kinematics
        gap, xi, expected = np.full((3, len(x)), np.nan)
        moved = (x - self.x)[self.nodes]
        gap[self.points], xi[self.points] = then.gap, then.xi
        rate = then.gap_1.reshape(-1, NODES, 2)
        expected[self.points] = then.gap + np.einsum("mai,mai->m", rate, moved)
        known = np.isfinite(xi[points])
        way = np.where(known, ring.way(now.xi, np.where(known, xi[points], now.xi)), np.nan)
        far = np.hypot(now.size * way, now.gap - gap[points])
        missed = now.gap - expected[points]
        return np.where(np.abs(missed) <= FARTHEST_MISS * far, missed, 0.0)

"""Contact states at which contact forces are not differentiable.

The force of a point has a kink where it begins to touch, g_n = 0, and where it begins to slip,
w_t |g_t| = mu w_n |g_n|. The derivatives of one side and of the other differ there.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled
from seal_mdao.contact.friction import elastic_slip

OPERATIONS = 40
"""Roundings between displacements and a gap: a sum over some 25 neighbours, the pose of the profile, the
projection. Each is at most half a unit in the last place of the largest coordinate."""

SMOOTH, TOUCHING, LIMIT = range(3)

SLIGHT = 1e-6
"""Of slip over the gap that closes or opens meanwhile, and of displacements over the gap whose kink
causes them: less is rounding, as of a symmetric section under a symmetric profile."""


class Kinks(NamedTuple):
    """Points of a contact that are at a kink.

    Attributes
    ----------
    touching : ndarray of int, shape (t,)
        Points with zero gap.
    forces : ndarray, shape (t, k, 2)
        Derivatives of the forces at all points with the gap of a touching one, on its closed side: on
        the other side they are zero.
    slips : ndarray of bool, shape (t,)
        Whether the touching points slide here or in the next step, so that the slip which they carry
        has a kink as well.
    slipping : ndarray of int
        Closed points whose tangential traction is at the friction limit.
    """

    touching: np.ndarray
    forces: np.ndarray
    slips: np.ndarray
    slipping: np.ndarray


def rounding_of(size: float) -> float:
    """Rounding of a gap between coordinates of ``size``, mm."""
    return 0.5 * OPERATIONS * np.finfo(float).eps * size


@compiled
def find_kinks(period, law, gap, xi, state_0, variables_0, rounding, found):
    """Find the points whose gap or slip margin is zero within rounding; returns how many there are.

    Parameters
    ----------
    period : float
        Of the natural coordinate, 0 for an open profile.
    gap, xi : ndarray, shape (k,)
        Of the step.
    state_0, variables_0 : ndarray, shapes (k,), (k, 3)
        Of the ``ContactHistory`` with which it began.
    rounding : float
        Of a gap; a slip is a difference of two coordinates.
    found : ndarray of int, shape (k,)
        Written: SMOOTH, TOUCHING or LIMIT.
    """
    by_gap, count = law.friction * law.normal_penalty, 0
    for i in range(gap.size):
        found[i] = SMOOTH
        if abs(gap[i]) <= rounding:
            found[i] = TOUCHING
        elif gap[i] < 0.0 and by_gap > 0.0:
            way = xi[i] - variables_0[i, 0]
            if period > 0.0:
                way -= period * np.floor(way / period + 0.5)
            slip = elastic_slip(gap[i], way, state_0[i], variables_0[i, 1], variables_0[i, 2])
            # mu w_n |g_n| - w_t |g_t|
            margin = -by_gap * gap[i] - law.tangent_penalty * abs(slip)
            if abs(margin) <= (by_gap + 2.0 * law.tangent_penalty) * rounding:
                found[i] = LIMIT
        count += found[i] != SMOOTH
    return count


def no_kinks(n_points: int) -> Kinks:
    """Nothing of ``n_points`` points."""
    none = np.empty(0, int)
    return Kinks(none, np.empty((0, n_points, 2)), np.empty(0, bool), none)

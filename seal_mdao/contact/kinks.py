"""Contact states at which contact forces are not differentiable.

The force of a point has a kink where it begins to touch, g_n = 0, and where it begins to slip,
w_t |g_t| = mu w_n |g_n|. The derivatives of one side and of the other differ there.
"""

import math
from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, internal
from seal_mdao.contact.friction import elastic_slip, friction_limit

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
    """Compute the rounding error of a gap between coordinates of ``size``, mm."""
    return 0.5 * OPERATIONS * np.finfo(float).eps * size


@internal
def _limit_by_gap(limits, law, i, slip):
    """|d limit / d g_n|: mu w_n, or w_n |d limit / dp| of another law."""
    if limits is None:
        # d(mu w_n |g_n|)/d|g_n|
        return law.friction * law.normal_penalty
    return abs(limits[i, 1 if math.copysign(1.0, slip) > 0.0 else 0, 1]) * law.normal_penalty


@compiled
def find_kinks(period, law, gap, xi, state_0, variables_0, rounding, found):
    """Find the points whose gap or slip margin is zero within rounding, and count them.

    Parameters
    ----------
    period : float
        Of the natural coordinate, 0 for an open profile.
    gap, xi : ndarray, shape (k,)
        Of the step.
    state_0, variables_0 : ndarray, shapes (k,), (k, 3)
        Of the ``ContactHistory`` with which it began.
    law : ContactLaw
        ``at`` the gaps.
    rounding : float
        Of a gap; a slip is a difference of two coordinates.
    found : ndarray of int, shape (k,)
        Written: SMOOTH, TOUCHING or LIMIT.
    """
    count = 0
    for i in range(gap.size):
        found[i] = SMOOTH
        # g_n = 0
        if abs(gap[i]) <= rounding:
            found[i] = TOUCHING
        elif gap[i] < 0.0:
            # xi - xi0, the shorter way round
            change = xi[i] - variables_0[i, 0]
            if period > 0.0:
                change -= period * np.floor(change / period + 0.5)
            slip = elastic_slip(gap[i], change, state_0[i], variables_0[i, 1], variables_0[i, 2])
            # limit - w_t |g_t|, with Coulomb's law mu w_n |g_n| - w_t |g_t|
            limit = friction_limit(law.limits, law, i, gap[i], slip)
            margin = limit - law.tangent_penalty * abs(slip)
            by_gap = _limit_by_gap(law.limits, law, i, slip)
            if limit > 0.0 and abs(margin) <= (by_gap + 2.0 * law.tangent_penalty) * rounding:
                found[i] = LIMIT
        count += found[i] != SMOOTH
    return count


def no_kinks(n_points: int) -> Kinks:
    """Return the empty ``Kinks`` of ``n_points`` points."""
    none = np.empty(0, int)
    return Kinks(none, np.empty((0, n_points, 2)), np.empty(0, bool), none)

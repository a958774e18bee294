"""Forces of self-contact with friction and their derivatives (of rigid profiles: ``rigid_forces``).

    q = length (w_n g dg/du + tau |t0| dxi/du)

for the positions u of a point and of the six particles of its segment of the deformed boundary.
Forces and moments balance, since gap and slip are invariant under rigid motions. Traction and slip are
those of ``contact.friction`` (accumulated history).
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled
from seal_mdao.contact import friction
from seal_mdao.contact.boundary_curve import N_PLACES, Kinematics
from seal_mdao.contact.friction import (
    OPEN,
    ContactLaw,
    elastic_slip,
    elastic_slip_rate,
    traction,
    traction_rate,
)

FIRST = N_PLACES - friction.XI_0
"""Offset of the columns of the inputs after the positions, in the order of ``contact.friction``."""

SIZE_0, LENGTH, NORMAL_PENALTY, CONSTANTS = (
    FIRST + column
    for column in (friction.SIZE_0, friction.LENGTH, friction.NORMAL_PENALTY, friction.FRICTION)
)
XI, SIZE, CARRIED = range(N_PLACES, N_PLACES + 3)
N_OUTPUTS = N_PLACES + 3


class Before(NamedTuple):
    """State of m points at the previous step.

    Attributes
    ----------
    state : ndarray of int, shape (m,)
    change : ndarray, shape (m,)
        xi - xi0, 0 where unknown.
    size, carried : ndarray, shape (m,)
        |t0|, and the elastic slip of a point in contact or the gap of an open one.
    """

    state: np.ndarray
    change: np.ndarray
    size: np.ndarray
    carried: np.ndarray


class Touch(NamedTuple):
    """State and traction of m points.

    Attributes
    ----------
    state : ndarray of int, shape (m,)
    tau : ndarray, shape (m,)
        Tangential traction.
    slip : ndarray, shape (m,)
        Elastic slip as if the points stuck; 0 where they are open.
    """

    state: np.ndarray
    tau: np.ndarray
    slip: np.ndarray


def touch(law: ContactLaw, now: Kinematics, before: Before) -> Touch:
    """Compute contact state (open, stick, slip) and tangential traction, Eqs. (28), (29), with the
    ``law`` at the gaps."""
    m = len(now.gap)
    found = Touch(np.full(m, OPEN), np.zeros(m), np.zeros(m))
    _touch_points(law, now.gap, before, found)
    return found


@compiled
def _touch_points(law, gap, before, found):
    """Write the states and tractions of all points."""
    for i in range(gap.size):
        if gap[i] < 0.0:
            # g_t of Eq. (19), then trial traction and return mapping, Eqs. (28), (29)
            found.slip[i] = elastic_slip(
                gap[i], before.change[i], before.state[i], before.size[i], before.carried[i]
            )
            found.state[i], found.tau[i] = traction(law, i, gap[i], found.slip[i])


def forces(law: ContactLaw, now: Kinematics, size_0, tau, length) -> np.ndarray:
    """Compute the forces q of points in contact, shape (m, 14)."""
    # w_n g dg/du + tau |t0| dxi/du
    normal = (law.normal_penalty * now.gap)[:, None] * now.gap_1
    return length[:, None] * (normal + (tau * size_0)[:, None] * now.xi_1)


def resultants(law: ContactLaw, gap, before: Before, found: Touch, length) -> tuple:
    """Compute the forces N along dg/du and T along dxi/du of m points, with their derivatives.

    Returns
    -------
    forces : ndarray, shape (m, 2)
    slopes : ndarray, shape (m, 2, 2)
        d(N, T) / d(g, xi).
    """
    m = len(gap)
    tau_rate, carried_rate = np.zeros((2, m, 2))
    # dtau/dg and dtau/dxi
    gap_rate, xi_rate = np.tile([1.0, 0.0], (m, 1)), np.tile([0.0, 1.0], (m, 1))
    _traction_rates(law, gap, gap_rate, xi_rate, before, found, tau_rate, carried_rate)
    # N = length w_n g,  T = length |t0| tau of closed points
    closed, slopes = np.where(found.state != OPEN, length, 0.0), np.zeros((m, 2, 2))
    forces = np.column_stack([closed * law.normal_penalty * gap, closed * before.size * found.tau])
    slopes[:, 0, 0] = closed * law.normal_penalty
    slopes[:, 1] = (closed * before.size)[:, None] * tau_rate
    return forces, slopes


def linearized(
    law: ContactLaw, now: Kinematics, before: Before, found: Touch, length
) -> np.ndarray:
    """Compute the derivatives of q, xi, |t| and the carried variable, shape
    (m, 17, 20 + constants of the law); the inputs XI_0 ... follow u."""
    m, n_inputs = len(now.gap), CONSTANTS + friction.law_constants(law.limits)
    out = np.zeros((m, N_OUTPUTS, n_inputs))
    # dxi/du and d|t|/du for all points
    out[:, XI, :N_PLACES], out[:, SIZE, :N_PLACES] = now.xi_1, now.size_1
    closed = found.state != OPEN
    # an open point carries its gap
    out[~closed, CARRIED, :N_PLACES] = now.gap_1[~closed]
    gap_rate, tau_rate, carried_rate = np.zeros((3, m, n_inputs))
    gap_rate[:, :N_PLACES] = now.gap_1
    # dtau and d(tau / w_t)
    _traction_rates(law, now.gap, gap_rate, now.xi_1, before, found, tau_rate, carried_rate)
    w_n, size_0 = law.normal_penalty, before.size
    # dq = length (w_n (dg/du dg + g d2g/du2 du) + |t0| (dxi/du dtau + tau d2xi/du2 du) + ...)
    force = w_n * (now.gap_1[:, :, None] * gap_rate[:, None, :])
    force += size_0[:, None, None] * now.xi_1[:, :, None] * tau_rate[:, None, :]
    force[:, :, :N_PLACES] += (
        w_n * now.gap[:, None, None] * now.gap_2 + (found.tau * size_0)[:, None, None] * now.xi_2
    )
    # dq/d|t0| = tau dxi/du,  dq/dw_n = g dg/du
    force[:, :, SIZE_0] += found.tau[:, None] * now.xi_1
    force[:, :, NORMAL_PENALTY] += now.gap[:, None] * now.gap_1
    force *= length[:, None, None]
    # dq/dlength = q / length
    force[:, :, LENGTH] = forces(law, now, size_0, found.tau, np.ones(m))
    out[closed, :N_PLACES] = force[closed]
    out[closed, CARRIED] = carried_rate[closed]
    return out


@compiled
def _traction_rates(law, gap, gap_rate, xi_1, before, found, tau_rate, carried_rate):
    """Write the derivatives (m, n) of tau and of the elastic slip that closed points carry on."""
    for i in range(gap.size):
        if found.state[i] == OPEN:
            continue
        state_0, change, size_0 = before.state[i], before.change[i], before.size[i]
        for k in range(gap_rate.shape[1]):
            column, change_r = k - FIRST, 0.0
            if k < N_PLACES:
                # d(xi - xi0)/du = dxi/du
                column, change_r = friction.X, xi_1[i, k]
            elif column == friction.XI_0:
                # d(xi - xi0)/dxi0 = -1
                change_r = -1.0
            slip_r = elastic_slip_rate(
                column, gap[i], gap_rate[i, k], change, change_r, state_0, size_0, before.carried[i]
            )
            tau_rate[i, k], carried_rate[i, k] = traction_rate(
                law, i, column, found.state[i], found.tau[i], gap[i], gap_rate[i, k], slip_r
            )

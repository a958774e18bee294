"""Penalty and friction between two stretches of the deformed boundary, with all derivatives.

    q = length (w_n g dg/du + tau |t0| dxi/du)

for the places u of a point and of the six particles of its segment: forces and moments balance, for gap
and slip do not know of rigid motions. The rules are those of ``contact.friction`` (accumulated history).
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.boundary_curve import N_PLACES, Kinematics
from seal_mdao.contact.friction import OPEN, SLIP, STICK, ContactLaw

UNKNOWN = -1
"""State of a point that was near no other boundary: it touches without slip."""

XI_0, SIZE_0, CARRIED_0, LENGTH, NORMAL_PENALTY, TANGENT_PENALTY, FRICTION = range(
    N_PLACES, N_PLACES + 7
)
N_INPUTS = N_PLACES + 7
XI, SIZE, CARRIED = range(N_PLACES, N_PLACES + 3)
N_OUTPUTS = N_PLACES + 3


class Before(NamedTuple):
    """What m points were at the previous step.

    Attributes
    ----------
    state : ndarray of int, shape (m,)
    way : ndarray, shape (m,)
        xi - xi0, 0 where unknown.
    size, carried : ndarray, shape (m,)
        |t0|, and the elastic slip of a point in contact or the gap of an open one.
    """

    state: np.ndarray
    way: np.ndarray
    size: np.ndarray
    carried: np.ndarray


class Touch(NamedTuple):
    """State and traction of m points.

    Attributes
    ----------
    state : ndarray of int, shape (m,)
    tau : ndarray, shape (m,)
        Tangential traction.
    share : ndarray, shape (m,)
        Share of the step after the point touched.
    """

    state: np.ndarray
    tau: np.ndarray
    share: np.ndarray


def slip_of(now: Kinematics, before: Before):
    """Elastic slip as if the points stuck, and the share of the step that they slid."""
    opened, unknown = before.state == OPEN, before.state == UNKNOWN
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(opened, now.gap / (now.gap - before.carried), 1.0)
    share = np.where(unknown | ~np.isfinite(share), 0.0, share)
    carried = np.where(opened | unknown, 0.0, before.carried)
    return before.size * before.way * share + carried, share


def touch(law: ContactLaw, now: Kinematics, before: Before) -> Touch:
    """Open, stick or slip, and the tangential traction, Eqs. (28), (29)."""
    slip, share = slip_of(now, before)
    limit, tau = -law.friction * law.normal_penalty * now.gap, law.tangent_penalty * slip
    closed, sticks = now.gap < 0.0, np.abs(tau) < limit
    tau = np.where(sticks, tau, np.copysign(limit, slip))
    state = np.where(closed, np.where(sticks, STICK, SLIP), OPEN)
    return Touch(state, np.where(closed, tau, 0.0), share)


def forces(law: ContactLaw, now: Kinematics, size_0, tau, length) -> np.ndarray:
    """q of points in contact, shape (m, 14)."""
    normal = (law.normal_penalty * now.gap)[:, None] * now.gap_1
    return length[:, None] * (normal + (tau * size_0)[:, None] * now.xi_1)


def linearized(
    law: ContactLaw, now: Kinematics, before: Before, found: Touch, length
) -> np.ndarray:
    """Derivatives of q, xi, |t| and what is carried, shape (m, 17, 21); inputs XI_0 ... behind u."""
    m, out = len(now.gap), np.zeros((len(now.gap), N_OUTPUTS, N_INPUTS))
    out[:, XI, :N_PLACES], out[:, SIZE, :N_PLACES] = now.xi_1, now.size_1
    closed = found.state != OPEN
    out[~closed, CARRIED, :N_PLACES] = now.gap_1[~closed]
    gap_rate = np.zeros((m, N_INPUTS))
    gap_rate[:, :N_PLACES] = now.gap_1
    tau_rate, carried_rate = _traction_rates(law, now, before, found, gap_rate)
    w_n, size_0 = law.normal_penalty, before.size
    force = w_n * (now.gap_1[:, :, None] * gap_rate[:, None, :])
    force += size_0[:, None, None] * now.xi_1[:, :, None] * tau_rate[:, None, :]
    force[:, :, :N_PLACES] += (
        w_n * now.gap[:, None, None] * now.gap_2 + (found.tau * size_0)[:, None, None] * now.xi_2
    )
    force[:, :, SIZE_0] += found.tau[:, None] * now.xi_1
    force[:, :, NORMAL_PENALTY] += now.gap[:, None] * now.gap_1
    force *= length[:, None, None]
    force[:, :, LENGTH] = forces(law, now, size_0, found.tau, np.ones(m))
    out[closed, :N_PLACES] = force[closed]
    out[closed, CARRIED] = carried_rate[closed]
    return out


def _traction_rates(law, now, before, found, gap_rate):
    """Derivatives (m, 21) of tau and of the elastic slip that is carried on."""
    m, sticks, way = len(now.gap), found.state == STICK, before.way
    opened, share = before.state == OPEN, found.share
    slip_rate = np.zeros((m, N_INPUTS))
    slip_rate[:, :N_PLACES] = (before.size * share)[:, None] * now.xi_1
    slip_rate[:, XI_0], slip_rate[:, SIZE_0] = -before.size * share, way * share
    slip_rate[:, CARRIED_0] = before.state > OPEN
    whole = np.where(opened & (share > 0.0), (now.gap - before.carried) ** 2, np.inf)
    slid = before.size * way / whole
    slip_rate -= (slid * before.carried * opened)[:, None] * gap_rate
    slip_rate[:, CARRIED_0] += slid * now.gap * opened
    slip_rate[before.state == UNKNOWN] = 0.0
    stuck_rate = law.tangent_penalty * slip_rate
    stuck_rate[:, TANGENT_PENALTY] += found.tau / law.tangent_penalty
    sign = np.sign(found.tau)
    slid_rate = -(sign * law.friction * law.normal_penalty)[:, None] * gap_rate
    slid_rate[:, NORMAL_PENALTY] -= sign * law.friction * now.gap
    slid_rate[:, FRICTION] -= sign * law.normal_penalty * now.gap
    tau_rate = np.where(sticks[:, None], stuck_rate, slid_rate)
    carried_rate = slid_rate / law.tangent_penalty
    carried_rate[:, TANGENT_PENALTY] -= found.tau / law.tangent_penalty**2
    return tau_rate, np.where(sticks[:, None], slip_rate, carried_rate)

"""Penalty contact and regularised Coulomb friction, Eqs. (19), (28), (29), with both histories.

``accumulated``: the elastic slip of the previous step is carried and return-mapped.
``incremental``: slip is measured from the previous converged step only, Eq. (19) as printed.

A point that enters contact starts at zero slip from where it touched. That place is interpolated
between the open point before the step and the closed one after it, with the normal gaps as weights,
so the path does not jump when a design makes a point touch one step earlier or later.
"""

import math
from typing import NamedTuple

import numba as nb
import numpy as np

from seal_mdao.contact.kinematics import closest_point, contact_frame, rates
from seal_mdao.geometry.profile import curve_velocity

FRICTION_HISTORIES = ("accumulated", "incremental")

# Contact states.
OPEN, STICK, SLIP = 0, 1, 2

# Inputs and outputs of the local linearisation of one contact point.
X, Y, XI_0, SIZE_0, SLIP_0, LENGTH, RADIUS, NORMAL_PENALTY, TANGENT_PENALTY, FRICTION = range(10)
FORCE_X, FORCE_Y, XI, SIZE, CARRIED, GAP = range(6)


class ContactLaw(NamedTuple):
    """Penalties (stress per length), friction coefficient, history rule."""

    normal_penalty: float
    tangent_penalty: float
    friction: float
    accumulated: bool


class ContactHistory(NamedTuple):
    """What a contact point carries from one converged step to the next.

    Attributes
    ----------
    state : ndarray of int, shape (n,)
        OPEN, STICK or SLIP at the previous step.
    variables : ndarray, shape (n, 3)
        xi0, |t0|, and the elastic slip s0 of a point in contact or the normal gap of an open one.
    """

    state: np.ndarray
    variables: np.ndarray


def no_history(n_points: int) -> ContactHistory:
    """History of points that have never touched."""
    return ContactHistory(np.zeros(n_points, np.int64), np.zeros((n_points, 3)))


@nb.njit(cache=True, error_model="numpy", inline="always")
def elastic_slip(g_n, xi, state_0, carried):
    """Slip g_t of Eq. (19) plus what is carried, as if the point stuck.

    A point that was open slides only over the share g_n / (g_n - g_n0) of the step after it touched.
    """
    slid = carried[1] * (xi - carried[0])
    if state_0 == OPEN:
        return slid * g_n / (g_n - carried[2])
    return slid + carried[2]


@nb.njit(cache=True, error_model="numpy", inline="always")
def traction(law, g_n, g_t):
    """Contact state and tangential traction per area, Eqs. (28), (29).

    Parameters
    ----------
    g_n, g_t : float
        Normal gap, and elastic slip as if the point stuck.

    Returns
    -------
    state : int
    tau : float
        w_t g_t in stick, +-mu w_n |g_n| in slip; stress.
    """
    if g_n >= 0.0:
        return OPEN, 0.0
    limit = -law.friction * law.normal_penalty * g_n
    tau = law.tangent_penalty * g_t
    if abs(tau) < limit:
        return STICK, tau
    return SLIP, math.copysign(limit, g_t)


@nb.njit(cache=True, error_model="numpy", inline="always")
def elastic_slip_rate(column, g_n, gap_r, xi, xi_r, state_0, carried):
    """Derivative of ``elastic_slip`` with respect to the input ``column``."""
    slid = carried[1] * (xi - carried[0])
    slid_r = carried[1] * xi_r
    if column == XI_0:
        slid_r = -carried[1]
    elif column == SIZE_0:
        slid_r = xi - carried[0]
    carried_r = 1.0 if column == SLIP_0 else 0.0
    if state_0 != OPEN:
        return slid_r + carried_r
    whole = g_n - carried[2]
    share_r = (g_n * carried_r - carried[2] * gap_r) / (whole * whole)
    return slid_r * g_n / whole + slid * share_r


@nb.njit(cache=True, error_model="numpy", inline="always")
def traction_rate(column, law, state, tau, g_n, gap_r, slip_r):
    """Derivatives of tau and of the elastic slip that is carried on."""
    if state == STICK:
        tau_r = law.tangent_penalty * slip_r
        if column == TANGENT_PENALTY:
            tau_r = tau / law.tangent_penalty
        return tau_r, slip_r
    way = math.copysign(1.0, tau)
    tau_r = -way * law.friction * law.normal_penalty * gap_r
    if column == NORMAL_PENALTY:
        tau_r = tau / law.normal_penalty
    elif column == FRICTION:
        tau_r = -way * law.normal_penalty * g_n
    slip_r = tau_r / law.tangent_penalty
    if column == TANGENT_PENALTY:
        slip_r = -tau / law.tangent_penalty**2
    return tau_r, slip_r


@nb.njit(cache=True, error_model="numpy")
def linearize_contact_point(
    profile, law, piece, xi, g_n, state, tau, state_0, carried, length, columns, out
):
    """Derivatives of force and history of one point with respect to all its inputs.

    The force is T = length [w_n g_n e_n + tau nu e_t], Eq. (29); with dx alone its columns are the
    tangents (35), (36), (41), with the rest they are the fictitious loads (57), (63), (66).

    Parameters
    ----------
    state, state_0 : int
        Contact state now and at the previous converged step.
    carried : ndarray, shape (3,)
        The variables of ``ContactHistory``.
    columns : int
        How many of the inputs X, Y, ... are wanted (2: the tangent alone).
    out : ndarray, shape (6, 10)
        Rows FORCE_X ... GAP, columns X ... FRICTION. The rigid motion of the profile is minus the
        columns X, Y.
    """
    e_t, e_n, size, alpha, beta, gamma, c = contact_frame(profile, piece, xi, g_n)
    size_0 = carried[1]
    nu = size * size_0 / c if state != OPEN else 0.0
    pressure, shear = law.normal_penalty * g_n, tau * nu
    for column in range(columns):
        w, v1, v2 = (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)
        if column == X:
            w = (1.0, 0.0)
        elif column == Y:
            w = (0.0, 1.0)
        elif column == RADIUS:
            v, v1, v2 = curve_velocity(profile, piece, xi)
            w = (-v[0], -v[1])
        xi_r, gap_r, turn, size_r, c_r = rates(
            e_t, e_n, size, alpha, beta, gamma, c, g_n, w, v1, v2
        )
        out[XI, column], out[SIZE, column], out[GAP, column] = xi_r, size_r, gap_r
        if state == OPEN:
            out[FORCE_X, column] = out[FORCE_Y, column] = 0.0
            out[CARRIED, column] = gap_r
            continue
        slip_r = elastic_slip_rate(column, g_n, gap_r, xi, xi_r, state_0, carried)
        tau_r, slip_r = traction_rate(column, law, state, tau, g_n, gap_r, slip_r)
        pressure_r = law.normal_penalty * gap_r
        if column == NORMAL_PENALTY:
            pressure_r = g_n
        size_0_r = 1.0 if column == SIZE_0 else 0.0
        nu_r = nu * (size_r / size + size_0_r / size_0 - c_r / c)
        shear_r = tau_r * nu + tau * nu_r
        on_n = length * (pressure_r + turn * shear)
        on_t = length * (shear_r - turn * pressure)
        if column == LENGTH:
            on_n, on_t = pressure, shear
        out[FORCE_X, column] = on_n * e_n[0] + on_t * e_t[0]
        out[FORCE_Y, column] = on_n * e_n[1] + on_t * e_t[1]
        out[CARRIED, column] = slip_r if law.accumulated else 0.0


@nb.njit(cache=True, error_model="numpy")
def _without_reversal(law, state, tau, g_t, direction, i):
    """Let a point stick that would slip the other way round than one Newton iteration before."""
    way = 0
    if state == SLIP:
        way = 1 if tau > 0.0 else -1
    reversed_slip = way * direction[i] < 0
    direction[i] = 0 if reversed_slip else way
    if reversed_slip:
        return STICK, law.tangent_penalty * g_t, 1
    return state, tau, 0


@nb.njit(cache=True, error_model="numpy")
def contact_points(
    profile, law, position, x, length, history, direction, force, tangent, state, kept, gap
):
    """Forces of all contact points on a rigid profile and their tangents.

    Parameters
    ----------
    position : ndarray, shape (2,)
        Rigid translation of the profile.
    x : ndarray, shape (n, 2)
        Deformed contact points.
    length : ndarray, shape (n,)
        Tributary lengths.
    history : ContactHistory
    direction : ndarray of int, shape (n,)
        Slip direction in the previous Newton iteration, 0 for none; updated. A point that would
        slip the other way round has passed the stick branch in between: it is taken to stick in
        this iteration, whatever its limit, else Newton can jump to and fro for ever.
    force, tangent : ndarray, shapes (n, 2), (n, 2, 2)
        Written: the contact form (29) of each point, and d force / d x.
    state, kept, gap : ndarray, shapes (n,), (n, 3), (n,)
        Written: contact state, the variables to carry, the normal gap.

    Returns
    -------
    int
        Points made to stick; forces are those of Eq. (29) only when it is zero.
    """
    local = np.empty((6, 10))
    made_to_stick = 0
    for i in range(x.shape[0]):
        piece, xi, g_n = closest_point(profile, x[i, 0] - position[0], x[i, 1] - position[1])
        e_t, e_n, size, _, _, _, c = contact_frame(profile, piece, xi, g_n)
        gap[i], kept[i, 0], kept[i, 1] = g_n, xi, size
        if g_n >= 0.0:
            state[i], direction[i], kept[i, 2] = OPEN, 0, g_n
            force[i] = 0.0
            tangent[i] = 0.0
            continue
        state_0, carried = history.state[i], history.variables[i]
        g_t = elastic_slip(g_n, xi, state_0, carried)
        state[i], tau = traction(law, g_n, g_t)
        state[i], tau, made = _without_reversal(law, state[i], tau, g_t, direction, i)
        made_to_stick += made
        kept[i, 2] = tau / law.tangent_penalty if law.accumulated else 0.0
        shear = tau * size * carried[1] / c
        for a in range(2):
            force[i, a] = length[i] * (law.normal_penalty * g_n * e_n[a] + shear * e_t[a])
        linearize_contact_point(
            profile, law, piece, xi, g_n, state[i], tau, state_0, carried, length[i], 2, local
        )
        tangent[i] = local[:2, :2]
    return made_to_stick


@nb.njit(cache=True, error_model="numpy")
def contact_linearization(profile, law, position, x, length, history, points, out):
    """Full local derivatives of the ``points`` (s,) at a converged step: ``out`` (s, 6, 10), see the
    input names above."""
    for k, i in enumerate(points):
        piece, xi, g_n = closest_point(profile, x[i, 0] - position[0], x[i, 1] - position[1])
        state_0, carried = history.state[i], history.variables[i]
        state, tau = OPEN, 0.0
        if g_n < 0.0:
            state, tau = traction(law, g_n, elastic_slip(g_n, xi, state_0, carried))
        linearize_contact_point(
            profile, law, piece, xi, g_n, state, tau, state_0, carried, length[i], 10, out[k]
        )

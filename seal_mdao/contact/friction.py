"""Penalty contact and regularised Coulomb friction, Eqs. (19), (28), (29), with both histories.

``accumulated``: the elastic slip of the previous step is carried and return-mapped.
``incremental``: slip is measured from the previous converged step only, Eq. (19) as printed.
"""

import math
from typing import NamedTuple

import numba as nb
import numpy as np

from seal_mdao.contact.kinematics import closest_point, contact_frame, rates
from seal_mdao.geometry.profile import curve_velocity

FRICTION_HISTORIES = ("accumulated", "incremental")

# Contact states. TOUCH: the first step in contact, zero slip counted from where it touched.
OPEN, TOUCH, STICK, SLIP = 0, 1, 2, 3

# Inputs and outputs of the local linearisation of one contact point.
X, Y, XI_0, SIZE_0, SLIP_0, LENGTH, RADIUS, NORMAL_PENALTY, TANGENT_PENALTY, FRICTION = range(10)
FORCE_X, FORCE_Y, XI, SIZE, ELASTIC_SLIP, GAP = range(6)


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
        OPEN, TOUCH, STICK or SLIP at the previous step.
    variables : ndarray, shape (n, 3)
        xi0, |t0|, elastic slip s0.
    """

    state: np.ndarray
    variables: np.ndarray


def no_history(n_points: int) -> ContactHistory:
    """History of points that have never touched."""
    return ContactHistory(np.zeros(n_points, np.int64), np.zeros((n_points, 3)))


@nb.njit(cache=True, error_model="numpy", inline="always")
def traction(law, g_n, xi, state_0, xi_0, size_0, slip_0):
    """Contact state and tangential traction per area, Eqs. (28), (29).

    Returns
    -------
    state : int
    tau : float
        w_t g_t in stick, +-mu w_n |g_n| in slip; stress.
    g_t : float
        Elastic slip, Eq. (19) plus what is carried.
    """
    if g_n >= 0.0:
        return OPEN, 0.0, 0.0
    if state_0 == OPEN:
        return TOUCH, 0.0, 0.0
    g_t = slip_0 + size_0 * (xi - xi_0)
    limit = -law.friction * law.normal_penalty * g_n
    tau = law.tangent_penalty * g_t
    if abs(tau) <= limit:
        return STICK, tau, g_t
    tau = math.copysign(limit, g_t)
    return SLIP, tau, tau / law.tangent_penalty


@nb.njit(cache=True, error_model="numpy")
def linearize_contact_point(
    profile, law, piece, xi, g_n, state, tau, carried, length, columns, out
):
    """Derivatives of force and history of one point with respect to all its inputs.

    The force is T = length [w_n g_n e_n + tau nu e_t], Eq. (29); with dx alone its columns are the
    tangents (35), (36), (41), with the rest they are the fictitious loads (57), (63), (66).

    Parameters
    ----------
    carried : ndarray, shape (3,)
        xi0, |t0|, s0 of the previous converged step.
    columns : int
        How many of the inputs X, Y, ... are wanted (2: the tangent alone).
    out : ndarray, shape (6, 10)
        Rows FORCE_X ... GAP, columns X ... FRICTION. The rigid motion of the profile is minus the
        columns X, Y.
    """
    e_t, e_n, size, alpha, beta, gamma, c = contact_frame(profile, piece, xi, g_n)
    touching = state != OPEN
    size_0 = size if state == TOUCH else carried[1]
    nu = size * size_0 / c if touching else 0.0
    w_n, w_t = law.normal_penalty, law.tangent_penalty
    sign = math.copysign(1.0, tau)
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
        if not touching:
            out[FORCE_X, column] = out[FORCE_Y, column] = out[ELASTIC_SLIP, column] = 0.0
            continue
        tau_r, slip_r, size_0_r = 0.0, 0.0, 0.0
        if column == SIZE_0:
            size_0_r = 1.0
        if state == STICK:
            slip_r = size_0 * xi_r
            if column == XI_0:
                slip_r = -size_0
            elif column == SIZE_0:
                slip_r = xi - carried[0]
            elif column == SLIP_0:
                slip_r = 1.0
            tau_r = w_t * slip_r
            if column == TANGENT_PENALTY:
                tau_r = tau / w_t
        elif state == SLIP:
            tau_r = -sign * law.friction * w_n * gap_r
            if column == NORMAL_PENALTY:
                tau_r = tau / w_n
            elif column == FRICTION:
                tau_r = -sign * w_n * g_n
            slip_r = tau_r / w_t
            if column == TANGENT_PENALTY:
                slip_r = -tau / (w_t * w_t)
        if state == TOUCH:
            size_0_r = size_r
        pressure, pressure_r = w_n * g_n, w_n * gap_r
        if column == NORMAL_PENALTY:
            pressure_r = g_n
        nu_r = nu * (size_r / size + size_0_r / size_0 - c_r / c)
        shear, shear_r = tau * nu, tau_r * nu + tau * nu_r
        on_n = length * (pressure_r + turn * shear)
        on_t = length * (shear_r - turn * pressure)
        if column == LENGTH:
            on_n, on_t = pressure, shear
        out[FORCE_X, column] = on_n * e_n[0] + on_t * e_t[0]
        out[FORCE_Y, column] = on_n * e_n[1] + on_t * e_t[1]
        out[ELASTIC_SLIP, column] = slip_r if law.accumulated else 0.0


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
        gap[i] = g_n
        xi_0, size_0, slip_0 = history.variables[i]
        state[i], tau, g_t = traction(law, g_n, xi, history.state[i], xi_0, size_0, slip_0)
        way = 0
        if state[i] == SLIP:
            way = 1 if tau > 0.0 else -1
            if way * direction[i] < 0:
                g_t = slip_0 + size_0 * (xi - xi_0)
                state[i], tau, way = STICK, law.tangent_penalty * g_t, 0
                made_to_stick += 1
        direction[i] = way
        kept[i, 0] = xi
        kept[i, 2] = g_t if law.accumulated else 0.0
        e_t, e_n, size, _, _, _, c = contact_frame(profile, piece, xi, g_n)
        kept[i, 1] = size
        if state[i] == OPEN:
            force[i] = 0.0
            tangent[i] = 0.0
            continue
        if state[i] == TOUCH:
            size_0 = size
        shear = tau * size * size_0 / c
        for a in range(2):
            force[i, a] = length[i] * (law.normal_penalty * g_n * e_n[a] + shear * e_t[a])
        linearize_contact_point(
            profile, law, piece, xi, g_n, state[i], tau, history.variables[i], length[i], 2, local
        )
        tangent[i] = local[:2, :2]
    return made_to_stick


@nb.njit(cache=True, error_model="numpy")
def contact_linearization(profile, law, position, x, length, history, out):
    """Full local derivatives at a converged step: ``out`` (n, 6, 10), see the input names above."""
    for i in range(x.shape[0]):
        piece, xi, g_n = closest_point(profile, x[i, 0] - position[0], x[i, 1] - position[1])
        xi_0, size_0, slip_0 = history.variables[i]
        state, tau, _ = traction(law, g_n, xi, history.state[i], xi_0, size_0, slip_0)
        linearize_contact_point(
            profile, law, piece, xi, g_n, state, tau, history.variables[i], length[i], 10, out[i]
        )

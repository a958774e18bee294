"""Contact of points with one rigid profile: forces (27), (29), tangents (35), (36), (41) and fictitious
loads (57), (63), (66).

``contact_points`` has the force T, ``_fill_column`` one product rule T' for all of its derivatives, with
the printed forms term by term beside it. The law is that of ``contact.friction``, the kinematics those
of ``contact.kinematics``.
"""

import math

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.contact.friction import (
    CARRIED,
    FORCE_X,
    FORCE_Y,
    FRICTION,
    GAP,
    LENGTH,
    NORMAL_PENALTY,
    OPEN,
    SIZE,
    SIZE_0,
    SLIP,
    SLIP_0,
    STICK,
    XI,
    XI_0,
    X,
    Y,
    elastic_slip,
    elastic_slip_rate,
    friction_limit,
    law_constants,
    traction,
    traction_rate,
)
from seal_mdao.contact.kinematics import (
    closest_point,
    contact_frame,
    coordinate_change,
    rates,
    whole_turns,
)
from seal_mdao.geometry.curve import curve_velocity
from seal_mdao.geometry.pose import in_frame, turned

# What a point did in the previous Newton iteration, beside slip along e_t (1) and against it (-1):
# not known; stick; open; stick from open, though it slips in between.
NOT_YET, STUCK, APART, PASSED = 0, 2, 3, 4
# Share of two terms below which their sum is rounding.
ROUNDING = 1e-13


@compiled
def slip_slopes(profile, points, history, xi, gap, local, out):
    """Derivatives ``out[:, 0]`` (s, 2) of the elastic slip of ``points`` (s,) with their displacements
    at the step before.

    A point that stays in stick on |t| = |t0| passes s0 - |t0| xi0 to the next step, which does not
    change with its displacement: the derivative is mere rounding, and set to zero here.

    Parameters
    ----------
    history : ContactHistory
        passed on by the step before, of all points.
    xi, gap : ndarray, shape (n,)
        Natural coordinates and normal gaps of all points at the step.
    local : ndarray, shape (s, 6, ...)
        Of ``contact_linearization`` at the step before.
    """
    for k, i in enumerate(points):
        state_0, before = history.state[i], history.variables[i]
        # xi0, |t0|, s0 or g_n0 that the step began with
        xi_0, size_0, carried = before[0], before[1], before[2]
        change = coordinate_change(profile, xi[i], xi_0)
        # dg_t/dxi0 and dg_t/ds0   Eq. (60)
        by_xi = elastic_slip_rate(XI_0, gap[i], 0.0, change, -1.0, state_0, size_0, carried)
        by_carried = elastic_slip_rate(SLIP_0, gap[i], 0.0, change, 0.0, state_0, size_0, carried)
        scale = 0.0
        for c in range(2):
            # dg_t/dx_(n-1) = (dg_t/dxi0) dxi0/dx + (dg_t/ds0) ds0/dx
            a, b = by_xi * local[k, XI, X + c], by_carried * local[k, CARRIED, X + c]
            out[k, 0, c], scale = a + b, max(scale, abs(a) + abs(b))
        if max(abs(out[k, 0, 0]), abs(out[k, 0, 1])) <= ROUNDING * scale:
            out[k, 0, 0] = out[k, 0, 1] = 0.0


@internal
def _fill_column(column, change_r, moved, frame, now, then, law, i, length, out):
    """One column of ``linearize_contact_point``.

    Parameters
    ----------
    change_r : float
        Rate of xi - xi0, without that of xi.
    moved : tuple of pairs
        w, V_c,xi, V_c,xixi of ``rates``.
    frame, now, then : tuple
        What ``contact_frame`` gives; g_n, state, tau, nu; what came before: state, |t0|, xi - xi0,
        and the gap or slip carried.
    """
    e_t, e_n, size, alpha, beta, gamma, c = frame
    g_n, state, tau, nu = now
    state_0, size_0, change, carried = then
    w, v1, v2 = moved
    # xi', g_n', e_t' = turn e_n, |t|', c'  Eqs. (52)-(55), with dx alone (31)-(34)
    xi_r, gap_r, turn, size_r, c_r = rates(e_t, e_n, size, alpha, beta, gamma, c, g_n, w, v1, v2)
    out[XI, column], out[SIZE, column], out[GAP, column] = xi_r, size_r, gap_r
    if state == OPEN:
        out[FORCE_X, column] = out[FORCE_Y, column] = 0.0
        out[CARRIED, column] = gap_r
        return
    # g_t'   Eq. (60), with dx alone nu e_t.dx   Eq. (32)
    slip_r = elastic_slip_rate(
        column, g_n, gap_r, change, xi_r + change_r, state_0, size_0, carried
    )
    # tau' = w_t g_t' in stick, (omega_t g_n)' with omega_t = -mu w_n sgn(g_t) in slip   Eq. (39)
    tau_r, slip_r = traction_rate(law, i, column, state, tau, g_n, gap_r, slip_r)
    pressure, shear = law.normal_penalty * g_n, tau * nu
    # (w_n g_n)' = w_n g_n' + w_n' g_n
    pressure_r = law.normal_penalty * gap_r
    if column == NORMAL_PENALTY:
        pressure_r = g_n
    # nu' = nu (|t|'/|t| + |t0|'/|t0| - c'/c) of nu = |t||t0|/c   Eq. (22)
    size_0_r = 1.0 if column == SIZE_0 else 0.0
    nu_r = nu * (size_r / size + size_0_r / size_0 - c_r / c)
    shear_r = tau_r * nu + tau * nu_r
    # T' = l [(w_n g_n)' + turn tau nu] e_n + l [(tau nu)' - turn w_n g_n] e_t, for e_t' = turn e_n and
    # e_n' = -turn e_t. The same terms apart, as in the paper:
    #
    # Tangents, w = dx: turn = (alpha/c) e_t.dx, g_n' = e_n.dx, and
    #   nu' = (nu/c) {[((gamma |t| - 2 alpha beta) g_n - beta |t|^2)/c] e_t.dx + alpha e_n.dx}
    # normal (35)
    #   (w_n g_n)' e_n     w_n e_n e_n^T dx
    #   -turn w_n g_n e_t  -w_n (alpha g_n/c) e_t e_t^T dx
    # stick (36), tau = w_t g_t, and slip (41), tau = omega_t g_n
    #   tau' nu e_t        w_t nu^2 e_t e_t^T dx in stick,  omega_t nu e_t e_n^T dx in slip
    #   turn tau nu e_n    tau (alpha nu/c) e_n e_t^T dx    (36) prints e_n e_n^T
    #   tau nu' e_t        tau (alpha nu/c) e_t e_n^T dx
    #                      + tau (nu/c^2) [(gamma |t| - 2 alpha beta) g_n - beta |t|^2] e_t e_t^T dx
    # These are exact; the print says that higher-order terms are ignored.
    #
    # Fictitious loads, w = V - V_c; 0 marks the step before, where w0 = V - V_c0 + z0':
    # normal (57): (35) with w for dx, and of -turn w_n g_n e_t
    #   - w_n (g_n |t|/c) e_t e_n.V_c,xi
    # stick (63), w_t times: (36) with w for dx (V printed), and
    #   + (2 g_t |t|/c) e_t e_t0.V_c0,xi
    #   + (nu/c0) (2 beta0 g_t - |t0|^2) e_t e_t0.w0                 1/c0 is missing in the print
    #   + (2 beta0 g_n0 g_t |t|/(c c0)) e_t e_n0.V_c0,xi             g_n (|t| + |t0|) printed
    #   - (g_n0 |t| |t0|^2/(c c0)) e_t e_n0.V_c0,xi                  g_n printed
    #   + (nu g_n |t0|/c) e_t e_n.V_c,xi                             missing in the print
    # slip (66), omega_t times: (41) with w for dx (V printed), and
    #   + (g_n |t|/c) e_t e_t0.V_c0,xi
    #   + (nu beta0 g_n/c0) e_t e_t0.w0
    #   + (beta0 g_n g_n0 |t|/(c c0)) e_t e_n0.V_c0,xi               |t0| and e_t0 printed
    # (63) and (66), tau nu times, of V_c,xi and V_c,xixi in turn and nu', missing in the print:
    #   + (|t|/c) e_n e_n.V_c,xi - ((|t|^2 + alpha g_n)/(|t| c)) e_t e_t.V_c,xi
    #   + (g_n/c^2) [gamma g_n - beta (2 |t|^2 + alpha g_n)/|t|] e_t e_n.V_c,xi
    #   + (g_n/c) e_t e_n.V_c,xixi
    # Terms with 0 are columns XI_0, SIZE_0 times the rates of the history; kappa (V^T n) of the print is
    # column LENGTH times l'/l, the rate of the boundary element with its tangential stretch.
    on_n = length * (pressure_r + turn * shear)
    on_t = length * (shear_r - turn * pressure)
    if column == LENGTH:
        on_n, on_t = pressure, shear
    out[FORCE_X, column] = on_n * e_n[0] + on_t * e_t[0]
    out[FORCE_Y, column] = on_n * e_n[1] + on_t * e_t[1]
    out[CARRIED, column] = slip_r if law.accumulated else 0.0


@internal
def _fill_columns(first, end, frame, now, then, law, i, length, out):
    """Columns ``first`` to ``end`` of ``linearize_contact_point``, none of them of the shape."""
    zero = (0.0, 0.0)
    for column in range(first, end):
        # w = dx, a unit vector for the places and zero for the others
        w = (1.0 if column == X else 0.0, 1.0 if column == Y else 0.0)
        change_r = -1.0 if column == XI_0 else 0.0
        _fill_column(column, change_r, (w, zero, zero), frame, now, then, law, i, length, out)


@inlined
def linearize_contact_point(
    profile, law, i, pose, piece, xi, g_n, state, tau, state_0, carried, length, columns, out
):
    """Derivatives of force and history of one point with respect to all its inputs.

    The force is T = length [w_n g_n e_n + tau nu e_t], Eq. (29); with dx alone its columns are the
    tangents (35), (36), (41), with the rest they are the fictitious loads (57), (63), (66), of which
    ``_fill_column`` has the terms:

    - X, Y: dT/dx, normal (35), stick (36) and slip (41).
    - The same columns times V + z': Eqs. (51), (56) of (50); times V alone: the terms of (57), (63),
      (66) with V.
    - XI_0, SIZE_0 and the variable carried: what the previous step passes on, through Eq. (60).
    - LENGTH: T over its length; l' of the tributary length is kappa (V^T n) of the printed loads.
    - Penalties and friction: the law; shape parameters: V_c of the profile, Eqs. (52), (53).

    Parameters
    ----------
    state, state_0 : int
        Contact state now and at the previous converged step.
    carried : ndarray, shape (3,)
        The variables of ``ContactHistory``.
    columns : pair of int
        The first column of the shape parameters, and the end of them.
    out : ndarray, shape (6, columns)
        Rows FORCE_X ... GAP, columns X ... FRICTION ..., shape parameters; x and
        force in the fixed frame. ``geometry.pose`` describes the effect of rates of the pose.
    """
    first, end = columns
    e_t, e_n, size, alpha, beta, gamma, c = contact_frame(profile, piece, xi, g_n)
    frame = turned(pose, e_t), turned(pose, e_n), size, alpha, beta, gamma, c
    change = coordinate_change(profile, xi, carried[0])
    # nu = |t||t0|/c   Eq. (22)
    now = g_n, state, tau, size * carried[1] / c if state != OPEN else 0.0
    then = state_0, carried[1], change, carried[2]
    if state == OPEN:
        # history, length and law matter in contact only
        out[:, XI_0:first] = 0.0
    _fill_columns(X, first if state != OPEN else XI_0, frame, now, then, law, i, length, out)
    for column in range(first, end):
        # w = -V_c, and V_c,xi, V_c,xixi of a shape parameter   Eq. (52)
        v, v1, v2 = curve_velocity(profile, column - first, piece, xi)
        moved = turned(pose, (-v[0], -v[1])), turned(pose, v1), turned(pose, v2)
        turns = whole_turns(profile, xi, carried[0])
        change_r = -turns * profile.period_rate[column - first]
        _fill_column(column, change_r, moved, frame, now, then, law, i, length, out)


@inlined
def _slips_at_touch(tau, limit, g_n, state_0, gap_0):
    """Whether a point of traction ``tau`` that sticks at g_n would slip at g_n -> 0-."""
    if state_0 != OPEN:
        # g_t = |t0| (xi - xi0) + s0 does not depend on g_n, and the limit tends to zero
        return tau != 0.0
    # with g_t = |t0| (xi - xi0) g_n / (g_n - g_n0) and a limit in proportion to |g_n|
    #   lim |tau| / limit = (|tau| / limit) (g_n0 - g_n) / g_n0 > 1
    return abs(tau) * (gap_0 - g_n) > limit * gap_0


@inlined
def _in_between(law, i, g_n, g_t, found, before, previous, through_slip):
    """Let a point take the state between its previous and its present one where it passed over it:
    stick between slip one way and the other and, with ``through_slip``, slip between open and stick."""
    (state, tau), (state_0, gap_0), was = found, before, previous[i]
    if was == NOT_YET and state_0 == OPEN:
        was = APART
    if state == SLIP:
        sense = 1 if tau > 0.0 else -1
        if was == -sense:
            previous[i] = STUCK
            return STICK, law.tangent_penalty * g_t, 1
        previous[i] = sense
        return state, tau, 0
    previous[i] = STUCK
    if was == APART:
        limit = friction_limit(law.limits, law, i, g_n, g_t)
        if _slips_at_touch(tau, limit, g_n, state_0, gap_0):
            if through_slip:
                previous[i] = 1 if g_t > 0.0 else -1
                return SLIP, math.copysign(limit, g_t), 1
            previous[i] = PASSED
    return state, tau, 0


@compiled
def contact_points(
    profile, law, pose, x, length, history, previous, through_slip, force, tangent, state, kept, gap
):
    """Forces of all contact points on a rigid profile and their tangents.

    Parameters
    ----------
    law : ContactLaw
        ``at`` the gaps of the points.
    pose : Pose
        Translation and rotation of the profile.
    x : ndarray, shape (n, 2)
        Deformed contact points.
    length : ndarray, shape (n,)
        Tributary lengths.
    history : ContactHistory
    previous : ndarray of int, shape (n,)
        What the points did in the previous Newton iteration, NOT_YET where there was none; updated. A
        point that would slip the other way round has passed the stick branch in between: it is taken to
        stick in this iteration, whatever its limit, else Newton can jump to and fro for ever.
    through_slip : bool
        Whether a point that was open and would stick is taken to slip in this iteration where it slips
        at touch, for iterations that alternate between open and stick.
    force, tangent : ndarray, shapes (n, 2), (n, 2, 2)
        Written: the contact form (29) of each point, and d force / d x.
    state, kept, gap : ndarray, shapes (n,), (n, 3), (n,)
        Written: contact state, the variables to carry, the normal gap.

    Returns
    -------
    int
        Points taken to stick or slip; forces are those of Eq. (29) only when it is zero.
    """
    local = np.empty((6, 2))
    changed = 0
    for i in range(x.shape[0]):
        # x in the frame of the profile, closest point (18) and gap (17)
        x_1, x_2 = in_frame(pose, x[i, 0], x[i, 1])
        piece, xi, g_n = closest_point(profile, x_1, x_2)
        e_t, e_n, size, alpha, beta, gamma, c = contact_frame(profile, piece, xi, g_n)
        e_t, e_n = turned(pose, e_t), turned(pose, e_n)
        gap[i], kept[i, 0], kept[i, 1] = g_n, xi, size
        if g_n >= 0.0:
            state[i], previous[i], kept[i, 2] = OPEN, APART, g_n
            for a in range(2):
                force[i, a] = tangent[i, a, 0] = tangent[i, a, 1] = 0.0
            continue
        state_0, carried = history.state[i], history.variables[i]
        # slip (19), stick or slip (28)
        change = coordinate_change(profile, xi, carried[0])
        g_t = elastic_slip(g_n, change, state_0, carried[1], carried[2])
        found = traction(law, i, g_n, g_t)
        before = state_0, carried[2]
        state[i], tau, made = _in_between(law, i, g_n, g_t, found, before, previous, through_slip)
        changed += made
        kept[i, 2] = tau / law.tangent_penalty if law.accumulated else 0.0
        # T.dx = w_n g_n dg_n + tau dg_t   Eq. (21), dg_n = e_n.dx, dg_t = nu e_t.dx   Eqs. (23), (26):
        # T = l (w_n g_n e_n + tau nu e_t), nu = |t||t0|/c   Eqs. (22), (27), (29), the sum b_N + b_T of
        # (30) with tau = w_t g_t, (61), or of (38) with tau = omega_t g_n, (40), (64); b_N is (50)
        shear = tau * size * carried[1] / c
        for a in range(2):
            force[i, a] = length[i] * (law.normal_penalty * g_n * e_n[a] + shear * e_t[a])
        frame = e_t, e_n, size, alpha, beta, gamma, c
        now = g_n, state[i], tau, size * carried[1] / c
        then = state_0, carried[1], change, carried[2]
        # d force/dx: tangents (35), (36), (41)
        _fill_columns(X, Y + 1, frame, now, then, law, i, length[i], local)
        for row in range(2):
            for column in range(2):
                tangent[i, row, column] = local[row, column]
    return changed


@inlined
def _add_motion(pose, motion_rates, x, force, first, out):
    """Columns of one point from ``first`` on for the motion's parameters: the profile moves under it,
    see ``geometry.pose``."""
    for m in range(motion_rates.shape[0]):
        v_x, v_y, turn = motion_rates[m, 0], motion_rates[m, 1], motion_rates[m, 2]
        # velocity of the profile at x
        v_x -= turn * (x[1] - pose.position[1] - pose.pivot[1])
        v_y += turn * (x[0] - pose.position[0] - pose.pivot[0])
        for row in range(out.shape[0]):
            # the law depends on x minus the profile's motion; forces turn with it
            out[row, first + m] = -out[row, X] * v_x - out[row, Y] * v_y
        out[FORCE_X, first + m] -= turn * force[1]
        out[FORCE_Y, first + m] += turn * force[0]


@compiled
def contact_linearization(
    profile, curve, law, pose, motion_rates, x, length, force, history, points, out
):
    """Full local derivatives of the ``points`` (s,) at a converged step, ``out`` (s, 6, columns)
    written; the inputs are those of ``contact.friction``.

    Parameters
    ----------
    curve : RigidProfile
        The profile without its rates, for which the closest point is compiled already.
    motion_rates : ndarray, shape (m, 3)
        Rates of x, y and angle of the pose, whose columns come last.
    force : ndarray, shape (n, 2)
        Of all points at the step.
    """
    first = FRICTION + law_constants(law.limits)
    columns = first, first + profile.period_rate.size
    for k, i in enumerate(points):
        x_1, x_2 = in_frame(pose, x[i, 0], x[i, 1])
        piece, xi, g_n = closest_point(curve, x_1, x_2)
        state_0, carried = history.state[i], history.variables[i]
        state, tau = OPEN, 0.0
        if g_n < 0.0:
            change = coordinate_change(profile, xi, carried[0])
            g_t = elastic_slip(g_n, change, state_0, carried[1], carried[2])
            state, tau = traction(law, i, g_n, g_t)
        linearize_contact_point(
            profile, law, i, pose, piece, xi, g_n, state, tau, state_0, carried, length[i], columns,
            out[k],
        )  # fmt: skip
        _add_motion(pose, motion_rates, x[i], force[i], columns[1], out[k])

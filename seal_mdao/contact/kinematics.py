"""Contact kinematics: closest point (18), gap (17), the scalars (22) and their derivatives.

The rates (23)-(26) for a moving body point and (52)-(55) for a moving design are one formula:
``rates`` takes the velocity of the body point relative to the curve, w = V - V_c + z', and the
derivatives of the curve's own design velocity. The slip (19) and its derivative (60) are in
``contact.friction``.
"""

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.contact.cubic_projection import nearest_on_cubic
from seal_mdao.geometry.bounds import PIECES_A_RUN
from seal_mdao.geometry.curve import CUBIC, END_SLACK, LINE, cubic_point, curve_point
from seal_mdao.geometry.pose import in_frame, turned

# Share of its way by which a point may miss its linearised gap.
FARTHEST_MISS = 0.3


@inlined
def _on_line(ox, oy, angle, length, open_start, open_end):
    """Distance squared, gap, s, and whether s lies beyond the piece."""
    c, n = np.cos(angle), np.sin(angle)
    # s = e_t . (x - x_0),  g_n = e_n . (x - x_0)
    s, gap = ox * c + oy * n, ox * n - oy * c
    over = 0.0
    if s < 0.0 and not open_start:
        over = s
    if s > length and not open_end:
        over = s - length
    return gap * gap + over * over, gap, s, over != 0.0


@inlined
def _on_arc(ox, oy, angle, length, r):
    """Distance squared, gap, s, and whether s lies beyond the piece."""
    size, turn = abs(r), (1.0 if r > 0.0 else -1.0)
    span = length / size
    # angle from the start of the arc, in the sense of xi
    distance = (ox * ox + oy * oy) ** 0.5
    a = turn * (np.arctan2(oy, ox) - angle)
    a -= 2.0 * np.pi * np.floor((a - 0.5 * span + np.pi) / (2.0 * np.pi))
    # g_n = +-(|x - m| - r)
    gap = turn * (distance - size)
    over = 0.0
    if a < 0.0:
        over = a
    if a > span:
        over = a - span
    # chord law: distance to the end point of the arc
    half = np.sin(0.5 * over)
    square = gap * gap + 4.0 * distance * size * half * half
    return square, gap, size * a, over != 0.0


@internal
def _on_cubic(coefficients, piece, length, x, y, open_start, open_end):
    """Distance squared, gap, s, and whether s lies beyond the piece."""
    if coefficients is None:
        return np.inf, 0.0, 0.0, True
    square, s = nearest_on_cubic(coefficients[piece], length, x, y, open_start, open_end)
    x_c, t, _, _ = cubic_point(coefficients, piece, length, s)
    # g_n = (x - x_c) . e_n   Eq. (17)
    gap = ((x - x_c[0]) * t[1] - (y - x_c[1]) * t[0]) / (t[0] * t[0] + t[1] * t[1]) ** 0.5
    slack = END_SLACK * length
    over = (s < -slack and not open_start) or (s > length + slack and not open_end)
    return square, gap, s, over


@inlined
def _candidate(pieces, piece, x, y, goes_on, farthest):
    """Projection on one piece: distance squared to the piece, signed gap, s = xi - start, and
    whether it lies beyond the ends of the piece.

    Cubic pieces farther away than ``farthest`` are given an infinite distance.
    """
    kind, origin, angle, radius, length, coefficient = pieces
    open_start, open_end = goes_on and piece == 0, goes_on and piece == kind.size - 1
    ox, oy = x - origin[piece, 0], y - origin[piece, 1]
    if kind[piece] == LINE:
        return _on_line(ox, oy, angle[piece], length[piece], open_start, open_end)
    if kind[piece] != CUBIC:
        return _on_arc(ox, oy, angle[piece], length[piece], radius[piece])
    away = (ox * ox + oy * oy) ** 0.5 - radius[piece]
    if away > farthest and not open_start and not open_end:
        return np.inf, 0.0, 0.0, True
    return _on_cubic(coefficient, piece, length[piece], x, y, open_start, open_end)


@inlined
def _distance(profile, run, x, y):
    """From the centre of the circle around a run of pieces."""
    dx, dy = x - profile.run_centre[run, 0], y - profile.run_centre[run, 1]
    return (dx * dx + dy * dy) ** 0.5


@inlined
def _within_reach(profile, x, y):
    """A distance that the profile is certainly not farther away than, a little enlarged."""
    nearest = np.inf
    for run in range(profile.run_radius.size):
        # comparisons here and below: numba compiles functions of its own for min
        farthest = _distance(profile, run, x, y) + profile.run_radius[run]
        nearest = farthest if farthest < nearest else nearest
    return (1.0 + 1e-9) * nearest


@compiled
def closest_point(profile, x, y):
    """Solve the contact consistency condition (18).

    Between two pieces that meet in a convex corner the nearer one's own line is continued, so the
    projection is perpendicular everywhere; of two equally near pieces the one with the larger
    distance to its line is taken, which keeps the gap continuous. Where they meet smoothly the piece
    that the projection falls on comes first, whose curvature it is.

    Returns
    -------
    piece : int
    xi : float
        Natural coordinate of the closest point.
    g_n : float
        Normal gap, Eq. (17); negative in penetration.
    """
    best, best_gap, best_s, best_piece, best_over = np.inf, 0.0, 0.0, -1, True
    count, goes_on = profile.kind.size, profile.period == 0.0
    # taken out of the profile once: numba counts references at every attribute
    kind, origin, angle, radius = profile.kind, profile.origin, profile.angle, profile.radius
    pieces = kind, origin, angle, radius, profile.length, profile.coefficient
    farthest = _within_reach(profile, x, y)
    for run in range(profile.run_radius.size):
        if _distance(profile, run, x, y) - profile.run_radius[run] > farthest:
            continue
        for piece in range(run * PIECES_A_RUN, (run + 1) * PIECES_A_RUN):
            if piece == count:
                break
            square, gap, s, over = _candidate(pieces, piece, x, y, goes_on, farthest)
            slack = 1e-12 * (square + best) if best < np.inf else 0.0
            better = square < best - slack
            if abs(square - best) <= slack:
                better = abs(gap) > abs(best_gap) if over == best_over else best_over
            if better:
                best, best_gap, best_s, best_piece, best_over = square, gap, s, piece, over
                reach = (1.0 + 1e-9) * square**0.5
                farthest = reach if reach < farthest else farthest
    # xi with e_t . (x - x_c(xi)) = 0   Eq. (18),  g_n = (x - x_c(xi)) . e_n   Eq. (17)
    return best_piece, profile.start[best_piece] + best_s, best_gap


@compiled
def normal_gaps(profile, pose, x, gap):
    """Compute the normal gaps (n,) of the points ``x`` (n, 2), Eq. (17)."""
    for i in range(len(x)):
        own = in_frame(pose, x[i, 0], x[i, 1])
        gap[i] = closest_point(profile, own[0], own[1])[2]


@inlined
def whole_turns(profile, xi, xi_0):
    """Compute the number of complete turns around a closed profile to subtract from xi - xi0."""
    if profile.period == 0.0:
        return 0.0
    return np.floor((xi - xi_0) / profile.period + 0.5)


@inlined
def coordinate_change(profile, xi, xi_0):
    """Compute xi - xi0, on a closed profile in the shorter direction."""
    return xi - xi_0 - whole_turns(profile, xi, xi_0) * profile.period


@inlined
def contact_frame(profile, piece, xi, g_n):
    """Compute e_t and e_n (pairs) and the scalars (22): |t|, alpha, beta, gamma, c."""
    _, t, x2, x3 = curve_point(profile, piece, xi)
    size = (t[0] * t[0] + t[1] * t[1]) ** 0.5
    # e_t = t / |t|,  e_n = e_t turned clockwise
    e_t = (t[0] / size, t[1] / size)
    e_n = (e_t[1], -e_t[0])
    # alpha = e_n . x_c,xixi,  beta = e_t . x_c,xixi,  gamma = e_n . x_c,xixixi   Eq. (22)
    alpha = e_n[0] * x2[0] + e_n[1] * x2[1]
    beta = e_t[0] * x2[0] + e_t[1] * x2[1]
    gamma = e_n[0] * x3[0] + e_n[1] * x3[1]
    # c = |t|^2 - g_n alpha   Eq. (22)
    return e_t, e_n, size, alpha, beta, gamma, size * size - g_n * alpha


@compiled
def linearized_positions(profile, pose, x, place, normal, gap):
    """Move ``place`` to where the points ``x`` (n, 2) have the gaps that their linearisation expects.

    The gap was linearised at ``place``: g = gap + e_n . (x - place). From the closest point of x the new
    place has that gap along the normal there, so it is x itself where the profile is straight.
    Where x = place nothing was linearised, and where the gap of x differs by more than FARTHEST_MISS
    of the distance x - place, the linearisation means nothing: the new place is x.

    Parameters
    ----------
    place, normal : ndarray, shape (n, 2)
        Of the last linearisation; updated.
    gap : ndarray, shape (n,)
        Gaps at ``place``; updated.
    """
    for i in range(len(x)):
        dx, dy = x[i, 0] - place[i, 0], x[i, 1] - place[i, 1]
        # g + e_n . (x - z)
        expected = gap[i] + normal[i, 0] * dx + normal[i, 1] * dy
        own = in_frame(pose, x[i, 0], x[i, 1])
        piece, xi, g_n = closest_point(profile, own[0], own[1])
        e_n = turned(pose, contact_frame(profile, piece, xi, g_n)[1])
        missed = g_n - expected
        if abs(missed) > FARTHEST_MISS * (dx * dx + dy * dy) ** 0.5:
            missed = 0.0
        gap[i] = g_n - missed
        for a in range(2):
            # z = x - (g_n(x) - g) e_n
            place[i, a], normal[i, a] = x[i, a] - missed * e_n[a], e_n[a]


@inlined
def rates(e_t, e_n, size, alpha, beta, gamma, c, g_n, w, v1, v2):
    """Compute the derivatives of the contact kinematics.

    Parameters
    ----------
    e_t, e_n : pair
    size, alpha, beta, gamma, c, g_n : float
        |t| and the scalars of Eq. (22).
    w : pair
        V - V_c + z', velocity of the body point relative to the curve at fixed xi.
    v1, v2 : pair
        V_c,xi and V_c,xixi.

    Returns
    -------
    xi_rate : float
        Eq. (52); Eqs. (26), (32) are |t0| times it.
    gap_rate : float
        Eqs. (23), (31), (55).
    turn : float
        e_t' = turn e_n and e_n' = -turn e_t, Eqs. (24), (25), (33), (34), (53), (54).
    size_rate, c_rate : float
        |t|' and c'.
    """
    # components of w = V - V_c + z' and of V_c,xi
    w_t = e_t[0] * w[0] + e_t[1] * w[1]
    w_n = e_n[0] * w[0] + e_n[1] * w[1]
    v1_t = e_t[0] * v1[0] + e_t[1] * v1[1]
    v1_n = e_n[0] * v1[0] + e_n[1] * v1[1]
    # xi' = (|t|/c) e_t . w + (g_n/c) e_n . V_c,xi   Eq. (52); |t0| xi' with dx alone   Eqs. (26), (32)
    xi_rate = (size * w_t + g_n * v1_n) / c
    # e_t' = [(alpha/c) e_t . w + (|t|/c) e_n . V_c,xi] e_n, e_n' = -[same] e_t   Eqs. (53), (54), with
    # dx alone (24), (25), (33), (34). The print has (alpha/c)(g_n/c) in place of |t|/c, a misprint: turn
    # = e_n . t'/|t| = (alpha xi' + e_n . V_c,xi)/|t| has (alpha g_n/c + 1)/|t| = |t|/c there, and so
    # has the paper's own (56)
    turn = (alpha * w_t + size * v1_n) / c
    # |t|' = beta xi' + e_t . V_c,xi
    size_rate = beta * xi_rate + v1_t
    # alpha' = -turn beta + gamma xi' + e_n . V_c,xixi
    alpha_rate = -turn * beta + gamma * xi_rate + e_n[0] * v2[0] + e_n[1] * v2[1]
    # c' = 2 |t| |t|' - g_n' alpha - g_n alpha', g_n' = e_n . w   Eq. (55), with dx alone (23), (31)
    c_rate = 2.0 * size * size_rate - w_n * alpha - g_n * alpha_rate
    return xi_rate, w_n, turn, size_rate, c_rate

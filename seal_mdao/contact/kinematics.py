"""Contact kinematics: closest point (18), gap (17), the scalars (22) and all their rates.

The rates (23)-(26) for a moving body point and (52)-(55) for a moving design are one formula:
``rates`` takes the velocity of the body point relative to the curve, w = V - V_c + z', and the
derivatives of the curve's own design velocity.
"""

import numba as nb
import numpy as np

from seal_mdao.geometry.bounds import PIECES_A_RUN
from seal_mdao.geometry.profile import LINE, curve_point


@nb.njit(cache=True, error_model="numpy")
def _candidate(profile, piece, x, y, last):
    """Projection on one piece: distance squared to the piece, signed gap, natural coordinate."""
    ox, oy = x - profile.origin[piece, 0], y - profile.origin[piece, 1]
    length = profile.length[piece]
    if profile.kind[piece] == LINE:
        c, n = np.cos(profile.angle[piece]), np.sin(profile.angle[piece])
        s, gap = ox * c + oy * n, ox * n - oy * c
        over = 0.0
        if s < 0.0 and piece > 0:
            over = s
        if s > length and piece < last:
            over = s - length
        return gap * gap + over * over, gap, profile.start[piece] + s
    r = profile.radius[piece]
    size, turn = abs(r), (1.0 if r > 0.0 else -1.0)
    span = length / size
    distance = (ox * ox + oy * oy) ** 0.5
    a = turn * (np.arctan2(oy, ox) - profile.angle[piece])
    a -= 2.0 * np.pi * np.floor((a - 0.5 * span + np.pi) / (2.0 * np.pi))
    gap = turn * (distance - size)
    over = 0.0
    if a < 0.0:
        over = a
    if a > span:
        over = a - span
    # chord law: distance to the end point of the arc
    square = gap * gap + 4.0 * distance * size * np.sin(0.5 * over) ** 2
    return square, gap, profile.start[piece] + size * a


@nb.njit(cache=True, error_model="numpy", inline="always")
def _distance(profile, run, x, y):
    """From the centre of the circle around a run of pieces."""
    dx, dy = x - profile.run_centre[run, 0], y - profile.run_centre[run, 1]
    return (dx * dx + dy * dy) ** 0.5


@nb.njit(cache=True, error_model="numpy")
def _within_reach(profile, x, y):
    """A distance that the profile is certainly not farther away than, a little enlarged."""
    nearest = np.inf
    for run in range(profile.run_radius.size):
        nearest = min(nearest, _distance(profile, run, x, y) + profile.run_radius[run])
    return (1.0 + 1e-9) * nearest


@nb.njit(cache=True, error_model="numpy")
def closest_point(profile, x, y):
    """Solve the contact consistency condition (18).

    Between two pieces that meet in a convex corner the nearer one's own line is continued, so the
    projection is perpendicular everywhere; of two equally near pieces the one with the larger
    distance to its line is taken, which keeps the gap continuous.

    Returns
    -------
    piece : int
    xi : float
        Natural coordinate of the closest point.
    g_n : float
        Normal gap, Eq. (17); negative in penetration.
    """
    best, best_gap, best_xi, best_piece = np.inf, 0.0, 0.0, -1
    last = profile.kind.size - 1
    farthest = _within_reach(profile, x, y)
    for run in range(profile.run_radius.size):
        if _distance(profile, run, x, y) - profile.run_radius[run] > farthest:
            continue
        for piece in range(run * PIECES_A_RUN, min((run + 1) * PIECES_A_RUN, last + 1)):
            square, gap, xi = _candidate(profile, piece, x, y, last)
            slack = 1e-12 * (square + best) if best < np.inf else 0.0
            tie = abs(square - best) <= slack and abs(gap) > abs(best_gap)
            if square < best - slack or tie:
                best, best_gap, best_xi, best_piece = square, gap, xi, piece
    return best_piece, best_xi, best_gap


@nb.njit(cache=True, error_model="numpy", inline="always")
def contact_frame(profile, piece, xi, g_n):
    """e_t and e_n (pairs) and the scalars (22): |t|, alpha, beta, gamma, c."""
    _, t, x2, x3 = curve_point(profile, piece, xi)
    size = (t[0] * t[0] + t[1] * t[1]) ** 0.5
    e_t = (t[0] / size, t[1] / size)
    e_n = (e_t[1], -e_t[0])
    alpha = e_n[0] * x2[0] + e_n[1] * x2[1]
    beta = e_t[0] * x2[0] + e_t[1] * x2[1]
    gamma = e_n[0] * x3[0] + e_n[1] * x3[1]
    return e_t, e_n, size, alpha, beta, gamma, size * size - g_n * alpha


@nb.njit(cache=True, error_model="numpy", inline="always")
def rates(e_t, e_n, size, alpha, beta, gamma, c, g_n, w, v1, v2):
    """Rates of the contact kinematics.

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
        Eq. (52); Eq. (26) is |t0| times it.
    gap_rate : float
        Eq. (23), (55).
    turn : float
        e_t' = turn e_n and e_n' = -turn e_t, Eqs. (24), (25), (53), (54).
    size_rate, c_rate : float
        |t|' and c'.
    """
    w_t = e_t[0] * w[0] + e_t[1] * w[1]
    w_n = e_n[0] * w[0] + e_n[1] * w[1]
    v1_t = e_t[0] * v1[0] + e_t[1] * v1[1]
    v1_n = e_n[0] * v1[0] + e_n[1] * v1[1]
    xi_rate = (size * w_t + g_n * v1_n) / c
    turn = (alpha * w_t + size * v1_n) / c
    size_rate = beta * xi_rate + v1_t
    alpha_rate = -turn * beta + gamma * xi_rate + e_n[0] * v2[0] + e_n[1] * v2[1]
    c_rate = 2.0 * size * size_rate - w_n * alpha - g_n * alpha_rate
    return xi_rate, w_n, turn, size_rate, c_rate

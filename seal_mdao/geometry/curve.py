"""Points of a rigid curve and their design velocities at a natural coordinate of one of its pieces."""

import numpy as np

from seal_mdao.compilation import inlined, internal

LINE, ARC, CUBIC = 0, 1, 2

END_SLACK = 1e-12
"""Fraction of its length by which the polynomial of a cubic piece extends beyond its ends, so that a
joint met to rounding has its curvature; beyond, the piece continues along its tangent."""


def has_cubics(profile) -> bool:
    """Return whether a profile has cubic pieces, so that |t| varies; it is 1 on lines and arcs."""
    return profile.coefficient is not None


@internal
def cubic_point(coefficients, piece, length, s):
    """Evaluate sum_k c_k s^k and its three derivatives as pairs, continued along the end tangents.

    ``coefficients`` (n, 4, 2) are those of all pieces; None, without cubic ones, is never evaluated.
    """
    if coefficients is None:
        return (0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)
    coefficient = coefficients[piece]
    # s beyond an end: evaluate at the end and continue along the tangent there
    slack, beyond = END_SLACK * length, 0.0
    if s < -slack:
        beyond, s = s, 0.0
    elif s > length + slack:
        beyond, s = s - length, length
    c0, c1, c2, c3 = coefficient[0], coefficient[1], coefficient[2], coefficient[3]
    # t = c_1 + 2 c_2 s + 3 c_3 s^2
    tx = c1[0] + s * (2.0 * c2[0] + 3.0 * s * c3[0])
    ty = c1[1] + s * (2.0 * c2[1] + 3.0 * s * c3[1])
    # x_c = c_0 + c_1 s + c_2 s^2 + c_3 s^3
    x = c0[0] + s * (c1[0] + s * (c2[0] + s * c3[0]))
    y = c0[1] + s * (c1[1] + s * (c2[1] + s * c3[1]))
    # x_c(end) + (s - end) t(end), without curvature
    if beyond != 0.0:
        return (x + beyond * tx, y + beyond * ty), (tx, ty), (0.0, 0.0), (0.0, 0.0)
    return (
        (x, y),
        (tx, ty),
        # x_c,xixi = 2 c_2 + 6 c_3 s,  x_c,xixixi = 6 c_3
        (2.0 * c2[0] + 6.0 * s * c3[0], 2.0 * c2[1] + 6.0 * s * c3[1]),
        (6.0 * c3[0], 6.0 * c3[1]),
    )


@internal
def _cubic_velocity(coefficients, rates, shape, piece, length, s, ds):
    """Evaluate V_c, V_c,xi, V_c,xixi of a cubic piece."""
    if coefficients is None:
        return (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)
    v, v1, v2, _ = cubic_point(rates[shape], piece, length, s)
    _, t, x2, x3 = cubic_point(coefficients, piece, length, s)
    return (
        # with s = xi - start, s' = -start':
        # V_c = sum_k c_k' s^k + s' t,  V_c,xi = sum_k c_k' k s^(k-1) + s' x_c,xixi,  and once more
        (v[0] + ds * t[0], v[1] + ds * t[1]),
        (v1[0] + ds * x2[0], v1[1] + ds * x2[1]),
        (v2[0] + ds * x3[0], v2[1] + ds * x3[1]),
    )


@inlined
def curve_point(profile, piece, xi):
    """Evaluate x_c, Eq. (16), and its derivatives t, x_c,xixi, x_c,xixixi, as four pairs."""
    s = xi - profile.start[piece]
    ox, oy = profile.origin[piece, 0], profile.origin[piece, 1]
    if profile.kind[piece] == LINE:
        # line: x_c = o + s u,  t = u
        c, n = np.cos(profile.angle[piece]), np.sin(profile.angle[piece])
        return (ox + s * c, oy + s * n), (c, n), (0.0, 0.0), (0.0, 0.0)
    if profile.kind[piece] == CUBIC:
        return cubic_point(profile.coefficient, piece, profile.length[piece], s)
    # arc: x_c = o + |r| u(a),  a = angle + s / r,  u = (cos a, sin a),  w = (-sin a, cos a)
    r = profile.radius[piece]
    a = profile.angle[piece] + s / r
    c, n = np.cos(a), np.sin(a)
    # t = sgn(r) w,  x_c,xixi = -u / |r|,  x_c,xixixi = -sgn(r) w / r^2
    size = abs(r)
    turn = 1.0 if r > 0.0 else -1.0
    return (
        (ox + size * c, oy + size * n),
        (-turn * n, turn * c),
        (-c / size, -n / size),
        (turn * n / (r * r), -turn * c / (r * r)),
    )


@inlined
def curve_velocity(profile, shape, piece, xi):
    """Evaluate the design velocity V_c of Eq. (49) at fixed xi, V_c,xi and V_c,xixi, as three pairs.

    Parameters
    ----------
    shape : int
        Index of the shape parameter.
    """
    s, ds = xi - profile.start[piece], -profile.start_rate[shape, piece]
    if profile.kind[piece] == CUBIC:
        return _cubic_velocity(
            profile.coefficient,
            profile.coefficient_rate,
            shape,
            piece,
            profile.length[piece],
            s,
            ds,
        )
    ox, oy = profile.origin_rate[shape, piece, 0], profile.origin_rate[shape, piece, 1]
    da = profile.angle_rate[shape, piece]
    if profile.kind[piece] == LINE:
        # rate of a line, u = (cos a, sin a), w = (-sin a, cos a):
        # V_c = o' + s' u + s a' w,  V_c,xi = a' w,  V_c,xixi = 0
        c, n = np.cos(profile.angle[piece]), np.sin(profile.angle[piece])
        return (
            (ox + ds * c - s * da * n, oy + ds * n + s * da * c),
            (-da * n, da * c),
            (0.0, 0.0),
        )
    r, dr = profile.radius[piece], profile.radius_rate[shape, piece]
    a = profile.angle[piece] + s / r
    c, n = np.cos(a), np.sin(a)
    turn = 1.0 if r > 0.0 else -1.0
    size, dsize = abs(r), turn * dr
    # a = angle + s / r:  a' = angle' + s' / r - s r' / r^2,  (a')_,xi = -r' / r^2
    rate = da + ds / r - s * dr / (r * r)
    rate_1 = -dr / (r * r)
    k = 1.0 / r
    # V_c = o' + |r|' u + |r| a' w
    v_u, v_w = dsize, size * rate
    # u_,xi = k w, w_,xi = -k u:  V_c,xi = -k |r| a' u + (k |r|' + |r| (a')_,xi) w, and once more
    v1_u, v1_w = -k * v_w, k * v_u + size * rate_1
    v2_u, v2_w = -k * size * rate_1 - k * v1_w, k * v1_u
    return (
        (ox + v_u * c - v_w * n, oy + v_u * n + v_w * c),
        (v1_u * c - v1_w * n, v1_u * n + v1_w * c),
        (v2_u * c - v2_w * n, v2_u * n + v2_w * c),
    )

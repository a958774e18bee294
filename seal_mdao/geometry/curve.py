"""Points of a rigid curve and their design velocities at a natural coordinate of one of its pieces."""

import numpy as np

from seal_mdao.compilation import inlined, internal

LINE, ARC, CUBIC = 0, 1, 2

END_SLACK = 1e-12
"""Share of its length by which the polynomial of a cubic piece reaches beyond its ends, so that a
joint met to rounding has its curvature; beyond, the piece goes on along its tangent."""


def has_cubics(profile) -> bool:
    """Whether |t| varies along a profile; it is one on lines and arcs."""
    return profile.coefficient is not None


@internal
def cubic_point(coefficients, piece, length, s):
    """sum_k c_k s^k and its three derivatives as pairs, continued along the tangent at the ends.

    ``coefficients`` (n, 4, 2) are those of all pieces; None, without cubic ones, is never asked for.
    """
    if coefficients is None:
        return (0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)
    coefficient = coefficients[piece]
    slack, beyond = END_SLACK * length, 0.0
    if s < -slack:
        beyond, s = s, 0.0
    elif s > length + slack:
        beyond, s = s - length, length
    c0, c1, c2, c3 = coefficient[0], coefficient[1], coefficient[2], coefficient[3]
    tx = c1[0] + s * (2.0 * c2[0] + 3.0 * s * c3[0])
    ty = c1[1] + s * (2.0 * c2[1] + 3.0 * s * c3[1])
    x = c0[0] + s * (c1[0] + s * (c2[0] + s * c3[0]))
    y = c0[1] + s * (c1[1] + s * (c2[1] + s * c3[1]))
    if beyond != 0.0:
        return (x + beyond * tx, y + beyond * ty), (tx, ty), (0.0, 0.0), (0.0, 0.0)
    return (
        (x, y),
        (tx, ty),
        (2.0 * c2[0] + 6.0 * s * c3[0], 2.0 * c2[1] + 6.0 * s * c3[1]),
        (6.0 * c3[0], 6.0 * c3[1]),
    )


@internal
def _cubic_velocity(coefficients, rates, shape, piece, length, s, ds):
    """V_c, V_c,xi, V_c,xixi of a cubic piece."""
    if coefficients is None:
        return (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)
    v, v1, v2, _ = cubic_point(rates[shape], piece, length, s)
    _, t, x2, x3 = cubic_point(coefficients, piece, length, s)
    return (
        (v[0] + ds * t[0], v[1] + ds * t[1]),
        (v1[0] + ds * x2[0], v1[1] + ds * x2[1]),
        (v2[0] + ds * x3[0], v2[1] + ds * x3[1]),
    )


@inlined
def curve_point(profile, piece, xi):
    """x_c and its derivatives: ((x, y), t, x_c,xixi, x_c,xixixi) as four pairs."""
    s = xi - profile.start[piece]
    ox, oy = profile.origin[piece, 0], profile.origin[piece, 1]
    if profile.kind[piece] == LINE:
        c, n = np.cos(profile.angle[piece]), np.sin(profile.angle[piece])
        return (ox + s * c, oy + s * n), (c, n), (0.0, 0.0), (0.0, 0.0)
    if profile.kind[piece] == CUBIC:
        return cubic_point(profile.coefficient, piece, profile.length[piece], s)
    r = profile.radius[piece]
    a = profile.angle[piece] + s / r
    c, n = np.cos(a), np.sin(a)
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
    """Design velocity V_c of Eq. (49) at fixed xi with V_c,xi and V_c,xixi, as three pairs.

    Parameters
    ----------
    shape : int
        Which of the shape parameters changes.
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
    rate = da + ds / r - s * dr / (r * r)  # a'
    rate_1 = -dr / (r * r)  # (a')_,xi
    k = 1.0 / r
    # V = o' + dsize u + size a' w, with u = (cos, sin), w = (-sin, cos), u_,xi = k w, w_,xi = -k u
    v_u, v_w = dsize, size * rate
    v1_u, v1_w = -k * v_w, k * v_u + size * rate_1
    v2_u, v2_w = -k * size * rate_1 - k * v1_w, k * v1_u
    return (
        (ox + v_u * c - v_w * n, oy + v_u * n + v_w * c),
        (v1_u * c - v1_w * n, v1_u * n + v1_w * c),
        (v2_u * c - v2_w * n, v2_u * n + v2_w * c),
    )

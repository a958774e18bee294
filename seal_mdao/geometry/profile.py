"""Rigid profiles x_c(xi) of Eq. (16), made of lines and circular arcs, and their design velocity.

The natural coordinate xi is the arc length, so |t| = 1 on every piece. A profile moves rigidly along
the load path: coordinates here are relative to that motion. The body lies on the left of the curve
when it is walked with growing xi; the unit outward normal e_n is e_t turned clockwise.
"""

from typing import NamedTuple

import numba as nb
import numpy as np

from seal_mdao.geometry.bounds import bounding_circles

LINE, ARC = 0, 1

PROFILE_EXTENT = 100.0
"""Length of the straight end pieces (mm for the door); they continue beyond it."""


class RigidProfile(NamedTuple):
    """Pieces of a rigid curve and their derivatives with respect to one shape parameter.

    Attributes
    ----------
    kind : ndarray of int, shape (n,)
        LINE or ARC.
    origin : ndarray, shape (n, 2)
        Start of a line, centre of an arc.
    angle : ndarray, shape (n,)
        Direction of a line; polar angle of the start of an arc.
    radius : ndarray, shape (n,)
        Radius of an arc, positive when walked counter-clockwise (1 for lines).
    start, length : ndarray, shape (n,)
        Natural coordinate at the start of the piece, and its extent.
    origin_rate, angle_rate, radius_rate, start_rate : ndarray
        Derivatives with respect to the shape parameter (the corner radius of a door).
    run_centre, run_radius : ndarray, shapes (b, 2), (b,)
        Circles of ``geometry.bounds`` around runs of pieces.
    """

    kind: np.ndarray
    origin: np.ndarray
    angle: np.ndarray
    radius: np.ndarray
    start: np.ndarray
    length: np.ndarray
    origin_rate: np.ndarray
    angle_rate: np.ndarray
    radius_rate: np.ndarray
    start_rate: np.ndarray
    run_centre: np.ndarray
    run_radius: np.ndarray

    @classmethod
    def of(cls, kind, origin, angle, radius, start, length, *rates):
        """The profile of these pieces, with the circles around them."""
        circles = bounding_circles(kind == LINE, origin, angle, radius, length)
        return cls(kind, origin, angle, radius, start, length, *rates, *circles)


@nb.njit(cache=True, error_model="numpy", inline="always")
def curve_point(profile, piece, xi):
    """x_c and its derivatives: ((x, y), t, x_c,xixi, x_c,xixixi) as four pairs."""
    s = xi - profile.start[piece]
    ox, oy = profile.origin[piece, 0], profile.origin[piece, 1]
    if profile.kind[piece] == LINE:
        c, n = np.cos(profile.angle[piece]), np.sin(profile.angle[piece])
        return (ox + s * c, oy + s * n), (c, n), (0.0, 0.0), (0.0, 0.0)
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


@nb.njit(cache=True, error_model="numpy", inline="always")
def curve_velocity(profile, piece, xi):
    """Design velocity V_c of Eq. (49) at fixed xi with V_c,xi and V_c,xixi, as three pairs."""
    s, ds = xi - profile.start[piece], -profile.start_rate[piece]
    ox, oy = profile.origin_rate[piece, 0], profile.origin_rate[piece, 1]
    da = profile.angle_rate[piece]
    if profile.kind[piece] == LINE:
        c, n = np.cos(profile.angle[piece]), np.sin(profile.angle[piece])
        return (
            (ox + ds * c - s * da * n, oy + ds * n + s * da * c),
            (-da * n, da * c),
            (0.0, 0.0),
        )
    r, dr = profile.radius[piece], profile.radius_rate[piece]
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


def _profile(pieces, rates) -> RigidProfile:
    kind, origin, angle, radius, length = (np.array(column) for column in zip(*pieces, strict=True))
    d_origin, d_angle, d_radius, d_length = (
        np.array(column, float) for column in zip(*rates, strict=True)
    )
    start = np.concatenate([[0.0], np.cumsum(length)[:-1]])
    d_start = np.concatenate([[0.0], np.cumsum(d_length)[:-1]])
    return RigidProfile.of(
        kind.astype(np.int64), origin.astype(float), angle.astype(float), radius.astype(float),
        start, length.astype(float), d_origin, d_angle, d_radius, d_start,
    )  # fmt: skip


def flat_profile(extent: float = PROFILE_EXTENT) -> RigidProfile:
    """A flat lower face through y = 0, outward normal (0, -1); the end pieces of a profile extend."""
    return _profile([(LINE, (-extent, 0.0), 0.0, 1.0, 2 * extent)], [((0.0, 0.0), 0.0, 0.0, 0.0)])


def corner_profile(corner_x: float, radius: float, side: float, extent: float = PROFILE_EXTENT):
    """Flat at y = 0, quarter circle, vertical side: the door, exact line-arc-line form.

    Parameters
    ----------
    corner_x : float
        Where the flat ends for the drawn radius; ``corner_x + drawn radius = side``.
    radius : float
        Corner radius; its derivative is the one carried.
    side : float
        x of the vertical side, which stays where it is when the radius changes.
    """
    flat_end = side - radius
    quarter = 0.5 * np.pi
    return _profile(
        [
            (LINE, (corner_x - extent, 0.0), 0.0, 1.0, flat_end - corner_x + extent),
            (ARC, (flat_end, radius), -quarter, radius, quarter * radius),
            (LINE, (side, radius), quarter, 1.0, extent),
        ],
        [
            ((0.0, 0.0), 0.0, 0.0, -1.0),
            ((-1.0, 1.0), 0.0, 1.0, quarter),
            ((0.0, 1.0), 0.0, 0.0, 0.0),
        ],
    )


def segmented_corner_profile(
    corner_x: float, radius: float, side: float, segments: int, extent: float = PROFILE_EXTENT
):
    """The door as ``segments`` straight pieces: the flat, the side, and chords of the arc."""
    angle = np.linspace(-0.5 * np.pi, 0.0, segments - 1)
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    arc = np.array([side - radius, radius]) + radius * unit
    arc_rate = np.array([-1.0, 1.0]) + unit
    first, last = [corner_x - extent, 0.0], [side, radius + extent]
    return polyline_profile(
        np.vstack([first, arc, last]), np.vstack([[0.0, 0.0], arc_rate, [0.0, 1.0]])
    )


def polyline_profile(vertices: np.ndarray, rates: np.ndarray | None = None) -> RigidProfile:
    """Straight segments through ``vertices`` (n, 2), with the vertices' design velocity ``rates``."""
    vertices = np.asarray(vertices, float)
    rates = np.zeros_like(vertices) if rates is None else np.asarray(rates, float)
    edge, edge_rate = np.diff(vertices, axis=0), np.diff(rates, axis=0)
    length = np.hypot(*edge.T)
    d_length = np.einsum("ni,ni->n", edge, edge_rate) / length
    turn = (edge[:, 0] * edge_rate[:, 1] - edge[:, 1] * edge_rate[:, 0]) / length**2
    angle = np.arctan2(edge[:, 1], edge[:, 0])
    one, zero = np.ones(len(edge)), np.zeros(len(edge))
    return _profile(
        list(zip(zero, vertices[:-1], angle, one, length, strict=True)),
        list(zip(rates[:-1], turn, zero, d_length, strict=True)),
    )


def circle_profile(centre, radius: float) -> RigidProfile:
    """A rigid cylinder walked counter-clockwise from its lowest point; carries d/d(radius)."""
    return _profile(
        [(ARC, tuple(centre), -0.5 * np.pi, radius, 2 * np.pi * radius)],
        [((0.0, 0.0), 0.0, 1.0, 2 * np.pi)],
    )


def trace(profile: RigidProfile, spacing: float, reach: float) -> np.ndarray:
    """Points along the profile for pictures, shape (n, 2), within ``reach`` of the origin."""
    points = []
    for piece in range(len(profile.kind)):
        count = 2 if profile.kind[piece] == LINE else 2 + int(profile.length[piece] / spacing)
        for s in np.linspace(0.0, profile.length[piece], count):
            points.append(curve_point(profile, piece, profile.start[piece] + s)[0])
    return np.clip(np.array(points), -reach, reach)

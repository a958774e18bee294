"""Rigid profiles x_c(xi) of Eq. (16), made of lines, circular arcs and cubics, and their velocities.

On lines and arcs the natural coordinate xi is the arc length, |t| = 1; on cubic pieces it is any
parameter, |t| != 1. A profile moves rigidly along the load path: coordinates here are in its own
frame. The rigid body lies on the left of the curve for increasing xi; the unit outward normal e_n is
e_t rotated clockwise by 90 degrees.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seal_mdao.geometry.bounds import bounding_circles, circles_of_cubics
from seal_mdao.geometry.curve import ARC, CUBIC, LINE, curve_point

PROFILE_EXTENT = 100.0
"""Length of the straight end pieces (mm for the door); they continue beyond it."""


RATES = (
    "origin_rate", "angle_rate", "radius_rate", "start_rate", "coefficient_rate", "period_rate",
)  # fmt: skip


class RigidProfile(NamedTuple):
    """Pieces of a rigid curve and their derivatives with respect to S shape parameters.

    ``rigid_profile`` and the functions of this module and of ``spline_profile`` make them.

    Attributes
    ----------
    kind : ndarray of int, shape (n,)
        LINE, ARC or CUBIC.
    origin : ndarray, shape (n, 2)
        Start of a line, centre of an arc, centre of a circle around a cubic.
    angle : ndarray, shape (n,)
        Direction of a line; polar angle of the start of an arc.
    radius : ndarray, shape (n,)
        Radius of an arc, positive if traversed counter-clockwise (1 for lines); radius of the circle
        around a cubic.
    start, length : ndarray, shape (n,)
        Natural coordinate at the start of the piece, and its extent.
    coefficient : ndarray, shape (n, 4, 2), or None
        Of 1, s, s^2, s^3 with s = xi - start on cubic pieces, zero on others. None without cubic pieces:
        numba then compiles nothing for them.
    period : float
        Range of the natural coordinate over a closed profile, 0 for one that is not closed.
    origin_rate, angle_rate, radius_rate, start_rate, coefficient_rate, period_rate : ndarray
        Derivatives with respect to the shape parameters (the corner radius of a door), a leading
        axis of length S each. The extent of a cubic piece does not change with the shape;
        ``coefficient_rate`` is None where ``coefficient`` is.
    run_centre, run_radius : ndarray, shapes (b, 2), (b,)
        Circles of ``geometry.bounds`` around runs of pieces.
    """

    kind: np.ndarray
    origin: np.ndarray
    angle: np.ndarray
    radius: np.ndarray
    start: np.ndarray
    length: np.ndarray
    coefficient: np.ndarray | None
    period: float
    origin_rate: np.ndarray
    angle_rate: np.ndarray
    radius_rate: np.ndarray
    start_rate: np.ndarray
    coefficient_rate: np.ndarray | None
    period_rate: np.ndarray
    run_centre: np.ndarray
    run_radius: np.ndarray

    @property
    def n_shapes(self) -> int:
        """Number S of shape parameters."""
        return self.period_rate.size

    @property
    def curve(self) -> "RigidProfile":
        """Profile without its rates, for kernels that do not need them: they compile faster, and
        once for all profiles."""
        return self._replace(**dict.fromkeys(RATES))


class Pieces(NamedTuple):
    """Pieces of a rigid curve; attributes as those of ``RigidProfile``.

    Origin and radius of cubic pieces are computed from their coefficients.
    """

    kind: Sequence
    origin: Sequence
    angle: Sequence
    radius: Sequence
    start: Sequence
    length: Sequence
    coefficient: Sequence | None = None


class PieceRates(NamedTuple):
    """Derivatives of pieces and period with respect to S shape parameters; empty ones are zero."""

    origin: Sequence = ()
    angle: Sequence = ()
    radius: Sequence = ()
    start: Sequence = ()
    coefficient: Sequence = ()
    period: Sequence = ()


FIXED = PieceRates()
"""No shape parameters."""


def _piece_circles(kind, origin, radius, length, coefficient):
    """Fill in ``origin`` and ``radius`` of the circles around cubic pieces."""
    if coefficient is None:
        return origin, radius
    centre, reach = circles_of_cubics(coefficient, length)
    cubic = kind == CUBIC
    return np.where(cubic[:, None], centre, origin), np.where(cubic, reach, radius)


def rigid_profile(pieces: Pieces, rates: PieceRates = FIXED, period: float = 0.0) -> RigidProfile:
    """Build a rigid profile from its pieces and their rates.

    Parameters
    ----------
    period : float
        As in ``RigidProfile``; 0 for a profile that is not closed.
    """
    kind = np.array(pieces.kind, np.int64)
    origin, angle, radius, start, length = (np.array(own, float) for own in pieces[1:6])
    rates = _filled(rates, len(kind))
    if (kind == CUBIC).any():
        coefficient = np.array(pieces.coefficient, float)
    else:
        coefficient, rates = None, rates._replace(coefficient=None)
    origin, radius = _piece_circles(kind, origin, radius, length, coefficient)
    circles = bounding_circles(kind == LINE, origin, angle, radius, length, period > 0.0)
    return RigidProfile(
        kind, origin, angle, radius, start, length, coefficient, float(period), *rates, *circles
    )


def _filled(rates: PieceRates, n: int) -> PieceRates:
    """Make the rates of ``n`` pieces arrays (S, ...), zero where they are empty."""
    shapes = PieceRates((n, 2), (n,), (n,), (n,), (n, 4, 2), ())
    count = max(map(len, rates))
    return PieceRates(*(
        np.array(rate if len(rate) else np.zeros((count, *shape)), float).reshape(count, *shape)
        for rate, shape in zip(rates, shapes, strict=True)
    ))  # fmt: skip


def _profile(pieces, *shapes, period=0.0, period_rate=()) -> RigidProfile:
    """Build the profile of pieces (kind, origin, angle, radius, length) and, for every shape parameter,
    the rates (origin, angle, radius, length) of all pieces."""
    kind, origin, angle, radius, length = (np.array(column) for column in zip(*pieces, strict=True))
    rates = []
    for shape in shapes:
        # starts of the pieces and their rates: sums of the lengths before
        *columns, d_length = (np.array(column, float) for column in zip(*shape, strict=True))
        rates.append((*columns, _starts(d_length)))
    return rigid_profile(
        Pieces(kind, origin, angle, radius, _starts(length), length),
        PieceRates(*zip(*rates, strict=True), period=period_rate), period,
    )  # fmt: skip


def _starts(length) -> np.ndarray:
    # xi_k = sum of the lengths of the pieces before k; linear, so that it gives the rates too
    return np.concatenate([[0.0], np.cumsum(length)[:-1]])


def flat_profile(extent: float = PROFILE_EXTENT) -> RigidProfile:
    """Build a flat lower face through y = 0, outward normal (0, -1), without ends."""
    return _profile([(LINE, (-extent, 0.0), 0.0, 1.0, 2 * extent)])


def corner_profile(corner_x: float, radius: float, side: float, extent: float = PROFILE_EXTENT):
    """Build the door: flat at y = 0, quarter circle, vertical side, exact line-arc-line form.

    Parameters
    ----------
    corner_x : float
        x at which the flat ends for the nominal radius; ``corner_x + nominal radius = side``.
    radius : float
        Corner radius R, the shape parameter.
    side : float
        x of the vertical side, which does not change with the radius.
    """
    # arc of centre (side - R, R) from the angle -pi/2 to 0
    flat_end = side - radius
    quarter = 0.5 * np.pi
    return _profile(
        [
            (LINE, (corner_x - extent, 0.0), 0.0, 1.0, flat_end - corner_x + extent),
            (ARC, (flat_end, radius), -quarter, radius, quarter * radius),
            (LINE, (side, radius), quarter, 1.0, extent),
        ],
        [
            # d/dR of (origin, angle, radius, length); arc length pi R / 2
            ((0.0, 0.0), 0.0, 0.0, -1.0),
            ((-1.0, 1.0), 0.0, 1.0, quarter),
            ((0.0, 1.0), 0.0, 0.0, 0.0),
        ],
    )


def segmented_corner_profile(
    corner_x: float, radius: float, side: float, segments: int, extent: float = PROFILE_EXTENT
):
    """Build the door of ``segments`` straight pieces: the flat, the side, and chords of the arc."""
    angle = np.linspace(-0.5 * np.pi, 0.0, segments - 1)
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    # x = (side - R, R) + R u,  dx/dR = (-1, 1) + u
    arc = np.array([side - radius, radius]) + radius * unit
    arc_rate = np.array([-1.0, 1.0]) + unit
    first, last = [corner_x - extent, 0.0], [side, radius + extent]
    return polyline_profile(
        np.vstack([first, arc, last]), np.vstack([[0.0, 0.0], arc_rate, [0.0, 1.0]])[np.newaxis]
    )


def polyline_profile(vertices: np.ndarray, rates: np.ndarray | None = None) -> RigidProfile:
    """Build straight segments through ``vertices`` (n, 2), with design velocities ``rates`` (S, n, 2)
    of the vertices, if any."""
    vertices = np.asarray(vertices, float)
    edge = np.diff(vertices, axis=0)
    angle, length = np.arctan2(edge[:, 1], edge[:, 0]), np.hypot(*edge.T)
    one, zero = np.ones(len(edge)), np.zeros(len(edge))
    shapes = []
    for rate in np.zeros((0, *vertices.shape)) if rates is None else np.asarray(rates, float):
        edge_rate = np.diff(rate, axis=0)
        # L' = e . e' / L,  angle' = (e x e') / L^2
        d_length = np.einsum("ni,ni->n", edge, edge_rate) / length
        turn = (edge[:, 0] * edge_rate[:, 1] - edge[:, 1] * edge_rate[:, 0]) / length**2
        shapes.append(list(zip(rate[:-1], turn, zero, d_length, strict=True)))
    return _profile(list(zip(zero, vertices[:-1], angle, one, length, strict=True)), *shapes)


def circle_profile(centre, radius: float) -> RigidProfile:
    """Build a rigid cylinder, counter-clockwise from its lowest point, with the radius as parameter."""
    return _profile(
        # L = 2 pi R,  d/dR: radius 1, length and period 2 pi
        [(ARC, tuple(centre), -0.5 * np.pi, radius, 2 * np.pi * radius)],
        [((0.0, 0.0), 0.0, 1.0, 2 * np.pi)],
        period=2 * np.pi * radius,
        period_rate=[2 * np.pi],
    )


def trace(profile: RigidProfile, spacing: float, reach: float) -> np.ndarray:
    """Sample points along the profile for plots, shape (n, 2), within ``reach`` of the origin."""
    points = []
    last = len(profile.kind) - 1
    for piece, (kind, length) in enumerate(zip(profile.kind, profile.length, strict=True)):
        along = {LINE: 0.0, ARC: length, CUBIC: 2.0 * profile.radius[piece]}[int(kind)]
        samples = np.linspace(0.0, length, 2 + int(along / spacing))
        if kind == CUBIC and profile.period == 0.0:
            # the ends of a spline continue along their tangents
            beyond = reach * length / profile.radius[piece]
            samples = np.concatenate([
                [-beyond] * (piece == 0), samples, [length + beyond] * (piece == last)
            ])  # fmt: skip
        points += [curve_point(profile, piece, profile.start[piece] + s)[0] for s in samples]
    return np.clip(np.array(points), -reach, reach)

"""Arcs and circles as segments of a section."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.seals.outline.segments import Segment, pair, point, require, set_numbers, set_points

COLLINEAR = 1e-6
"""Height of a triangle over its longest side below which its corners lie on one line."""


def circle_through(points) -> tuple[np.ndarray, float, int]:
    """Fit a circle to points (k, 2) by least squares: its centre (2,) and radius, and the rank of the
    equations, 3 unless the points lie on one line."""
    # |x - c|^2 = R^2 is linear in c and R^2 - c . c; coordinates from the mean of the points
    mean = points.mean(axis=0)
    x = points - mean
    matrix = np.column_stack([2.0 * x, np.ones(len(x))])
    found, _, rank, _ = np.linalg.lstsq(matrix, (x**2).sum(axis=1), rcond=None)
    # R^2 = (R^2 - c . c) + c . c
    return mean + found[:2], float(np.sqrt(found[2] + found[:2] @ found[:2])), int(rank)


class _Round(Segment):
    """Base of arcs and circles: ``centre``, ``radius``, ``angle`` of the start, ``sweep``."""

    @property
    def length(self) -> float:
        return self.radius * abs(self.sweep)

    @property
    def turning(self) -> float:
        return abs(self.sweep)

    def _directions(self, s):
        # x(s) = c + r (cos phi, sin phi),  phi = phi_0 + s sweep
        phi = self.angle + self.sweep * np.asarray(s, float)
        return np.column_stack([np.cos(phi), np.sin(phi)])

    def points(self, s):
        return np.array(self.centre) + self.radius * self._directions(s)

    def tangents(self, s):
        # t = sign(sweep) (-sin phi, cos phi),  curvature sign(sweep) / r
        u = self._directions(s)
        return np.copysign(1.0, self.sweep) * np.column_stack([-u[:, 1], u[:, 0]])

    def curvature(self, s):
        return np.full(np.size(s), np.copysign(1.0 / self.radius, self.sweep))

    def divided(self, s):
        # phi_0 to phi_0 + s sweep, and the rest; of a circle too
        first, rest = s * self.sweep, (1.0 - s) * self.sweep
        return (
            Arc(self.centre, self.radius, self.angle, first, self.edge),
            Arc(self.centre, self.radius, self.angle + first, rest, self.edge),
        )

    @property
    def area(self):
        # 1/2 int x dy - y dx with x = c + r e_r: sector r^2 sweep / 2 and 1/2 c x (x_1 - x_0)
        (x0, y0), (x1, y1) = self.points([0.0, 1.0]) - self.centre
        x, y = self.centre
        return 0.5 * (self.radius**2 * self.sweep + x * (y1 - y0) - y * (x1 - x0))


@dataclass(frozen=True)
class Arc(_Round):
    """Part of a circle.

    Attributes
    ----------
    centre : pair of float
        mm.
    radius : float
        mm.
    angle : float
        Polar angle of its start about the centre, radians.
    sweep : float
        Angle from start to end, positive counter-clockwise, less than a full turn, radians.

    Raises
    ------
    GeometryError
        For values that are no numbers, a radius that is not positive, a sweep of zero or a full turn.
    """

    centre: tuple[float, float]
    radius: float
    angle: float
    sweep: float
    edge: str = ""

    def __post_init__(self):
        set_points(self, "centre")
        set_numbers(self, "radius", "angle", "sweep")
        require(self.radius > 0.0, f"the radius of an arc must be positive, got {self.radius:g}")
        require(
            0.0 < abs(self.sweep) < 2.0 * np.pi,
            "the angle of an arc must be between 0 and 360 degrees, got "
            f"{np.degrees(self.sweep):g}; use a circle instead of an arc for 360 degrees",
        )

    @classmethod
    def through(cls, start, through, end, edge: str = "") -> "Arc":
        """Construct the arc from ``start`` to ``end`` through a third point.

        Raises
        ------
        GeometryError
            For points that are no numbers, coincide, or lie on one line.
        """
        a, b, c = (
            np.array(point(value, name))
            for value, name in ((start, "start"), (through, "through"), (end, "end"))
        )
        for p, q, names in ((a, b, "start and through"), (b, c, "through and end"),
                            (a, c, "start and end")):  # fmt: skip
            require(
                (p != q).any(),
                f"{names} of an arc coincide at {pair(p)}; give three different points",
            )
        u, v = b - a, c - a
        # twice the area of the triangle over the square of its longest side: flatness
        cross = u[0] * v[1] - u[1] * v[0]
        longest = max(u @ u, v @ v, (c - b) @ (c - b))
        require(
            abs(cross) > COLLINEAR * longest,
            f"start {pair(a)}, through {pair(b)} and end {pair(c)} of an arc are collinear; use a "
            "line instead of an arc",
        )
        # circumcentre c - a = (v_y u.u - u_y v.v, u_x v.v - v_x u.u) / (2 u x v)
        to_centre = np.array([v[1] * (u @ u) - u[1] * (v @ v), u[0] * (v @ v) - v[0] * (u @ u)])
        to_centre /= 2.0 * cross
        centre = a + to_centre
        first, last = (np.arctan2(*(p - centre)[::-1]) for p in (a, c))
        # counter-clockwise if the three points turn to the left, else clockwise
        sweep = (last - first) % (2.0 * np.pi) - (2.0 * np.pi if cross < 0.0 else 0.0)
        return cls(tuple(centre), float(np.hypot(*to_centre)), float(first), float(sweep), edge)

    @classmethod
    def bulged(cls, start, end, bulge: float, edge: str = "") -> "Arc":
        """Construct the arc with ``bulge`` b = tan(sweep / 4), as in polylines of drawings."""
        a, c = np.array(point(start, "start")), np.array(point(end, "end"))
        require((a != c).any(), f"start and end of an arc coincide at {pair(a)}")
        chord = c - a
        middle = 0.5 * (a + c)
        # centre = middle + (1 - b^2) / (4 b) times the chord turned to the left
        away = (1.0 - bulge * bulge) / (4.0 * bulge)
        centre = middle + away * np.array([-chord[1], chord[0]])
        first = np.arctan2(*(a - centre)[::-1])
        # r = |chord| (1 + b^2) / (4 |b|)
        radius = np.hypot(*chord) * (1.0 + bulge * bulge) / (4.0 * abs(bulge))
        return cls(tuple(centre), float(radius), float(first), float(4.0 * np.arctan(bulge)), edge)

    def reversed(self):
        return replace(self, angle=self.angle + self.sweep, sweep=-self.sweep)

    def between(self, start, end):
        if tuple(start) == tuple(end):
            return Circle(self.centre, self.radius, self.edge, self.sweep < 0.0)
        # up to half a turn the sweep is preserved and the centre follows from the new chord
        if abs(self.sweep) <= np.pi:
            return Arc.bulged(start, end, float(np.tan(0.25 * self.sweep)), self.edge)
        # the ends are close to each other: the point between them keeps the radius
        return Arc.through(start, self.points([0.5])[0], end, self.edge)


@dataclass(frozen=True)
class Circle(_Round):
    """A full circle from its rightmost point; mm.

    Raises
    ------
    GeometryError
        For values that are no numbers, or a radius that is not positive.
    """

    centre: tuple[float, float]
    radius: float
    edge: str = ""
    clockwise: bool = False

    angle = 0.0

    def __post_init__(self):
        set_points(self, "centre")
        set_numbers(self, "radius")
        require(self.radius > 0.0, f"the radius of a circle must be positive, got {self.radius:g}")

    @property
    def sweep(self) -> float:
        return -2.0 * np.pi if self.clockwise else 2.0 * np.pi

    def points(self, s):
        # it ends where it begins, to the last bit
        s = np.asarray(s, float)
        return super().points(np.where(s == 1.0, 0.0, s))

    def reversed(self):
        return replace(self, clockwise=not self.clockwise)

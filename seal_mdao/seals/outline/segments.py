"""Segments of a section's boundary: line, arc, circle, cubic spline.

All are walked with s from 0 to 1 in proportion to the arc length. The material lies on the left, so
the outward normal is the tangent turned clockwise.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, hypot, sqrt

import numpy as np

from seal_mdao.errors import GeometryError

COLLINEAR = 1e-6
"""Height of a triangle over its longest side below which its corners lie on one line."""

MOST_CHORDS = 20_000
"""Of one segment; the curvature of a spline may be without bound."""


class Segment:
    """Base class of segments; a subclass is a frozen dataclass.

    Attributes
    ----------
    edge : str
        Name of the edge that it belongs to.
    length : float
        Arc length, mm.
    turning : float
        Integral of |curvature| along it, radians.
    """

    edge: str
    length: float
    turning: float

    def points(self, s) -> np.ndarray:
        """Points at shares ``s`` (k,) of the arc length, shape (k, 2)."""
        raise NotImplementedError

    def tangents(self, s) -> np.ndarray:
        """Unit tangents, shape (k, 2)."""
        raise NotImplementedError

    def curvature(self, s) -> np.ndarray:
        """Signed curvature, positive where it turns to the left, 1/mm, shape (k,)."""
        raise NotImplementedError

    def normals(self, s) -> np.ndarray:
        """Unit normals away from the material, shape (k, 2)."""
        tangent = self.tangents(s)
        return np.column_stack([tangent[:, 1], -tangent[:, 0]])

    def reversed(self) -> "Segment":
        """The same segment walked the other way."""
        raise NotImplementedError

    @property
    def area(self) -> float:
        """Its part of 1/2 the integral of x dy - y dx, mm^2."""
        raise NotImplementedError

    @property
    def start(self) -> np.ndarray:
        """First point, shape (2,)."""
        return self.points([0.0])[0]

    @property
    def end(self) -> np.ndarray:
        """Last point, shape (2,)."""
        return self.points([1.0])[0]

    @property
    def sides(self) -> int:
        """Least number of straight sides: no side turns by more than 45 degrees."""
        return max(1, ceil(self.turning / (0.25 * np.pi) - 1e-9))

    def chords(self, sagitta: float) -> np.ndarray:
        """Shares s of points whose chords are nowhere farther than ``sagitta`` from it, shape (k,)."""
        sharpest = float(np.abs(self.curvature(np.linspace(0.0, 1.0, 16 * self.sides + 1))).max())
        count = min(ceil(self.length * sqrt(sharpest / (8.0 * sagitta))), MOST_CHORDS)
        return np.linspace(0.0, 1.0, max(count, self.sides) + 1)

    def named(self, edge: str) -> "Segment":
        """The same segment of another edge."""
        return replace(self, edge=edge)


@dataclass(frozen=True)
class Line(Segment):
    """Straight from ``first`` to ``last``, mm.

    Raises
    ------
    GeometryError
        For points that are no numbers or coincide.
    """

    first: tuple[float, float]
    last: tuple[float, float]
    edge: str = ""

    turning = 0.0

    def __post_init__(self):
        _set_points(self, "first", "last")
        _require(self.first != self.last, f"a line from {pair(self.first)} to itself has no length")

    @cached_property
    def length(self) -> float:
        return hypot(self.last[0] - self.first[0], self.last[1] - self.first[1])

    def points(self, s):
        s = np.asarray(s, float)[:, None]
        return (1.0 - s) * np.array(self.first) + s * np.array(self.last)

    def tangents(self, s):
        way = np.subtract(self.last, self.first) / self.length
        return np.tile(way, (np.size(s), 1))

    def curvature(self, s):
        return np.zeros(np.size(s))

    def reversed(self):
        return Line(self.last, self.first, self.edge)

    @property
    def area(self):
        return 0.5 * (self.first[0] * self.last[1] - self.first[1] * self.last[0])


class _Round(Segment):
    """What arcs and circles share: ``centre``, ``radius``, ``angle`` of the start, ``sweep``."""

    @property
    def length(self) -> float:
        return self.radius * abs(self.sweep)

    @property
    def turning(self) -> float:
        return abs(self.sweep)

    def _directions(self, s):
        phi = self.angle + self.sweep * np.asarray(s, float)
        return np.column_stack([np.cos(phi), np.sin(phi)])

    def points(self, s):
        return np.array(self.centre) + self.radius * self._directions(s)

    def tangents(self, s):
        u = self._directions(s)
        return np.copysign(1.0, self.sweep) * np.column_stack([-u[:, 1], u[:, 0]])

    def curvature(self, s):
        return np.full(np.size(s), np.copysign(1.0 / self.radius, self.sweep))

    @property
    def area(self):
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
        Angle from start to end, positive counter-clockwise, less than a whole turn, radians.

    Raises
    ------
    GeometryError
        For what is no number, a radius that is not positive, no sweep or a whole turn.
    """

    centre: tuple[float, float]
    radius: float
    angle: float
    sweep: float
    edge: str = ""

    def __post_init__(self):
        _set_points(self, "centre")
        _set_numbers(self, "radius", "angle", "sweep")
        _require(self.radius > 0.0, f"the radius of an arc must be positive, got {self.radius:g}")
        _require(
            0.0 < abs(self.sweep) < 2.0 * np.pi,
            f"an arc must sweep more than nothing and less than a whole turn, got "
            f"{np.degrees(self.sweep):g} degrees; use a circle for a whole turn",
        )

    @classmethod
    def through(cls, start, through, end, edge: str = "") -> "Arc":
        """The arc from ``start`` to ``end`` by way of a third point.

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
            _require((p != q).any(), f"{names} of an arc coincide at {pair(p)}")
        u, v = b - a, c - a
        cross = u[0] * v[1] - u[1] * v[0]
        longest = max(u @ u, v @ v, (c - b) @ (c - b))
        _require(
            abs(cross) > COLLINEAR * longest,
            f"start {pair(a)}, through {pair(b)} and end {pair(c)} of an arc lie on one line; use a "
            "line",
        )
        to_centre = np.array([v[1] * (u @ u) - u[1] * (v @ v), u[0] * (v @ v) - v[0] * (u @ u)])
        to_centre /= 2.0 * cross
        centre = a + to_centre
        first, last = (np.arctan2(*(p - centre)[::-1]) for p in (a, c))
        sweep = (last - first) % (2.0 * np.pi) - (2.0 * np.pi if cross < 0.0 else 0.0)
        return cls(tuple(centre), float(np.hypot(*to_centre)), float(first), float(sweep), edge)

    @classmethod
    def bulged(cls, start, end, bulge: float, edge: str = "") -> "Arc":
        """The arc with ``bulge`` = tan(sweep / 4), as polylines of drawings have it."""
        a, c = np.array(point(start, "start")), np.array(point(end, "end"))
        _require((a != c).any(), f"start and end of an arc coincide at {pair(a)}")
        chord = c - a
        middle = 0.5 * (a + c)
        # the centre lies on the left of the chord by (1 - b^2) / (4 b) of it
        away = (1.0 - bulge * bulge) / (4.0 * bulge)
        centre = middle + away * np.array([-chord[1], chord[0]])
        first = np.arctan2(*(a - centre)[::-1])
        radius = np.hypot(*chord) * (1.0 + bulge * bulge) / (4.0 * abs(bulge))
        return cls(tuple(centre), float(radius), float(first), float(4.0 * np.arctan(bulge)), edge)

    def reversed(self):
        return replace(self, angle=self.angle + self.sweep, sweep=-self.sweep)


@dataclass(frozen=True)
class Circle(_Round):
    """A whole circle, walked from its rightmost point; mm.

    Raises
    ------
    GeometryError
        For what is no number, or a radius that is not positive.
    """

    centre: tuple[float, float]
    radius: float
    edge: str = ""
    clockwise: bool = False

    angle = 0.0

    def __post_init__(self):
        _set_points(self, "centre")
        _set_numbers(self, "radius")
        _require(self.radius > 0.0, f"the radius of a circle must be positive, got {self.radius:g}")

    @property
    def sweep(self) -> float:
        return -2.0 * np.pi if self.clockwise else 2.0 * np.pi

    def points(self, s):
        s = np.asarray(s, float)
        return super().points(
            np.where(s == 1.0, 0.0, s)
        )  # it ends where it begins, to the last bit

    def reversed(self):
        return replace(self, clockwise=not self.clockwise)


def point(value, what: str) -> tuple[float, float]:
    """A pair of finite floats.

    Raises
    ------
    GeometryError
        That says what the value should have been.
    """
    try:
        x, y = (float(v) for v in value)
    except (TypeError, ValueError):
        raise GeometryError(f"{what} must be a point [x, y], got {value!r}") from None
    _require(np.isfinite(x) and np.isfinite(y), f"{what} = {pair((x, y))} is not finite")
    return x, y


def pair(p) -> str:
    """A point for a message."""
    x, y = (round(float(v), 9) + 0.0 for v in p)  # no -0, no rests of rounding
    return f"({x:.6g}, {y:.6g})"


def _set_points(segment, *names) -> None:
    for name in names:
        object.__setattr__(segment, name, point(getattr(segment, name), name))


def _set_numbers(segment, *names) -> None:
    for name in names:
        value = getattr(segment, name)
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise GeometryError(f"{name} must be a number, got {value!r}") from None
        _require(np.isfinite(number), f"{name} = {number} is not finite")
        object.__setattr__(segment, name, number)


def _require(condition, message) -> None:
    if not condition:
        raise GeometryError(message)

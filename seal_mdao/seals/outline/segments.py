"""Segments of a section's boundary: what all have in common, and the line.

All are walked with s from 0 to 1 in proportion to the arc length. The material lies on the left, so
the outward normal is the tangent turned clockwise.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, hypot, sqrt

import numpy as np

from seal_mdao.errors import GeometryError

MOST_CHORDS = 20_000
"""Of one segment; the curvature of a spline may be without bound."""


LARGEST = 1e9
"""Of coordinates and radii, mm: their fourth powers are still numbers."""


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

    def between(self, start, end) -> "Segment":
        """Move its ends to two points nearby, mm.

        The rest moves by less than three times as far; by more where the ends of an arc are closer to
        each other than its radius, which their direction turns.
        """
        raise NotImplementedError

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
        set_points(self, "first", "last")
        require(self.first != self.last, f"a line from {pair(self.first)} to itself has no length")

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

    def between(self, start, end):
        return Line(start, end, self.edge)

    @property
    def area(self):
        return 0.5 * (self.first[0] * self.last[1] - self.first[1] * self.last[0])


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
    _check_size(x, f"{what} = {pair((x, y))}")
    _check_size(y, f"{what} = {pair((x, y))}")
    return x, y


def pair(p) -> str:
    """A point for a message."""
    x, y = (round(float(v), 9) + 0.0 for v in p)  # no -0, no rests of rounding
    return f"({x:.6g}, {y:.6g})"


def _check_size(number: float, where: str) -> None:
    require(np.isfinite(number), f"{where} is not finite")
    require(abs(number) <= LARGEST, f"{where} is beyond {LARGEST:g} mm")


def set_points(segment, *names) -> None:
    """Make the named fields of a segment points."""
    for name in names:
        object.__setattr__(segment, name, point(getattr(segment, name), name))


def set_numbers(segment, *names) -> None:
    """Make the named fields of a segment finite floats."""
    for name in names:
        value = getattr(segment, name)
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise GeometryError(f"{name} must be a number, got {value!r}") from None
        _check_size(number, f"{name} = {number:g}")
        object.__setattr__(segment, name, number)


def require(condition, message) -> None:
    """Raise GeometryError unless the condition holds."""
    if not condition:
        raise GeometryError(message)

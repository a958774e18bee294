"""Segments of a section's boundary: base class, and the line.

The parameter s from 0 to 1 is proportional to the arc length. The material lies on the left, so the
outward normal is the tangent rotated clockwise, n = (t_y, -t_x).
"""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, hypot, sqrt

import numpy as np
import scipy

from seal_mdao.errors import GeometryError

MOST_CHORDS = 20_000
"""Largest number of chords of one segment; the curvature of a spline may be unbounded."""

LARGEST = 1e9
"""Largest coordinates and radii, mm: their fourth powers do not overflow."""


class Segment:
    """Base class of segments; a subclass is a frozen dataclass.

    Attributes
    ----------
    edge : str
        Name of its edge.
    length : float
        Arc length, mm.
    turning : float
        Integral of |curvature| along it, radians.
    """

    edge: str
    length: float
    turning: float

    def points(self, s) -> np.ndarray:
        """Evaluate points at fractions ``s`` (k,) of the arc length, shape (k, 2), mm."""
        raise NotImplementedError

    def tangents(self, s) -> np.ndarray:
        """Evaluate unit tangents, shape (k, 2)."""
        raise NotImplementedError

    def curvature(self, s) -> np.ndarray:
        """Evaluate the signed curvature, positive for a turn to the left, 1/mm, shape (k,)."""
        raise NotImplementedError

    def normals(self, s) -> np.ndarray:
        """Evaluate outward unit normals, shape (k, 2)."""
        # n = t turned clockwise, (t_y, -t_x)
        tangent = self.tangents(s)
        return np.column_stack([tangent[:, 1], -tangent[:, 0]])

    def reversed(self) -> "Segment":
        """Return the segment in the opposite direction."""
        raise NotImplementedError

    @property
    def area(self) -> float:
        """Contribution 1/2 int x dy - y dx to the area of the contour, mm^2."""
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
        """Least number of straight sides such that no side turns by more than 45 degrees."""
        return max(1, ceil(self.turning / (0.25 * np.pi) - 1e-9))

    def chords(self, sagitta: float) -> np.ndarray:
        """Compute fractions s of points whose chords are within ``sagitta`` (mm) of it, shape (k,)."""
        # sagitta of a chord of length h: h^2 curvature / 8, so h = sqrt(8 sagitta / curvature)
        sharpest = float(np.abs(self.curvature(np.linspace(0.0, 1.0, 16 * self.sides + 1))).max())
        count = min(ceil(self.length * sqrt(sharpest / (8.0 * sagitta))), MOST_CHORDS)
        return np.linspace(0.0, 1.0, max(count, self.sides) + 1)

    def between(self, start, end) -> "Segment":
        """Return the segment with its ends moved to two nearby points, mm.

        All other points move by less than three times as far as the ends; by more where the ends of an
        arc are closer to each other than its radius, for their chord then rotates.
        """
        raise NotImplementedError

    def divided(self, s: float) -> tuple["Segment", "Segment"]:
        """Divide the segment at a fraction 0 < ``s`` < 1 of its arc length; both parts follow the
        same curve."""
        raise NotImplementedError

    def nearest(self, point) -> tuple[float, float]:
        """Find the fraction of the arc length nearest to a point, and the distance, mm."""
        # the nearest of many points, then Brent's method between its neighbours, which scipy loads at
        # its first use
        s = np.linspace(0.0, 1.0, 64 * self.sides + 1)
        place = int(np.hypot(*(self.points(s) - point).T).argmin())
        around = s[max(place - 1, 0)], s[min(place + 1, s.size - 1)]
        found = scipy.optimize.minimize_scalar(
            lambda at: float(((self.points([at])[0] - point) ** 2).sum()),
            bounds=around, method="bounded", options={"xatol": 1e-12},
        )  # fmt: skip
        return float(found.x), float(np.sqrt(found.fun))


@dataclass(frozen=True)
class Line(Segment):
    """Straight line from ``first`` to ``last``, mm.

    Raises
    ------
    GeometryError
        For points that are not finite or coincide.
    """

    first: tuple[float, float]
    last: tuple[float, float]
    edge: str = ""

    turning = 0.0

    def __post_init__(self):
        set_points(self, "first", "last")
        require(
            self.first != self.last,
            f"a line of the boundary has zero length, because both ends are {pair(self.first)}; "
            "give two different points",
        )

    @cached_property
    def length(self) -> float:
        return hypot(self.last[0] - self.first[0], self.last[1] - self.first[1])

    def points(self, s):
        # x(s) = (1 - s) a + s b: exact at both ends
        s = np.asarray(s, float)[:, None]
        return (1.0 - s) * np.array(self.first) + s * np.array(self.last)

    def tangents(self, s):
        # t = (b - a) / |b - a|
        direction = np.subtract(self.last, self.first) / self.length
        return np.tile(direction, (np.size(s), 1))

    def curvature(self, s):
        return np.zeros(np.size(s))

    def reversed(self):
        return Line(self.last, self.first, self.edge)

    def between(self, start, end):
        return Line(start, end, self.edge)

    def divided(self, s):
        middle = tuple(self.points([s])[0].tolist())
        return Line(self.first, middle, self.edge), Line(middle, self.last, self.edge)

    def nearest(self, point):
        # s = (p - a) . (b - a) / |b - a|^2, at most from end to end
        along = np.subtract(self.last, self.first)
        s = float(np.clip(np.subtract(point, self.first) @ along / (along @ along), 0.0, 1.0))
        return s, float(np.hypot(*(self.points([s])[0] - point)))

    @property
    def area(self):
        # 1/2 a x b
        return 0.5 * (self.first[0] * self.last[1] - self.first[1] * self.last[0])


def point(value, what: str) -> tuple[float, float]:
    """Check a pair of finite floats and return it; GeometryError with the expected form."""
    try:
        x, y = (float(v) for v in value)
    except (TypeError, ValueError):
        raise GeometryError(f"{what} must be a point [x, y], got {value!r}") from None
    _check_size(x, f"{what} = {pair((x, y))}")
    _check_size(y, f"{what} = {pair((x, y))}")
    return x, y


def pair(p) -> str:
    """Format a point for a message."""
    # no -0, no rounding errors
    x, y = (round(float(v), 9) + 0.0 for v in p)
    return f"({x:.6g}, {y:.6g})"


def _check_size(number: float, where: str) -> None:
    require(np.isfinite(number), f"{where} is not finite")
    require(abs(number) <= LARGEST, f"{where} is beyond {LARGEST:g} mm")


def set_points(segment, *names) -> None:
    """Check and convert the named fields of a segment to points."""
    for name in names:
        object.__setattr__(segment, name, point(getattr(segment, name), name))


def set_numbers(segment, *names) -> None:
    """Check and convert the named fields of a segment to finite floats."""
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

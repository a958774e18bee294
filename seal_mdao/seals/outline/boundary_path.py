"""Edges and segments of a sampled boundary as curves: positions by arc length, mirror images."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

SAME = 1e-3
"""Largest distance of two curves that are mirror images of each other, mm."""
SYMMETRIC = 5e-4
"""The same over their length, where it is larger: a symmetric design that is written is a spline through
particles that need not be mirror images of each other."""
PROJECTION_STEPS = 12
"""Newton steps of a projection; quadratic convergence from the nearest sampled point."""


class Stretch(NamedTuple):
    """An edge as a range of points of its loop.

    Attributes
    ----------
    loop : int
    points : ndarray of int, shape (k,)
        Indices in the loop, in order; those of a complete loop once around.
    closed : bool
        Whether it is a complete loop.
    """

    loop: int
    points: np.ndarray
    closed: bool


class MirrorPlane(NamedTuple):
    """A plane of symmetry of a section: coordinate ``axis`` (0 for x, 1 for y) is ``at`` (mm)."""

    axis: int
    at: float

    def image(self, points) -> np.ndarray:
        """Reflect points (..., 2)."""
        found = np.array(points, float)
        # x -> 2 a - x
        found[..., self.axis] = 2.0 * self.at - found[..., self.axis]
        return found


def stretches(boundaries) -> dict:
    """Find the ``Stretch`` of every edge of boundaries by name; ValueError if it is not connected."""
    found = {}
    for loop, boundary in enumerate(boundaries):
        edges = np.asarray(boundary.edge)
        for name in dict.fromkeys(edges.tolist()):
            sides = np.flatnonzero(edges == name)
            if sides.size == edges.size:
                found[name] = Stretch(loop, sides, True)
                continue
            # an edge across the beginning of the loop: rotate its sides into order
            gap = np.flatnonzero(np.diff(sides) > 1)
            if gap.size:
                sides = np.roll(sides, -int(gap[0]) - 1)
            if name in found or (np.diff(sides) % edges.size != 1).any():
                raise ValueError(
                    f"the edge {name!r} is not one connected part of the boundary; give its second "
                    "part a different name"
                )
            found[name] = Stretch(loop, np.append(sides, (sides[-1] + 1) % edges.size), False)
    return found


@dataclass(frozen=True, eq=False)
class BoundaryPath:
    """A stretch of a sampled boundary as a curve, a cubic between neighbouring points.

    Attributes
    ----------
    boundary : Boundary
    stretch : Stretch
    """

    boundary: object
    stretch: Stretch

    @cached_property
    def along(self) -> np.ndarray:
        """Arc length of the points from the beginning of the stretch, shape (k,), mm."""
        # modulo the length, for a stretch may run over the start of the loop
        arc = np.asarray(self.boundary.arc_length)[self.stretch.points]
        return (arc - arc[0]) % self.boundary.length

    @property
    def length(self) -> float:
        """Arc length of the stretch, mm."""
        return float(self.boundary.length if self.stretch.closed else self.along[-1])

    @cached_property
    def _sides(self) -> tuple:
        """Arc lengths, points and tangents at the beginnings and ends of the sides."""
        which = self.stretch.points
        points = np.asarray(self.boundary.points)[which]
        before, after = np.asarray(self.boundary.tangent)[which].transpose(1, 0, 2)
        arc = self.along
        if self.stretch.closed:
            # the last side returns to the first point
            arc, points = np.append(arc, self.length), np.vstack([points, points[:1]])
            before, after = np.vstack([before, before[:1]]), np.vstack([after, after[:1]])
        return arc, points, after[:-1], before[1:]

    def at(self, s, derivative: bool = False) -> np.ndarray:
        """Evaluate points (k, 2) at arc lengths (k,), or their derivatives in the arc length."""
        arc, points, first, last = self._sides
        s = np.mod(s, self.length) if self.stretch.closed else np.clip(s, 0.0, self.length)
        i = np.clip(np.searchsorted(arc, s, side="right") - 1, 0, arc.size - 2)
        h = (arc[i + 1] - arc[i])[:, None]
        t = ((s - arc[i])[:, None]) / h
        a, b, u, v = points[i], points[i + 1], h * first[i], h * last[i]
        # Hermite: x = (1 + 2t)(1 - t)^2 a + t (1 - t)^2 u + t^2 (3 - 2t) b + t^2 (t - 1) v
        if derivative:
            slope = 6.0 * t * (1.0 - t) * (b - a)
            return (slope + (1.0 - t) * (1.0 - 3.0 * t) * u + t * (3.0 * t - 2.0) * v) / h
        r = 1.0 - t
        return (1.0 + 2.0 * t) * r**2 * a + t * r**2 * u + t**2 * (3.0 - 2.0 * t) * b - t**2 * r * v

    def project(self, point) -> tuple[float, float]:
        """Find the arc length of the nearest point of the curve, and its distance, mm."""
        _, points, _, _ = self._sides
        # start at the nearest point
        s = np.array([self._sides[0][np.hypot(*(points - point).T).argmin()]])
        for _ in range(PROJECTION_STEPS):
            # s <- s + (p - x) . x' / (x' . x')
            slope = self.at(s, derivative=True)
            s = s + ((point - self.at(s)) * slope).sum(axis=1) / (slope**2).sum(axis=1)
            s = np.mod(s, self.length) if self.stretch.closed else np.clip(s, 0.0, self.length)
        return float(s[0]), float(np.hypot(*(self.at(s)[0] - point)))

    def mirrored_start(self, other: "BoundaryPath", plane: MirrorPlane) -> float | None:
        """Return c such that the point at s of this curve is the mirror image of that at c - s of the
        other one; None unless they are mirror images."""
        own = np.asarray(self.boundary.points)[self.stretch.points]
        if self.stretch.closed != other.stretch.closed:
            return None
        # an open curve is walked from its other end, a closed one from the image of its first point
        c = other.length
        if other.stretch.closed:
            c = other.project(plane.image(own[0]))[0]
        away = other.at(c - self.along) - plane.image(own)
        return c if np.hypot(*away.T).max() <= max(SAME, SYMMETRIC * self.length) else None

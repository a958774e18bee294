"""Cubic splines as segments of a section."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from seal_mdao.errors import GeometryError
from seal_mdao.geometry.spline_profile import chord_length
from seal_mdao.seals.outline.segments import Segment, pair, point, require

PANELS = 8
"""Panels between consecutive points; the arc length of each is an 8-point Gauss sum."""

CLOSE = 1e-9
"""Least distance of a knot from the point at which a spline is divided, over the range of knots."""

_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(8)
# Newton's method on a function almost linear in a panel: two or three suffice
_INVERSIONS = 6


@dataclass(frozen=True)
class Spline(Segment):
    """The C2 cubic spline through points, mm.

    Ends are not-a-knot, or have the tangents ``slopes``; where the last point is the first one and no
    slopes are given, the spline is periodic: smooth there too.

    Attributes
    ----------
    through : tuple of pair of float
    edge : str
    parameter : tuple of float
        Increasing, one a point: knots of the spline. Chord lengths where they are left out.
    slopes : pair of pair of float, or None
        Derivatives with respect to the parameter at the first and the last point.

    Raises
    ------
    GeometryError
        For fewer than two points (three when closed), points that are not finite or coincide with
        their neighbour, a parameter that does not increase, a cusp.
    """

    through: tuple
    edge: str = ""
    parameter: tuple = ()
    slopes: tuple | None = None

    def __post_init__(self):
        try:
            count = len(self.through)
        except TypeError:
            raise GeometryError(
                f"a spline needs a list of points [[x, y], ...], got {self.through!r}"
            ) from None
        points = tuple(point(p, f"point {i} of a spline") for i, p in enumerate(self.through, 1))
        # a closed one without slopes is periodic: three distinct points
        periodic = count > 1 and points[0] == points[-1] and self.slopes is None
        least, closed = (4, " when it is closed") if periodic else (2, "")
        require(count >= least, f"a spline needs at least {least} points{closed}, got {count}")
        for i in range(1, count):
            message = (
                f"points {i} and {i + 1} of a spline coincide at {pair(points[i])}; remove one of "
                "the two points"
            )
            require(points[i] != points[i - 1], message)
        object.__setattr__(self, "through", points)
        object.__setattr__(self, "parameter", self._checked_parameter())
        if self.slopes is not None:
            ends = tuple(point(slope, "a slope of a spline") for slope in self.slopes)
            object.__setattr__(self, "slopes", ends)
        self._check_cusps()

    def _check_cusps(self):
        """Refuse turns by more than a right angle between neighbouring Gauss points."""
        u = self._inside(self._panels[:-1], self._panels[1:]).ravel()
        t = self.curve(u, 1)
        # t_k . t_k+1 <= 0: the tangent reverses, a cusp lies between
        back = np.flatnonzero((t[1:] * t[:-1]).sum(axis=1) <= 0.0)
        require(
            back.size == 0,
            "a spline has a cusp (its tangent reverses) near "
            f"{pair(self.curve(u[back[:1].sum()]))}",
        )

    def _checked_parameter(self) -> tuple:
        if not len(self.parameter):
            return tuple(chord_length(self.through))
        parameter = tuple(float(value) for value in self.parameter)
        require(
            len(parameter) == len(self.through) and bool(np.all(np.diff(parameter) > 0.0)),
            f"the curve parameters of a spline must be {len(self.through)} increasing numbers, one "
            "per point",
        )
        return parameter

    @cached_property
    def curve(self) -> "scipy.interpolate.CubicSpline":
        """The spline as a function of its parameter, with its end conditions."""
        # end conditions: given slopes x'(u), periodic, or a continuous third derivative
        points = np.array(self.through)
        if self.slopes is not None:
            ends = tuple((1, np.array(slope)) for slope in self.slopes)
        else:
            ends = "periodic" if self.through[0] == self.through[-1] else "not-a-knot"
        return scipy.interpolate.CubicSpline(self.parameter, points, bc_type=ends)

    @property
    def end_slopes(self) -> tuple:
        """Derivatives with respect to the parameter at both ends, given or not."""
        if self.slopes is not None:
            return self.slopes
        return tuple(map(tuple, self.curve([self.parameter[0], self.parameter[-1]], 1).tolist()))

    # ---- arc length ----

    @cached_property
    def _panels(self) -> np.ndarray:
        """Ends of the panels in terms of the parameter, shape (m + 1,)."""
        knots = np.array(self.parameter)
        fraction = np.arange(PANELS) / PANELS
        inner = knots[:-1, None] + np.diff(knots)[:, None] * fraction
        return np.append(inner.ravel(), knots[-1])

    @cached_property
    def _speeds(self) -> np.ndarray:
        """|t| at the Gauss points of all panels, shape (m, g)."""
        return self._speed(self._inside(self._panels[:-1], self._panels[1:]))

    def _inside(self, a, b):
        # Gauss points (a + b) / 2 + (b - a) / 2 xi_g
        return 0.5 * (a + b)[:, None] + 0.5 * (b - a)[:, None] * _GAUSS

    def _speed(self, u):
        return np.linalg.norm(self.curve(u, 1), axis=-1)

    @cached_property
    def _lengths(self) -> np.ndarray:
        """Arc length at the ends of the panels, shape (m + 1,)."""
        # panel length (b - a) / 2 sum_g w_g |t(u_g)|
        parts = 0.5 * np.diff(self._panels) * (self._speeds @ _WEIGHTS)
        return np.concatenate([[0.0], np.cumsum(parts)])

    @cached_property
    def length(self) -> float:
        return float(self._lengths[-1])

    def parameters(self, s) -> np.ndarray:
        """Compute the spline parameters at fractions ``s`` (k,) of the arc length."""
        wanted = np.asarray(s, float) * self.length
        # the panel that contains the arc length, and the rest within it
        panel = np.searchsorted(self._lengths, wanted, side="right") - 1
        panel = np.clip(panel, 0, len(self._panels) - 2)
        a, b = self._panels[panel], self._panels[panel + 1]
        rest = wanted - self._lengths[panel]
        # start linear in the panel, then Newton: u <- u - (int_a^u |t| - rest) / |t(u)|
        u = a + (b - a) * rest / (self._lengths[panel + 1] - self._lengths[panel])
        for _ in range(_INVERSIONS):
            done = 0.5 * (u - a) * (self._speed(self._inside(a, u)) @ _WEIGHTS)
            u = np.clip(u - (done - rest) / self._speed(u), a, b)
        ends = (self.parameter[0], self.parameter[-1])
        return np.where(wanted <= 0.0, ends[0], np.where(wanted >= self.length, ends[1], u))

    # ---- methods of Segment ----

    def points(self, s):
        s = np.asarray(s, float)
        out = self.curve(self.parameters(s))
        # ends as given, to the last bit
        out[s == 0.0], out[s == 1.0] = self.through[0], self.through[-1]
        return out

    def tangents(self, s):
        t = self.curve(self.parameters(s), 1)
        return t / np.linalg.norm(t, axis=1, keepdims=True)

    def curvature(self, s):
        u = self.parameters(s)
        t, bend = self.curve(u, 1), self.curve(u, 2)
        # kappa = (x' y'' - y' x'') / |t|^3
        return (t[:, 0] * bend[:, 1] - t[:, 1] * bend[:, 0]) / np.linalg.norm(t, axis=1) ** 3

    @cached_property
    def turning(self) -> float:
        u = self._inside(self._panels[:-1], self._panels[1:])
        t, bend = self.curve(u, 1), self.curve(u, 2)
        # int |kappa| ds = int |x' y'' - y' x''| / |t|^2 du
        rate = np.abs(t[..., 0] * bend[..., 1] - t[..., 1] * bend[..., 0]) / (t * t).sum(axis=-1)
        return float(0.5 * np.diff(self._panels) @ (rate @ _WEIGHTS))

    @property
    def area(self):
        # x y' - y x' has degree 5 on every piece, so the Gauss sum is exact
        u = self._inside(self._panels[:-1], self._panels[1:])
        x, t = self.curve(u), self.curve(u, 1)
        rate = x[..., 0] * t[..., 1] - x[..., 1] * t[..., 0]
        return float(0.25 * np.diff(self._panels) @ (rate @ _WEIGHTS))

    def between(self, start, end):
        through = (tuple(start), *self.through[1:-1], tuple(end))
        # a closed spline with a corner keeps it: without slopes it would be periodic
        slopes = self.end_slopes if through[0] == through[-1] else self.slopes
        return replace(self, through=through, slopes=slopes)

    def divided(self, s):
        # a spline with the knots and end slopes of a part of this one is that part
        at, knots = float(self.parameters([s])[0]), np.array(self.parameter)
        near = CLOSE * (knots[-1] - knots[0])
        before, after = knots[knots < at - near].tolist(), knots[knots > at + near].tolist()
        return tuple(
            Spline(
                tuple(map(tuple, self.curve(part).tolist())), self.edge, tuple(part),
                tuple(map(tuple, self.curve([part[0], part[-1]], 1).tolist())),
            )
            for part in ([*before, at], [at, *after])
        )  # fmt: skip

    def reversed(self):
        slopes = self.slopes
        if slopes is not None:
            slopes = tuple((-x, -y) for x, y in reversed(slopes))
        # u -> u_0 + u_n - u reverses the direction; slopes at the ends change sign
        total = self.parameter[0] + self.parameter[-1]
        parameter = tuple(total - u for u in reversed(self.parameter))
        return replace(self, through=self.through[::-1], parameter=parameter, slopes=slopes)

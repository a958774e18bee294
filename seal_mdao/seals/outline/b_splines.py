"""B-splines of drawings as splines of a section, and back."""

from itertools import pairwise

import numpy as np
from scipy.interpolate import BSpline, CubicSpline, make_interp_spline

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.segments import Line
from seal_mdao.seals.outline.spline import Spline

FIT = 1e-6
"""Largest distance of a spline from the rational B-spline, or the one of degree above three, that it
stands for, mm. Polynomial B-splines up to degree three are taken over exactly."""

_REPEATED = 1e-10
_MOST_PIECES = 4096


def segments_of(degree: int, knots, control, weights, edge: str) -> list:
    """Lines and splines along a B-spline.

    Where its curvature jumps a new spline begins.

    Parameters
    ----------
    degree : int
    knots : array_like, shape (n + degree + 1,)
    control : array_like, shape (n, 2)
        mm.
    weights : array_like, shape (n,), or empty
    edge : str

    Raises
    ------
    GeometryError
        For arrays that do not fit each other, knots that decrease.
    """
    knots, control = np.asarray(knots, float), np.asarray(control, float)
    weights = np.asarray(weights, float)
    n = len(control)
    if degree < 1 or n <= degree or knots.shape != (n + degree + 1,):
        raise GeometryError(
            f"a spline of degree {degree} with {n} control points needs {n + degree + 1} knots, got "
            f"{knots.size}"
        )
    if not (np.isfinite(knots).all() and np.isfinite(control).all()):
        raise GeometryError("a knot or a control point of a spline is not a finite number")
    if not (np.diff(knots) >= 0.0).all():
        raise GeometryError("the knots of a spline decrease")
    if not knots[-degree - 1] > knots[degree]:
        raise GeometryError("the knots of a spline leave it no length")
    try:
        curve = _Curve(degree, knots, control, weights)
    except GeometryError:
        raise
    except ValueError as error:  # knots repeated until the curve falls apart
        raise GeometryError(f"not a curve: {error}") from None
    parts = []
    for stretch in curve.stretches():
        if degree == 1:
            ends = curve.at(stretch)
            parts.append(Line(tuple(ends[0]), tuple(ends[-1]), edge))
        else:
            parts.append(curve.spline(stretch, edge))
    return parts


class _Curve:
    """A B-spline, rational or not, with its first derivative."""

    def __init__(self, degree, knots, control, weights):
        self.degree, self.knots = degree, knots
        self.rational = weights.size > 0 and not np.allclose(weights, weights[0], rtol=1e-14)
        columns = control
        if self.rational:
            if not (weights > 0.0).all():
                raise GeometryError("the weights of a spline must be positive")
            columns = np.column_stack([control * weights[:, None], weights])
        self.value = BSpline(knots, columns, degree)
        self.slope = self.value.derivative()

    def at(self, u):
        value = self.value(u)
        return value[:, :2] / value[:, 2:] if self.rational else value

    def slopes(self, u):
        slope = self.slope(u)
        if not self.rational:
            return slope
        weight = self.value(u)[:, 2:]
        return (slope[:, :2] - self.at(u) * slope[:, 2:]) / weight

    def stretches(self):
        """Knots of every stretch along which the curve is C2."""
        first, last = self.knots[self.degree], self.knots[-self.degree - 1]
        inside = self.knots[(self.knots >= first) & (self.knots <= last)]
        span = _REPEATED * (last - first)
        distinct = inside[np.append(True, np.diff(inside) > span)]
        count = [(np.abs(self.knots - u) <= span).sum() for u in distinct]
        cuts = [
            i for i in range(1, len(distinct) - 1)
            if count[i] > self.degree - 2
        ]  # fmt: skip
        bounds = [0, *cuts, len(distinct) - 1]
        return [distinct[a : b + 1] for a, b in pairwise(bounds)]

    def spline(self, u, edge):
        """The cubic spline with the knots ``u``, or finer ones, and the curve's end tangents."""
        while True:
            # at a kink the tangent is that of this side
            points, ends = self.at(u), self.slopes(np.array([u[0], np.nextafter(u[-1], -np.inf)]))
            fit = CubicSpline(u, points, bc_type=((1, ends[0]), (1, ends[1])))
            between = (u[:-1, None] + np.diff(u)[:, None] * [0.2, 0.5, 0.8]).ravel()
            if self.degree <= 3 and not self.rational:
                break
            if np.abs(fit(between) - self.at(between)).max() <= 0.5 * FIT:
                break
            if u.size > _MOST_PIECES:
                raise GeometryError(f"a rational spline cannot be followed to {FIT:g} mm")
            u = np.sort(np.concatenate([u, 0.5 * (u[1:] + u[:-1])]))
        return Spline(tuple(map(tuple, points.tolist())), edge, tuple(u), tuple(map(tuple, ends)))


def b_spline_of(spline: Spline) -> tuple[np.ndarray, np.ndarray]:
    """Knots (n + 4,) and control points (n, 2) of the cubic B-spline that is the same curve."""
    ends = spline.end_slopes
    found = make_interp_spline(
        spline.parameter, np.array(spline.through), k=3, bc_type=([(1, ends[0])], [(1, ends[1])])
    )
    return found.t, found.c

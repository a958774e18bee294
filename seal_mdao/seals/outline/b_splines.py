"""Conversion of B-splines of drawings to splines of a section, and back."""

from itertools import pairwise

import numpy as np
import scipy

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.segments import Line
from seal_mdao.seals.outline.spline import Spline

FIT = 1e-6
"""Largest distance of a spline from a rational B-spline, or one of degree above three, that it
approximates, mm. Polynomial B-splines up to degree three are converted exactly."""

_REPEATED = 1e-10
_MOST_PIECES = 4096


def segments_of(degree: int, knots, control, weights, edge: str) -> list:
    """Convert a B-spline to lines and cubic splines of an edge.

    A new spline begins where the curvature is discontinuous. ``knots`` have shape (n + degree + 1,),
    ``control`` (n, 2), mm, ``weights`` (n,) or none.

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
        raise GeometryError("a knot or a control point of a spline is not finite")
    if not (np.diff(knots) >= 0.0).all():
        raise GeometryError("the knots of a spline must not decrease")
    if not knots[-degree - 1] > knots[degree]:
        raise GeometryError("the spline has zero length, because its knots coincide")
    try:
        curve = _Curve(degree, knots, control, weights)
    except GeometryError:
        raise
    except ValueError as error:  # knots repeated until the curve falls apart
        raise GeometryError(f"the spline is not a continuous curve: {error}") from None
    # lines of degree one, else a cubic spline for every stretch of continuous curvature
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
        # homogeneous coordinates (w x, w y, w): x = sum N_i w_i P_i / sum N_i w_i
        if self.rational:
            if not (weights > 0.0).all():
                raise GeometryError("the weights of a spline must be positive")
            columns = np.column_stack([control * weights[:, None], weights])
        self.value = scipy.interpolate.BSpline(knots, columns, degree)
        self.slope = self.value.derivative()

    def at(self, u):
        value = self.value(u)
        return value[:, :2] / value[:, 2:] if self.rational else value

    def slopes(self, u):
        slope = self.slope(u)
        if not self.rational:
            return slope
        weight = self.value(u)[:, 2:]
        # quotient rule: x' = ((w x)' - x w') / w
        return (slope[:, :2] - self.at(u) * slope[:, 2:]) / weight

    def stretches(self):
        """List the knots of every section along which the curve is C2."""
        first, last = self.knots[self.degree], self.knots[-self.degree - 1]
        inside = self.knots[(self.knots >= first) & (self.knots <= last)]
        span = _REPEATED * (last - first)
        distinct = inside[np.append(True, np.diff(inside) > span)]
        # at a knot of multiplicity m a curve of degree p is C^(p - m): C2 up to m = p - 2
        count = [(np.abs(self.knots - u) <= span).sum() for u in distinct]
        cuts = [i for i in range(1, len(distinct) - 1) if count[i] > self.degree - 2]
        # each stretch takes the knots from cut to cut, ends included
        bounds = [0, *cuts, len(distinct) - 1]
        return [distinct[a : b + 1] for a, b in pairwise(bounds)]

    def spline(self, u, edge):
        """Interpolate the curve at the knots ``u``, or finer ones, with its end tangents."""
        while True:
            # at a kink the tangent is that of this side
            points, ends = self.at(u), self.slopes(np.array([u[0], np.nextafter(u[-1], -np.inf)]))
            fit = scipy.interpolate.CubicSpline(u, points, bc_type=((1, ends[0]), (1, ends[1])))
            # accuracy is checked at 0.2, 0.5 and 0.8 of every interval; all are halved until it holds
            between = (u[:-1, None] + np.diff(u)[:, None] * [0.2, 0.5, 0.8]).ravel()
            if self.degree <= 3 and not self.rational:
                break
            if np.abs(fit(between) - self.at(between)).max() <= 0.5 * FIT:
                break
            if u.size > _MOST_PIECES:
                raise GeometryError(
                    f"a rational spline of the drawing cannot be approximated within {FIT:g} mm; "
                    "replace it by arcs or a polynomial spline"
                )
            u = np.sort(np.concatenate([u, 0.5 * (u[1:] + u[:-1])]))
        return Spline(tuple(map(tuple, points.tolist())), edge, tuple(u), tuple(map(tuple, ends)))


def b_spline_of(spline: Spline) -> tuple[np.ndarray, np.ndarray]:
    """Compute knots (n + 4,) and control points (n, 2) of the cubic B-spline of the same curve."""
    ends = spline.end_slopes
    found = scipy.interpolate.make_interp_spline(
        spline.parameter, np.array(spline.through), k=3, bc_type=([(1, ends[0])], [(1, ends[1])])
    )
    return found.t, found.c

"""Deformed boundary as a curve of cubic splines near its particles, and points projected onto it.

    x_c(xi) = sum_b N_b(s) x_(a-2+b),    xi = a + s,  0 <= s < 1,  b = 0 ... 5

Uniform cubic B-splines, whose control points are those of quasi-interpolation, (-1, 8, -1)/6 of three
particles: C. de Boor, A Practical Guide to Splines, Springer 2001, chapter XII. Curvature is continuous,
so friction does not jump where a point goes from one segment to the next, and the curve errs by the
fourth power of the distance of particles. A boundary is walked with the body on the left, so e_n, e_t
turned clockwise, leads out of it. Formulas are those of ``contact.kinematics`` with
V_c = sum N_b V_(a-2+b): the curve is a profile whose shape parameters are the places of its particles.
"""

from typing import NamedTuple

import numpy as np

_B_SPLINES = np.array([
    [1.0, 4.0, 1.0, 0.0], [-3.0, 0.0, 3.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]
]) / 6.0  # fmt: skip
"""Coefficients of 1, s, s^2, s^3 of the four splines."""

_CONTROL = np.array([np.roll([-1.0, 8.0, -1.0, 0.0, 0.0, 0.0], by) for by in range(4)]) / 6.0
"""Their control points by the particles."""

_CUBICS = _B_SPLINES @ _CONTROL

NODES = 7
"""A point and the particles of its segment."""

N_PLACES = 2 * NODES

_ITERATIONS = 60
"""Of the bisection that Newton's method falls back to; it ends at rounding."""

_SETTLED = 4.0 * np.finfo(float).eps
"""Change of s between 0 and 1 that is rounding."""


class Rings(NamedTuple):
    """Closed boundaries; their points are numbered consecutively.

    Attributes
    ----------
    first, size : ndarray of int, shape (k,)
        Of every point's own ring: where it begins, how many points it has.
    """

    first: np.ndarray
    size: np.ndarray

    def step(self, points: np.ndarray, by: int) -> np.ndarray:
        """Return the points a number of positions further along their rings."""
        first = self.first[points]
        return first + (points - first + by) % self.size[points]

    def coordinate_change(self, xi: np.ndarray, before: np.ndarray) -> np.ndarray:
        """Compute xi - xi0 in the shorter direction; nan from one ring to another."""
        k = len(self.first)
        own, its = (np.minimum(value.astype(int), k - 1) for value in (xi, before))
        size = self.size[own]
        change = xi - before
        # the shorter way round the ring
        change = change - size * np.round(change / size)
        return np.where(self.first[own] == self.first[its], change, np.nan)


def rings(sizes) -> Rings:
    """Build rings from the numbers of their points."""
    sizes = np.asarray(sizes, int)
    first = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    return Rings(np.repeat(first, sizes), np.repeat(sizes, sizes))


def cubics(s: np.ndarray, order: int) -> np.ndarray:
    """Evaluate N_0 ... N_5 or one of their derivatives at s (m,), shape (m, 6)."""
    coefficients = _CUBICS
    for _ in range(order):
        # d(s^k)/ds = k s^(k-1)
        coefficients = coefficients[1:] * np.arange(1, len(coefficients))[:, None]
    return s[:, None] ** np.arange(len(coefficients)) @ coefficients


def outward(x: np.ndarray, ring: Rings) -> np.ndarray:
    """Compute outward unit normals at the points of the boundary, shape (k, 2)."""
    every = np.arange(len(x))
    # e_n = e_t turned clockwise, e_t along x_(i+1) - x_(i-1)
    along = x[ring.step(every, 1)] - x[ring.step(every, -1)]
    return np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]


def masters(segments: np.ndarray, ring: Rings) -> np.ndarray:
    """Return the six particles of the segments that begin at the given points, shape (m, 6)."""
    return np.column_stack([ring.step(segments, by) for by in range(-2, 4)])


def _polynomials(x, segments, ring):
    """Coefficients of 1, s, s^2, s^3 of the curve on segments, shape (4, m, 2)."""
    return np.einsum("cb,mbi->cmi", _CUBICS, x[masters(segments, ring)])


def _slope(polynomials, places, s):
    """(x - x_c) . t and its derivative by s."""
    (c0, c1, c2, c3), s = polynomials, s[:, None]
    # r = x - x_c,  t = x_c,s,  x_c,ss
    r = places - (((c3 * s + c2) * s + c1) * s + c0)
    t, bend = (3.0 * c3 * s + 2.0 * c2) * s + c1, 6.0 * c3 * s + 2.0 * c2
    # h = r . t,  h,s = r . x_c,ss - t . t
    return (r * t).sum(axis=1), (r * bend).sum(axis=1) - (t * t).sum(axis=1)


def project(x, places, nearest, ring: Rings):
    """Closest points of the curve near its particles ``nearest`` (m,) to ``places`` (m, 2).

    Returns
    -------
    segments : ndarray of int, shape (m,)
    s : ndarray, shape (m,)
    found : ndarray of bool, shape (m,)
        Whether (x - x_c) . t = 0 within two segments of the nearest particle.
    """
    zero, one = np.zeros(len(nearest)), np.ones(len(nearest))
    # the projection lies ahead of the nearest particle where r . t >= 0 there
    ahead = _slope(_polynomials(x, nearest, ring), places, zero)[0] >= 0.0
    segments = np.where(ahead, nearest, ring.step(nearest, -1))
    for _ in range(2):
        polynomials = _polynomials(x, segments, ring)
        first, last = (_slope(polynomials, places, end)[0] for end in (zero, one))
        # a segment has it where r . t changes sign
        found = (first >= 0.0) & (last <= 0.0)
        on = np.where(ahead, ring.step(segments, 1), ring.step(segments, -1))
        segments = np.where(found, segments, on)
    s = 0.5 * one
    s[found] = _stationary(polynomials[:, found], places[found])
    return segments, s, found


def _stationary(polynomials, places) -> np.ndarray:
    """s (m,) where (x - x_c) . t, which changes sign from 0 to 1, is zero; every point for itself."""
    s = np.full(len(places), 0.5)
    low, high, left = np.zeros_like(s), np.ones_like(s), np.arange(len(s))
    for _ in range(_ITERATIONS):
        at = s[left]
        value, rate = _slope(polynomials[:, left], places[left], at)
        # h falls along s: the zero lies in [low, high]
        low[left] = np.where(value > 0.0, at, low[left])
        high[left] = np.where(value > 0.0, high[left], at)
        with np.errstate(divide="ignore", invalid="ignore"):
            # Newton, halving where it leaves the bracket
            step = at - value / rate
        inside = (step > low[left]) & (step < high[left])
        step = np.where(inside, step, 0.5 * (low[left] + high[left]))
        s[left] = step = np.where(value == 0.0, at, step)
        left = left[np.abs(step - at) > _SETTLED]
        if not left.size:
            break
    return s


class Kinematics(NamedTuple):
    """Gap, natural coordinate and |t| of m points near the curve, with their derivatives by the places
    of the point itself and of the six particles of its segment, (7, 2) each.

    Attributes
    ----------
    gap, xi, size : ndarray, shape (m,)
    gap_1, xi_1, size_1 : ndarray, shape (m, 14)
    gap_2, xi_2 : ndarray, shape (m, 14, 14)
    """

    gap: np.ndarray
    xi: np.ndarray
    size: np.ndarray
    gap_1: np.ndarray
    xi_1: np.ndarray
    size_1: np.ndarray
    gap_2: np.ndarray
    xi_2: np.ndarray


def kinematics(x, nodes, segments, s) -> Kinematics:
    """Kinematics of points ``nodes[:, 0]`` at s (m,) of ``segments``, whose particles are
    ``nodes[:, 1:]`` (m, 7)."""
    weights = [np.column_stack([np.full(len(s), 1.0 if i == 0 else 0.0), -cubics(s, i)])
               for i in range(4)]  # fmt: skip
    # r = x - x_c, and t, x_c,ss, x_c,sss of the curve, whose weights have a minus
    r, *along = (np.einsum("ma,mai->mi", w, x[nodes]) for w in weights)
    t, bend, twist = (-part for part in along)
    size = np.hypot(*t.T)
    e_t = t / size[:, None]
    e_n = np.column_stack([e_t[:, 1], -e_t[:, 0]])
    # g = r . e_n, alpha = e_n . x_c,ss, beta = e_t . x_c,ss, gamma = e_n . x_c,sss   (17), (22)
    gap, alpha, beta, gamma = (
        (a * b).sum(axis=1) for a, b in ((r, e_n), (e_n, bend), (e_t, bend), (e_n, twist))
    )
    # c = |t|^2 - g alpha   Eq. (22)
    c = size**2 - gap * alpha

    def spread(order, direction):
        return np.einsum("ma,mi->mai", weights[order], direction).reshape(len(s), N_PLACES)

    def times(number, vector):
        return number[:, None] * vector

    def outer(a, b):
        return a[:, :, None] * b[:, None, :]

    # w.e_t, w.e_n and -V_c,s.e_t, -V_c,s.e_n, -V_c,ss.e_n with w = V - V_c, by every position
    on_t, on_n, on_t1, on_n1, on_n2 = (
        spread(0, e_t), spread(0, e_n), spread(1, e_t), spread(1, e_n), spread(2, e_n)
    )  # fmt: skip
    # dxi = (|t|/c) e_t.w + (g/c) e_n.V_c,s   Eq. (52)
    xi_1 = times(size / c, on_t) - times(gap / c, on_n1)
    # turn = (alpha/c) e_t.w + (|t|/c) e_n.V_c,s   Eq. (53)
    turn = times(alpha / c, on_t) - times(size / c, on_n1)
    # d|t| = beta dxi + e_t.V_c,s
    size_1 = times(beta, xi_1) - on_t1
    # d alpha = gamma dxi - beta turn + e_n.V_c,ss
    alpha_1 = times(gamma, xi_1) - times(beta, turn) - on_n2
    # dc = 2 |t| d|t| - alpha dg - g d alpha,  dg = e_n.w   Eq. (55)
    c_1 = times(2.0 * size, size_1) - times(alpha, on_n) - times(gap, alpha_1)
    # d(|t|/c) and d(g/c)
    size_over_c = times(1.0 / c, size_1) - times(size / c**2, c_1)
    gap_over_c = times(1.0 / c, on_n) - times(gap / c**2, c_1)
    part = size[:, None, None] / c[:, None, None], gap[:, None, None] / c[:, None, None]
    # d^2 xi: the product rule on dxi, with de_t = turn e_n, de_n = -turn e_t, dw = -V_c,s dxi
    xi_2 = (
        outer(on_t, size_over_c) + part[0] * (outer(on_n, turn) + outer(on_t1, xi_1))
        - outer(on_n1, gap_over_c) - part[1] * (outer(on_n2, xi_1) - outer(on_t1, turn))
    )  # fmt: skip
    # d^2 g = d(e_n.w) = -e_n.V_c,s dxi - turn e_t.w
    gap_2 = outer(on_n1, xi_1) - outer(on_t, turn)
    return Kinematics(gap, segments + s, size, on_n, xi_1, size_1, gap_2, xi_2)

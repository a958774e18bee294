"""Deformed boundary as a smooth curve through its contact points, and points projected onto it.

    x_c(xi) = sum_b N_b(s) x_(a-2+b),    xi = a + s,  0 <= s < 1,  b = 0 ... 5

On a segment the curve is the quintic with the positions and first and second derivatives of its ends.
The derivatives at a point j are those of the polynomial through the points j - 2 ... j + 2 (finite
differences), so curvature is continuous, and friction does not jump where a point goes from one segment
to the next; the curve errs by the fourth power of the distance of points. N_b is one at its own point
and zero at all others: points that face each other transfer their forces completely.

A curve through the points overshoots at a bend by more than ``BENT``, and iterations of Newton's method
go to and fro there. Positions and second derivatives are smoothed at bends, as by quasi-interpolation
with cubic B-splines (C. de Boor, A Practical Guide to Splines, Springer 2001, chapter XII). With the
second differences D x at bends,

    y = W x,    y'' = x'' + 3 (W - I) x,    W = I - D^T D / 36.

W is symmetric and W 1 = 1, so points that face each other transfer a uniform pressure unchanged.

At a sharp corner there are two points, each ``BESIDE`` of a side of length h away from it
(``terms.averaged_points``). The polynomials end at corners, so that straight sides are straight. Between
both points the curve goes around the corner by

    x_c = X_corner - BESIDE h ((1 - s)^5 t_1 - s^5 t_2),

which follows the first side t_1 nearly up to the corner, then the second one, t_2.

A boundary is walked with the body on the left, so e_n, e_t turned clockwise, leads out of it. Formulas
are those of ``contact.kinematics`` with V_c = sum N_b V_(a-2+b): the curve is a profile whose shape
parameters are the positions of its points.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.terms.averaged_points import SMOOTH

BESIDE = (1.0 - SMOOTH) / 3.0
"""Distance of the points at a sharp corner from it over the length of their sides."""

SPEED = 5.0 * BESIDE
"""Derivative of x_c by s at both ends of the segment around a corner over that along its sides."""

BENT = np.cos(np.deg2rad(15.0))
"""Cosine of the least angle between two edges that makes the particle between them a bend."""

_HERMITE = np.linalg.inv([
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], [0.0, 0.0, 2.0, 6.0, 12.0, 20.0],
])  # fmt: skip
"""Coefficients of 1, s, ... s^5 by x, x', x'' at s = 0 and at s = 1."""

NODES = 7
"""A point and the points of its segment."""

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
    quintics : ndarray, shape (k, 6, 6)
        Coefficients of 1, s, ... s^5 of the six functions N_b on the segment that begins at every point.
    """

    first: np.ndarray
    size: np.ndarray
    quintics: np.ndarray

    def weights(self, segments: np.ndarray, s: np.ndarray, order: int) -> np.ndarray:
        """Evaluate N_0 ... N_5 of segments or one of their derivatives at s (m,), shape (m, 6)."""
        coefficients = self.quintics[segments]
        for _ in range(order):
            # d(s^k)/ds = k s^(k-1)
            factors = np.arange(1, coefficients.shape[1])
            coefficients = coefficients[:, 1:] * factors[:, None]
        powers = s[:, None] ** np.arange(coefficients.shape[1])
        return np.einsum("mc,mcb->mb", powers, coefficients)

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


def rings(sizes, corner=None, bent=None) -> Rings:
    """Build rings from the numbers of their points.

    Parameters
    ----------
    sizes : sequence of int
    corner : ndarray of bool, shape (k,), optional
        Whether a point is the first one of two at a sharp corner; none unless given.
    bent : ndarray of bool, shape (k,), optional
        Whether a point is at a bend, which is not a sharp corner; none unless given.
    """
    sizes = np.asarray(sizes, int)
    first = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    first, size = np.repeat(first, sizes), np.repeat(sizes, sizes)
    made = Rings(first, size, np.empty((len(first), 6, 6)))
    corner, bent = (
        np.zeros(len(first), bool) if given is None else np.asarray(given, bool)
        for given in (corner, bent)
    )
    distance = _distances(made, corner)
    smoothing = _smoothing(made, distance, bent)
    # x, x', x'' by the points j - 2 ... j + 2, smoothed at bends
    at_point = np.concatenate([smoothing[:, None], _differences(distance)], axis=1)
    at_point[:, 2] += 3.0 * (smoothing - (np.arange(5) == 2))
    # rows x, x', x'' at both ends by the six points a - 2 ... a + 3
    rows = np.zeros((len(first), 6, 6))
    rows[:, :3, :5], rows[:, 3:, 1:] = at_point, at_point[made.step(np.arange(len(first)), 1)]
    # around a corner x' = SPEED h t, and x'' = -4 x' and 4 x' at its ends
    rows[corner, 1:3] = SPEED * rows[corner, 1, None] * [[1.0], [-4.0]]
    rows[corner, 4:] = SPEED * rows[corner, 4, None] * [[1.0], [4.0]]
    return made._replace(quintics=_HERMITE @ rows)


def _distances(ring: Rings, corner: np.ndarray) -> np.ndarray:
    """Distances from the points j to j - 2 ... j + 2 along a side, over the length of its edges, shape
    (k, 5); infinite beyond a corner."""
    every, number = np.arange(len(corner)), np.arange(-2, 3)
    back, further = corner[ring.step(every, -1)], corner[ring.step(every, -2)]
    # points on the same side of corners, up to two before and two after
    before = 2 - 2 * back - (~back & further)
    after = 2 - 2 * corner - (~corner & corner[ring.step(every, 1)])
    # the points at both ends of a side are BESIDE h inside of it
    shift = BESIDE * (back.astype(float) - corner)
    found = number + shift[ring.step(every[:, None], number)] - shift[:, None]
    found[(number < -before[:, None]) | (number > after[:, None])] = np.inf
    return found


def _differences(distance: np.ndarray) -> np.ndarray:
    """Weights of the points j - 2 ... j + 2 in x' and x'' at the points j, shape (k, 2, 5): those of
    the polynomial through the ones on the same side of corners."""
    patterns, own = np.unique(distance, axis=0, return_inverse=True)
    weights = np.zeros((len(patterns), 2, 5))
    for pattern, found in zip(patterns, weights, strict=True):
        there = np.isfinite(pattern)
        # rows of the inverse Vandermonde matrix: coefficients of s and s^2 of the Lagrange polynomials
        powers = np.linalg.inv(pattern[there, None] ** np.arange(there.sum()))
        for order, factor in enumerate((1.0, 2.0)[: len(powers) - 1]):
            found[order, there] = factor * powers[order + 1]
    return weights[own.ravel()]


def _smoothing(ring: Rings, distance: np.ndarray, bent: np.ndarray) -> np.ndarray:
    """Weights of the points j - 2 ... j + 2 in the smoothed positions y_j, shape (k, 5)."""
    every = np.arange(len(distance))
    # (D x)_j = (x_(j+1) - x_j) / h_2 - (x_j - x_(j-1)) / h_1 at bends
    one, two = 1.0 / -distance[:, 1], 1.0 / distance[:, 3]
    differences = np.where(bent[:, None], np.column_stack([one, -one - two, two]), 0.0)
    weights = np.zeros((len(every), 5))
    weights[:, 2] = 1.0
    for i in range(3):
        row = differences[ring.step(every, i - 1)]
        # W_jb = delta_jb - D_ij D_ib / 36, i = j - 1, j, j + 1
        weights[:, i : i + 3] -= row[:, 2 - i, None] * row / 36.0
    return weights


def outward(x: np.ndarray, ring: Rings) -> np.ndarray:
    """Compute outward unit normals at the points of the boundary, shape (k, 2)."""
    every = np.arange(len(x))
    # e_n = e_t turned clockwise, e_t along x_(i+1) - x_(i-1)
    along = x[ring.step(every, 1)] - x[ring.step(every, -1)]
    return np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]


def masters(segments: np.ndarray, ring: Rings) -> np.ndarray:
    """Return the six points of the segments that begin at the given points, shape (m, 6)."""
    return np.column_stack([ring.step(segments, by) for by in range(-2, 4)])


@inlined
def _step(point, by, first, size):
    """``Rings.step`` of one point."""
    return first[point] + (point - first[point] + by) % size[point]


@internal
def _is_ahead(x, place, a, first, size, quintics):
    """Whether the projection of a place lies at the point a or ahead of it, (x - x_c) . t >= 0 there."""
    value = 0.0
    for i in range(2):
        x_c, t = 0.0, 0.0
        for b in range(6):
            own = x[_step(a, b - 2, first, size), i]
            x_c += quintics[a, 0, b] * own
            t += quintics[a, 1, b] * own
        value += (place[i] - x_c) * t
    return value >= 0.0


@internal
def _polynomial(x, a, first, size, quintics, found):
    """Coefficients (6, 2) of 1, s, ... s^5 of the curve on the segment that begins at point a."""
    for c in range(6):
        for i in range(2):
            found[c, i] = 0.0
            for b in range(6):
                found[c, i] += quintics[a, c, b] * x[_step(a, b - 2, first, size), i]


@internal
def _slope(polynomial, place, s):
    """(x - x_c) . t and its derivative by s."""
    value, rate, square = 0.0, 0.0, 0.0
    for i in range(2):
        # x_c, t = x_c,s and x_c,ss / 2 by Horner's rule
        x_c, t, half_bend = polynomial[5, i], 0.0, 0.0
        for c in range(4, -1, -1):
            half_bend = half_bend * s + t
            t = t * s + x_c
            x_c = x_c * s + polynomial[c, i]
        r = place[i] - x_c
        # h = r . t,  h,s = r . x_c,ss - t . t
        value += r * t
        rate += 2.0 * r * half_bend
        square += t * t
    return value, rate - square


@internal
def _stationary(polynomial, place):
    """Natural coordinate s where (x - x_c) . t, which changes sign from 0 to 1, is zero."""
    low, high, s = 0.0, 1.0, 0.5
    for _ in range(_ITERATIONS):
        value, rate = _slope(polynomial, place, s)
        if value == 0.0:
            break
        # h falls along s: the zero lies in [low, high]
        if value > 0.0:
            low = s
        else:
            high = s
        # Newton, halving where it leaves the bracket
        step = s - value / rate if rate != 0.0 else low
        if not low < step < high:
            step = 0.5 * (low + high)
        change, s = abs(step - s), step
        if change <= _SETTLED:
            break
    return s


@compiled
def _project(x, places, nearest, first, size, quintics, segments, s, found):
    """Fill in ``segments``, ``s`` and ``found`` of ``project``."""
    polynomial = np.empty((6, 2))
    for m in range(len(places)):
        place, a = places[m], nearest[m]
        ahead = _is_ahead(x, place, a, first, size, quintics)
        for k in range(2):
            segments[m] = here = _step(a, k if ahead else -1 - k, first, size)
            after = _step(here, 1, first, size)
            # a segment has it where r . t changes sign; both segments that meet at a point ask the
            # same there, so that rounding cannot make both refuse
            if _is_ahead(x, place, here, first, size, quintics) and not _is_ahead(
                x, place, after, first, size, quintics
            ):
                _polynomial(x, here, first, size, quintics, polynomial)
                found[m], s[m] = True, _stationary(polynomial, place)
                break


def project(x, places, nearest, ring: Rings):
    """Closest points of the curve near its points ``nearest`` (m,) to ``places`` (m, 2).

    Returns
    -------
    segments : ndarray of int, shape (m,)
    s : ndarray, shape (m,)
    found : ndarray of bool, shape (m,)
        Whether (x - x_c) . t = 0 within two segments of the nearest point.
    """
    segments, s, found = nearest.copy(), np.full(len(nearest), 0.5), np.zeros(len(nearest), bool)
    _project(x, places, nearest, *ring, segments, s, found)
    return segments, s, found


class Kinematics(NamedTuple):
    """Gap, natural coordinate and |t| of m points near the curve, with their derivatives by the places
    of the point itself and of the six points of its segment, (7, 2) each.

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


def kinematics(x, nodes, segments, s, ring: Rings) -> Kinematics:
    """Kinematics of points ``nodes[:, 0]`` at s (m,) of ``segments``, whose points are
    ``nodes[:, 1:]`` (m, 7)."""
    weights = [
        np.column_stack([np.full(len(s), 1.0 if i == 0 else 0.0), -ring.weights(segments, s, i)])
        for i in range(4)
    ]
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

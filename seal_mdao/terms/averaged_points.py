"""Boundary points that move as the mean of the adjacent edges.

The mean of ``rkpm.averages`` over the edges from A to its neighbours B has the weight function

    psi_A = N_A + gamma (N_A - N_B),    sum_A psi_A = 1.

With gamma = 1/2 its second moment is zero: the mean of a smooth curve lies on the curve up to the fourth
power of the spacing. gamma = 1 gives the dual hat functions (B. I. Wohlmuth, SIAM J. Numer. Anal. 38
(2000) 989), whose mean of a linear field is its value at A: straight ends stay where they are.
A sharp corner has two points, each with the edge on its side of the corner alone, whose means lie
(1 - gamma) / 3 of the length of this edge away from the corner.
The Gauss points of a curved edge of length h lie on the parabola with X'' of one of its ends,

    X_q = N_A X_A + N_B X_B - (h^2 / 12) X''.

In a body of revolution the weights R psi_A of an edge from the axis have no first moment about A, but a
second one: with Gauss points on the parabola the mean of a point A on the axis would lie beside the
curve by a fraction of h^2 |X''|. Its Gauss points lie on the straight edge, so that the mean is X_A.
"""

from dataclasses import replace

import numpy as np

from seal_mdao.rkpm.averages import EdgeAverages
from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.terms.points import MaterialPoints, boundary_particles

CORNER = np.cos(np.deg2rad(45.0))
"""Cosine of the least angle between two edges that makes the particle between them a corner."""

STRAIGHT = 1e-9
"""Bend h^2 |X''| of an edge over its length, below which it is rounding."""

EQUAL = 1e-6
"""Relative difference of the bends of both ends of an edge, below which they are equal, as on an arc
with equal edges: rounding must not decide between them."""

SMOOTH, DUAL, BESIDE_CORNER = 0.5, 1.0, 0.94
"""gamma of other edges, of straight ones at an end, and of those beside a sharp corner.

The points of a corner lie 2 % of an edge inside of their sides: if a profile presses on one side, the
point of the free side beside it does not touch, unless the penetration is as large.
"""


def averaged_points(
    which: np.ndarray, neighbours: np.ndarray, nominal, axisymmetric: bool = False,
    beside_corner: float = BESIDE_CORNER,
) -> MaterialPoints:  # fmt: skip
    """Create boundary points that move as the mean of the edges beside each particle, with half of
    their lengths; two at a sharp corner, one for each of its sides.

    Parameters
    ----------
    which, neighbours : ndarray of int, shapes (k,), (k, 2)
        As for ``boundary_particles``.
    nominal : ndarray, shape (n, 2)
        Particles of the nominal body, which say where the boundary has corners and how its edges are
        curved, mm.
    axisymmetric : bool
        Whether the edges are turned about the axis x = 0.
    beside_corner : float
        gamma of edges at sharp corners.
    """
    which, neighbours, divided = _divided_corners(which, neighbours, nominal)
    where = boundary_particles(which, neighbours)
    # edges from A to B, the particle C before A, the edge from B to A where there is one
    a, b = edges = where.edges.reshape(-1, 2).T
    c = where.edges[:, ::-1, 1].ravel()
    back, known = _opposite(edges)
    factors, inner = _curvature(nominal, a, b, c)
    corner = np.repeat(divided, 2)
    at_corner = corner | (corner[back] & known)
    bend = np.einsum("mj,mji->mi", factors, nominal[np.column_stack([a, b, c])])
    bend[np.hypot(*bend.T) < STRAIGHT * np.hypot(*(nominal[b] - nominal[a]).T)] = 0.0
    near, far = _curved(bend, bend[back], inner, inner[back] & known)
    near, far = (own * ~at_corner for own in (near, far))
    straight, on_axis = near + far == 0.0, axisymmetric & (nominal[a, 0] == 0.0)
    # a point on the axis has the mean of the chord: the weights R psi_A have no first moment
    near, far = (own * ~on_axis for own in (near, far))
    # h^2 X'' at A by (A, B, C), or at B by (B, A, D)
    one, two = near[:, None] * factors, far[:, None] * factors[back]
    bulge = np.column_stack([one[:, 0] + two[:, 1], one[:, 1] + two[:, 0], one[:, 2], two[:, 2]])
    g, w = np.polynomial.legendre.leggauss(2)
    hat = 0.5 * (1.0 - g)
    # X_q = N_A X_A + N_B X_B - h^2 X'' / 12
    linear = np.column_stack([hat, 1.0 - hat, np.zeros((2, 2))])
    between = linear - bulge[:, None] / 12.0
    anchors = np.column_stack([a, b, c, np.where(known, c[back], b)])
    gauss = PointSet(np.repeat(anchors, 2, axis=0), between.reshape(-1, 4), 4, sloped=False, ends=2)
    # m_q / l = w/2 [N_A + gamma (N_A - N_B)]
    # the axis is no end: the mirror image follows, and dual hats have no weight there
    inside = (inner | on_axis) & known
    straight_end = ~(inside & inside[back]) & straight
    gamma = np.where(straight_end, DUAL, SMOOTH)
    gamma = np.where(at_corner, beside_corner, gamma)
    if axisymmetric:
        # an edge of length h from the axis: the mean radius h (1 - 2 gamma) / (2 (1 - gamma)) is to be
        # that of other points at corners
        from_axis = corner & on_axis & (nominal[b, 0] != 0.0)
        beside = (1.0 - beside_corner) / 3.0
        gamma[from_axis | (from_axis[back] & known)] = (1.0 - 2.0 * beside) / (2.0 - 2.0 * beside)
    gamma = gamma[:, None]
    fractions = (a != b)[:, None] * 0.5 * w * (hat + gamma * (2.0 * hat - 1.0))
    radial = None
    if axisymmetric:
        # int R psi_A / int psi_A on the chord of an edge, psi_A linear: 2/3 + gamma/3 of R_A
        own = (2.0 + gamma.reshape(where.edges.shape[:2])) / 3.0
        radial = np.stack([own, 1.0 - own], axis=2)
    fractions = fractions.reshape(*where.edges.shape[:2], 2)
    # edges on the axis have no circumference
    around = axisymmetric & (nominal[where.edges, 0] != 0.0).any(axis=(1, 2))
    averages = EdgeAverages(gauss, where.edges, fractions, around)
    return replace(where, averages=averages, radial=radial)


def sharp_corners(edges: np.ndarray, particles: np.ndarray, least: float = CORNER) -> np.ndarray:
    """Find the points at which the boundary turns by more than an angle.

    Parameters
    ----------
    edges : ndarray of int, shape (k, 2, 2)
        From the particle of a point to those before and after; to itself where there is none.
    particles : ndarray, shape (n, 2)
    least : float
        Cosine of the angle.

    Returns
    -------
    ndarray of bool, shape (k,)
    """
    sides = particles[edges[..., 1]] - particles[edges[..., 0]]
    length = np.hypot(sides[..., 0], sides[..., 1])
    # cosine of the angle by which the boundary turns, over both lengths; 0 < 0 without an edge
    turn = -np.einsum("ki,ki->k", sides[:, 0], sides[:, 1])
    return turn < least * length[:, 0] * length[:, 1]


def _divided_corners(which, neighbours, nominal) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Divide every sharp corner into two points, one with the edge before and one with the edge after
    it; the particles and neighbours of all points, and which of them are at a sharp corner."""
    sharp = sharp_corners(boundary_particles(which, neighbours).edges, nominal)
    rows = np.repeat(np.arange(len(sharp)), 1 + sharp)
    which, neighbours, sharp = np.asarray(which)[rows], np.asarray(neighbours)[rows], sharp[rows]
    after = np.append(False, rows[1:] == rows[:-1])
    before = sharp & ~after
    neighbours[before, 1], neighbours[after, 0] = which[before], which[after]
    return which, neighbours, sharp


def _opposite(edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the edge from B to A of every edge (2, m) from A to B, and whether there is one."""
    base = edges.max() + 1
    key, wanted = base * edges[0] + edges[1], base * edges[1] + edges[0]
    order = np.argsort(key)
    found = order[np.minimum(np.searchsorted(key[order], wanted), key.size - 1)]
    return found, key[found] == wanted


def _curvature(nominal, a, b, c) -> tuple[np.ndarray, np.ndarray]:
    """Compute factors (m, 3) of X_A, X_B and X_C in h^2 X'' at A, with C before A and h the length of
    the edge from A to B; and whether A has both neighbours."""
    before, after = nominal[a] - nominal[c], nominal[b] - nominal[a]
    h_1, h_2 = np.hypot(*before.T), np.hypot(*after.T)
    inside = (h_1 > 0.0) & (h_2 > 0.0)
    h_1, h_2 = np.where(inside, h_1, 1.0), np.where(inside, h_2, 1.0)
    # X'' = 2 / (h_1 + h_2) [(X_B - X_A) / h_2 - (X_A - X_C) / h_1]
    by_b, by_c = 2.0 * h_2 / (h_1 + h_2), 2.0 * h_2**2 / (h_1 * (h_1 + h_2))
    return np.column_stack([-by_b - by_c, by_b, by_c]), inside


def _curved(bend, other, smooth, far_smooth) -> tuple[np.ndarray, np.ndarray]:
    """Weights (m,) of the curvatures of the near end A and of the far end B in that of an edge.

    One for the smaller one of both, ``bend`` and ``other`` (m, 2), a half for each where they are equal;
    zero where both bends are zero or point to different sides.
    """
    same = np.einsum("mi,mi->m", bend, other) > 0.0
    one, two = np.hypot(*bend.T), np.hypot(*other.T)
    equal = np.abs(one - two) <= EQUAL * np.maximum(one, two)
    share = np.where(equal, 0.5, one < two)
    near = (smooth & (one > 0.0)) * np.where(far_smooth, same * share, 1.0)
    return near, (far_smooth & (two > 0.0)) * np.where(smooth, same * (1.0 - share), 1.0)

"""Forces of a pressure on the sides of a deformed edge: cubics through their ends and Gauss points.

The points of a side are its first particle, two Gauss points and its last particle, with which the
consistent integration integrates the boundary, too (``rkpm.consistent_gradients``). With the weights
w, linear along a side between the w_i of two particles, and n into the body,

    f_m = int N_m w n ds = sum_i w_i f_im,    x = sum_n N_n(s) x_n.

The two particles are those at its ends, or for a constant weight twice the same.

A linear field moves a side to another straight one. There int N_m ds = (0, 1/2, 1/2, 0), and with w = 1
the forces are those at the Gauss points, which balance a uniform hydrostatic stress to rounding.

In a body of revolution the pressure acts on the deformed surface 2 pi r ds, r = sum_k N_k x_k1,

    f_m = int N_m w n c r ds + w_m dC/dx_m,    c r = 2 pi r in metres (``rkpm.axisymmetry``),

with w_m the mean of the w_i of a side. The product N_m r on a straight side is of degree four, which two
Gauss points do not integrate exactly. The error of their rule for s^4 is 1/180, and the forces are those
at the Gauss points again with

    C = -(c / 180) (r_b - r_a) T . Q (x_b - x_a),    T = sum_n a_n x_n,

a_n the leading coefficients of N_n: T is a sixth of the third derivative of the cubic, and C is of fifth
order in the length of the side. Q turns by a quarter into the body.

With w = 1 these forces are the derivative of an area, or in a body of revolution of the volume
pi int r^2 dz + sum C (m mm^2), between the edge and the axis, except at the ends of the edge.
"""

import numpy as np

from seal_mdao.rkpm.axisymmetry import CIRCUMFERENCE

POINTS = 3
"""Points from a particle to the next one along the edge."""

INNER = 0.5 - 0.5 / np.sqrt(3.0)
"""Place of the first Gauss point on a side [0, 1]."""

_NODES = np.array([0.0, INNER, 1.0 - INNER, 1.0])
# columns: coefficients of 1, s, s^2, s^3 of N_n, which is 1 at its own node
_COEFFICIENTS = np.linalg.inv(np.vander(_NODES, increasing=True))
_LEADING = _COEFFICIENTS[3]
# x_b - x_a = sum_n D_n x_n
_CHORD = np.array([-1.0, 0.0, 0.0, 1.0])


def _side_shapes(n_gauss: int) -> tuple:
    """Evaluate weights, N, dN/ds and M at Gauss points of [0, 1]: cubic N, linear M."""
    s, weight = np.polynomial.legendre.leggauss(n_gauss)
    s = 0.5 + 0.5 * s
    powers = s ** np.arange(4)[:, None]
    slopes = np.arange(1, 4)[:, None] * powers[:3]
    # M = (1 - s, s)
    return (
        0.5 * weight, _COEFFICIENTS.T @ powers, _COEFFICIENTS[1:].T @ slopes, np.stack([1.0 - s, s]),
    )  # fmt: skip


def _side_integrals() -> np.ndarray:
    """Integrate N_m M_i dN_n/ds over [0, 1], shape (2, 4, 4) of (i, m, n)."""
    # degree 3 + 1 + 2 = 6: four Gauss points are exact
    weight, shapes, slopes, lines = _side_shapes(4)
    return np.einsum("q,mq,iq,nq->imn", weight, shapes, lines, slopes)


def _ring_integrals() -> np.ndarray:
    """Integrate c N_k N_m M_i dN_n/ds over [0, 1], shape (2, 4, 4, 4) of (i, k, m, n)."""
    # degree 3 + 3 + 1 + 2 = 9: five Gauss points are exact
    weight, shapes, slopes, lines = _side_shapes(5)
    return CIRCUMFERENCE * np.einsum("q,kq,mq,iq,nq->ikmn", weight, shapes, shapes, lines, slopes)


_INTEGRALS = _side_integrals()
_RING_INTEGRALS = _ring_integrals()


class PressedSides:
    """Sides of an edge under pressure.

    Attributes
    ----------
    points : ndarray of int, shape (s, 4)
        First particle, Gauss points and last particle of every side.
    inward : ndarray, shape (2, 2)
        Q: quarter turn of the tangent into the body.
    axisymmetric : bool

    Parameters
    ----------
    weighted_by : ndarray of int, shape (s, 2)
        Particles whose weights every side has at its beginning and at its end.
    left : bool
        Whether the body is on the left of the edge, else on its right.
    axisymmetric : bool
        Whether the edge is turned about the axis x = 0.
    """

    def __init__(self, weighted_by: np.ndarray, left: bool, axisymmetric: bool):
        self.weighted_by = weighted_by
        self.points = POINTS * np.arange(len(weighted_by))[:, None] + np.arange(POINTS + 1)
        self.inward = (1.0 if left else -1.0) * np.array([[0.0, -1.0], [1.0, 0.0]])
        self.axisymmetric = axisymmetric

    def _integrals(self, x) -> np.ndarray:
        """Integrate N_m M_i dN_n/ds, in a body of revolution times c r, over the sides (s): shape
        (2, 4, 4), or (2, s, 4, 4)."""
        if not self.axisymmetric:
            return _INTEGRALS
        # c r = c sum_k N_k x_k1
        return np.einsum("ikmn,sk->ismn", _RING_INTEGRALS, x[self.points, 0])

    def forces(self, x) -> np.ndarray:
        """Compute the force on the points per unit pressure and unit weight, shape (k, m, 2)."""
        # f_im = int N_m M_i n ds = sum_n [int N_m M_i dN_n/ds ds] Q x_n,  Q: quarter turn inward
        inward = x[self.points] @ self.inward.T
        out = np.zeros((len(self.points) + 1, *x.shape))
        consistent = 0.5 * self._corrections(x[self.points]) if self.axisymmetric else 0.0
        for particle, integrals in zip(self.weighted_by.T, self._integrals(x), strict=True):
            # two sides may share a point and a particle
            np.add.at(out, (particle[:, None], self.points), integrals @ inward + consistent)
        return out

    def pressed(self, weight) -> np.ndarray:
        """Find the sides with any pressure for the weights of particles, a mask (s,)."""
        return weight[self.weighted_by].any(axis=1)

    def _corrections(self, x) -> np.ndarray:
        """Compute dC/dx_m of the sides (s) of deformed points ``x`` (s, 4, 2), shape (s, 4, 2)."""
        chord, bent = _CHORD @ x, _LEADING @ x
        normal, turned = chord @ self.inward.T, bent @ self.inward
        along = chord[:, :1, None]
        # dC/dx_m = -c/180 [ D_m (T.Qt) e_1 + t_1 (a_m Q t + D_m Q^T T) ],  t = x_b - x_a
        out = along * (_LEADING[:, None] * normal[:, None] + _CHORD[:, None] * turned[:, None])
        out[..., 0] += np.einsum("sc,sc->s", bent, normal)[:, None] * _CHORD
        return -CIRCUMFERENCE / 180.0 * out

    def tangents(self, x, size):
        """Compute pairs of points and tangents of a follower pressure ``size`` (k,) at the particles."""
        wetted = self.pressed(size)
        by_side, points = size[self.weighted_by[wetted]], self.points[wetted]
        if self.axisymmetric:
            tangents = self._ring_turning(x[points], by_side)
        else:
            # K_mn = sum_i size_i [int N_m M_i dN_n/ds ds] Q
            integrals = np.einsum("si,imn->smn", by_side, _INTEGRALS)
            tangents = integrals.reshape(-1, 1, 1) * self.inward
        pairs = np.stack(np.broadcast_arrays(points[:, :, None], points[:, None]), axis=-1)
        return pairs.reshape(-1, 2), tangents

    def _ring_turning(self, x, by_side) -> np.ndarray:
        """Compute the tangents of sides (s) in a body of revolution, shape (16 s, 2, 2).

        Parameters
        ----------
        x : ndarray, shape (s, 4, 2)
            Their deformed points.
        by_side : ndarray, shape (s, 2)
            Pressures at their ends.
        """
        # S_kmn = sum_i size_i int c N_k N_m M_i dN_n/ds ds
        integrals = np.einsum("si,ikmn->skmn", by_side, _RING_INTEGRALS)
        # K_mn = (sum_k S_kmn r_k) Q + (sum_l S_nml Q x_l) e_1^T
        turned = np.einsum("skmn,sk->smn", integrals, x[:, :, 0])
        tangents = turned[..., None, None] * self.inward
        tangents[..., 0] += np.einsum("snml,slc->smnc", integrals, x @ self.inward.T)
        tangents += by_side.mean(axis=1)[:, None, None, None, None] * self._corrections_turning(x)
        return tangents.reshape(-1, 2, 2)

    def _corrections_turning(self, x) -> np.ndarray:
        """Compute d^2 C/dx_m dx_n of the sides (s), shape (s, 4, 4, 2, 2)."""
        chord, bent = _CHORD @ x, _LEADING @ x
        normal, turned = chord @ self.inward.T, bent @ self.inward
        # b_m = a_m Q t + D_m Q^T T
        # d^2 C/dx_m dx_n = -c/180 [ D_m e_1 b_n^T + D_n b_m e_1^T + t_1 (a_m D_n Q + D_m a_n Q^T) ]
        slopes = _LEADING[:, None] * normal[:, None] + _CHORD[:, None] * turned[:, None]
        out = np.zeros((len(x), 4, 4, 2, 2))
        out[..., 0, :] += _CHORD[:, None, None] * slopes[:, None]
        out[..., :, 0] += _CHORD[:, None] * slopes[:, :, None]
        crossed = np.multiply.outer(_LEADING, _CHORD)[..., None, None]
        both = crossed * self.inward + np.swapaxes(crossed, 0, 1) * self.inward.T
        return -CIRCUMFERENCE / 180.0 * (out + chord[:, 0, None, None, None, None] * both)

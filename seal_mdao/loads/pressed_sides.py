"""Forces of a pressure on the sides of a deformed edge: parabolas through their ends and middles.

The points alternate, particles at even and middles of sides at odd places. With the weights w, linear
along a side between the w_i of its particles, and n into the body,

    f_m = int N_m w n ds = sum_i w_i f_im,    x = sum_n N_n(s) x_n.

In a body of revolution it acts on the deformed surface 2 pi r ds, r = sum_k N_k x_k1,

    f_m = int N_m w n c r ds,    c r = 2 pi r in metres (``rkpm.axisymmetry``).

With w = 1 these forces are the derivative of the volume pi int r^2 dz (m mm^2) between the edge and the
axis, as those of plane strain are that of the area, except at the ends of the edge.
"""

import numpy as np

from seal_mdao.rkpm.axisymmetry import CIRCUMFERENCE


def _side_shapes(n_gauss: int) -> tuple:
    """Evaluate weights, N, dN/ds and M at Gauss points of [0, 1]: quadratic N with nodes 0, 1/2, 1 and
    linear M with nodes 0, 1."""
    s, weight = np.polynomial.legendre.leggauss(n_gauss)
    s = 0.5 + 0.5 * s
    # N = ((1 - s)(1 - 2 s), 4 s (1 - s), s (2 s - 1)),  M = (1 - s, s)
    shapes = np.stack([(1.0 - s) * (1.0 - 2.0 * s), 4.0 * s * (1.0 - s), s * (2.0 * s - 1.0)])
    slopes = np.stack([4.0 * s - 3.0, 4.0 - 8.0 * s, 4.0 * s - 1.0])
    return 0.5 * weight, shapes, slopes, np.stack([1.0 - s, s])


def _side_integrals() -> np.ndarray:
    """Integrate N_m M_i dN_n/ds over [0, 1], shape (2, 3, 3) of (i, m, n)."""
    # degree 2 + 1 + 1 = 4: three Gauss points are exact
    weight, shapes, slopes, lines = _side_shapes(3)
    return np.einsum("q,mq,iq,nq->imn", weight, shapes, lines, slopes)


def _ring_integrals() -> np.ndarray:
    """Integrate c N_k N_m M_i dN_n/ds over [0, 1], shape (2, 3, 3, 3) of (i, k, m, n)."""
    # degree 2 + 2 + 1 + 1 = 6: four Gauss points are exact
    weight, shapes, slopes, lines = _side_shapes(4)
    return CIRCUMFERENCE * np.einsum("q,kq,mq,iq,nq->ikmn", weight, shapes, shapes, lines, slopes)


_INTEGRALS = _side_integrals()
_RING_INTEGRALS = _ring_integrals()


class PressedSides:
    """Sides of an edge under pressure.

    Attributes
    ----------
    points : ndarray of int, shape (s, 3)
        First particle, middle and last particle of every side.
    inward : ndarray, shape (2, 2)
        Q: quarter turn of the tangent into the body.
    axisymmetric : bool

    Parameters
    ----------
    count : int
        Number of sides.
    left : bool
        Whether the body is on the left of the edge, else on its right.
    axisymmetric : bool
        Whether the edge is turned about the axis x = 0.
    """

    def __init__(self, count: int, left: bool, axisymmetric: bool):
        self.points = 2 * np.arange(count)[:, None] + np.arange(3)
        self.inward = (1.0 if left else -1.0) * np.array([[0.0, -1.0], [1.0, 0.0]])
        self.axisymmetric = axisymmetric

    def _integrals(self, x) -> np.ndarray:
        """Integrate N_m M_i dN_n/ds, in a body of revolution times c r, over the sides (s): shape
        (2, 3, 3), or (2, s, 3, 3)."""
        if not self.axisymmetric:
            return _INTEGRALS
        # c r = c sum_k N_k x_k1
        return np.einsum("ikmn,sk->ismn", _RING_INTEGRALS, x[self.points, 0])

    def forces(self, x) -> np.ndarray:
        """Compute the force on the points per unit pressure and unit weight, shape (k, m, 2)."""
        # f_im = int N_m M_i n ds = sum_n [int N_m M_i dN_n/ds ds] Q x_n,  Q: quarter turn inward
        inward = x[self.points] @ self.inward.T
        out = np.zeros((len(self.points) + 1, *x.shape))
        side = np.arange(len(self.points))[:, None]
        for end, integrals in enumerate(self._integrals(x)):
            # each point occurs once per side
            out[side + end, self.points] += integrals @ inward
        return out

    def tangents(self, x, size):
        """Compute pairs of points and tangents of a follower pressure ``size`` (k,) at the particles."""
        wetted = np.flatnonzero((size[:-1] != 0.0) | (size[1:] != 0.0))
        by_side = np.stack([size[wetted], size[wetted + 1]], axis=1)
        points = self.points[wetted]
        if self.axisymmetric:
            tangents = self._ring_turning(x[points], by_side)
        else:
            # K_mn = sum_i size_i [int N_m M_i dN_n/ds ds] Q
            integrals = np.einsum("si,imn->smn", by_side, _INTEGRALS)
            tangents = integrals.reshape(-1, 1, 1) * self.inward
        pairs = np.stack(np.broadcast_arrays(points[:, :, None], points[:, None]), axis=-1)
        return pairs.reshape(-1, 2), tangents

    def _ring_turning(self, x, by_side) -> np.ndarray:
        """Compute the tangents of sides (s) in a body of revolution, shape (9 s, 2, 2).

        Parameters
        ----------
        x : ndarray, shape (s, 3, 2)
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
        return tangents.reshape(-1, 2, 2)

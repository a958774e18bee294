"""Rows whose determinants are the part of a deformed cell's area that is quadratic in displacements.

The boundary of a cell with displacements u = sum_I Phi_I d_I encloses the area

    A + sum_e Phi_e d . n_e + 1/2 oint u x du.

The displacement along an edge from corner e to e + 1 is the parabola through both values u_e and u_e+1
whose integral is that of the two Gauss points, with s_e the sum of the values there less those of the
ends. Exactly,

    1/2 oint u x du = sum_e 1/2 (s_e - s_4 + u_e+1 - u_4) x (u_e+1 - u_e),    e = 1, 2, 3.

Each term is det G of G_i1 = sum_I a_I d_Ii, G_i2 = sum_I b_I d_Ii, with rows a_I and b_I that are linear
in the shape functions at the Gauss points and corners: three pairs of rows for each cell, as of three
quadrature points. Neighbouring cells share the edge between them, so that their areas add up to that of
the body: a uniform pressure does no work on displacements that leave the boundary where it is.
Quadrature of det F does not have this property, and under a high pressure the displacements oscillate.

On edges of the essential boundary the ends take the place of the Gauss points: s_e = 0.

In a body of revolution the mean circumference c = V / A, with V = sum_q c w and A = sum_q w, takes the
rows to the volume. The sum of c w det(F - 1) over the quadrature points and c times this area are not
the same for a linear displacement, for the gradients obey the divergence theorem around the axis. Two
more pairs of rows,

    - V det Gbar + V det M,    Gbar = (1 / A) sum_e Phi_e d n_e,    M = (1 / V) sum_q c w grad u,

the mean gradients of the boundary and of the quadrature, remove this difference.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import internal

CORNERS = 8
"""Index of the first corner among the points of a cell, after the two of each of the four edges."""

PLANE, AROUND = 3, 5
"""Pairs of rows of a cell in plane strain and in a body of revolution."""


class AreaFactors(NamedTuple):
    """Factors of the rows of areas.

    Attributes
    ----------
    values : ndarray, shape (n_cells, 3)
        V / A, 1 / A and 1 / V.
    volumes, areas : ndarray, shape (n_cells, 1)
        V and A.
    """

    values: np.ndarray
    volumes: np.ndarray
    areas: np.ndarray

    def rates(self, volume_rates, area_rates) -> np.ndarray:
        """Rates for those of V and A, shape (P, n_cells), as (P, n_cells, 3)."""
        by_volume, by_area = self._derivatives()
        return by_volume * volume_rates[..., None] + by_area * area_rates[..., None]

    def seeds(self, bar: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Transpose: seeds (n_cells, 3, M) to those on V and A, shape (n_cells, M)."""
        return tuple(np.einsum("ck,ckm->cm", own, bar) for own in self._derivatives())

    def _derivatives(self) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives in V and in A, shape (n_cells, 3)."""
        v, a = self.volumes, self.areas
        nothing = np.zeros_like(v)
        return np.hstack([1 / a, nothing, -1 / v**2]), np.hstack([-v / a**2, -1 / a**2, nothing])


def area_factors(volume_weights: np.ndarray, weights: np.ndarray) -> AreaFactors:
    """Compute the factors from the weights c w and w, shape (n_cells, q)."""
    v, a = (own.sum(axis=1, keepdims=True) for own in (volume_weights, weights))
    return AreaFactors(np.hstack([v / a, 1 / a, 1 / v]), v, a)


@internal
def area_rows(values, out):
    """Fill a_I and b_I, ``out`` (3, 2, m), from values at the points of a cell, ``values`` (12, m)."""
    c = CORNERS
    for i in range(values.shape[1]):
        # s_4 + u_4
        last = values[6, i] + values[7, i] - values[c, i]
        for e in range(3):
            start, end = values[c + e, i], values[c + e + 1, i]
            # s_e + u_e+1 = u_p + u_q - u_e
            out[e, 0, i] = 0.5 * (values[2 * e, i] + values[2 * e + 1, i] - start - last)
            out[e, 1, i] = end - start


@internal
def add_area_row_seeds(seeds, value_bar):
    """Transpose of ``area_rows``: seeds (3, 2, m) on the rows, added to those on the values (12, m)."""
    c = CORNERS
    for i in range(value_bar.shape[1]):
        for e in range(3):
            on_a, on_b = 0.5 * seeds[e, 0, i], seeds[e, 1, i]
            value_bar[2 * e, i] += on_a
            value_bar[2 * e + 1, i] += on_a
            value_bar[c + e, i] -= on_a + on_b
            value_bar[c + e + 1, i] += on_b
            # of s_4 + u_4
            value_bar[6, i] -= on_a
            value_bar[7, i] -= on_a
            value_bar[c, i] += on_a

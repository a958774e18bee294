"""Monomial basis H(x - x_I) of Eq. (2), scaled by a length so that M(x) is well conditioned."""

import numpy as np

from seal_mdao.compilation import inlined

BASIS_SIZE = {1: 3, 2: 6}

_POWERS = [(degree - b, b) for degree in range(5) for b in range(degree + 1)]
_INDEX = {powers: index for index, powers in enumerate(_POWERS)}

POWER = np.array(_POWERS).T.copy()
"""Powers of x and of y in the monomials up to the fourth degree, shape (2, 15)."""
PRODUCT = np.array([[_INDEX[a + c, b + d] for c, d in _POWERS[:6]] for a, b in _POWERS[:6]])
"""Index of the product H_a H_b of two monomials of the basis, shape (6, 6)."""
LOWERED = np.array(
    [[_INDEX.get((a - x, b - y), 0) for a, b in _POWERS] for x, y in ((1, 0), (0, 1))]
)
"""Index of each of them with one x, one y less (its derivative), shape (2, 15)."""


@inlined
def basis_slope(a, j, scale):
    """Differentiate monomial ``a`` along component ``j``: a factor, per length, and the monomial that
    it multiplies."""
    # H_a = (x/s)^px (y/s)^py:  H_a,j = (p_j / s) H_b, b having one factor x_j less
    return POWER[j, a] / scale, LOWERED[j, a]


@inlined
def fill_monomials(h):
    """Write 1, x, y, x^2, xy, y^2, ... of n points, as many as ``h`` (size, n) has rows; its rows 1 and
    2 hold x and y."""
    n = h.shape[1]
    # H_0 = 1
    for i in range(n):
        h[0, i] = 1.0
    # the others by recursion: H_e = (x/s) H_b, or (y/s) H_b where H_e has no factor x
    for e in range(3, len(h)):
        by = 0 if POWER[0, e] > 0 else 1
        lowered = LOWERED[by, e]
        for i in range(n):
            h[e, i] = h[1 + by, i] * h[lowered, i]

"""Monomial basis H(x - x_I) of Eq. (2), scaled by a length so that M(x) is well conditioned."""

import numpy as np

from seal_mdao.compilation import inlined

BASIS_SIZE = {1: 3, 2: 6}

_POWERS = [(degree - b, b) for degree in range(5) for b in range(degree + 1)]
_PLACE = {powers: place for place, powers in enumerate(_POWERS)}

POWER = np.array(_POWERS).T.copy()
"""Powers of x and of y in the monomials up to the fourth degree, shape (2, 15)."""
PRODUCT = np.array([[_PLACE[a + c, b + d] for c, d in _POWERS[:6]] for a, b in _POWERS[:6]])
"""Place of the product of two monomials of the basis among them, shape (6, 6)."""
LOWERED = np.array(
    [[_PLACE.get((a - x, b - y), 0) for a, b in _POWERS] for x, y in ((1, 0), (0, 1))]
)
"""Place of each of them with one x, one y less, shape (2, 15)."""


@inlined
def basis_slope(a, j, scale):
    """Derivative of monomial ``a`` along component ``j``: a factor, per length, and the monomial that
    it multiplies."""
    return POWER[j, a] / scale, LOWERED[j, a]


@inlined
def fill_monomials(h):
    """Write 1, x, y, x^2, xy, y^2, ... of n points, as many as ``h`` (size, n) has rows; its rows 1 and
    2 hold x and y."""
    n = h.shape[1]
    for i in range(n):
        h[0, i] = 1.0
    for e in range(3, len(h)):
        by = 0 if POWER[0, e] > 0 else 1
        lowered = LOWERED[by, e]
        for i in range(n):
            h[e, i] = h[1 + by, i] * h[lowered, i]

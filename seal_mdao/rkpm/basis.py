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
def fill_basis(rx, ry, scale, h):
    """Write H(r / scale) and its first and second derivatives.

    Parameters
    ----------
    rx, ry : float
        Components of ``x - x_I``.
    scale : float
        Length that makes the monomials dimensionless.
    h : ndarray, shape (6, m)
        Rows: H, H_x, H_y, H_xx, H_xy, H_yy; ``m`` is 3 (linear) or 6 (quadratic).
    """
    s = 1.0 / scale
    x, y = rx * s, ry * s
    h[:] = 0.0
    h[0, 0] = 1.0
    h[0, 1] = x
    h[0, 2] = y
    h[1, 1] = h[2, 2] = s
    if h.shape[1] == 6:
        h[0, 3] = x * x
        h[0, 4] = x * y
        h[0, 5] = y * y
        h[1, 3] = 2.0 * x * s
        h[1, 4] = y * s
        h[2, 4] = x * s
        h[2, 5] = 2.0 * y * s
        h[3, 3] = h[5, 5] = 2.0 * s * s
        h[4, 4] = s * s


@inlined
def fill_monomials(x, y, monomials):
    """Write 1, x, y, x^2, xy, y^2, ... of as many degrees as there are places for."""
    monomials[0] = 1.0
    before, at, degree = 0, 1, 1
    while at < monomials.size:
        for b in range(degree):
            monomials[at + b] = x * monomials[before + b]
        monomials[at + degree] = y * monomials[before + degree - 1]
        before, at, degree = at, at + degree + 1, degree + 1

"""Monomial basis H(x - x_I) of Eq. (2), scaled by a length so that M(x) is well conditioned."""

from seal_mdao.compilation import inlined

BASIS_SIZE = {1: 3, 2: 6}


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
    h[0, 0], h[0, 1], h[0, 2] = 1.0, x, y
    h[1, 0], h[1, 1], h[1, 2] = 0.0, s, 0.0
    h[2, 0], h[2, 1], h[2, 2] = 0.0, 0.0, s
    for a in range(3):
        h[3, a] = h[4, a] = h[5, a] = 0.0
    if h.shape[1] == 6:
        h[0, 3], h[0, 4], h[0, 5] = x * x, x * y, y * y
        h[1, 3], h[1, 4], h[1, 5] = 2.0 * x * s, y * s, 0.0
        h[2, 3], h[2, 4], h[2, 5] = 0.0, x * s, 2.0 * y * s
        h[3, 3], h[3, 4], h[3, 5] = 2.0 * s * s, 0.0, 0.0
        h[4, 3], h[4, 4], h[4, 5] = 0.0, s * s, 0.0
        h[5, 3], h[5, 4], h[5, 5] = 0.0, 0.0, 2.0 * s * s

"""Cubic B-spline kernel phi_a(x - x_I) of Eq. (1) and its derivatives.

Round kernels take the distance, product kernels the two coordinates along the directions of the
cells around: on a regular grid, supports of two spacings then give the uniform bicubic B-splines.
"""

from seal_mdao.compilation import inlined


@inlined
def cubic_b_spline(z):
    """Evaluate the cubic B-spline and its derivatives at the normalised distance ``z = |x - x_I| / a``.

    Returns
    -------
    w : float
        phi(z).
    w1 : float
        phi'(z) / z, finite at z = 0.
    w2 : float
        phi''(z) - phi'(z) / z, zero at z = 0.
    """
    if z < 0.5:
        # phi = 2/3 - 4 z^2 + 4 z^3,  phi' = -8 z + 12 z^2,  phi'' = -8 + 24 z
        return 2.0 / 3.0 - 4.0 * z * z * (1.0 - z), -8.0 + 12.0 * z, 12.0 * z
    if z < 1.0:
        # phi = 4/3 (1 - z)^3,  phi' = -4 (1 - z)^2,  phi'' = 8 (1 - z)
        s = 1.0 - z
        w1 = -4.0 * s * s / z
        return 4.0 / 3.0 * s * s * s, w1, 8.0 * s - w1
    return 0.0, 0.0, 0.0


@inlined
def kernel_derivatives(rx, ry, a):
    """Evaluate a round kernel of support radius ``a`` at ``r = x - x_I``: value, gradient, Hessian.

    Returns
    -------
    tuple of float
        phi, phi_x, phi_y, phi_xx, phi_xy, phi_yy (per length, per length squared).
    """
    distance = (rx * rx + ry * ry) ** 0.5
    w, w1, w2 = cubic_b_spline(distance / a)
    ex, ey = (rx / distance, ry / distance) if distance > 0.0 else (0.0, 0.0)
    # with e = r / |r|:  grad phi_a = (phi' / z) r / a^2
    # H = [ (phi' / z) I + (phi'' - phi' / z) e e^T ] / a^2
    s = 1.0 / (a * a)
    return (
        w,
        w1 * rx * s,
        w1 * ry * s,
        (w1 + w2 * ex * ex) * s,
        w2 * ex * ey * s,
        (w1 + w2 * ey * ey) * s,
    )


@inlined
def product_kernel_derivatives(rx, ry, ax, ay, bx, by):
    """Evaluate the product kernel phi(a . r) phi(b . r) at ``r = x - x_I``: value, gradient, Hessian.

    Parameters
    ----------
    ax, ay, bx, by : float
        Inverse half-widths of the support along its two directions, per length.

    Returns
    -------
    tuple of float
        As of ``kernel_derivatives``.
    """
    s, t = ax * rx + ay * ry, bx * rx + by * ry
    p, p1, p2 = cubic_b_spline(abs(s))
    q, q1, q2 = cubic_b_spline(abs(t))
    # phi'' = phi' / z + (phi'' - phi' / z);  phi' with the sign of the coordinate
    p2, q2 = p1 + p2, q1 + q2
    p1, q1 = p1 * s, q1 * t
    # grad phi_a = p' q a + p q' b
    # H = p'' q a a^T + p' q' (a b^T + b a^T) + p q'' b b^T
    ss, st, tt = p2 * q, p1 * q1, p * q2
    return (
        p * q,
        p1 * q * ax + p * q1 * bx,
        p1 * q * ay + p * q1 * by,
        ss * ax * ax + 2.0 * st * ax * bx + tt * bx * bx,
        ss * ax * ay + st * (ax * by + ay * bx) + tt * bx * by,
        ss * ay * ay + 2.0 * st * ay * by + tt * by * by,
    )

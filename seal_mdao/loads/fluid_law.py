"""How far a fluid gets along an edge: weights from 1, wetted, to 0, dry, from point to point.

The seal presses on what is opposite to a point i with P_i = c_i + p w_i, contact pressure and the share
of the fluid's that is there. The fluid goes on as long as the seal presses with less than it does,

    w_i = w_{i-1} (1 - s(u_i)),    u_i = (P_i - p) / (share p),    w_{-1} = 1,

with the smooth step s from 0 at u = 0 to 1 at u = 1. Both together are one equation for u_i,

    p (share u_i + 1 - w_{i-1} (1 - s(u_i))) = c_i,

whose left side grows with u_i: there is one solution. With c_i in place of P_i there would be two
states, wet and dry, wherever c_i is between p and 2 p, and the front would jump from point to point.
"""

import numpy as np

from seal_mdao.compilation import compiled, inlined

MOST_ITERATIONS = 200
"""Bisection alone needs some 60."""


@inlined
def smooth_step(u):
    """s and ds/du: 0 up to u = 0, 1 from u = 1 on, two derivatives continuous."""
    if u <= 0.0:
        return 0.0, 0.0
    if u >= 1.0:
        return 1.0, 0.0
    return u * u * u * (10.0 + u * (6.0 * u - 15.0)), 30.0 * (u * (1.0 - u)) ** 2


@compiled
def _excess(closing, pressure, share, before):
    """u_i between 0 and 1."""
    low, high, u = 0.0, 1.0, 0.5
    for _ in range(MOST_ITERATIONS):
        wet, slope = smooth_step(1.0 - u)  # 1 - s(u), never negative
        over = pressure * (share * u + 1.0 - before * wet) - closing
        if over > 0.0:
            high = u
        else:
            low = u
        following = u - over / (pressure * (share + before * slope))
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - u) <= 2.0 * np.finfo(np.float64).eps * u:
            break
        u = following
    return u


@compiled
def wetting(closing, pressure, share):
    """Weights of points along an edge and their derivatives.

    Parameters
    ----------
    closing : ndarray, shape (k,)
        Contact pressure of every point from the wet end on, kPa.
    pressure : float
        Of the fluid, not negative, kPa.
    share : float
        Of it by which the seal has to press with more where it is dry.

    Returns
    -------
    weight, by_closing, by_pressure, by_before : ndarray, shape (k,)
        w_i, and its derivatives with c_i, p and w_{i-1}, each with the others fixed.
    """
    k = closing.size
    weight, by_closing = np.zeros(k), np.zeros(k)
    by_pressure, by_before = np.zeros(k), np.zeros(k)
    before = 1.0
    for i in range(k):
        if closing[i] <= pressure * (1.0 - before):
            weight[i], by_before[i] = before, 1.0
        elif closing[i] < pressure * (1.0 + share):
            wet, slope = smooth_step(1.0 - _excess(closing[i], pressure, share, before))
            stiff = pressure * (share + before * slope)
            weight[i] = before * wet
            by_closing[i] = -before * slope / stiff
            by_pressure[i] = before * slope * closing[i] / (pressure * stiff)
            by_before[i] = wet * (1.0 - before * slope * pressure / stiff)
        before = weight[i]
    return weight, by_closing, by_pressure, by_before


@compiled
def accumulated(by_closing, by_pressure, by_before):
    """Derivatives of all weights with all contact pressures and that of the fluid, from those of
    ``wetting``.

    Returns
    -------
    on_closing : ndarray, shape (k, k)
        d w_i / d c_j.
    on_pressure : ndarray, shape (k,)
    """
    k = by_closing.size
    on_closing, on_pressure = np.diag(by_closing), by_pressure.copy()
    for i in range(1, k):
        on_pressure[i] += by_before[i] * on_pressure[i - 1]
        for j in range(i):
            on_closing[i, j] = by_before[i] * on_closing[i - 1, j]
    return on_closing, on_pressure

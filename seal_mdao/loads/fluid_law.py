"""Penetration of a fluid along an edge: weights from 1 (wetted) to 0 (dry), from point to point.

The total pressure at a point i is P_i = c_i + p w_i, contact pressure and the acting fraction of the
fluid pressure. The fluid advances as long as the total pressure is below the fluid pressure,

    w_i = w_{i-1} (1 - s(u_i)),    u_i = (P_i - p) / (share p),    w_{-1} = 1,

with the smooth step s from 0 at u = 0 to 1 at u = 1. Both together are one equation for u_i,

    p (share u_i + 1 - w_{i-1} (1 - s(u_i))) = c_i,

whose left side increases with u_i: the solution is unique. With c_i in place of P_i there would be two
states, wet and dry, for c_i between p and 2 p, and the front would jump from point to point.
"""

import numpy as np

from seal_mdao.compilation import compiled, inlined

MOST_ITERATIONS = 200
"""Limit of iterations; bisection alone needs about 60."""


@inlined
def smooth_step(u):
    """Evaluate s and ds/du: 0 for u <= 0, 1 for u >= 1, with two continuous derivatives."""
    if u <= 0.0:
        return 0.0, 0.0
    if u >= 1.0:
        return 1.0, 0.0
    # s = 10 u^3 - 15 u^4 + 6 u^5,  s' = 30 u^2 (1 - u)^2
    return u * u * u * (10.0 + u * (6.0 * u - 15.0)), 30.0 * (u * (1.0 - u)) ** 2


@compiled
def _excess(closing, pressure, share, before):
    """Solve for u_i between 0 and 1 by Newton's method, safeguarded by bisection."""
    low, high, u = 0.0, 1.0, 0.5
    for _ in range(MOST_ITERATIONS):
        # 1 - s(u) = s(1 - u), never negative, and s'(u) = s'(1 - u)
        wet, slope = smooth_step(1.0 - u)
        # f(u) = p (share u + 1 - w_(i-1) (1 - s(u))) - c_i,  increasing
        over = pressure * (share * u + 1.0 - before * wet) - closing
        if over > 0.0:
            high = u
        else:
            low = u
        # u - f / f',  f' = p (share + w_(i-1) s'(u))
        following = u - over / (pressure * (share + before * slope))
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - u) <= 2.0 * np.finfo(np.float64).eps * u:
            break
        u = following
    return u


@compiled
def wetting(closing, pressure, share):
    """Compute the weights of points along an edge and their derivatives.

    Parameters
    ----------
    closing : ndarray, shape (k,)
        Contact pressure of every point from the wet end on, kPa.
    pressure : float
        Of the fluid, not negative, kPa.
    share : float
        Fraction of the fluid pressure by which the contact pressure must exceed it at a dry point.

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
        # u_i <= 0: w_i = w_(i-1)
        if closing[i] <= pressure * (1.0 - before):
            weight[i], by_before[i] = before, 1.0
        # 0 < u_i < 1, with f' = p (share + w_(i-1) s');  u_i >= 1: w_i = 0
        elif closing[i] < pressure * (1.0 + share):
            wet, slope = smooth_step(1.0 - _excess(closing[i], pressure, share, before))
            stiff = pressure * (share + before * slope)
            weight[i] = before * wet
            # dw_i = -w_(i-1) s' du_i + (1 - s) dw_(i-1), from f = 0:
            # du_i/dc = 1 / f',  du_i/dp = -(c / p) / f',  du_i/dw_(i-1) = p (1 - s) / f'
            by_closing[i] = -before * slope / stiff
            by_pressure[i] = before * slope * closing[i] / (pressure * stiff)
            by_before[i] = wet * (1.0 - before * slope * pressure / stiff)
        before = weight[i]
    return weight, by_closing, by_pressure, by_before


@compiled
def accumulated(by_closing, by_pressure, by_before):
    """Accumulate the derivatives of ``wetting`` along the edge: those of all weights in all contact
    pressures and in the fluid pressure.

    Returns
    -------
    on_closing : ndarray, shape (k, k)
        d w_i / d c_j.
    on_pressure : ndarray, shape (k,)
    """
    k = by_closing.size
    on_closing, on_pressure = np.diag(by_closing), by_pressure.copy()
    for i in range(1, k):
        # dw_i/dp = (dw_i/dp)_(w fixed) + dw_i/dw_(i-1) dw_(i-1)/dp
        on_pressure[i] += by_before[i] * on_pressure[i - 1]
        for j in range(i):
            # dw_i/dc_j = dw_i/dw_(i-1) dw_(i-1)/dc_j, j < i
            on_closing[i, j] = by_before[i] * on_closing[i - 1, j]
    return on_closing, on_pressure

"""C(c) = cosh(a arccosh c) for c >= 1: smooth sums of powers of the two stretches in the plane.

With c = T / (2 J) = cosh u the principal stretches in the plane are J^(1/2) exp(+-u / 2), so that

    lambda_1^alpha + lambda_2^alpha = 2 J^a C(c),   a = alpha / 2.

The stretches are not differentiable where they are equal (c = 1); C is. In v = c - 1 it is

    C = sum_k t_k v^k,   t_0 = 1,   t_(k+1) = t_k (a^2 - k^2) / ((2 k + 1)(k + 1)),   |v| < 2,

Chebyshev's polynomial where a is a whole number (Abramowitz and Stegun, 15.4.3 and 22.5.47).
"""

from functools import lru_cache

import numpy as np

from seal_mdao.compilation import compiled, inlined

SWITCH = 0.1
"""v below which the series is summed. The closed form of C'' divides rounding by 2 v, the terms of
the series fall like (v / 2)^k: at this v the first costs less than a digit and some 13 terms do."""


def stretch_power(v, a: float, rows: int = 3) -> np.ndarray:
    """Evaluate C, C', C'', and with five rows also the derivatives of C and C' with respect to a.

    Parameters
    ----------
    v : ndarray
        c - 1; values below zero, from rounding, are continued smoothly.
    a : float
        Half the exponent alpha, not zero.

    Returns
    -------
    ndarray, shape (rows, ...)
    """
    kind = np.result_type(v, a, float)
    v = np.asarray(v, kind)
    out = np.empty((rows, *v.shape), kind)
    _fill(v.ravel(), a, _coefficients(a), out.reshape(rows, -1))
    return out


@lru_cache(maxsize=64)
def _coefficients(a) -> np.ndarray:
    """Compute the coefficients of v^k in the columns C, C', C'', dC/da, dC'/da.

    The series ends where the next term of C'', which converges last, is below rounding relative to the
    first at ``SWITCH``; for k > |a| the ratio of successive terms is below v / 2.
    """
    # t_0 = 1, t_1 = a^2 and their derivatives in a
    terms, rates = [1.0, a * a], [0.0, 2.0 * a]
    while True:
        k = len(terms) - 1
        size = max(abs(terms[k] / terms[1]), abs(rates[k] / rates[1])) * k * k * SWITCH ** (k - 2)
        if k > abs(a) + 2 and size < 0.1 * np.finfo(float).eps:
            break
        # t_(k+1) = t_k (a^2 - k^2) / ((2 k + 1)(k + 1)),  and its derivative in a
        divisor = (2 * k + 1) * (k + 1)
        factor = (a * a - k * k) / divisor
        rates.append(rates[k] * factor + terms[k] * 2.0 * a / divisor)
        terms.append(terms[k] * factor)
    # C = sum t_k v^k,  C' = sum (k + 1) t_(k+1) v^k,  C'' = sum (k + 1)(k + 2) t_(k+2) v^k
    k = np.arange(len(terms) - 2)
    t, r = np.array(terms), np.array(rates)
    return np.stack(
        [t[k], (k + 1) * t[k + 1], (k + 1) * (k + 2) * t[k + 2], r[k], (k + 1) * r[k + 1]], axis=1
    )


@compiled
def _fill(v, a, table, out):
    rows, last = len(out), len(table) - 1
    for i in range(v.size):
        x = v[i]
        if x.real < SWITCH:
            for m in range(rows):
                # Horner's scheme, in the number type of x (complex steps)
                total = table[last, m] + 0.0 * x
                for k in range(last - 1, -1, -1):
                    total = total * x + table[k, m]
                out[m, i] = total
        else:
            values = closed_form(x, a)
            for m in range(rows):
                out[m, i] = values[m]


@inlined
def closed_form(v, a):
    """Evaluate the five values from hyperbolic functions, away from v = 0."""
    # c = cosh u,  s = sinh u = sqrt(c^2 - 1),  u = ln(c + s)
    c, s = 1.0 + v, np.sqrt(v * (v + 2.0))
    u = np.log(c + s)
    power = np.exp(a * u)
    cosh, sinh = 0.5 * (power + 1.0 / power), 0.5 * (power - 1.0 / power)
    # C' = a sinh(a u) / s,  C'' = (a^2 C - c C') / s^2 (Chebyshev's equation)
    # dC/da = u sinh(a u),  dC'/da = (sinh(a u) + a u cosh(a u)) / s
    slope = a * sinh / s
    return cosh, slope, (a * a * cosh - c * slope) / (s * s), u * sinh, (sinh + a * u * cosh) / s

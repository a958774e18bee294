"""Minimum of a function of one variable, without ``scipy.optimize``, whose import takes longer."""

from collections.abc import Callable

GOLDEN = 0.5 * (5.0**0.5 - 1.0)
"""Ratio of the golden section, g^2 = 1 - g."""


def least_between(function: Callable, first: float, last: float, within: float = 1e-8) -> float:
    """Find where a function with one minimum in an interval is least, by golden-section search.

    Parameters
    ----------
    function : callable
    first, last : float
        Ends of the interval.
    within : float, optional
        Largest error of the result; closer than 1e-8 of the interval values differ by rounding alone.
    """
    # a < x < y < b with x - a = b - y = g^2 (b - a)
    a, b = first, last
    x, y = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    at_x, at_y = function(x), function(y)
    while b - a > within:
        # the minimum is not beyond the larger of both values
        if at_x < at_y:
            b, y, at_y = y, x, at_x
            x = b - GOLDEN * (b - a)
            at_x = function(x)
        else:
            a, x, at_x = x, y, at_y
            y = a + GOLDEN * (b - a)
            at_y = function(y)
    return x if at_x < at_y else y

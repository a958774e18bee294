"""The record of one test problem."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

INF = np.inf


@dataclass(frozen=True)
class HSProblem:
    """A problem of the collection of Hock and Schittkowski (1981).

    Attributes
    ----------
    number : int
        Number in the collection.
    start : tuple of float
        Starting point.
    optimum : float
        Objective at the solution, as printed in the collection (or its closed form).
    f, df : callable
        Objective and gradient.
    c, dc : callable or None
        Constraints and their Jacobian; None where there are only bounds.
    c_lower, c_upper : tuple of float
        Bounds of the constraints.
    lower, upper : float or tuple of float
        Bounds of the variables.
    linear : bool
        Whether all constraints are linear.
    """

    number: int
    start: tuple[float, ...]
    optimum: float
    f: Callable
    df: Callable
    c: Callable | None = None
    dc: Callable | None = None
    c_lower: tuple[float, ...] = ()
    c_upper: tuple[float, ...] = ()
    lower: float | tuple[float, ...] = -INF
    upper: float | tuple[float, ...] = INF
    linear: bool = False


def minus_product(x):
    """Return minus the product of all variables."""
    return -np.prod(x)


def d_minus_product(x):
    """Return the gradient of minus the product of all variables."""
    return [-np.prod(np.delete(x, i)) for i in range(len(x))]

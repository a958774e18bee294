"""Rigid profiles of cubic pieces: given by coefficients, or as a C2 spline through points."""

import numpy as np
import scipy

from seal_mdao.geometry.curve import CUBIC
from seal_mdao.geometry.profile import PieceRates, Pieces, RigidProfile, rigid_profile
from seal_mdao.values import require

SAME = 1e-9
"""Relative difference of points, and of their rates, that are equal but for rounding."""


def cubic_profile(knots, coefficients, rates=None, closed: bool = False) -> RigidProfile:
    """Build a profile of cubic pieces x_c = sum_k c_k (xi - knot)^k between ``knots``.

    The ends continue along their tangents without end unless the profile is closed. Pieces should join
    with a continuous t: the slip over a joint is measured with |t|, Eq. (19).

    Parameters
    ----------
    knots : array_like, shape (n + 1,)
        Increasing natural coordinates; fixed numbers that do not change with the shape.
    coefficients : array_like, shape (n, 4, 2)
    rates : array_like, shape (S, n, 4, 2), optional
        Their derivatives with respect to S shape parameters.
    closed : bool
        Whether the last piece ends where the first begins.

    Raises
    ------
    ValueError
        For knots that do not increase, or arrays that do not fit each other.
    """
    knots, coefficients = np.asarray(knots, float), np.asarray(coefficients, float)
    n = len(knots) - 1
    require(
        n > 0 and np.all(np.diff(knots) > 0.0),
        "the knots of the cubic curves of a profile must increase",
    )
    rates = np.zeros((0, n, 4, 2)) if rates is None else np.asarray(rates, float)
    require(
        coefficients.shape == (n, 4, 2) and rates.shape[1:] == (n, 4, 2),
        f"{n + 1} knots need coefficients of shape ({n}, 4, 2) and rates (S, {n}, 4, 2), got "
        f"{coefficients.shape} and {rates.shape}",
    )
    pieces = Pieces(
        np.full(n, CUBIC), np.zeros((n, 2)), np.zeros(n), np.ones(n), knots[:-1], np.diff(knots),
        coefficients,
    )  # fmt: skip
    period = knots[-1] - knots[0] if closed else 0.0
    return rigid_profile(pieces, PieceRates(coefficient=rates), period)


def spline_profile(points, rates=None, closed: bool = False, parameter=None) -> RigidProfile:
    """Build the C2 cubic spline through ``points``, with exact rates.

    Not-a-knot at the ends, which continue along their tangents, or periodic when ``closed``.
    The coefficients are linear in the points as long as the natural coordinates of the points stay
    the same numbers; so these are 0, 1, 2, ... or the ``parameter`` given, never computed from points
    of the current design.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Traversed with the rigid body on the left. The last point of a closed profile may repeat the
        first one, and its rates with it; n does not count it.
    rates : array_like, shape (S, n, 2), optional
        Velocities of the points with respect to S shape parameters.
    closed : bool
    parameter : array_like, shape (n,), or (n + 1,) when closed, optional
        Natural coordinates of the points; for points at uneven distances, ``chord_length`` of the
        *nominal* points. Closed: the last is that of the first point after one complete turn.

    Raises
    ------
    ValueError
        For arrays of a wrong shape, coinciding neighbours, coordinates that do not increase.

    Examples
    --------
    An ellipse whose semi-axes are its two shape parameters:

    >>> phi = 2 * np.pi * np.arange(40) / 40
    >>> unit = np.column_stack([np.cos(phi), np.sin(phi)])
    >>> ellipse = spline_profile(unit * [3.0, 2.0], [unit * [1, 0], unit * [0, 1]], closed=True)
    >>> ellipse.n_shapes
    2
    """
    given, points = np.shape(points)[:1], _checked_points(points, closed)
    n = len(points)
    rates = np.zeros((0, n, 2)) if rates is None else np.asarray(rates, float)
    if (n,) != given and rates.shape[1:] == (*given, 2):
        # one point with two rates would not be one point of the next design
        require(
            np.allclose(
                rates[:, -1], rates[:, 0], rtol=SAME, atol=SAME * np.abs(rates).max(initial=0.0)
            ),
            "the last point of the closed profile repeats the first one, but has other rates",
        )
        rates = rates[:, :-1]
    require(
        rates.shape[1:] == (n, 2) and np.isfinite(rates).all(),
        f"rates of {n} points must be finite numbers of shape (S, {n}, 2), got {rates.shape}",
    )
    count = n + closed
    knots = np.arange(float(count)) if parameter is None else np.asarray(parameter, float)
    require(
        knots.shape == (count,) and np.all(np.diff(knots) > 0.0),
        f"parameter must be {count} increasing numbers, got {knots}",
    )
    # x_c(xi) = sum_i B_i(xi) x_i with basis splines of the fixed natural coordinates, so that
    # V_c(xi) = sum_i B_i(xi) x_i': points and rates are columns of one interpolation
    values = np.concatenate([points[np.newaxis], rates]).transpose(1, 0, 2)
    if closed:
        values = np.concatenate([values, values[:1]])
    spline = scipy.interpolate.CubicSpline(
        knots, values, bc_type="periodic" if closed else "not-a-knot"
    )
    # from (power, piece, column, component), highest power first
    coefficients = spline.c[::-1].transpose(2, 1, 0, 3)
    return cubic_profile(knots, coefficients[0], coefficients[1:], closed)


def chord_length(points, closed: bool = False) -> np.ndarray:
    """Compute natural coordinates of points (n, 2) from their distances, (n,), or (n + 1,) if closed.

    With them |t| is about 1 on a smooth curve.
    """
    points = _checked_points(points, closed)
    if closed:
        points = np.concatenate([points, points[:1]])
    # xi_i+1 = xi_i + |x_i+1 - x_i|
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _checked_points(points, closed) -> np.ndarray:
    """Return points (n, 2) as floats, those of a closed profile without a repetition of the first."""
    points = np.asarray(points, float)
    if closed and points.ndim == 2 and points.shape[1] == 2 and len(points) > 1:
        # equal but for rounding, as of angles from 0 to 2 pi
        size = np.ptp(points, axis=0).max()
        points = points[: -1 if np.hypot(*(points[-1] - points[0])) <= SAME * size else None]
    least = 3 if closed else 2
    require(
        points.ndim == 2 and points.shape[1] == 2 and len(points) >= least,
        f"a profile needs points of shape (n, 2), n at least {least}; got shape {points.shape}",
    )
    require(np.isfinite(points).all(), "the points of a profile must be finite")
    step = np.diff(np.concatenate([points, points[:1]]) if closed else points, axis=0)
    same = np.flatnonzero(~step.any(axis=1))
    require(
        same.size == 0,
        f"point {same[:1].sum()} of the profile coincides with the next one; remove one of them",
    )
    return points

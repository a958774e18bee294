"""Bounding circles of pieces of a rigid profile and of runs of pieces, for the contact search."""

import numpy as np

PIECES_A_RUN = 16


def bounding_circles(line, origin, angle, radius, length, closed: bool):
    """Compute centres (b, 2) and radii (b,) of circles around ``PIECES_A_RUN`` consecutive pieces each.

    The end pieces of a profile that is not closed are unbounded: the radius of their runs is infinite.

    Parameters
    ----------
    line : ndarray of bool, shape (n,)
        Whether a piece is straight; others lie in the circle of ``origin`` and ``radius``.
    origin, angle, radius, length : ndarray
        As in ``RigidProfile``.
    closed : bool
        Whether the last piece ends where the first begins.
    """
    # circle of a line: midpoint, L / 2;  of an arc or cubic: origin, |radius|
    half = 0.5 * length
    along = half[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    centre = np.where(line[:, None], origin + along, origin)
    reach = np.where(line, half, np.abs(radius))
    # circle of a run: centre m = mean of the centres c_i, radius max_i |c_i - m| + r_i
    run = np.arange(len(length)) // PIECES_A_RUN
    count = np.bincount(run)
    middle = np.column_stack([np.bincount(run, column) / count for column in centre.T])
    circle = np.zeros(len(count))
    np.maximum.at(circle, run, np.linalg.norm(centre - middle[run], axis=1) + reach)
    if not closed:
        circle[[0, -1]] = np.inf
    return middle, circle


def circles_of_cubics(coefficient, length):
    """Compute centres (n, 2) and radii (n,) of circles around cubic pieces, from Bezier polygons.

    Parameters
    ----------
    coefficient : ndarray, shape (n, 4, 2)
        Of 1, s, s^2, s^3 for s from 0 to ``length`` (n,).
    """
    # control points b_i = sum_k binom(i, k) / binom(3, k) c_k L^k: the piece is in their hull
    scaled = coefficient * length[:, None, None] ** np.arange(4)[:, None]
    to_bezier = np.array([[1, 0, 0, 0], [1, 1 / 3, 0, 0], [1, 2 / 3, 1 / 3, 0], [1, 1, 1, 1]])
    corners = to_bezier @ scaled
    # centre at the middle of the chord, radius max_i |b_i - centre|
    centre = 0.5 * (corners[:, 0] + corners[:, 3])
    return centre, np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)

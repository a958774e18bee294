"""Circles around pieces of a rigid profile and runs of them, so that a search leaves far ones out."""

import numpy as np

PIECES_A_RUN = 16


def bounding_circles(line, origin, angle, radius, length, closed: bool):
    """Centres (b, 2) and radii (b,) of circles around ``PIECES_A_RUN`` consecutive pieces each.

    The end pieces of a profile that is not closed continue for ever: the radius of their runs is
    infinite.

    Parameters
    ----------
    line : ndarray of bool, shape (n,)
        Whether a piece is straight; others lie in the circle of ``origin`` and ``radius``.
    origin, angle, radius, length : ndarray
        As in ``RigidProfile``.
    closed : bool
        Whether the last piece ends where the first begins.
    """
    half = 0.5 * length
    along = half[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    centre = np.where(line[:, None], origin + along, origin)
    reach = np.where(line, half, np.abs(radius))
    run = np.arange(len(length)) // PIECES_A_RUN
    count = np.bincount(run)
    middle = np.column_stack([np.bincount(run, column) / count for column in centre.T])
    circle = np.zeros(len(count))
    np.maximum.at(circle, run, np.linalg.norm(centre - middle[run], axis=1) + reach)
    if not closed:
        circle[[0, -1]] = np.inf
    return middle, circle


def circles_of_cubics(coefficient, length):
    """Centres (n, 2) and radii (n,) of circles around cubic pieces: those of their Bezier polygons.

    Parameters
    ----------
    coefficient : ndarray, shape (n, 4, 2)
        Of 1, s, s^2, s^3 for s from 0 to ``length`` (n,).
    """
    scaled = coefficient * length[:, None, None] ** np.arange(4)[:, None]
    to_bezier = np.array([[1, 0, 0, 0], [1, 1 / 3, 0, 0], [1, 2 / 3, 1 / 3, 0], [1, 1, 1, 1]])
    corners = to_bezier @ scaled
    centre = 0.5 * (corners[:, 0] + corners[:, 3])
    return centre, np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)

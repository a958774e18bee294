"""Circles around runs of pieces of a rigid profile, so that a search can leave far ones out."""

import numpy as np

PIECES_A_RUN = 16


def bounding_circles(line, origin, angle, radius, length):
    """Centres (b, 2) and radii (b,) of circles around ``PIECES_A_RUN`` consecutive pieces each.

    The radius of the runs with the end pieces, which continue for ever, is infinite.

    Parameters
    ----------
    line : ndarray of bool, shape (n,)
        Whether a piece is straight; others are arcs.
    origin, angle, radius, length : ndarray
        As in ``RigidProfile``.
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
    circle[[0, -1]] = np.inf
    return middle, circle

"""Narrow notches of a section, at whose vertices particles are closer to each other."""

import numpy as np

NARROW = np.radians(60.0)
"""Angle of a notch below which points at equal distances from its vertex are nearer to each other than
to the vertex."""


def notch_places(boundaries) -> np.ndarray:
    """Collect the vertices of all notches with an angle of the void below ``NARROW``, (k, 2), mm."""
    return np.concatenate([own.points[_void_angles(own) < NARROW] for own in boundaries])


def _void_angles(boundary) -> np.ndarray:
    """Compute the angles of the void at the points of a boundary, radians; pi where it is smooth."""
    before, after = boundary.tangent[:, 0], boundary.tangent[:, 1]
    # body on the left: the void has the angle pi + atan2(a x b, a . b)
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.pi + np.arctan2(turn, (before * after).sum(axis=1))

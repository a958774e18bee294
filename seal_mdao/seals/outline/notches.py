"""Narrow notches of a section: kernels connect their faces near the vertex (``rkpm.visibility``)."""

from typing import NamedTuple

import numpy as np

NARROW = np.radians(60.0)
"""Angle of a notch below which points at equal distances from its vertex are nearer to each other than
to the vertex."""


class Notch(NamedTuple):
    """A corner of the boundary with a narrow void before it.

    Attributes
    ----------
    place : ndarray, shape (2,)
        Vertex, mm.
    angle : float
        Of the void between its faces, radians.
    reach : float
        Support radius of the particle at the vertex, mm.
    """

    place: np.ndarray
    angle: float
    reach: float


def notch_vertices(boundaries) -> list[np.ndarray]:
    """Find the corners of every boundary with an angle of the void below ``NARROW``, their indices."""
    return [np.flatnonzero(_void_angles(boundary) < NARROW) for boundary in boundaries]


def notch_places(boundaries) -> np.ndarray:
    """Collect the vertices of all narrow notches, shape (k, 2), mm."""
    which = notch_vertices(boundaries)
    return np.concatenate([b.points[own] for b, own in zip(boundaries, which, strict=True)])


def coarsest_notch(boundaries, loops, radius: np.ndarray) -> Notch | None:
    """Find the narrow notch with the largest support radius at its vertex.

    Parameters
    ----------
    boundaries : sequence of Boundary
    loops : sequence of ndarray of int
        Particles at their points.
    radius : ndarray, shape (n,)
        Support radii, mm.
    """
    found = []
    for boundary, loop in zip(boundaries, loops, strict=True):
        angle = _void_angles(boundary)
        for at in np.flatnonzero(angle < NARROW):
            found.append(Notch(boundary.points[at], float(angle[at]), float(radius[loop[at]])))
    return max(found, key=lambda own: own.reach, default=None)


def _void_angles(boundary) -> np.ndarray:
    """Compute the angles of the void at the points of a boundary, radians; pi where it is smooth."""
    before, after = boundary.tangent[:, 0], boundary.tangent[:, 1]
    # body on the left: the void has the angle pi + atan2(a x b, a . b)
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.pi + np.arctan2(turn, (before * after).sum(axis=1))

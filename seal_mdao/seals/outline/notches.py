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


def narrowest_notch(boundaries, loops, radius: np.ndarray) -> Notch | None:
    """Find the corner with the smallest angle of the void, below ``NARROW``.

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
        before, after = boundary.tangent[:, 0], boundary.tangent[:, 1]
        # body on the left: the void has the angle pi + atan2(a x b, a . b)
        turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        angle = np.pi + np.arctan2(turn, (before * after).sum(axis=1))
        angle = np.where(boundary.corner, angle, np.inf)
        at = int(angle.argmin())
        found.append(Notch(boundary.points[at], float(angle[at]), float(radius[loop[at]])))
    narrowest = min(found, key=lambda own: own.angle, default=None)
    return narrowest if narrowest is not None and narrowest.angle < NARROW else None

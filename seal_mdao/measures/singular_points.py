"""Points of the boundary at which the exact stress is infinite."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from seal_mdao.rkpm.cells import sides_of

REENTRANT = np.pi / 4.0
"""Angle by which a boundary turns into the body at a re-entrant corner, at the least."""
FIXED_END = "the end of a fixed edge"
REENTRANT_CORNER = "a re-entrant corner"
"""Kinds of singular points."""


class SingularPoint(NamedTuple):
    """A point of the boundary at which the stress of the exact solution is infinite."""

    place: np.ndarray
    spacing: float
    kind: str


def singular_points(body, particles: np.ndarray) -> list[SingularPoint]:
    """Find re-entrant corners and the ends of fixed edges of a body with these particles (n, 2)."""
    outer = sides_of(body.cells)[0]
    following, before = dict(outer.tolist()), dict(outer[:, ::-1].tolist())
    fixed, found = body.fixed.all(axis=1), []
    for point, after in following.items():
        last = before[point]
        one, other = particles[point] - particles[last], particles[after] - particles[point]
        # turn of the boundary, negative towards the body, which lies on the left
        turn = np.arctan2(one[0] * other[1] - one[1] * other[0], one @ other)
        kind = ""
        # the fixed edge ends here
        if fixed[point] and not (fixed[last] and fixed[after]):
            kind = FIXED_END
        elif turn < -REENTRANT and not fixed[point]:
            kind = REENTRANT_CORNER
        if kind:
            # spacing of the particles there
            size = max(np.linalg.norm(one), np.linalg.norm(other))
            found.append(SingularPoint(particles[point], float(size), kind))
    return found


def away_from_singular(seal, distance: float) -> np.ndarray:
    """Find the points of ``Body.samples`` farther than ``distance`` (mm) from all singular points of the
    nominal section, so that they are the same in every design.

    Raises
    ------
    ValueError
        Where no point is left.
    """
    body, particles = seal.body, seal.nominal_particles
    places = body.samples.at(particles)
    singular = singular_points(body, particles)
    if not singular:
        return np.arange(len(places))
    # |X_i - X_s| > distance for the nearest singular point s
    nearest = cKDTree([point.place for point in singular]).query(places)[0]
    left = np.flatnonzero(nearest > distance)
    if not left.size:
        raise ValueError(
            f"no point of the section is farther than {distance:g} mm from its singular points "
            f"(ends of fixed edges, re-entrant corners); the farthest one is {nearest.max():.3g} "
            "mm away; use a smaller away_from_singular"
        )
    return left

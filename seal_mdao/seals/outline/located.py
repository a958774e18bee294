"""Locate points on the boundary of a section: segment, arc length and order."""

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.sampling import Boundary, boundary_at
from seal_mdao.seals.outline.segments import pair

MATCH = 1e-6
"""Largest distance of a point from the boundary, mm."""

_LOOK = 32  # sample points per side of a segment in the first search
_STEPS = 12  # Gauss-Newton steps; quadratic convergence for points on the curve


def located(contour, points: np.ndarray, closest: float = MATCH) -> tuple[Boundary, np.ndarray]:
    """Locate the points of a loop on a contour, and return them as its ``Boundary``.

    Parameters
    ----------
    contour : Contour
    points : ndarray, shape (k, 2)
        In order along the contour, starting anywhere; ends of segments must be among them.
    closest : float
        Largest distance from the contour, mm.

    Returns
    -------
    boundary : Boundary
    order : ndarray of int, shape (k,)
        Order of the points from the beginning of the contour.

    Raises
    ------
    GeometryError
        For a point that is not on the contour, points in another order, an end of a segment where no
        point is.
    """
    segments = contour.segments
    number, fraction, away = _nearest(segments, points)
    worst = int(away.argmax())
    if not away[worst] <= closest:
        raise GeometryError(
            f"the particle at {pair(points[worst])} is {away[worst]:.3g} mm away from the edge "
            f"{segments[number[worst]].edge!r}, on which it should lie"
        )
    lengths = np.array([segment.length for segment in segments])
    number, fraction = _from_beginnings(number, fraction, lengths, closest)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    arc = starts[number] + fraction * lengths[number]
    order = np.roll(np.arange(len(points)), -int(arc.argmin()))
    # sorted from the beginning the arc length must increase strictly: once around, no repetition
    if not (np.diff(arc[order]) > 0.0).all():
        raise GeometryError(
            f"the particles along the contour with the edge {segments[0].edge!r} do not follow it once "
            "around"
        )
    missing = np.setdiff1d(np.arange(len(segments)), number[fraction == 0.0])
    if missing.size:
        raise GeometryError(
            f"no particle is at {pair(segments[missing[0]].start)}, where a segment of the edge "
            f"{segments[missing[0]].edge!r} begins"
        )
    return boundary_at(segments, number[order], fraction[order])._replace(
        points=points[order]
    ), order


def _nearest(segments, points):
    """Find segment, fraction of its length and distance of the nearest point for every point."""
    found = [_on(segment, points) for segment in segments]
    fractions, away = (np.array([one[i] for one in found]) for i in (0, 1))
    number, every = away.argmin(axis=0), np.arange(len(points))
    return number, fractions[number, every], away[number, every]


def _on(segment, points):
    first = np.linspace(0.0, 1.0, _LOOK * segment.sides + 1)
    candidates = segment.points(first)
    fraction = first[np.hypot(*np.moveaxis(points[:, None] - candidates, -1, 0)).argmin(axis=1)]
    for _ in range(_STEPS):
        # s <- s + (p - x(s)) . t(s) / L, clipped to the segment
        along = ((points - segment.points(fraction)) * segment.tangents(fraction)).sum(axis=1)
        fraction = np.clip(fraction + along / segment.length, 0.0, 1.0)
    return fraction, np.hypot(*(points - segment.points(fraction)).T)


def _from_beginnings(number, fraction, lengths, closest):
    """Assign points at the end of a segment to the beginning of the next one."""
    fraction = np.where(fraction * lengths[number] <= closest, 0.0, fraction)
    ends = (1.0 - fraction) * lengths[number] <= closest
    return np.where(ends, (number + 1) % len(lengths), number), np.where(ends, 0.0, fraction)

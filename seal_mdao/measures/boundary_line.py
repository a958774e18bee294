"""Lengths and integrals along the contact points of a boundary, and their derivatives."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class BoundaryLine:
    """Straight segments between contact points, in the undeformed or the deformed section.

    Attributes
    ----------
    where : MaterialPoints
        All contact points of a profile.
    stretch : ndarray of int, shape (k,)
        Indices of the joined contact points, in order.
    particles : ndarray, shape (n, 2)
        Undeformed, or deformed, particles, mm.
    """

    where: object
    stretch: np.ndarray
    particles: np.ndarray

    @cached_property
    def edges(self) -> np.ndarray:
        """Vectors of the segments, shape (k - 1, 2), mm."""
        return np.diff(self.where.points.at(self.particles)[self.stretch], axis=0)

    @cached_property
    def length(self) -> np.ndarray:
        """Lengths of the segments, shape (k - 1,), mm."""
        return np.hypot(*self.edges.T)

    def add_partials(self, by_length, particles_bar) -> None:
        """Add d/d(particles) (n, 2) of a function with derivatives ``by_length`` (k - 1,)."""
        # L = |x_2 - x_1|:  dL/dx_2 = (x_2 - x_1) / L = -dL/dx_1
        pull = (by_length / self.length)[:, None] * self.edges
        on_points = np.zeros((len(self.where), 2))
        on_points[self.stretch[1:]] += pull
        on_points[self.stretch[:-1]] -= pull
        self.where.points.add_seeds(
            self.particles, on_points[:, :, None], particles_bar[:, :, None]
        )


def is_closed(where) -> bool:
    """Return whether the last contact point of a boundary is joined to the first (closed boundary)."""
    first, last = where.points.anchors[[0, -1]]
    # the particles of the last point bound the first edge, and conversely
    joined = np.isin(last, where.edges[0]).any() and np.isin(first, where.edges[-1]).any()
    return bool(joined and len(where) > 2)


def ordered_points(where) -> np.ndarray:
    """List the contact points of a boundary in order, the first again at the end if it is closed."""
    every = np.arange(len(where))
    return np.append(every, 0) if is_closed(where) else every


def contact_fractions(gap: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute the fraction in contact of every segment between contact points, with linear gaps.

    Parameters
    ----------
    gap : ndarray, shape (k,)

    Returns
    -------
    fraction, by_first, by_second : ndarray, shape (k - 1,)
        The fraction, and its derivatives in the gaps at both ends.
    """
    a, b = gap[:-1], gap[1:]
    difference = np.where((a < 0.0) != (b < 0.0), a - b, 1.0)
    fraction = np.where((a < 0.0) & (b < 0.0), 1.0, 0.0)
    first, last = (a < 0.0) & (b >= 0.0), (a >= 0.0) & (b < 0.0)
    fraction = np.where(first, a / difference, np.where(last, -b / difference, fraction))
    # phi = a / (a - b) for a < 0 <= b, -b / (a - b) for b < 0 <= a
    # dphi/da = -b / (a - b)^2 and b / (a - b)^2,  dphi/db = a / (a - b)^2 and -a / (a - b)^2
    by_a = np.where(first, -b, np.where(last, b, 0.0)) / difference**2
    by_b = np.where(first, a, np.where(last, -a, 0.0)) / difference**2
    return fraction, by_a, by_b


def add_deformed_seeds(partials, row: int, on_deformed: np.ndarray) -> None:
    """Add derivatives (n, 2) in the deformed particles x = X + u(X) to those in X and in u."""
    partials.particles[row] += on_deformed
    partials.displacement()[row] += on_deformed


def opened_square_integral(gap: np.ndarray, length: np.ndarray):
    """Integrate max(g, 0)^2 along a line of points, with g linear between them.

    Parameters
    ----------
    gap : ndarray, shape (k,)
    length : ndarray, shape (k - 1,)
        Distances between neighbours.

    Returns
    -------
    value : float
    by_gap, by_length : ndarray, shapes (k,), (k - 1,)
    """
    a, b = gap[:-1], gap[1:]
    both, first, second = (a >= 0) & (b >= 0), (a >= 0) & (b < 0), (a < 0) & (b >= 0)
    # gaps a, b at the ends of a segment of length L:
    # both open:     L (a^2 + a b + b^2) / 3
    # a >= 0 > b:    L a^3 / (3 (a - b)), open up to the fraction a / (a - b);  b >= 0 > a: mirrored
    on_first, on_second = np.where(first, a, 0.0), np.where(second, b, 0.0)
    span = np.where(first | second, np.abs(a - b), 1.0)
    mean = np.where(both, (a * a + a * b + b * b) / 3.0, (on_first**3 + on_second**3) / (3 * span))
    by_a = np.where(both, (2 * a + b) / 3.0, 0.0)
    by_b = np.where(both, (a + 2 * b) / 3.0, 0.0)
    # d/da = a^2 / (a - b) - a^3 / (3 (a - b)^2),  d/db = a^3 / (3 (a - b)^2); mirrored
    square, cube = on_first**2 / span, on_first**3 / (3 * span**2)
    by_a, by_b = by_a + square - cube, by_b + cube
    square, cube = on_second**2 / span, on_second**3 / (3 * span**2)
    by_b, by_a = by_b + square - cube, by_a + cube
    by_gap = np.zeros_like(gap)
    by_gap[:-1] += length * by_a
    by_gap[1:] += length * by_b
    return float(length @ mean), by_gap, mean

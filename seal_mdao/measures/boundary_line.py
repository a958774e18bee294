"""Lengths and integrals along the contact points of a boundary, and their derivatives."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

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
        # L = |x_2 - x_1|:  dL/dx_2 = (x_2 - x_1) / L = -dL/dx_1;  0 between the points of a corner
        length = np.where(self.length > 0.0, self.length, 1.0)
        pull = (by_length / length)[:, None] * self.edges
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


class ContactFractions(NamedTuple):
    """Fractions in contact of the segments between contact points, with their derivatives.

    Attributes
    ----------
    fraction, by_first, by_second : ndarray, shape (k - 1,)
        phi, and its derivatives in the gaps at both ends.
    by_log : ndarray, shape (k - 1,)
        Derivatives in ln E*; those in ln w_n and ln L are the same with the other sign.
    closed : ndarray of int, shape (k - 1,)
        Index, from 0 to k - 1, of the point in contact of a segment in which the contact ends.
    """

    fraction: np.ndarray
    by_first: np.ndarray
    by_second: np.ndarray
    by_log: np.ndarray
    closed: np.ndarray


def contact_fractions(gap, length, modulus, penalty: float) -> ContactFractions:
    """Compute which fraction of each segment between contact points is in contact, with derivatives.

    Near the end of a smooth contact the pressure falls with the square root of the distance d, and the
    gap grows with its power 3/2 (K. L. Johnson, Contact Mechanics, 1985, section 4.2),

        p = K d^(1/2),    g = 4 K d^(3/2) / (3 E*).

    The pressure p of the point in contact and the gap g of the open one determine K and the end of the
    contact: p = K (phi L)^(1/2) and g = 4 K [(1 - phi) L]^(3/2) / (3 E*). With
    c = [3 E* g / (4 p L)]^(2/3) the fraction in contact phi = psi^3 of the segment solves
    psi^3 + c psi = 1.

    Parameters
    ----------
    gap : ndarray, shape (k,)
        Gaps in order along the boundary; p = w_n |g| in contact.
    length : ndarray, shape (k - 1,)
        L, mm; zero between the two points of a sharp corner.
    modulus : ndarray, shape (k,)
        E* = E / (1 - nu^2) at the points, kPa.
    penalty : float
        w_n, kPa/mm.
    """
    a, b = gap[:-1], gap[1:]
    first = (a < 0.0) & (b >= 0.0)
    ends = first | ((a >= 0.0) & (b < 0.0))
    pressed, opened = (np.where(ends, own, 1.0) for own in (-np.minimum(a, b), np.maximum(a, b)))
    closed = np.arange(len(a)) + ~first
    length = np.where(length > 0.0, length, 1.0)
    c = (0.75 * modulus[closed] * opened / (penalty * pressed * length)) ** (2.0 / 3.0)
    psi = _root(c)
    # dphi/dc = -3 phi / (3 psi^2 + c),  dc/c = 2/3 d ln(E* g / (w_n |g_c| L))
    phi = np.where(ends, psi**3, (a < 0.0) & (b < 0.0))
    by_log = np.where(ends, -2.0 * c * phi / (3.0 * psi**2 + c), 0.0)
    by_open = np.divide(by_log, opened, out=np.zeros_like(c), where=opened > 0.0)
    # |g_c| = -g of the point in contact
    by_closed = by_log / pressed
    by_a, by_b = np.where(first, by_closed, by_open), np.where(first, by_open, by_closed)
    return ContactFractions(phi, by_a, by_b, by_log, closed)


def _root(c: np.ndarray) -> np.ndarray:
    """Solve psi^3 + c psi = 1 for c >= 0."""
    # 2 (c/3)^(1/2) sinh(asinh(3/2 3^(1/2) c^(-3/2)) / 3), which 1 - c/3 is for small c
    large = np.maximum(c, 1e-9)
    x = 1.5 * np.sqrt(3.0) * large**-1.5
    psi = np.where(
        c < 1e-9, 1.0 - c / 3.0, 2.0 * np.sqrt(large / 3.0) * np.sinh(np.arcsinh(x) / 3.0)
    )
    # a step of Newton's method takes rounding off
    return psi - (psi**3 + c * psi - 1.0) / (3.0 * psi**2 + c)


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

"""Boundary offsets as cubic B-splines in the ray angle, and the design velocity they give.

Offsets along the ray, not positions, are the variables: zero is the nominal seal. The outer spline is
clamped from one base corner to the other with both end values held at zero; the inner one is
periodic. The particles between follow by the isoparametric (linear) map across the wall, so the
particles are linear in the parameters and the design velocity V is constant.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from seal_mdao import values
from seal_mdao.seals.door.section import RingGrid, Section

DEGREE = 3
GAUSS_POINTS = 12
"""Of an interval of the area."""
MOST_CONTROLS = 10_000
"""Free control values of a boundary."""


def clamped_basis(angle: np.ndarray, count: int, first: float, last: float) -> np.ndarray:
    """Values (n, count) of a clamped cubic spline on [first, last] without its two end functions."""
    # knots t_0 = ... = t_3 < t_4 < ..., the ends repeated: only the end functions are not zero there
    interior = np.linspace(first, last, count + 2 - DEGREE + 1)
    knots = np.concatenate([[first] * DEGREE, interior, [last] * DEGREE])
    inside = np.clip(angle, first, last)
    return scipy.interpolate.BSpline.design_matrix(inside, knots, DEGREE).toarray()[:, 1:-1]


def periodic_basis(angle: np.ndarray, count: int) -> np.ndarray:
    """Values (n, count) of a periodic cubic spline; control j is centred at the angle 2 pi j / count."""
    step = 2 * np.pi / count
    knots = step * np.arange(-DEGREE, count + DEGREE + 1)
    # angles in one period [2 h, 2 pi + 2 h) of the uniform knots k h
    wrapped = np.mod(np.asarray(angle) + 2 * step, 2 * np.pi)
    open_values = scipy.interpolate.BSpline.design_matrix(wrapped, knots, DEGREE).toarray()
    # N_j + N_(j + count): the functions that leave the period at its end enter at its start
    values = open_values[:, :count].copy()
    values[:, :DEGREE] += open_values[:, count:]
    # basis function j of the open spline peaks at (j - 1) steps, seen from the shifted angle
    return np.roll(values, -3, axis=1)


@dataclass(frozen=True)
class BoundarySplines:
    """The shape parameters of the section.

    Attributes
    ----------
    outer_parameters, inner_parameters : int
        Number of free control values of the outer and of the inner boundary, in this order.
    section : Section
    symmetric : bool
        The control values are those of one half, from the base upward; the other half is its mirror
        image. The first one of the inner boundary lies on the axis.
    """

    section: Section
    outer_parameters: int = 14
    inner_parameters: int = 11
    symmetric: bool = False

    def __post_init__(self):
        outer, inner = (1, 3) if self.symmetric else (2, 4)
        for name, least in (("outer_parameters", outer), ("inner_parameters", inner)):
            object.__setattr__(
                self, name, values.integer(name, getattr(self, name), least, MOST_CONTROLS)
            )

    @property
    def count(self) -> int:
        return self.outer_parameters + self.inner_parameters

    @property
    def outer_controls(self) -> int:
        """Control values of the complete outer boundary."""
        return 2 * self.outer_parameters if self.symmetric else self.outer_parameters

    @property
    def inner_controls(self) -> int:
        """Control values of the complete inner boundary."""
        return 2 * self.inner_parameters - 1 if self.symmetric else self.inner_parameters

    def outer_basis(self, angle: np.ndarray) -> np.ndarray:
        """Outer spline functions at ray angles in [0, 2 pi), zero on the base, (n, outer)."""
        angle = np.mod(np.asarray(angle, float), 2 * np.pi)
        d0 = self.section.base_angle
        values = clamped_basis(angle, self.outer_controls, d0, 2 * np.pi - d0)
        if self.symmetric:
            # N_j(D) + N_(m-1-j)(D): a control value and its mirror image
            values += values[:, ::-1]
        return values[:, : self.outer_parameters]

    def inner_basis(self, angle: np.ndarray) -> np.ndarray:
        """Inner spline functions at any ray angles, (n, inner)."""
        values = periodic_basis(np.asarray(angle, float), self.inner_controls)
        if self.symmetric:
            # the first control value lies on the axis and is its own mirror image
            values[:, 1:] += values[:, :0:-1]
        return values[:, : self.inner_parameters]

    @cached_property
    def breaks(self) -> np.ndarray:
        """Ray angles in [0, 2 pi] between which both boundaries are smooth."""
        d0 = self.section.base_angle
        outer = np.linspace(d0, 2 * np.pi - d0, self.outer_controls)
        inner = np.linspace(0.0, 2 * np.pi, self.inner_controls + 1)
        # ends of the flat base and where the flanks meet the circle
        own = [2 * d0, 2 * np.pi - 2 * d0]
        return np.unique(np.concatenate([outer, inner, own]))

    def area(self, offsets: np.ndarray) -> tuple[float, np.ndarray]:
        """Compute the exact area of the section and its gradient with respect to the offsets.

        Parameters
        ----------
        offsets : ndarray, shape (count,)
            Control values, mm; area and gradient are complex where they are.

        Returns
        -------
        area : float
            mm^2.
        gradient : ndarray, shape (count,)
            mm.
        """
        # Gauss points of all intervals in which both radii are smooth
        g, w = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        left, right = self.breaks[:-1, None], self.breaks[1:, None]
        angle = (0.5 * (left + right) + 0.5 * (right - left) * g).ravel()
        weight = (0.5 * (right - left) * w).ravel()
        # r = r_drawn + sum_p b_p N_p(D)
        outer_basis, inner_basis = self.outer_basis(angle), self.inner_basis(angle)
        n = self.outer_parameters
        outer = self.section.outer(angle) + outer_basis @ offsets[:n]
        inner = self.section.inner(angle) + inner_basis @ offsets[n:]
        # A = 1/2 int (r_outer^2 - r_inner^2) dD,  dA/db_p = +- int r N_p dD
        gradient = np.concatenate([(weight * outer) @ outer_basis, -(weight * inner) @ inner_basis])
        return (0.5 * weight @ (outer**2 - inner**2)).item(), gradient


def design_velocity(splines: BoundarySplines, grid: RingGrid) -> np.ndarray:
    """Design velocity of every particle for each parameter, shape (count, n, 2), dimensionless."""
    # V_p = N_p on its own boundary, linear across the wall, zero on the other boundary
    zero_in = np.zeros((splines.outer_parameters, grid.rays))
    zero_out = np.zeros((splines.inner_parameters, grid.rays))
    outer = np.vstack([splines.outer_basis(grid.angles).T, zero_out])
    inner = np.vstack([zero_in, splines.inner_basis(grid.angles).T])
    velocity = grid.positions(inner, outer)
    velocity[np.abs(velocity) < 1e-15] = 0.0
    return velocity

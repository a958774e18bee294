"""Exact area of the section between its two spline boundaries."""

import numpy as np

from seal_mdao.seals.door.splines import BoundarySplines

GAUSS_POINTS = 12


def _quadrature(splines: BoundarySplines):
    g, w = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    left, right = splines.breaks[:-1, None], splines.breaks[1:, None]
    angle = (0.5 * (left + right) + 0.5 * (right - left) * g).ravel()
    weight = (0.5 * (right - left) * w).ravel()
    return angle, weight


def section_area(splines: BoundarySplines, offsets: np.ndarray) -> tuple[float, np.ndarray]:
    """Area = 1/2 int (r_outer^2 - r_inner^2) dD and its gradient with respect to the offsets.

    Parameters
    ----------
    offsets : ndarray, shape (splines.count,)
        Control values, mm; area and gradient are complex where they are.

    Returns
    -------
    area : float
        mm^2.
    gradient : ndarray, shape (splines.count,)
        mm.
    """
    angle, weight = _quadrature(splines)
    outer_basis, inner_basis = splines.outer_basis(angle), splines.inner_basis(angle)
    n = splines.outer_parameters
    outer = splines.section.outer(angle) + outer_basis @ offsets[:n]
    inner = splines.section.inner(angle) + inner_basis @ offsets[n:]
    gradient = np.concatenate([(weight * outer) @ outer_basis, -(weight * inner) @ inner_basis])
    return (0.5 * weight @ (outer**2 - inner**2)).item(), gradient

"""Volume that a closed polygon of points encloses, with its first and second derivatives.

In plane strain it is the area, the volume per length of depth (mm^2); in a body of revolution, where
the straight sides are turned about the axis x = 0, the volume of the complete ring,

    V = pi int r^2 dz = (pi / 3) sum_i (r_i^2 + r_i r_j + r_j^2)(z_j - z_i),    j = i + 1,

with 2 pi r in metres (``rkpm.axisymmetry``), hence in m mm^2. A pressure p (kPa) on the sides has the
potential -p V and the forces p dV/dx, in N/m or in a body of revolution in N.
"""

import numpy as np

from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.rkpm.axisymmetry import CIRCUMFERENCE


def enclosed_volume(x: np.ndarray, axisymmetric: bool) -> tuple[float, np.ndarray]:
    """Compute the volume in a polygon (k, 2), positive counter-clockwise, and its gradient (k, 2)."""
    if not axisymmetric:
        return polygon_area(x)
    before, after = np.roll(x, 1, axis=0), np.roll(x, -1, axis=0)
    (r, z), (r_b, z_b), (r_a, z_a) = x.T, before.T, after.T
    # V = c/6 sum (r_i^2 + r_i r_j + r_j^2) dz with r = r_0 + s, whose terms r_0^2 cancel
    s, s_a = r - r[0], r_a - r[0]
    squares = 3.0 * r[0] * (s + s_a) + s * s + s * s_a + s_a * s_a
    value = CIRCUMFERENCE / 6.0 * float((squares * (z_a - z)).sum())
    # dV/dr_i = c/6 [(2 r_i + r_b)(z_i - z_b) + (2 r_i + r_a)(z_a - z_i)]
    by_r = (2.0 * r + r_b) * (z - z_b) + (2.0 * r + r_a) * (z_a - z)
    # dV/dz_i = c/6 (r_b - r_a)(r_b + r_i + r_a)
    by_z = (r_b - r_a) * (r_b + r + r_a)
    return value, CIRCUMFERENCE / 6.0 * np.column_stack([by_r, by_z])


def coupled_points(count: int, axisymmetric: bool) -> np.ndarray:
    """List the pairs (m, 2) of ``count`` points that have second derivatives of the volume."""
    at = np.arange(count)
    pairs = [np.column_stack([at, np.roll(at, -1)]), np.column_stack([at, np.roll(at, 1)])]
    if axisymmetric:
        pairs.append(np.column_stack([at, at]))
    return np.concatenate(pairs)


def second_derivatives(x: np.ndarray, axisymmetric: bool) -> np.ndarray:
    """Compute d^2 V/dx dx of the ``coupled_points`` of a polygon (k, 2), shape (m, 2, 2)."""
    if not axisymmetric:
        # d^2 A/(dx_i dx_j) = 1/2 [[0, 1], [-1, 0]], j after i, and its transpose
        quarter = 0.5 * np.array([[0.0, 1.0], [-1.0, 0.0]])
        return np.concatenate([np.tile(turn, (len(x), 1, 1)) for turn in (quarter, -quarter)])
    (r, z), (r_a, z_a) = x.T, np.roll(x, -1, axis=0).T
    # of a side, c/6 [[z_j - z_i, 2 r_i + r_j], [-(r_i + 2 r_j), 0]], and its transpose
    after, own = np.zeros((2, len(x), 2, 2))
    after[:, 0, 0], after[:, 0, 1], after[:, 1, 0] = z_a - z, 2.0 * r + r_a, -(r + 2.0 * r_a)
    before = np.roll(after, 1, axis=0).transpose(0, 2, 1)
    # of a point, from both of its sides: 2 (z_a - z_b), and r_b - r_a beside it
    r_b, z_b = np.roll(x, 1, axis=0).T
    own[:, 0, 0], own[:, 0, 1], own[:, 1, 0] = 2.0 * (z_a - z_b), r_b - r_a, r_b - r_a
    return CIRCUMFERENCE / 6.0 * np.concatenate([after, before, own])

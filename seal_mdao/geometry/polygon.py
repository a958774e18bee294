"""Area of polygons, and points closest to others on their sides."""

import numpy as np


def polygon_area(x: np.ndarray) -> tuple[float, np.ndarray]:
    """Compute signed area of a polygon (k, 2), positive counter-clockwise, and its gradient (k, 2)."""
    before, after = np.roll(x, 1, axis=0), np.roll(x, -1, axis=0)
    # A = 1/2 sum_i (x_i y_i+1 - x_i+1 y_i)
    value = 0.5 * float((x[:, 0] * after[:, 1] - x[:, 1] * after[:, 0]).sum())
    # dA/dx_i = (y_i+1 - y_i-1) / 2,  dA/dy_i = (x_i-1 - x_i+1) / 2
    return value, 0.5 * np.column_stack([after[:, 1] - before[:, 1], before[:, 0] - after[:, 0]])


def from_sides(x, a, b) -> tuple[np.ndarray, np.ndarray]:
    """Find where straight sides from ``a`` to ``b`` are closest to points ``x``, all (..., 2).

    Returns
    -------
    along : ndarray
        Fraction t of the side at the closest point, from 0 to 1.
    across : ndarray, shape (..., 2)
        Vector from the closest point a + t (b - a) to the point.
    """
    side, reached = b - a, x - a
    # t = (x - a) . (b - a) / |b - a|^2 within [0, 1]
    along = np.clip((reached * side).sum(axis=-1) / (side**2).sum(axis=-1), 0.0, 1.0)
    return along, reached - along[..., None] * side

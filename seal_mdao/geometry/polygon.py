"""Polygons."""

import numpy as np


def polygon_area(x: np.ndarray) -> tuple[float, np.ndarray]:
    """Signed area of a closed polygon (k, 2), positive counter-clockwise, and its gradient (k, 2)."""
    before, after = np.roll(x, 1, axis=0), np.roll(x, -1, axis=0)
    value = 0.5 * float((x[:, 0] * after[:, 1] - x[:, 1] * after[:, 0]).sum())
    return value, 0.5 * np.column_stack([after[:, 1] - before[:, 1], before[:, 0] - after[:, 0]])

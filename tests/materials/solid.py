"""Mooney-Rivlin rubber once more in three dimensions, from the invariants of C = F^T F."""

import numpy as np


def in_space(F):
    """Plane strain: F_33 = 1."""
    full = np.eye(3)
    full[:2, :2] = F
    return full


def _invariants(F):
    C = F.T @ F
    return C, np.trace(C), 0.5 * (np.trace(C) ** 2 - np.trace(C @ C)), np.linalg.det(F)


def energy(F, c10, c01):
    """W_dev from I1, I2 and J."""
    _, i1, i2, j = _invariants(F)
    return c10 * (i1 * j ** (-2 / 3) - 3) + c01 * (i2 * j ** (-4 / 3) - 3)


def stress(F, c10, c01):
    """P = dW/dF by the chain rule through I1, I2 and J, 3 x 3."""
    C, i1, i2, j = _invariants(F)
    by_i1, by_i2, by_j = 2 * F, 2 * (i1 * F - F @ C), j * np.linalg.inv(F).T
    return (
        c10 * j ** (-2 / 3) * by_i1
        + c01 * j ** (-4 / 3) * by_i2
        - (2 / 3 * c10 * i1 * j ** (-5 / 3) + 4 / 3 * c01 * i2 * j ** (-7 / 3)) * by_j
    )

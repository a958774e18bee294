"""Sums into shared rows, for the transposes of gathers."""

import numba as nb
import numpy as np


def scatter_add(out: np.ndarray, rows: np.ndarray, values: np.ndarray) -> None:
    """out[m, rows[k]] += values[m, k] with repeated rows, in order.

    Parameters
    ----------
    out : ndarray, shape (M, n, 2)
    rows : ndarray of int, any shape
    values : ndarray, shape (M, *rows.shape, 2)
    """
    _scatter_add(out, rows.ravel(), np.ascontiguousarray(values).reshape(len(out), -1, 2))


@nb.njit(cache=True, error_model="numpy")
def _scatter_add(out, rows, values):
    for m in range(out.shape[0]):
        for k in range(rows.size):
            for c in range(2):
                out[m, rows[k], c] += values[m, k, c]

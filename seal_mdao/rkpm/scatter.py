"""Sums into shared rows, for the transposes of gathers."""

import numpy as np

from seal_mdao.compilation import compiled


def scatter_add(out: np.ndarray, rows: np.ndarray, values: np.ndarray) -> None:
    """Add values to rows that may repeat, in order: out[rows[k]] += values[k].

    Parameters
    ----------
    out : ndarray, shape (n, 2, M)
    rows : ndarray of int, any shape
    values : ndarray, shape (*rows.shape, 2, M)
    """
    _scatter_add(out, rows.ravel(), np.ascontiguousarray(values).reshape(-1, *out.shape[1:]))


@compiled
def _scatter_add(out, rows, values):
    for k in range(rows.size):
        for c in range(out.shape[1]):
            for m in range(out.shape[2]):
                out[rows[k], c, m] += values[k, c, m]

"""Helpers for mesh files with the library meshio (extra ``vtk``)."""

from importlib import import_module

import numpy as np

MISSING = "meshes and VTU files need meshio, which is not installed: pip install seal_mdao[vtk]"


def library():
    """Import meshio.

    Raises
    ------
    ImportError
        Where meshio is not installed.
    """
    try:
        return import_module("meshio")
    except ImportError as error:
        raise ImportError(MISSING) from error


def flat(points: np.ndarray) -> np.ndarray:
    """Extend points or vectors (n, 2) by z = 0, shape (n, 3)."""
    return np.column_stack([points, np.zeros(len(points))])


def cell_blocks(cells: np.ndarray, values: np.ndarray | None = None) -> list[tuple]:
    """Split cells (m, 4), in which triangles repeat a corner, into blocks of meshio.

    Parameters
    ----------
    cells : ndarray of int, shape (m, 4)
    values : ndarray, shape (m,), optional
        Values of the cells; their indices if left out.

    Returns
    -------
    list of (str, ndarray, ndarray)
        Cell type of meshio, corners, values; no empty blocks.
    """
    values = np.arange(len(cells)) if values is None else values
    # a corner equal to the one before it is the repeated one of a triangle
    repeated = cells == np.roll(cells, 1, axis=1)
    triangular = repeated.any(axis=1)
    triangles = cells[triangular][~repeated[triangular]].reshape(-1, 3)
    blocks = [
        ("quad", cells[~triangular], values[~triangular]),
        ("triangle", triangles, values[triangular]),
    ]
    return [block for block in blocks if len(block[1])]

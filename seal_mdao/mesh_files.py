"""Meshes in files, with the library meshio (extra ``vtk``)."""

from importlib import import_module

import numpy as np

MISSING = "meshes and VTU files need meshio, which is not installed: pip install seal_mdao[vtk]"


def library():
    """meshio.

    Raises
    ------
    ImportError
        Without it.
    """
    try:
        return import_module("meshio")
    except ImportError as error:
        raise ImportError(MISSING) from error


def flat(points: np.ndarray) -> np.ndarray:
    """Points or vectors (n, 2) in the plane z = 0, shape (n, 3)."""
    return np.column_stack([points, np.zeros(len(points))])


def cell_blocks(cells: np.ndarray, values: np.ndarray | None = None) -> list[tuple]:
    """Quadrilaterals and triangles of cells (m, 4), in which a triangle repeats a corner.

    Parameters
    ----------
    cells : ndarray of int, shape (m, 4)
    values : ndarray, shape (m,), optional
        Of the cells; their numbers unless given.

    Returns
    -------
    list of (str, ndarray, ndarray)
        Kind as meshio calls it, corners, values.
    """
    values = np.arange(len(cells)) if values is None else values
    repeated = cells == np.roll(cells, 1, axis=1)
    triangular = repeated.any(axis=1)
    triangles = cells[triangular][~repeated[triangular]].reshape(-1, 3)
    blocks = [
        ("quad", cells[~triangular], values[~triangular]),
        ("triangle", triangles, values[triangular]),
    ]
    return [block for block in blocks if len(block[1])]

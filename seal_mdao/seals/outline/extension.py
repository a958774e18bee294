"""How the inside of a section follows its boundary: harmonically, on the background cells."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from seal_mdao.rkpm.cells import cell_map, quadrature_weights, tangents


def stiffness(cells: np.ndarray, particles: np.ndarray):
    """int grad N_a . grad N_b over cells of three and of four corners, sparse (n, n)."""
    mapping = cell_map(cells)
    t = tangents(mapping, particles)
    weights = quadrature_weights(mapping, particles)
    slopes = np.empty((2, *weights.shape, 4))
    slopes[:] = mapping.rule.slopes[:, None]
    slopes[:, mapping.triangles] = mapping.triangle_rule.slopes[:, None]
    jacobian = t[0, ..., 0] * t[1, ..., 1] - t[0, ..., 1] * t[1, ..., 0]
    along_x = (slopes[0] * t[1, ..., 1, None] - slopes[1] * t[0, ..., 1, None]) / jacobian[
        ..., None
    ]
    along_y = (slopes[1] * t[0, ..., 0, None] - slopes[0] * t[1, ..., 0, None]) / jacobian[
        ..., None
    ]
    local = sum(np.einsum("cq,cqa,cqb->cab", weights, g, g) for g in (along_x, along_y))
    rows = np.broadcast_to(mapping.cells[:, :, None], local.shape)
    columns = np.broadcast_to(mapping.cells[:, None], local.shape)
    n = len(particles)
    return coo_array((local.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n)).tocsc()


def harmonic_extension(cells, particles, boundary, values: np.ndarray) -> np.ndarray:
    """Values inside that are harmonic and equal those given at the boundary.

    Linear in the values: linear fields stay as they are.

    Parameters
    ----------
    cells : ndarray of int, shape (m, 4)
    particles : ndarray, shape (n, 2)
        Of the drawn section.
    boundary : ndarray of int, shape (k,)
    values : ndarray, shape (P, k, 2)
        One factorisation serves all of them.

    Returns
    -------
    ndarray, shape (P, n, 2)
    """
    n_fields, n = len(values), len(particles)
    inside = np.setdiff1d(np.arange(n), boundary)
    out = np.zeros((n_fields, n, 2))
    out[:, boundary] = values
    if n_fields == 0 or inside.size == 0:
        return out
    matrix = stiffness(cells, particles)[inside]
    known = values.transpose(1, 0, 2).reshape(len(boundary), -1)
    solved = splu(matrix[:, inside].tocsc()).solve(-(matrix[:, boundary] @ known))
    out[:, inside] = solved.reshape(inside.size, n_fields, 2).transpose(1, 0, 2)
    return out

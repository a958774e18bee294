"""Harmonic extension of boundary velocities to the inside of a section, on background cells."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from seal_mdao.rkpm.cells import cell_map, quadrature_weights, tangents


def stiffness(cells: np.ndarray, particles: np.ndarray):
    """Assemble the stiffness int grad N_a . grad N_b of the Laplacian, sparse (n, n)."""
    mapping = cell_map(cells)
    t = tangents(mapping, particles)
    weights = quadrature_weights(mapping, particles)
    slopes = np.empty((2, *weights.shape, 4))
    slopes[:] = mapping.rule.slopes[:, None]
    slopes[:, mapping.triangles] = mapping.triangle_rule.slopes[:, None]
    # t_k = dX/dxi_k:  J = t_1 x t_2,  dN/dx = (dN/dxi_1 t_2y - dN/dxi_2 t_1y) / J,
    # dN/dy = (dN/dxi_2 t_1x - dN/dxi_1 t_2x) / J
    jacobian = t[0, ..., 0] * t[1, ..., 1] - t[0, ..., 1] * t[1, ..., 0]
    along_x = (slopes[0] * t[1, ..., 1, None] - slopes[1] * t[0, ..., 1, None]) / jacobian[
        ..., None
    ]
    along_y = (slopes[1] * t[0, ..., 0, None] - slopes[0] * t[1, ..., 0, None]) / jacobian[
        ..., None
    ]
    # k_ab = sum_q w_q (N_a,x N_b,x + N_a,y N_b,y)
    local = sum(np.einsum("cq,cqa,cqb->cab", weights, g, g) for g in (along_x, along_y))
    rows = np.broadcast_to(mapping.cells[:, :, None], local.shape)
    columns = np.broadcast_to(mapping.cells[:, None], local.shape)
    n = len(particles)
    return coo_array((local.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n)).tocsc()


def harmonic_extension(cells, particles, boundary, values: np.ndarray) -> np.ndarray:
    """Extend boundary values harmonically to the inside.

    Linear in the values; linear fields are reproduced.

    Parameters
    ----------
    cells : ndarray of int, shape (m, 4)
    particles : ndarray, shape (n, 2)
        Of the nominal section.
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
    # K_ii V_i = -K_ib V_b for the inside i and the boundary b
    matrix = stiffness(cells, particles)[inside]
    known = values.transpose(1, 0, 2).reshape(len(boundary), -1)
    solved = splu(matrix[:, inside].tocsc()).solve(-(matrix[:, boundary] @ known))
    out[:, inside] = solved.reshape(inside.size, n_fields, 2).transpose(1, 0, 2)
    return out

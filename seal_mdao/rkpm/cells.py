"""Background cells with Gauss quadrature, for the domain integrals of Eq. (43).

Four-node cells that follow the particles: the quadrature points move with the design, and their
weights are the reference weights times the Jacobian of the cell map.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.rkpm.scatter import scatter_add
from seal_mdao.rkpm.shape_functions import PointSet


class CellMap(NamedTuple):
    """Bilinear map of every cell at its Gauss points (the same for all cells).

    Attributes
    ----------
    cells : ndarray of int, shape (n_cells, 4)
        Corner particles, counter-clockwise.
    values : ndarray, shape (q, 4)
        Corner functions N_a at the Gauss points.
    slopes : ndarray, shape (2, q, 4)
        dN_a / d(xi, eta).
    reference_weights : ndarray, shape (q,)
    """

    cells: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    reference_weights: np.ndarray


def support_radii(cells: np.ndarray, particles: np.ndarray, support: float) -> np.ndarray:
    """Support radius of every particle: ``support`` times the longest cell edge that meets it."""
    longest = np.zeros(len(particles))
    for a, b in zip(cells.T, np.roll(cells, -1, axis=1).T, strict=True):
        edge = np.linalg.norm(particles[a] - particles[b], axis=1)
        np.maximum.at(longest, a, edge)
        np.maximum.at(longest, b, edge)
    return support * longest


def cell_map(cells: np.ndarray, n_gauss: int = 2) -> CellMap:
    """The map of ``cells`` with ``n_gauss`` x ``n_gauss`` Gauss points."""
    g, w = np.polynomial.legendre.leggauss(n_gauss)
    xi, eta = (a.ravel() for a in np.meshgrid(g, g, indexing="ij"))
    weights = np.outer(w, w).ravel()
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    fx, fy = 1 + np.outer(xi, corner[:, 0]), 1 + np.outer(eta, corner[:, 1])
    slopes = np.stack([0.25 * corner[:, 0] * fy, 0.25 * corner[:, 1] * fx])
    return CellMap(np.ascontiguousarray(cells), 0.25 * fx * fy, slopes, weights)


def quadrature_points(mapping: CellMap) -> PointSet:
    """Gauss points of all cells, one group a cell."""
    n_cells, q = len(mapping.cells), len(mapping.reference_weights)
    return PointSet(np.repeat(mapping.cells, q, axis=0), np.tile(mapping.values, (n_cells, 1)), q)


def tangents(mapping: CellMap, particles: np.ndarray) -> np.ndarray:
    """dx/d(xi, eta), shape (2, ..., n_cells, q, 2), of particles or velocities (..., n, 2)."""
    return np.einsum("dqa,...cai->d...cqi", mapping.slopes, particles[..., mapping.cells, :])


def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def quadrature_weights(mapping: CellMap, particles: np.ndarray) -> np.ndarray:
    """Reference weight times det(dx/d(xi, eta)), shape (n_cells, q), area unit.

    Raises
    ------
    GeometryError
        For a folded cell (negative area at a Gauss point).
    """
    t = tangents(mapping, particles)
    weights = _cross(t[0], t[1]) * mapping.reference_weights
    if not np.all(weights > 0.0):
        cell = int(np.argwhere(~(weights > 0.0))[0, 0])
        x, y = particles[mapping.cells[cell]].mean(axis=0)
        raise GeometryError(
            f"the section is folded: background cell {cell} near ({x:.4g}, {y:.4g}) has no positive "
            "area; use smaller or smoother boundary offsets"
        )
    return weights


def weight_rates(mapping: CellMap, particles: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Rates of the weights along design velocities (P, n, 2), shape (P, n_cells, q)."""
    t, v = tangents(mapping, particles), tangents(mapping, velocity)
    return (_cross(v[0], t[1]) + _cross(t[0], v[1])) * mapping.reference_weights


def add_weight_seeds(mapping, particles, weight_bar, x_bar) -> None:
    """Transpose of ``weight_rates``: seeds (n_cells, q, M) on the weights to ``x_bar`` (n, 2, M)."""
    t = tangents(mapping, particles)
    scaled = weight_bar * mapping.reference_weights[:, None]
    turned = np.stack([t[1][..., ::-1] * [1, -1], -t[0][..., ::-1] * [1, -1]])
    corner = np.einsum("cqm,dqa,dcqi->caim", scaled, mapping.slopes, turned, optimize=True)
    scatter_add(x_bar, mapping.cells, corner)

"""Background cells with Gauss quadrature, for the domain integrals of Eq. (43).

Cells of four corners and of three that follow the particles: the quadrature points move with the
design, and their weights are the reference weights times the Jacobian of the cell map. A cell of three
is stored as one of four that repeats a corner; both kinds have the same number of points.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from seal_mdao.errors import GeometryError
from seal_mdao.rkpm.scatter import scatter_add
from seal_mdao.rkpm.shape_functions import PointSet

GAUSS_POINTS = (2, 10)
"""Smallest and largest number in a direction of a cell of a seal. One leaves a wall far too soft."""


class ReferenceRule(NamedTuple):
    """Corner functions and weights at the quadrature points of a reference cell.

    Attributes
    ----------
    values : ndarray, shape (q, 4)
        Corner functions N_a.
    slopes : ndarray, shape (2, q, 4)
        dN_a / d(xi, eta).
    weights : ndarray, shape (q,)
    """

    values: np.ndarray
    slopes: np.ndarray
    weights: np.ndarray


class CellMap(NamedTuple):
    """Maps of all cells from their reference cell, at the quadrature points.

    Attributes
    ----------
    cells : ndarray of int, shape (n_cells, 4)
        Corner particles, counter-clockwise; the last two are the same in a triangle.
    rule : ReferenceRule
        Of quadrilaterals.
    triangles : ndarray of int
        Indices of the triangles among the cells.
    triangle_rule : ReferenceRule
    """

    cells: np.ndarray
    rule: ReferenceRule
    triangles: np.ndarray
    triangle_rule: ReferenceRule

    @property
    def n_points(self) -> int:
        """Quadrature points of every cell."""
        return len(self.rule.weights)

    @property
    def values(self) -> np.ndarray:
        """Corner functions of every cell, shape (n_cells, q, 4)."""
        values = np.tile(self.rule.values, (len(self.cells), 1, 1))
        values[self.triangles] = self.triangle_rule.values
        return values

    @property
    def reference_weights(self) -> np.ndarray:
        """Shape (n_cells, q)."""
        weights = np.tile(self.rule.weights, (len(self.cells), 1))
        weights[self.triangles] = self.triangle_rule.weights
        return weights


def support_radii(cells: np.ndarray, particles: np.ndarray, support: float) -> np.ndarray:
    """Compute support radii a_I: ``support`` times the longest cell edge at particle I, shape (n,)."""
    # a_I = support max_e |x_a - x_b| over the edges e = (a, b) at particle I
    longest = np.zeros(len(particles))
    for a, b in zip(cells.T, np.roll(cells, -1, axis=1).T, strict=True):
        edge = np.linalg.norm(particles[a] - particles[b], axis=1)
        np.maximum.at(longest, a, edge)
        np.maximum.at(longest, b, edge)
    return support * longest


def support_axes(cells: np.ndarray, particles: np.ndarray, supports) -> np.ndarray:
    """Compute inverse half-widths of product kernels aligned with the two directions of the cells.

    Parameters
    ----------
    cells : ndarray of int, shape (n_cells, 4)
        All numbered alike: first corner to second is one direction, second to third the other.
    particles : ndarray, shape (n, 2)
        Of the nominal body.
    supports : pair of float
        Half-width in each direction over the longest edge of that direction at a particle.

    Returns
    -------
    ndarray, shape (n, 2, 2)
        Inverse of the matrix whose columns are the half-widths along the mean edge directions.
    """
    columns = np.zeros((len(particles), 2, 2))
    for k, support in enumerate(supports):
        # the two edges of direction k of every cell, both with the same sense
        ends = np.roll(cells, -k, axis=1)[:, [0, 1, 3, 2]].reshape(-1, 2)
        edge = particles[ends[:, 1]] - particles[ends[:, 0]]
        length, longest = np.hypot(*edge.T), np.zeros(len(particles))
        for end in ends.T:
            np.maximum.at(longest, end, length)
            np.add.at(columns[:, :, k], end, edge / length[:, None])
        # column k: support_k max|e| times the mean unit edge vector at the particle
        columns[:, :, k] *= support * (longest / np.hypot(*columns[:, :, k].T))[:, None]
    # rows a, b of the inverse: phi_a = phi(a . r) phi(b . r), zero where |a . r| or |b . r| >= 1
    return np.linalg.inv(columns)


def circumscribed_radii(axes: np.ndarray) -> np.ndarray:
    """Compute the radius of the circumscribed circle of every product kernel's support, shape (n,)."""
    widths = np.linalg.inv(axes)
    # corners of the parallelogram: +-(w_1 + w_2), +-(w_1 - w_2)
    return np.max([np.hypot(*(widths @ [1.0, sign]).T) for sign in (1.0, -1.0)], axis=0)


def kernel_supports(cells: np.ndarray, particles: np.ndarray, support) -> tuple:
    """Compute the support radii and, for product kernels, their axes, else None.

    Parameters
    ----------
    support : float, or pair of float
        As of ``support_radii``, or of ``support_axes``.
    """
    if np.ndim(support) == 0:
        return support_radii(cells, particles, support), None
    axes = support_axes(cells, particles, support)
    return circumscribed_radii(axes), axes


def in_both_directions(n_gauss) -> tuple[int, int]:
    """Expand the number of Gauss points to a pair, one for each direction of a cell."""
    first, second = np.broadcast_to(n_gauss, 2).tolist()
    return first, second


def quadrilateral_rule(n_gauss) -> ReferenceRule:
    """Build the tensor product Gauss rule of [-1, 1]^2, ``n_gauss`` points in each direction."""
    (gx, wx), (gy, wy) = map(np.polynomial.legendre.leggauss, in_both_directions(n_gauss))
    xi, eta = (a.ravel() for a in np.meshgrid(gx, gy, indexing="ij"))
    weights = np.outer(wx, wy).ravel()
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    # N_a = (1 + xi xi_a)(1 + eta eta_a) / 4
    fx, fy = 1 + np.outer(xi, corner[:, 0]), 1 + np.outer(eta, corner[:, 1])
    # N_a,xi = xi_a (1 + eta eta_a) / 4,  N_a,eta = eta_a (1 + xi xi_a) / 4
    slopes = np.stack([0.25 * corner[:, 0] * fy, 0.25 * corner[:, 1] * fx])
    return ReferenceRule(0.25 * fx * fy, slopes, weights)


def triangle_rule(n_gauss) -> ReferenceRule:
    """Build a rule of a triangle with as many points as ``quadrilateral_rule``, of degree 2 n - 2.

    Up to four points it is symmetric: the centroid, and three points on the medians at 1 / sqrt(3) of
    the distance to the corners, of equal weights. Otherwise it is the Gauss rule of a square
    of which one side is collapsed to the last corner.
    """
    first, second = in_both_directions(n_gauss)
    count = first * second
    if first == second <= 2:
        # area coordinates L_a = (1 - s) / 3 + s delta_ab on the median of corner b, s = 1 / sqrt(3):
        # (1/4) sum_q L_a^2 = 1/6, so that four points of equal weight integrate quadratics exactly
        s = np.array([0.0, *[3.0**-0.5] * 3])[:count, None]
        area = (1.0 - s) / 3.0 + s * np.vstack([np.zeros(3), np.eye(3)])[:count]
        weights = np.full(count, 0.5 / count)
    else:
        # collapsed square: L_3 = N_3 + N_4, and d(L_2, L_3)/d(xi, eta) = (1 - L_3) / 4
        square = quadrilateral_rule(n_gauss)
        area = square.values @ [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 1]]
        weights = square.weights * (1.0 - area[:, 2]) / 4.0
    values = np.column_stack([area, np.zeros(count)])
    # N_1 = 1 - xi - eta, N_2 = xi, N_3 = eta; the repeated corner has N_4 = 0
    slopes = np.array([[-1.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0]])
    return ReferenceRule(values, np.repeat(slopes[:, None], count, axis=1), weights)


def is_triangle(cells: np.ndarray) -> np.ndarray:
    """Find the cells that repeat a corner (triangles), a mask of shape (n_cells,)."""
    return (cells == np.roll(cells, -1, axis=1)).any(axis=1)


def sides_of(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sides of the cells by the particles at their ends.

    Returns
    -------
    outer : ndarray of int, shape (m, 2)
        Those of one cell only, the boundary, with the body on the left.
    inner : ndarray of int, shape (k, 2)
    """
    pairs = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).reshape(-1, 2)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    _, first, count = np.unique(
        np.sort(pairs, axis=1), axis=0, return_index=True, return_counts=True
    )
    return pairs[first[count == 1]], pairs[first[count > 1]]


def beside(cells: np.ndarray, particles: np.ndarray) -> np.ndarray:
    """Find the cells with a side between two of some ``particles``, a mask (n_cells,); not those with a
    corner there only, such as cells of another material where an edge ends at an interface."""
    following = np.roll(cells, -1, axis=1)
    # a triangle repeats a corner
    return (np.isin([cells, following], particles).all(axis=0) & (cells != following)).any(axis=1)


def joined(pairs: np.ndarray, count: int) -> np.ndarray:
    """Number the groups of ``count`` particles that pairs (m, 2) join, shape (count,)."""
    graph = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def bodies(cells: np.ndarray, count: int) -> np.ndarray:
    """Number the bodies of ``count`` particles that cells (m, 4) connect, shape (count,)."""
    sides = np.stack([cells, np.roll(cells, 1, axis=1)], axis=-1).reshape(-1, 2)
    return joined(sides, count)


def cell_map(cells: np.ndarray, n_gauss=2) -> CellMap:
    """Build the map of ``cells`` with ``n_gauss`` Gauss points in each direction.

    Parameters
    ----------
    n_gauss : int, or pair of int
        In both directions alike, or in each: first corner to second, second to third.
    """
    cells = np.array(cells)
    triangles = np.flatnonzero(is_triangle(cells))
    for cell in triangles:
        # rotate the corners until the repeated one comes last
        first = int(np.flatnonzero(cells[cell] == np.roll(cells[cell], -1))[0])
        cells[cell] = np.roll(cells[cell], 2 - first)
    return CellMap(cells, quadrilateral_rule(n_gauss), triangles, triangle_rule(n_gauss))


def quadrature_points(mapping: CellMap) -> PointSet:
    """Collect the quadrature points of all cells, one group per cell."""
    q = mapping.n_points
    return PointSet(np.repeat(mapping.cells, q, axis=0), mapping.values.reshape(-1, 4), q)


def tangents(mapping: CellMap, particles: np.ndarray) -> np.ndarray:
    """Compute dx/d(xi, eta), shape (2, ..., n_cells, q, 2), of particles or velocities (..., n, 2)."""
    corners = particles[..., mapping.cells, :]
    # x,d = sum_a N_a,d(q) x_a in cell c
    out = np.einsum("dqa,...cai->d...cqi", mapping.rule.slopes, corners)
    if mapping.triangles.size:
        of_triangles = corners[..., mapping.triangles, :, :]
        out[..., mapping.triangles, :, :] = np.einsum(
            "dqa,...cai->d...cqi", mapping.triangle_rule.slopes, of_triangles
        )
    return out


def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def quadrature_weights(mapping: CellMap, particles: np.ndarray) -> np.ndarray:
    """Compute quadrature weights: reference weight times Jacobian, shape (n_cells, q), area unit.

    Raises
    ------
    GeometryError
        For a folded cell (negative area at a quadrature point).
    """
    t = tangents(mapping, particles)
    # w_q = w_ref det(dx/d(xi, eta)) = w_ref (x,xi X x,eta)
    weights = _cross(t[0], t[1]) * mapping.reference_weights
    if not np.all(weights > 0.0):
        cell = int(np.argwhere(~(weights > 0.0))[0, 0])
        x, y = particles[mapping.cells[cell]].mean(axis=0)
        raise GeometryError(
            f"the section is folded: background cell {cell} near ({x:.4g}, {y:.4g}) has a negative "
            "or zero area; use smaller or smoother boundary offsets",
            tuple(mapping.cells[cell].tolist()),
        )
    return weights


def weight_rates(mapping: CellMap, particles: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Differentiate the weights along design velocities V (P, n, 2), shape (P, n_cells, q)."""
    t, v = tangents(mapping, particles), tangents(mapping, velocity)
    # w_q' = w_ref (V,xi X x,eta + x,xi X V,eta)
    return (_cross(v[0], t[1]) + _cross(t[0], v[1])) * mapping.reference_weights


def add_weight_seeds(mapping, particles, weight_bar, x_bar) -> None:
    """Apply the transpose of ``weight_rates``: seeds (n_cells, q, M) added to ``x_bar`` (n, 2, M)."""
    t = tangents(mapping, particles)
    scaled = weight_bar * mapping.reference_weights[..., None]
    # dw/dx,xi = w_ref (y,eta, -x,eta)   dw/dx,eta = w_ref (-y,xi, x,xi)
    turned = np.stack([t[1][..., ::-1] * [1, -1], -t[0][..., ::-1] * [1, -1]])
    corner = _corner_seeds(scaled, mapping.rule.slopes, turned)
    if mapping.triangles.size:
        at = mapping.triangles
        corner[at] = _corner_seeds(scaled[at], mapping.triangle_rule.slopes, turned[:, at])
    scatter_add(x_bar, mapping.cells, corner)


def _corner_seeds(scaled, slopes, turned):
    """Compute the seeds on the corners, shape (n_cells, 4, 2, M)."""
    n, _, m = scaled.shape
    # dw_q/dx_a = sum_d N_a,d(q) dw_q/dx,d
    of_weights = np.einsum("dqa,dcqi->caiq", slopes, turned).reshape(n, 8, -1)
    return (of_weights @ scaled).reshape(n, 4, 2, m)

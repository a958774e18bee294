"""Bodies of revolution: x is the radius R from the axis, y runs along it.

The hoop stretch is h = 1 + u_r / R, so that a point has a third strain row beside the two of the
gradient,

    h - 1 = sum_I (Phi_I / R) d_I1,

and what is integrated over the section is integrated around the axis,

    dV = 2 pi R dA,    dA = 2 pi R ds.

Plane strain gives results per metre of depth; here the depth is the circumference 2 pi R in metres, so
that forces are in N where those of plane strain are in N/m.
"""

import numpy as np

from seal_mdao.compilation import compiled
from seal_mdao.rkpm.scatter import scatter_add

CIRCUMFERENCE = 2e-3 * np.pi
"""Circumference over radius, m/mm."""
ROUNDING = 1e-9
"""Radius that is zero, over the size of the section."""


def zero_radius(particles: np.ndarray) -> float:
    """Return the radius, mm, up to which a point of a section with these particles (n, 2) is on the
    axis: rounding."""
    return ROUNDING * float(np.ptp(particles, axis=0).max())


def edge_circumferences(ends: np.ndarray, radial: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Compute c = 2 pi R at points of edges, m, shape (..., *shape).

    Linear in ``vectors``: particles give c, a design velocity its rates.

    Parameters
    ----------
    ends : ndarray of int, shape (*shape, 2)
        Particles at the ends of the edge of every point.
    radial : ndarray, shape (*shape, 2)
        Weights of their radii in R.
    vectors : ndarray, shape (..., n, 2)
    """
    # c = 2 pi sum_a radial_a R_a
    return CIRCUMFERENCE * (radial * vectors[..., ends, 0]).sum(axis=-1)


def add_circumference_seeds(ends, radial, seeds, x_bar) -> None:
    """Apply the transpose of ``edge_circumferences``: seeds (*shape, M) added to ``x_bar`` (n, 2, M)."""
    on_ends = np.zeros((*ends.shape, 2, seeds.shape[-1]))
    # R_a_bar = 2 pi radial_a c_bar
    on_ends[..., 0, :] = CIRCUMFERENCE * radial[..., None] * seeds[..., None, :]
    scatter_add(x_bar, ends, on_ends)


def add_radius_seeds(points, particles, radius_bar, x_bar) -> None:
    """Add seeds (n_points, M) on the radii of a ``PointSet`` to ``x_bar`` (n, 2, M)."""
    point_bar = np.zeros((len(radius_bar), 2, radius_bar.shape[1]))
    # R is the first coordinate of a point
    point_bar[:, 0] = radius_bar
    points.add_seeds(particles, point_bar, x_bar)


@compiled
def with_hoop_rows(start, group_size, grad, phi, radius, out):
    """Fill ``out`` (point, 3, neighbour) with Phi_,x, Phi_,y and Phi / R of every point.

    A point on the axis stays there in all designs.

    Parameters
    ----------
    grad, phi : ndarray
        Flat (point, 2, neighbour), (point, neighbour).
    radius : ndarray, shape (n_points,)
        R, mm.
    """
    for g in range(start.size - 1):
        n = start[g + 1] - start[g]
        for q in range(group_size):
            at = start[g] * group_size + q * n
            for i in range(2 * n):
                out[3 * at + i] = grad[2 * at + i]
            r = radius[g * group_size + q]
            for i in range(n):
                # Phi_I / R; on the axis, where u_1 = 0, its limit Phi_I,1
                row = phi[at + i] / r if r > 0.0 else grad[2 * at + i]
                out[3 * at + 2 * n + i] = row


@compiled
def hoop_rates(start, group_size, table_rates, hoop, radius, radius_rate, out):
    """Differentiate ``with_hoop_rows`` for P parameters: (Phi / R)' = (Phi' - (Phi / R) R') / R.

    Parameters
    ----------
    table_rates : TableRates
        Phi_,j' and Phi'.
    hoop : ndarray
        Flat (point, 3, neighbour) of ``with_hoop_rows``.
    radius, radius_rate : ndarray, shapes (n_points,), (n_points, P)
        R and R'.
    out : ndarray
        Flat (point, 3, neighbour, parameter).
    """
    for g in range(start.size - 1):
        which = table_rates.active[table_rates.start[g, 0] : table_rates.start[g + 1, 0]]
        n, count = start[g + 1] - start[g], which.size
        for q in range(group_size):
            point, row = g * group_size + q, 3 * (start[g] * group_size + q * n) + 2 * n
            at = table_rates.start[g, 1] + q * n * count
            for k in range(2 * n * count):
                out[3 * at + k] = table_rates.grad[2 * at + k]
            for i in range(n):
                for p in range(count):
                    to = 3 * at + (2 * n + i) * count + p
                    if radius[point] > 0.0:
                        # (Phi_I' - (Phi_I / R) R') / R
                        moved = hoop[row + i] * radius_rate[point, which[p]]
                        rate = table_rates.phi[at + i * count + p] - moved
                        out[to] = rate / radius[point]
                    else:
                        # on the axis that of Phi_I,1
                        out[to] = table_rates.grad[2 * at + i * count + p]


@compiled
def split_hoop_seeds(start, groups, group_size, seeds, hoop, radius, grad_bar, phi_bar, radius_bar):
    """Apply the transpose of ``hoop_rates`` to the ``groups`` (first, last).

    Parameters
    ----------
    seeds : ndarray, shape (3 rows, M)
        On the rows (point, 3, neighbour) of these groups.
    grad_bar, phi_bar : ndarray, shapes (2 rows, M), (rows, M)
        Written.
    radius_bar : ndarray, shape (n_points, M)
        Added to: R_bar -= (Phi / R) hoop_bar / R.
    """
    first, last = groups
    for g in range(first, last):
        n, before = start[g + 1] - start[g], (start[g] - start[first]) * group_size
        for q in range(group_size):
            point, at = g * group_size + q, before + q * n
            row = 3 * (start[g] * group_size + q * n) + 2 * n
            for i in range(2 * n):
                grad_bar[2 * at + i] = seeds[3 * at + i]
            on_axis = not radius[point] > 0.0
            for i in range(n):
                for m in range(seeds.shape[1]):
                    if on_axis:
                        grad_bar[2 * at + i, m] += seeds[3 * at + 2 * n + i, m]
                        phi_bar[at + i, m] = 0.0
                        continue
                    # Phi_bar = hoop_bar / R,  R_bar = -(Phi / R) hoop_bar / R
                    seed = seeds[3 * at + 2 * n + i, m] / radius[point]
                    phi_bar[at + i, m] = seed
                    radius_bar[point, m] -= hoop[row + i] * seed

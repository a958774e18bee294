"""Design parameters of a section as a table: where each one moves the boundary, in which direction, how
far, and what it does to the area; limits of them that invert a wall; dependent parameters."""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import qr, solve_triangular
from scipy.spatial import cKDTree

from seal_mdao import values
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.outline.section_cloud import wall_thickness

ALONG = 0.2
"""Largest cosine between a velocity and the normal of an edge that it moves along."""
SAME = 1e-9
"""Relative difference of equal velocities."""
DEPENDENT = 1e-8
"""Least part of a velocity that is no combination of others, over the velocity."""


class DesignParameter(NamedTuple):
    """A component of ``boundary_offsets`` and its effect on the nominal boundary.

    Attributes
    ----------
    index : int
        Index in ``boundary_offsets``, from 0.
    table : int
        Number of its ``[[design]]``, from 1.
    edge : str
        Edge of the point that moves most; where two edges meet, the one that moves more along its
        normal.
    place : tuple of float
        This point, mm.
    direction : str
        Direction of its motion for a positive value, relative to the rubber.
    velocity : tuple of float
        dX/db of this point, mm per mm.
    largest : float
        Its amount, the largest of the boundary.
    area : float
        dA/db of the section, mm^2 per mm.
    """

    index: int
    table: int
    edge: str
    place: tuple[float, float]
    direction: str
    velocity: tuple[float, float]
    largest: float
    area: float


def design_parameters(seal: OutlineSeal) -> list[DesignParameter]:
    """List the design parameters of a seal in the order of ``boundary_offsets``."""
    if not seal.n_offsets:
        return []
    points, normals, velocity = _boundary(seal)
    # sides before and after every point: unit tangents t (k, 2, 2), edges
    tangents = np.concatenate([own.tangent for own in seal.boundaries])
    edges = np.concatenate(
        [np.column_stack([np.roll(own.edge, 1), own.edge]) for own in seal.boundaries]
    )
    by_offset = seal.area(np.zeros(seal.n_offsets))[1]
    tables = _tables(seal)
    found = []
    for index, own in enumerate(velocity):
        size = np.hypot(*own.T)
        # mirror images move alike: the first of them, whatever the rounding
        at = int(np.flatnonzero(size >= (1.0 - SAME) * size.max())[0])
        # |V . n| = |V_x t_y - V_y t_x| of both sides
        (x, y), (before, after) = own[at], tangents[at]
        across = abs(x * before[1] - y * before[0]), abs(x * after[1] - y * after[0])
        side = 0 if across[0] > across[1] + SAME * size[at] else 1
        found.append(
            DesignParameter(
                index, int(tables[index]), str(edges[at, side]), _pair(points[at]),
                _direction(own[at] @ normals[at], size[at]), _pair(own[at]), float(size[at]),
                float(by_offset[index]),
            )
        )  # fmt: skip
    return found


def inverting_limits(seal: OutlineSeal, bounds: np.ndarray) -> tuple[str, ...]:
    """Warn of limits of the design parameters that are larger than the thickness of a wall.

    Parameters
    ----------
    bounds : ndarray, shape (n_offsets,)
        Largest absolute values of the parameters, mm.

    Returns
    -------
    tuple of str
        Empty, or one warning about the wall whose two faces can move farthest towards each other in
        relation to its thickness.
    """
    points, normals, velocity = _boundary(seal)
    thickness = np.concatenate(wall_thickness([own.points for own in seal.boundaries]))
    walls = np.flatnonzero(np.isfinite(thickness))
    # largest motion along the normal, sum_p b_p |V_p . n|, of the points and of those opposite
    inward = bounds[:, None] * np.abs(np.einsum("pki,ki->pk", velocity, normals))
    across = points[walls] - thickness[walls, None] * normals[walls]
    faces = np.column_stack([walls, cKDTree(points).query(across)[1]])
    moved = inward.sum(axis=0)[faces].sum(axis=1)
    ratio = moved / thickness[walls]
    if not ratio.max(initial=0.0) > 1.0:
        return ()
    worst = int(ratio.argmax())
    # tables that move one of both faces
    numbers = np.unique(_tables(seal)[inward[:, faces[worst]].max(axis=1) > SAME * moved[worst]])
    named = " and ".join(f"[[design]] {number}" for number in numbers)
    place = points[walls[worst]]
    return (
        f"within the limits (bound) of {named} the two faces of the wall at {values.place(place)} "
        f"can move towards each other by {moved[worst]:.3g} mm, but the wall is only "
        f"{thickness[walls[worst]]:.3g} mm thick, so an optimisation may invert it; use a smaller "
        "bound",
    )


def dependent_parameters(seal: OutlineSeal) -> tuple[str, ...]:
    """Warn of design parameters whose velocities of the boundary are linearly dependent: their effects
    add up, and different values of them give the same section.

    Returns
    -------
    tuple of str
        Empty, or one warning about the tables of all these parameters.
    """
    velocity = _boundary(seal)[2].reshape(seal.n_offsets, -1)
    # V^T P = Q R of the velocities divided by their lengths: |R_kk| falls
    columns = (velocity / np.linalg.norm(velocity, axis=1, keepdims=True)).T
    upper, order = qr(columns, mode="r", pivoting=True)
    diagonal = np.abs(np.diagonal(upper))
    rank = int(np.count_nonzero(diagonal > DEPENDENT * diagonal[0]))
    if rank == seal.n_offsets:
        return ()
    # the dependent columns are combinations R_1 C = R_2 of the independent ones
    combination = solve_triangular(upper[:rank, :rank], upper[:rank, rank:])
    involved = np.concatenate(
        [np.abs(combination).max(axis=1) > DEPENDENT, [True] * (seal.n_offsets - rank)]
    )
    indices = np.sort(order[involved])
    tables = [f"[[design]] {number}" for number in np.unique(_tables(seal)[indices])]
    named = ", ".join(map(str, indices))
    return (
        f"the design parameters {named} (boundary_offsets) of {' and '.join(tables)} do not move the "
        "boundary independently: their effects add up, so that different values of them give the same "
        "section, and a bound of one table does not limit the sum; leave out one of the tables, or let "
        "them move different parts of the boundary or different directions",
    )


def _boundary(seal: OutlineSeal) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points and outward normals (k, 2) of all boundaries, and velocities V_p (P, k, 2)."""
    points = np.concatenate([own.points for own in seal.boundaries])
    # outward normal: tangent turned clockwise, rubber on the left; sum of both sides of a corner
    tangents = np.concatenate([np.asarray(own.tangent).sum(axis=1) for own in seal.boundaries])
    normals = np.column_stack([tangents[:, 1], -tangents[:, 0]])
    normals /= np.hypot(*normals.T)[:, None]
    # V_p at the boundary particles, in the order of the points
    return points, normals, seal.design_velocity[:, np.concatenate(seal.loops)]


def _tables(seal: OutlineSeal) -> np.ndarray:
    """Return the number of the ``[[design]]`` of every parameter, from 1, shape (n_offsets,)."""
    # every table has as many parameters as the seal says
    return np.repeat(np.arange(1, len(seal.design_sizes) + 1), seal.design_sizes)


def _pair(vector) -> tuple[float, float]:
    # zero where it is zero up to rounding, without a sign
    x, y = (np.round(vector, 9) + 0.0).tolist()
    return x, y


def _direction(outward: float, size: float) -> str:
    """Describe the direction of a velocity from its component along the outward normal."""
    if not math.fabs(outward) > ALONG * size:
        return "along the edge"
    return "out of the rubber" if outward > 0.0 else "into the rubber"

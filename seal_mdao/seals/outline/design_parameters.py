"""Design parameters of a section as a table: where each one moves the boundary, in which direction, how
far, and what it does to the area."""

import math
from typing import NamedTuple

import numpy as np

from seal_mdao.seals.outline.outline_seal import OutlineSeal

ALONG = 0.2
"""Largest cosine between a velocity and the normal of an edge that it moves along."""
SAME = 1e-9
"""Relative difference of equal velocities."""


class DesignParameter(NamedTuple):
    """A component of ``boundary_offsets`` and its effect on the nominal boundary.

    Attributes
    ----------
    index : int
        Index in ``boundary_offsets``, from 0.
    table : int
        Number of its ``[[design]]``, from 1.
    edge : str
        Edge of the point that moves most.
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
    points = np.concatenate([own.points for own in seal.boundaries])
    edges = np.concatenate([own.edge for own in seal.boundaries])
    # outward normal: tangent turned clockwise, rubber on the left; sum of both sides of a corner
    tangents = np.concatenate([np.asarray(own.tangent).sum(axis=1) for own in seal.boundaries])
    normals = np.column_stack([tangents[:, 1], -tangents[:, 0]])
    normals /= np.hypot(*normals.T)[:, None]
    # V_p at the boundary particles, in the order of the points
    velocity = seal.design_velocity[:, np.concatenate(seal.loops)]
    by_offset = seal.area(np.zeros(seal.n_offsets))[1]
    # every table has as many parameters as the seal says
    tables = np.repeat(np.arange(1, len(seal.design_sizes) + 1), seal.design_sizes)
    found = []
    for index, own in enumerate(velocity):
        size = np.hypot(*own.T)
        # mirror images move alike: the first of them, whatever the rounding
        at = int(np.flatnonzero(size >= (1.0 - SAME) * size.max())[0])
        found.append(
            DesignParameter(
                index, int(tables[index]), str(edges[at]), _pair(points[at]),
                _direction(own[at] @ normals[at], size[at]), _pair(own[at]), float(size[at]),
                float(by_offset[index]),
            )
        )  # fmt: skip
    return found


def _pair(vector) -> tuple[float, float]:
    # zero where it is zero up to rounding, without a sign
    x, y = (np.round(vector, 9) + 0.0).tolist()
    return x, y


def _direction(outward: float, size: float) -> str:
    """Describe the direction of a velocity from its component along the outward normal."""
    if not math.fabs(outward) > ALONG * size:
        return "along the edge"
    return "out of the rubber" if outward > 0.0 else "into the rubber"

"""Refinement of the door seal, and the flat door against an independent finite element solution."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from seal_mdao.measures.selection import open_points
from seal_mdao.seals.door.door_seal import DOOR, door_seal, options_of
from seal_mdao.seals.result import SealResult, analyze
from verification.flat_door_reference import BOUNDARY, REACTION

LEVELS = ((58, 3), (116, 5), (174, 7))


class SealLevel(NamedTuple):
    """The nominal seal under the corner door at 10 mm, on one particle discretisation.

    Attributes
    ----------
    rays, layers : int
    reaction : ndarray, shape (2,)
        Force on the door, N/m.
    max_gap : float
        Largest gap between the first and the last point in contact, mm.
    gap_square_integral : float
        Integral of g^2 over the undeformed boundary that is open between them, mm^3.
    """

    rays: int
    layers: int
    reaction: np.ndarray
    max_gap: float
    gap_square_integral: float


def corner_level(rays: int, layers: int, n_steps: int = 105) -> SealLevel:
    """Reaction and opened stretch of the nominal seal with ``rays`` x ``layers`` particles."""
    result = analyze(door_seal(rays=rays, layers=layers, n_steps=n_steps))
    opened = open_points(result.contact.state)
    gap, length = result.contact.gap[opened], result.term(DOOR).length[opened]
    return SealLevel(rays, layers, result.reaction[-1], float(gap.max()), float(length @ gap**2))


class FlatLevel(NamedTuple):
    """The nominal seal under the flat door, compared with ``flat_door_reference``.

    Attributes
    ----------
    rays, layers : int
    reaction_error : ndarray, shape (5,)
        Relative error of the vertical reaction at 2, 4, 6, 8 and 10 mm.
    boundary_error : float
        Largest distance of a particle of the outer boundary from its place in the reference at
        10 mm, mm.
    """

    rays: int
    layers: int
    reaction_error: np.ndarray
    boundary_error: float


def flat_level(rays: int, layers: int) -> FlatLevel:
    """Both errors on one particle discretisation, 105 steps."""
    result = analyze(door_seal(rays=rays, layers=layers, door="flat"))
    result.require_converged()
    at = np.argmin(np.abs(result.travel - REACTION[:, :1]), axis=1)
    error = result.reaction[at, 1] / REACTION[:, 1] - 1.0
    return FlatLevel(rays, layers, error, _boundary_error(result))


def _boundary_error(result: SealResult) -> float:
    mirrored = BOUNDARY * [-1.0, 1.0, -1.0, 1.0]
    undeformed, deformed = np.hsplit(np.vstack([BOUNDARY, mirrored]), 2)
    outer = options_of(result.seal).grid.free_outer
    distance, nearest = cKDTree(result.particles[outer]).query(undeformed)
    if distance.max() > 1e-5:
        raise ValueError("the particles do not include those of the reference")
    place = result.deformed()[outer[nearest]]
    return float(np.hypot(*(place - deformed).T).max())

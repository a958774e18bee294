"""Refinement of the door seal, and the flat door against an independent finite element solution."""

from typing import NamedTuple

import numpy as np

from seal_mdao.measures.selection import opened_points
from seal_mdao.model import door_seal
from seal_mdao.seal import analyze

LEVELS = ((58, 3), (116, 5), (174, 7))

# Door travel (mm) and reaction (N/m) of this section under a wholly flat door, friction 0.25, from
# an independent code: biquadratic displacements, discontinuous linear pressure, 8 x 232 elements,
# augmented-Lagrangian contact, 100 steps; its own discretisation error is about 0.5 %.
FLAT_DOOR = np.array(
    [
        [2.0, 13.674875],
        [4.0, 24.233102],
        [6.0, 35.704187],
        [8.0, 49.517427],
        [10.0, 64.567162],
    ]
)


class SealLevel(NamedTuple):
    """The drawn seal under the corner door at 10 mm, on one particle discretisation.

    Attributes
    ----------
    rays, layers : int
    reaction : ndarray, shape (2,)
        Force on the door, N/m.
    max_gap : float
        Largest gap between the first and the last point in contact, mm.
    gap_square_integral : float
        Integral of g^2 over the undeformed boundary that stands open between them, mm^3.
    """

    rays: int
    layers: int
    reaction: np.ndarray
    max_gap: float
    gap_square_integral: float


def corner_level(rays: int, layers: int, n_steps: int = 105) -> SealLevel:
    """Reaction and opened stretch of the drawn seal with ``rays`` x ``layers`` particles."""
    result = analyze(door_seal(rays=rays, layers=layers, n_steps=n_steps))
    end = result.end
    opened = opened_points(end.after.state)
    gap, length = end.gap[opened], result.path.discretization.contact_length[opened]
    return SealLevel(rays, layers, end.reaction, float(gap.max()), float(length @ gap**2))


def flat_door_error(rays: int, layers: int, n_steps: int = 105) -> np.ndarray:
    """Relative error of the vertical reaction at 2, 4, 6, 8 and 10 mm, shape (5,).

    ``n_steps`` must be a multiple of 21, so that the door stops at these places.
    """
    result = analyze(door_seal(rays=rays, layers=layers, door="flat", n_steps=n_steps))
    result.require_converged()
    at = np.argmin(np.abs(result.door_travel - FLAT_DOOR[:, :1]), axis=1)
    if np.abs(result.door_travel[at] - FLAT_DOOR[:, 0]).max() > 1e-9:
        raise ValueError(f"n_steps = {n_steps} must be a multiple of 21")
    return result.reaction[at, 1] / FLAT_DOOR[:, 1] - 1.0

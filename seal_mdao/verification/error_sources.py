"""Where the error of the door seal comes from: one discretisation choice changed at a time."""

from dataclasses import replace

import numpy as np

from seal_mdao.analysis.body import discretize
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.seals.door.door_seal import door_seal
from seal_mdao.seals.door.result import DoorSealResult
from seal_mdao.seals.result import analyze
from seal_mdao.terms.points import edge_points
from seal_mdao.verification.flat_door_reference import REACTION, reaction_errors
from seal_mdao.verification.pressed_elements import FLAT

STEPS = 42
"""Equal load steps of a study of anything else. One ends at every travel of the reference: between
their ends the reaction would be off by up to 0.1 %."""

MATCHED = {"pressure": "wall", "contact_points": "edges", "n_gauss": (2, 3)}
"""Two Gauss points around the wall and three across it, which the pressure through the wall needs."""
FUNCTIONS = tuple(
    MATCHED | {"basis_order": order, "support": support}
    for order, support in ((1, (1.7, 2.0)), (1, (1.7, 2.5)), (1, (1.8, 4.0)), (2, (1.8, 4.0)))
)
"""Wider and wider supports of the linear basis, and the quadratic one; the last of ``"fine"``."""


def flat_errors(**changes) -> np.ndarray:
    """Relative errors of the reaction under the flat door at 2, 4, 6, 8 and 10 mm, shape (5,).

    Parameters
    ----------
    **changes
        Attributes of ``DoorSeal``.
    """
    result = analyze(door_seal(**{"door": "flat", "n_steps": STEPS, **changes}))
    result.require_converged()
    return reaction_errors(result.door_travel, result.reaction[:, 1])


def from_the_limit(**changes) -> np.ndarray:
    """As ``flat_errors``, but from the limit of elements with the same contact law."""
    return (1.0 + flat_errors(**changes)) * REACTION[:, 1] / FLAT - 1.0


def worst_error(**changes) -> float:
    """The largest of ``flat_errors``, without its sign."""
    return float(np.abs(flat_errors(**changes)).max())


def boundary_gaps(result: DoorSealResult, per_side: int = 8) -> np.ndarray:
    """Gaps at the end along the outer boundary, ``per_side`` points between neighbouring particles.

    The shape functions are evaluated there, so that a gap between two particles is not overlooked.

    Returns
    -------
    ndarray, shape (n_sides * per_side,)
        mm, from the first to the last free particle.
    """
    seal, body = result.seal, result.seal.body
    structure, door = seal.terms()
    door = replace(door, where=edge_points(body.edges["outer"].sides, per_side))
    terms = structure, door
    problem = PathProblem(discretize(body, result.particles, terms), terms)
    problem.begin()
    problem.assemble_forces(result.end.d, result.end.fraction, problem.no_history())
    return problem.responses[1].gap


def largest_opened_gap(result: DoorSealResult) -> float:
    """Largest gap between the first and the last place in contact along the outer boundary, mm."""
    gap = boundary_gaps(result)
    touching = np.flatnonzero(gap <= 0.0)
    return float(gap[touching[0] : touching[-1] + 1].max())


def drawn(**changes) -> DoorSealResult:
    """The drawn seal under the corner door, analysed."""
    result = analyze(door_seal(**changes))
    result.require_converged()
    return result

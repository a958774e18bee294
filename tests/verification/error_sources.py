"""Where the error of the door seal comes from: one discretisation choice changed at a time."""

from dataclasses import replace

import numpy as np

from seal_mdao.analysis.problem import PathProblem
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.measures.selection import contact_range
from seal_mdao.seals.door.door_seal import ACCURACIES, door_seal
from seal_mdao.seals.result import SealResult, analyze
from seal_mdao.terms.points import edge_points
from verification.flat_door_reference import REACTION, at_its_travels
from verification.pressed_elements import FLAT

STEPS = 42
"""Equal load steps of a study of anything else. One ends at every travel of the reference: between
their ends the reaction would be off by up to 0.1 %."""

FINEST = {
    name: ACCURACIES["fine"][name]
    for name in ("support", "basis_order", "n_gauss", "pressure", "contact_points")
}
"""Two Gauss points around the wall and three across it, which the pressure through the wall needs."""
FUNCTIONS = tuple(
    FINEST | changes
    for changes in (
        {"basis_order": 1, "support": (1.7, 2.0)}, {"basis_order": 1, "support": (1.7, 2.5)},
        {"basis_order": 1}, {},
    )
)  # fmt: skip
"""Wider and wider supports of the linear basis, and the quadratic one of ``"fine"``."""


def flat_errors(**changes) -> np.ndarray:
    """Relative errors of the reaction under the flat door at 2, 4, 6, 8 and 10 mm, shape (5,).

    Parameters
    ----------
    **changes
        Options of ``DoorOptions``.
    """
    return _flat_curve(changes) / REACTION[:, 1] - 1.0


def from_the_limit(**changes) -> np.ndarray:
    """As ``flat_errors``, but from the limit of elements with the same contact law."""
    return _flat_curve(changes) / FLAT - 1.0


def _flat_curve(changes) -> np.ndarray:
    return at_travels(nominal(**{"door": "flat", "n_steps": STEPS, **changes}))


def at_travels(result: SealResult) -> np.ndarray:
    """Vertical reaction at the travels of the reference, N/m, shape (5,)."""
    return at_its_travels(result.travel, result.reaction[:, 1])


def worst_error(**changes) -> float:
    """The largest of ``flat_errors``, without its sign."""
    return float(np.abs(flat_errors(**changes)).max())


def boundary_gaps(result: SealResult, per_side: int = 8) -> np.ndarray:
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
    end, history = result.end, problem.no_history()
    return problem.evaluate(end.d, end.fraction, history, tangent=False).responses[1].gap


def largest_opened_gap(result: SealResult) -> float:
    """Largest gap between the first and the last place in contact along the outer boundary, mm."""
    gap = boundary_gaps(result)
    return float(gap[contact_range(gap <= 0.0)].max())


def nominal(**changes) -> SealResult:
    """The nominal seal, analysed; under the corner door unless ``changes`` say otherwise."""
    result = analyze(door_seal(**changes))
    result.require_converged()
    return result

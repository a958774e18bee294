"""What the displacements of one load step hand on to the next, and the few adjoints it takes.

Steps are coupled through the contact history alone, and only a point that sticks uses its history:
in slip the traction follows from the gap, and |t| = 1 always, the natural coordinate being the arc
length. So of all displacements of a step that is not measured no more is wanted than those of the
points that stick in the next step, and of a point that sticks in both the tangential one. With

    K_n^T Lambda_n = Phi^T q        a column for each wanted direction q of a point

they move by -Lambda_n^T f'_n, whatever the parameters (direct) or measures (adjoint).
"""

import math
from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import ConvergedStep
from seal_mdao.contact.friction import CARRIED, STICK, XI, XI_0, X
from seal_mdao.dsa.linearization import converged_factor
from seal_mdao.dsa.point_rates import add_displacement_seeds

# Sine of the angle between two directions below which they are one.
PARALLEL = 1e-13


class HandedOn(NamedTuple):
    """Displacements that the next step uses.

    Attributes
    ----------
    points : ndarray of int, shape (s,)
        Contact points; one of them once or twice.
    directions : ndarray, shape (s, 2)
        Unit vectors.
    """

    points: np.ndarray
    directions: np.ndarray


def sticking(following: ConvergedStep | None) -> np.ndarray:
    """Points whose history the step after uses; none for None."""
    if following is None:
        return np.empty(0, int)
    return np.flatnonzero(following.after.state == STICK)


def handed_on(used: np.ndarray, local: np.ndarray) -> HandedOn:
    """What the next step uses of this one, linearised in ``local`` (s, 6, 10) at the points
    ``used`` (s,)."""
    points, directions = [], []
    # rates of the natural coordinate and of what is carried, with the point's displacement
    rates = local[:, [XI, CARRIED], X:XI_0].tolist()
    for i, ((along_x, along_y), (carried_x, carried_y)) in zip(used, rates, strict=True):
        size = math.hypot(along_x, along_y)
        area = along_x * carried_y - along_y * carried_x
        if abs(area) <= PARALLEL * size * math.hypot(carried_x, carried_y):
            points.append(i)
            directions.append((along_x / size, along_y / size))
        else:
            points += [i, i]
            directions += [(1.0, 0.0), (0.0, 1.0)]
    return HandedOn(np.array(points, int), np.array(directions).reshape(-1, 2))


def adjoint_displacements(problem: PathProblem, step: ConvergedStep, loads) -> np.ndarray:
    """K_n^-T times ``loads`` (n_equations + 1, c), overwritten; the last row, of imposed
    displacements, becomes zero."""
    if loads.shape[1]:
        loads[:-1] = converged_factor(problem, step).solve(loads[:-1], transposed=True)
    loads[-1] = 0.0
    return loads


def handed_on_adjoints(problem: PathProblem, step: ConvergedStep, handed: HandedOn) -> np.ndarray:
    """Lambda_n, shape (n_equations + 1, s)."""
    layout, table = problem.discretization.layout, problem.discretization.contact.table
    loads = np.zeros((layout.n_equations + 1, handed.points.size))
    add_displacement_seeds(
        table, handed.points, unit_seeds(handed.directions), layout.equations, loads
    )
    return adjoint_displacements(problem, step, loads)


def unit_seeds(directions: np.ndarray) -> np.ndarray:
    """Seeds (s, 2, s) of ``directions`` (s, 2), a column for each."""
    return directions[:, :, None] * np.eye(len(directions))[:, None]

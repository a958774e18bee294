"""Detect increments that end on another branch of equilibria than the one the path was on.

Newton's method may converge to an equilibrium that the body does not reach quasi-statically: a lip that
a rod bends springs back a few increments too early, in equilibrium all the same. Damped motion and
descent may even find one with more energy, of folded material. The energy balance detects both. Along a
path of equilibria the work of the loading is stored or dissipated by friction; at a jump energy is
released, which a real body turns into motion, sound and heat:

    released = work of the loading - change of the stored energy - work of friction >= 0.

The work over the increment is not known, only the forces at its two ends. Where the forces change
monotonously it lies between those with the one and with the other. The smaller one and the largest
possible work of friction give a lower bound of ``released``, which is not positive on a path of
equilibria. The larger one and the least work of friction, the change of the energy of the elastic slip,
give an upper bound, which is negative only for equilibria to which no motion leads.
"""

import numpy as np

from seal_mdao.analysis.assembly import Assembly
from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.path_result import ConvergedStep, Status
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.terms.term import ReleasedEnergy

# Fraction of the increment that the predictor may miss where the tangent describes the increment.
SMALL_BEND = 0.03
# Fraction of the body's size above which a displacement is large where nothing is predicted.
FAR_AWAY = 0.01


def extent(problem: PathProblem) -> float:
    """Return the larger side of the box around the undeformed body, mm."""
    return float(np.ptp(problem.discretization.particles, axis=0).max())


def released_energy(
    problem: PathProblem, now: Assembly, last: ConvergedStep, target: float
) -> ReleasedEnergy:
    """Compute bounds of the energy that the body releases in an increment.

    Parameters
    ----------
    now : Assembly or ConvergedStep
        Equilibrium at ``target``.
    last : ConvergedStep
    """
    # work of the prescribed displacements with the forces at both ends of the increment: its bounds
    prescribed = [problem.prescribed_work(at.d, last, target) for at in (last, now)]
    bounds = [(min(prescribed), max(prescribed), max(map(abs, prescribed)))]
    # released = sum over terms of (work of the loading - stored energy - friction), with its bounds
    for term, before, own in zip(problem.terms, last.responses, now.responses, strict=True):
        bounds.append(term.released_energy(last, before, now.d, own, target))
    return ReleasedEnergy(*map(sum, zip(*bounds, strict=True)))


def jump_of(increment: Increment, now: Assembly, guess) -> Status | None:
    """Return how the equilibrium ``now`` contradicts a continuous path from ``last``: JUMPED, GAINED,
    or None where it does not.

    JUMPED where the increment releases energy, GAINED where it stores more than the loading supplies,
    in both cases beyond rounding, and

    - the correction |d - guess| is larger than the predicted increment |guess - d_n|, so that the
      tangent says nothing of the increment, and than ``FAR_AWAY`` of the body, or
    - that energy is larger than the work of the loading: on a path of equilibria both tend to zero with
      the increment, the work linearly and the error of the bounds faster.

    Increments that the predictor meets to ``SMALL_BEND`` are described by the tangent and not checked.
    """
    problem, last = increment.problem, increment.last
    missed, ahead = np.abs(now.d - guess).max(), np.abs(guess - last.d).max()
    if missed <= SMALL_BEND * ahead:
        return None
    bounds = released_energy(problem, now, last, increment.target)
    allowed = _rounding(problem) if is_far(increment, now.d, guess) else _error(problem, bounds)
    if bounds.least > allowed:
        return Status.JUMPED
    return Status.GAINED if -bounds.most > allowed else None


def without_gain(increment: Increment, found: Solution) -> Solution:
    """Replace CONVERGED by GAINED where an equilibrium ``found`` by any iteration stores more energy
    than the loading supplies, so that no motion from ``last`` leads there."""
    if not found.converged:
        return found
    bounds = released_energy(increment.problem, found.assembly, increment.last, increment.target)
    if -bounds.most > _error(increment.problem, bounds):
        return found._replace(status=Status.GAINED)
    return found


def _rounding(problem: PathProblem) -> float:
    """Rounding error of an energy: that of forces over the size of the body, mJ/m."""
    return problem.rounding * extent(problem)


def _error(problem: PathProblem, bounds: ReleasedEnergy) -> float:
    """Energy beyond which ``bounds`` contradict a path of equilibria of any increment, mJ/m."""
    return max(bounds.work, _rounding(problem))


def is_far(increment: Increment, d, guess) -> bool:
    """Return whether the correction |d - guess| is larger than the predicted increment
    |guess - d_n|, and than ``FAR_AWAY`` of the body."""
    missed, ahead = np.abs(d - guess).max(), np.abs(guess - increment.last.d).max()
    return bool(missed > max(ahead, FAR_AWAY * extent(increment.problem)))

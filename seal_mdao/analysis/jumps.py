"""Detect increments that end on another branch of equilibria than the one the path was on.

Newton's method may converge to an equilibrium that the body does not reach quasi-statically: a lip that
a rod bends springs back a few increments too early, in equilibrium all the same. The energy balance
detects it. Along a path of equilibria the work of the loading is stored or dissipated by friction; at a
jump energy is released, which a real body turns into motion, sound and heat:

    released = work of the loading - change of the stored energy - work of friction.

The work over the increment is not known, only the forces at its two ends. Where the forces change
monotonously it lies between those with the one and with the other; the smaller one and the largest
possible work of friction make ``released`` a lower bound, which is not positive on a path of equilibria.
"""

import numpy as np

from seal_mdao.analysis.assembly import Assembly
from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.path_result import ConvergedStep
from seal_mdao.analysis.problem import PathProblem

# Fraction of the increment that the predictor may miss where the tangent describes the increment.
SMALL_BEND = 0.03
# Fraction of the body's size above which a displacement is large where nothing is predicted.
FAR_AWAY = 0.01


def extent(problem: PathProblem) -> float:
    """Return the larger side of the box around the undeformed body, mm."""
    return float(np.ptp(problem.discretization.particles, axis=0).max())


def released_energy(problem: PathProblem, now: Assembly, last: ConvergedStep, target: float):
    """Compute a lower bound of the energy that the body releases in an increment.

    Parameters
    ----------
    now : Assembly or ConvergedStep
        Equilibrium at ``target``.
    last : ConvergedStep

    Returns
    -------
    released : float
        mJ/m; positive where the increment cannot be one of a path of equilibria.
    work : float
        Largest work of the loading, in amount, with the forces at either end of the increment, mJ/m.
    """
    # work of the prescribed displacements with the forces at both ends of the increment:
    # the smaller one bounds the released energy, the larger one in amount bounds the work
    prescribed = [problem.prescribed_work(at.d, last, target) for at in (last, now)]
    released, work = min(prescribed), max(map(abs, prescribed))
    # released = sum over terms of (work of the loading - stored energy - friction), bounded below
    for term, before, own in zip(problem.terms, last.responses, now.responses, strict=True):
        one, one_work = term.released_energy(last, before, now.d, own, target)
        released, work = released + one, work + one_work
    return released, work


def jumped(increment: Increment, now: Assembly, guess) -> bool:
    """Return whether the equilibrium ``now`` lies on another branch than the path up to ``last``.

    It does where the increment releases energy, and

    - the correction |d - guess| is larger than the predicted increment |guess - d_n|, so that the
      tangent says nothing of the increment, and than ``FAR_AWAY`` of the body, or
    - more energy is released than the loading exchanged with the body: on a path of equilibria both
      tend to zero with the increment, the work linearly and the error of the bound faster.

    Increments that the predictor meets to ``SMALL_BEND`` are described by the tangent and not checked.
    """
    problem, last = increment.problem, increment.last
    missed, ahead = np.abs(now.d - guess).max(), np.abs(guess - last.d).max()
    if missed <= SMALL_BEND * ahead:
        return False
    released, work = released_energy(problem, now, last, increment.target)
    far = is_far(increment, now.d, guess)
    # rounding of forces over the size of the body is rounding of energies
    return released > problem.rounding * extent(problem) and bool(far or released > work)


def is_far(increment: Increment, d, guess) -> bool:
    """Return whether the correction |d - guess| is larger than the predicted increment
    |guess - d_n|, and than ``FAR_AWAY`` of the body."""
    missed, ahead = np.abs(d - guess).max(), np.abs(guess - increment.last.d).max()
    return bool(missed > max(ahead, FAR_AWAY * extent(increment.problem)))

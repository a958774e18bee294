"""Newton iterations with the consistent tangent, Eq. (44)."""

from dataclasses import dataclass

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.assembly import Assembly
from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.linear_contact import with_contact
from seal_mdao.analysis.path_result import Status

BRANCHES = ("stable", "primary")
# Iterations cycle where displacements return to those of so many iterations before, within this
# fraction of the last correction.
SHORTEST_CYCLE, LONGEST_CYCLE, SAME_PLACE = 2, 7, 1e-3


@dataclass(frozen=True)
class NewtonOptions:
    """Options of the iterations and of the load path.

    Attributes
    ----------
    tolerance : float
        Residual norm over the norm of the contact and internal forces, at most 1e-4.
    max_iterations : int
        Iterations of Newton's method, and of the mixed ones after it, before a step is cut.
    max_cuts : int
        How often a step may be halved. Under friction a nominal step that was halved is solved as one
        in the end, from where its parts led.
    damped_iterations : int
        Most iterations of damped motion where the smallest step fails (``pseudo_time``); 0 for none.
        Where points slide on a little 10 to 40 are needed, where the seal sways to another state
        some thousands. They end early where the seal moves off altogether.
    branch : {"stable", "primary"}
        Where equilibrium loses its stability, without friction: "stable" continues to the next stable
        equilibrium (``critical_points``); "primary" stays on the branch as long as Newton's method does.
    """

    tolerance: float = 1e-10
    max_iterations: int = 15
    max_cuts: int = 8
    damped_iterations: int = 5_000
    branch: str = "stable"

    def __post_init__(self):
        object.__setattr__(
            self, "tolerance", values.real("tolerance", self.tolerance, above=0.0, high=1e-4)
        )
        for name, least, most in (
            ("max_iterations", 1, 10_000), ("max_cuts", 0, 40), ("damped_iterations", 0, 10**7)
        ):  # fmt: skip
            value = values.integer(name, getattr(self, name), least, most)
            object.__setattr__(self, name, value)
        object.__setattr__(self, "branch", values.one_of("branch", self.branch, BRANCHES))


def converged(assembly: Assembly, options: NewtonOptions) -> bool:
    """Return whether a residual is small, or only rounding, with the laws of the terms themselves,
    not their linearisations."""
    return (assembly.size <= options.tolerance or assembly.rounding) and not assembly.unconverged


def _stagnates(assembly: Assembly, residuals: list) -> bool:
    """Return whether only rounding is left of a residual: it is no larger than rounding may be, and the
    last iteration has not halved it."""
    slow = len(residuals) > 1 and residuals[-1] >= 0.5 * residuals[-2]
    return slow and assembly.noise and not assembly.unconverged


def _cycle(visited: list) -> int:
    """Return the number of iterations of one cycle where the last displacements are those of a few
    iterations before, so that the next are, too; 0 where they are not.

    Points that alternately stick and slip, or touch and open, make Newton's method cycle.
    """
    if len(visited) <= SHORTEST_CYCLE:
        return 0
    d, step = visited[-1], np.abs(visited[-1] - visited[-2]).max()
    # |d_k - d_(k-p)| << |d_k - d_(k-1)| for a period p
    for period in range(SHORTEST_CYCLE, min(LONGEST_CYCLE, len(visited) - 1) + 1):
        if np.abs(d - visited[-1 - period]).max() <= SAME_PLACE * step:
            return period
    return 0


def newton(increment: Increment, guess: np.ndarray) -> Solution:
    """Iterate by Newton's method (44) from the predictor ``guess`` (n, 2)."""
    return iterate(increment, guess)


def iterate(increment: Increment, d, iteration=None, mixed: bool = False) -> Solution:
    """Iterate to equilibrium with the tangent of every iterate.

    Parameters
    ----------
    d : ndarray, shape (n, 2)
        The predictor.
    iteration : tuple, optional
        State of the iterations of all terms to begin with.
    mixed : bool
        Whether the linearisations are those of mixed iterations (``mixed_newton``).
    """
    found = _iterate(increment, d, iteration, mixed)
    state = increment.problem.through_slip(found.cycle) if found.cycle else None
    if state is None:
        return found
    # from the last iterate, with points that pass through slip between open and stick
    again = _iterate(increment, found.assembly.d, state, mixed).after(found.residuals[:-1])
    return again if again.converged else found._replace(residuals=again.residuals)


def _iterate(increment: Increment, d, iteration, mixed: bool) -> Solution:
    """Iterate until the iterations converge, fail or cycle."""
    options, residuals, visited, states, now = increment.options, [], [], [], None
    for number in range(options.max_iterations + 1):
        last, now = now, increment.evaluate(d, iteration, tangent=not mixed)
        if now is None:
            return Solution(Status.INVERTED, d, tuple(residuals), last)
        residuals.append(now.size)
        if not np.isfinite(now.size):
            return Solution(Status.DIVERGED, d, tuple(residuals), now)
        done = converged(now, options) or _stagnates(now, residuals)
        if number == options.max_iterations and not done:
            break
        visited.append(d)
        states.append(now.iteration)
        period = 0 if done else _cycle(visited)
        if period:
            mean, cycle = np.mean(visited[-period:], axis=0), tuple(states[-period:])
            return Solution(Status.CYCLED, mean, tuple(residuals), now, cycle=cycle)
        if mixed:
            # tangent and force of the mixed linearisation at the same d
            now = increment.evaluate(d, now.iteration, mixed=not done)
        try:
            if done:
                return Solution(
                    Status.CONVERGED, d, tuple(residuals), now, now.factorize(check=True)
                )
            # K dd = -r, Eq. (44)
            factor = now.factorize()
            d = d - increment.gather(factor.solve(now.residual))
        except np.linalg.LinAlgError:
            return Solution(Status.SINGULAR, d, tuple(residuals), now)
        if mixed:
            # the linear step with the contact law itself between facing walls
            contacts = increment.problem.linear_contacts(now.iteration, increment.history)
            d = with_contact(increment, contacts, d, factor)
        iteration = now.iteration
    return Solution(Status.NOT_CONVERGED, d, tuple(residuals), now)

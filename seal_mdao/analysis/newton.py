"""Newton iterations with the consistent tangent, Eq. (44)."""

from dataclasses import dataclass

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import Status

BRANCHES = ("stable", "primary")


@dataclass(frozen=True)
class NewtonOptions:
    """Convergence control.

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
        Where equilibrium loses its stability, without friction: "stable" goes on to the next stable
        equilibrium (``stability``); "primary" stays on the branch as long as Newton's method does.
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


def converged(problem: PathProblem, size: float, rounding: bool, options: NewtonOptions) -> bool:
    """Whether a residual is small, or mere rounding, under the laws of the terms as they are."""
    return (size <= options.tolerance or rounding) and not problem.unsettled


def newton(problem: PathProblem, d, target: float, history, options: NewtonOptions):
    """Iterate by Newton's method (44) at a fixed loading.

    Returns
    -------
    status, d, residuals
        As of ``iterate``.
    """
    problem.begin()
    return iterate(problem, d, target, history, options)


def iterate(problem: PathProblem, d, target: float, history, options, mixed: bool = False):
    """Iterate to equilibrium with the tangent of every iterate, from where the problem has begun.

    Parameters
    ----------
    d : ndarray, shape (n, 2)
        The predictor.
    mixed : bool
        Whether the linearisations are those of mixed iterations (``mixed_newton``).

    Returns
    -------
    status : Status
    d : ndarray, shape (n, 2)
    residuals : tuple of float
        Relative. Where they converged the factor of the tangent is left in ``problem``.
    """
    gather, residuals = problem.discretization.layout.gather, []
    assemble = problem.assemble_forces if mixed else problem.assemble
    for number in range(options.max_iterations + 1):
        if not assemble(d, target, history):
            return Status.INVERTED, d, tuple(residuals)
        residual, size, rounding = problem.residual()
        residuals.append(size)
        if not np.isfinite(size):
            return Status.DIVERGED, d, tuple(residuals)
        done = converged(problem, size, rounding, options)
        if number == options.max_iterations and not done:
            break
        if mixed:
            problem.assemble(d, target, history, mixed=not done)
            residual = problem.residual()[0]
        try:
            problem.factorize(check=done)
        except np.linalg.LinAlgError:
            return Status.SINGULAR, d, tuple(residuals)
        if done:
            return Status.CONVERGED, d, tuple(residuals)
        d = d - gather(problem.factor.solve(residual))
    return Status.NOT_CONVERGED, d, tuple(residuals)

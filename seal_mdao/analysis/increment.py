"""One increment of a load path: input and result of a corrector."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.assembly import Assembly
from seal_mdao.analysis.path_result import ConvergedStep, Status
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.equilibrium.tangent_layout import Factor


@dataclass(frozen=True, eq=False)
class Increment:
    """Increment to the equilibrium at ``target``, the argument of all correctors beside a
    predictor.

    Attributes
    ----------
    problem : PathProblem
    target : float
        Path parameter.
    history : tuple
        What every term carries from the last converged step.
    options : NewtonOptions
    last : ConvergedStep, optional
        The last converged step, for methods that begin from its tangent.
    factor : Factor, optional
        Factor of the tangent at ``last``.
    note : callable, optional
        Called with the number of every iteration of damped motion and the relative residual.
    """

    problem: PathProblem
    target: float
    history: tuple
    options: object
    last: ConvergedStep | None = None
    factor: Factor | None = None
    note: Callable[[int, float], None] | None = None

    def evaluate(self, d, iteration=None, **options) -> Assembly | None:
        """Evaluate residual and tangent at ``d``, as ``PathProblem.evaluate``."""
        return self.problem.evaluate(d, self.target, self.history, iteration, **options)

    def gather(self, vector: np.ndarray) -> np.ndarray:
        """Return values of the equations by particle, zero where prescribed, (n, 2)."""
        return self.problem.discretization.layout.gather(vector)


class Solution(NamedTuple):
    """Result of the iterations of a corrector.

    Attributes
    ----------
    status : Status
        CONVERGED, or the reason why there is no equilibrium.
    d : ndarray, shape (n, 2)
        Generalised displacements; where CYCLED, their mean over one cycle.
    residuals : tuple of float
        Relative residual before each iteration, and at the end.
    assembly : Assembly
        The state evaluated last, at ``d`` where converged; None where none could be evaluated.
    factor : Factor
        Factor of the tangent there, where converged.
    cycle : tuple
        ``Assembly.iteration`` of the iterates of one cycle, where CYCLED.
    """

    status: Status
    d: np.ndarray
    residuals: tuple
    assembly: Assembly | None = None
    factor: Factor | None = None
    cycle: tuple = ()

    @property
    def converged(self) -> bool:
        return self.status is Status.CONVERGED

    def after(self, residuals: tuple) -> "Solution":
        """Return the solution with the ``residuals`` of attempts before it."""
        return self._replace(residuals=residuals + self.residuals)

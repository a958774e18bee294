"""What goes into SLSQP's loop and what comes out of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from seal_mdao.drivers.evaluation import Evaluation

STALLED = 10
"""Code of a run that failed analyses have brought to a halt."""

INTERRUPTED = 11
"""Code of a run that the user has stopped."""


@dataclass(frozen=True)
class LoopOptions:
    """Settings of the loop.

    Attributes
    ----------
    tol : float
        SLSQP's accuracy.
    max_iterations : int
        Largest number of major iterations.
    move_limit : float
        Largest change of a scaled design variable in a major iteration; infinite for none.
    max_failures : int
        Failed analyses in a major iteration after which backing off is given up.
    optimality_tol : float
        Where SLSQP's line search can gain nothing more (exit mode 8), the run is a success if
        the optimality conditions hold to this tolerance.
    require_optimality : bool
        Whether only the optimality conditions may end the run successfully, instead of SLSQP's
        own tests, one of which is a small change of the objective.
    """

    tol: float
    max_iterations: int
    move_limit: float
    max_failures: int
    optimality_tol: float
    require_optimality: bool


@dataclass(frozen=True)
class LoopResult:
    """How the loop ended.

    Attributes
    ----------
    point : Evaluation
        The last accepted point.
    gradient : ndarray, shape (n,), or None
        Gradient of the objective at the last point at which it was needed.
    code : int
        Exit mode of SLSQP, or ``STALLED``.
    message : str
        The code in words.
    iterations : int
        Major iterations, that is accepted steps.
    """

    point: Evaluation
    gradient: NDArray[np.float64] | None
    code: int
    message: str
    iterations: int

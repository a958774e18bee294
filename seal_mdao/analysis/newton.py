"""Newton iterations with the consistent tangent, Eq. (44)."""

from dataclasses import dataclass
from numbers import Integral

import numpy as np

from seal_mdao.analysis.loading import LoadPoint
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import Status


@dataclass(frozen=True)
class NewtonOptions:
    """Convergence control.

    Attributes
    ----------
    tolerance : float
        Residual norm over the norm of the contact and internal forces.
    max_iterations : int
        Newton iterations before a step is cut.
    max_cuts : int
        How often a step may be halved.
    """

    tolerance: float = 1e-10
    max_iterations: int = 15
    max_cuts: int = 8

    def __post_init__(self):
        if not (np.isfinite(self.tolerance) and self.tolerance > 0.0):
            raise ValueError(f"tolerance must be a positive number, got {self.tolerance!r}")
        for name, least in (("max_iterations", 1), ("max_cuts", 0)):
            value = getattr(self, name)
            if not isinstance(value, Integral) or value < least:
                raise ValueError(f"{name} must be an integer of at least {least}, got {value!r}")


def newton(problem: PathProblem, d, point: LoadPoint, history, options: NewtonOptions):
    """Newton iterations (44) at a fixed loading.

    Returns
    -------
    status : Status
    d : ndarray, shape (n, 2)
    residuals : tuple of float
    factor : object or None
        Factor of the tangent at the converged configuration.
    """
    gather = problem.discretization.layout.gather
    residuals = []
    problem.direction[:] = 0
    for _ in range(options.max_iterations + 1):
        if not problem.assemble(d, point, history):
            return Status.INVERTED, d, tuple(residuals), None
        residual, size, rounding = problem.residual()
        residuals.append(size)
        if not np.isfinite(size):
            return Status.DIVERGED, d, tuple(residuals), None
        try:
            problem.factorize()
        except np.linalg.LinAlgError:
            return Status.SINGULAR, d, tuple(residuals), None
        if (size <= options.tolerance or rounding) and not problem.made_to_stick:
            return Status.CONVERGED, d, tuple(residuals), problem.factor
        if len(residuals) <= options.max_iterations:
            d = d - gather(problem.factor.solve(residual))
    return Status.NOT_CONVERGED, d, tuple(residuals), None

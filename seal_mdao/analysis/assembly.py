"""Residual and tangent of the incremental equation (44), evaluated at one state."""

from dataclasses import dataclass
from math import sqrt

import numpy as np


def _norm(vector) -> float:
    """Compute the Euclidean norm with less overhead for short vectors than ``numpy.linalg.norm``."""
    return sqrt(vector.dot(vector))


@dataclass(frozen=True, eq=False)
class Assembly:
    """Residual and tangent at given displacements, which no later evaluation changes.

    Attributes
    ----------
    problem : PathProblem
    d : ndarray, shape (n, 2)
        Generalised displacements.
    forces : ndarray, shape (n_terms, force_size)
        Assembled force of every term, N/m.
    responses : tuple of Response
        Response of every term.
    values : ndarray
        Tangent in the storage of the layout; empty where only the forces were evaluated.
    iteration : tuple
        State of the iterations of every term, with which the next iteration begins.
    residual : ndarray, shape (n_equations,)
    size : float
        Norm of the residual over that of the largest force.
    rounding : bool
        Whether the residual is a mere rounding error.
    noise : bool
        Whether the residual is no larger than the rounding error of large displacements may be.
    """

    problem: object
    d: np.ndarray
    forces: np.ndarray
    responses: tuple
    values: np.ndarray
    iteration: tuple
    residual: np.ndarray
    size: float
    rounding: bool
    noise: bool

    @property
    def unconverged(self) -> int:
        """Number of points not converged in contact state."""
        return sum(response.unconverged for response in self.responses)

    @property
    def potential(self) -> float:
        """Potential of all terms of a symmetric problem, mJ/m."""
        both = zip(self.problem.terms, self.responses, strict=True)
        return sum(term.potential(self.d, response) for term, response in both)

    def factorize(self, check: bool = False, shift: float = 0.0):
        """Factorise the tangent, with ``shift`` added to its diagonal.

        With ``check`` the factor of a symmetric tangent knows whether it is definite.

        Raises
        ------
        LinAlgError
            The tangent is singular.
        """
        layout, values = self.problem.discretization.layout, self.values
        if shift:
            # K + alpha I
            values = values.copy()
            values[layout.storage.diagonal()] += shift
        return layout.factorize(values, check and self.problem.symmetric)

    @property
    def mean_stiffness(self) -> float:
        """Mean amount of the diagonal entries of the tangent."""
        diagonal = self.problem.discretization.layout.storage.diagonal()
        return np.abs(self.values[diagonal]).mean()


def relative_residual(forces: np.ndarray, prescribed: float) -> tuple:
    """Sum the forces (n_terms, n_equations) to the residual.

    Parameters
    ----------
    prescribed : float
        Norm of the forces on all components where displacements are prescribed, else 0.

    Returns
    -------
    residual : ndarray, shape (n_equations,)
    size, relative : float
        Its norm, and that relative to the forces.
    """
    # Eqs. (43), (44): r = sum of the terms' forces f~ = N^T f; |r| relative to the largest of them
    residual = forces[0].copy()
    for force in forces[1:]:
        residual += force
    size = _norm(residual)
    scale = max(prescribed, *(_norm(force) for force in forces))
    return residual, size, size / scale if scale > 0.0 else 0.0

"""History variables of a material along the load path, and their use in a load step.

Within a step such a law is an elastic one that depends on the history at its beginning. ``relaxation``
and ``softening`` define it; ``linearized_history`` is what the sensitivities of both have in common.
"""

from typing import Protocol

import numpy as np

from seal_mdao.structure.deformation import Deformation


class MaterialHistory(Protocol):
    """Law of the regions of a body on one design that carry a history; q points in a column of cells."""

    def no_history(self, *count: int):
        """Return the history of the undeformed state; with a ``count`` of columns, rates of zero."""

    def respond(self, term, w: np.ndarray, fraction: float, history):
        """Evaluate the law of a step at the deformation of a ``StructuralTerm``.

        Parameters
        ----------
        term : StructuralTerm
        w : ndarray, shape (5 or 9, n_columns, q)
            Derivatives of the energy W of the elastic law.
        fraction : float
            Path parameter at the end of the step.
        history
            With which it begins.

        Returns
        -------
        response : Response
            Whose ``history`` is passed to the next step.
        w : ndarray
            Derivatives of the energy of the step.
        carried : ndarray, shape (n_columns, q, 3 or 4), or empty
            Second Piola-Kirchhoff stress beside it.
        """

    def at_steps(self, w: np.ndarray, responses):
        """Evaluate the derivatives of the energy, (5 or 9, K, n_columns, q), and the stress beside it,
        (K, n_columns, q, 3 or 4) or (1, 0, 0, 0), of K converged steps, as ``respond`` does."""

    def constant_derivatives(self, term, deformation: Deformation, rows, responses) -> np.ndarray:
        """Differentiate W_T, W_J, and W_h of the steps in all parameters, at fixed history.

        Parameters
        ----------
        rows : ndarray, shape (C, 2 or 3, K, n_columns, q)
            Those of the elastic law.
        """

    def step_density(self, density: np.ndarray, f: np.ndarray, response) -> np.ndarray:
        """Evaluate the energy of a step, (n_columns, q), from W and F.

        Raises
        ------
        ValueError
            Without a ``response``, where the stored energy of the body is asked for.
        """

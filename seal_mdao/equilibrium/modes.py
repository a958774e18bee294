"""Modes of a tangent whose eigenvalues are next to zero, from its factor alone."""

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, eigsh

ACCURACY = 1e-6
POWERS = 100
"""Of the inverse, where the better methods do not converge."""


def nearest_mode(factor, n: int, symmetric: bool, negative: bool = False):
    """Eigenvalue next to zero and its mode, by Lanczos' or Arnoldi's method on the inverse.

    Parameters
    ----------
    factor : Factor
    n : int
        Equations.
    negative : bool
        The negative eigenvalue next to zero; there must be one.

    Returns
    -------
    value : float
    mode : ndarray, shape (n,)
        Of length 1.
    """
    # without any symmetry, and always the same
    start = 1.0 + np.cos(np.arange(n) ** 2)
    inverse = LinearOperator((n, n), matvec=factor.solve, dtype=float)
    solver, wanted = (eigsh, "SA") if symmetric else (eigs, "SR")
    try:
        found, modes = solver(
            inverse, 1, which=wanted if negative else "LM", v0=start, tol=ACCURACY
        )
        value, mode = found[0].real, np.ascontiguousarray(modes[:, 0].real)
    except ArpackNoConvergence:
        mode = start
        for _ in range(POWERS):
            before = mode / np.linalg.norm(mode)
            mode = factor.solve(before)
        value = before @ mode
    return float(1.0 / value), mode / np.linalg.norm(mode)

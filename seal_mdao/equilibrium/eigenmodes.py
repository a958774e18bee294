"""Critical modes: eigenvectors of a tangent with eigenvalues nearest to zero, from its factor."""

import numpy as np
from scipy.sparse.linalg import ArpackError, LinearOperator, eigs, eigsh

ACCURACY = 1e-6
"""Relative, of the eigenvalue."""
POWERS = 100
"""Power iterations where Lanczos' or Arnoldi's method does not converge."""


def nearest_mode(factor, n: int, symmetric: bool, negative: bool = False):
    """Compute the eigenvalue nearest to zero and its mode, by Lanczos or Arnoldi on the inverse.

    Parameters
    ----------
    factor : Factor
    n : int
        Number of equations.
    symmetric : bool
        Lanczos for a symmetric tangent, else Arnoldi.
    negative : bool
        Find the negative eigenvalue nearest to zero; there must be one.

    Returns
    -------
    value : float
    mode : ndarray, shape (n,)
        Unit eigenvector.
    """
    # a start vector without symmetry, so that no mode is orthogonal to it; fixed: same bits
    start = 1.0 + np.cos(np.arange(n) ** 2)
    # K phi = lambda phi <=> K^-1 phi = phi / lambda: nearest to zero is the largest of |1/lambda|,
    # negative and nearest to zero the smallest of 1/lambda
    inverse = LinearOperator((n, n), matvec=factor.solve, dtype=float)
    solver, wanted = (eigsh, "SA") if symmetric else (eigs, "SR")
    try:
        found, modes = solver(
            inverse, 1, which=wanted if negative else "LM", v0=start, tol=ACCURACY
        )
        value, mode = found[0].real, np.ascontiguousarray(modes[:, 0].real)
    except ArpackError:
        # power iteration phi <- K^-1 phi, 1/lambda by the Rayleigh quotient phi . K^-1 phi
        mode = start
        for _ in range(POWERS):
            before = mode / np.linalg.norm(mode)
            mode = factor.solve(before)
        value = before @ mode
    return float(1.0 / value), mode / np.linalg.norm(mode)

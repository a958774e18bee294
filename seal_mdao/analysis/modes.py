"""Modes of a tangent whose eigenvalues are next to zero, from its factor alone."""

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigs, eigsh

ACCURACY = 1e-6


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
    if symmetric:
        found, modes = eigsh(inverse, 1, which="SA" if negative else "LM", v0=start, tol=ACCURACY)
    else:
        found, modes = eigs(inverse, 1, which="SR" if negative else "LM", v0=start, tol=ACCURACY)
    mode = np.ascontiguousarray(modes[:, 0].real)
    return float(1.0 / found[0].real), mode / np.linalg.norm(mode)

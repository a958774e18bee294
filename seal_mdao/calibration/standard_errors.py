"""Standard errors and correlation of unknowns that were found by least squares.

With the residuals r of m readings and their derivatives A in k unknowns the covariance is, to first
order at the optimum (G. A. F. Seber, C. J. Wild, *Nonlinear Regression*, 1989, Sect. 2.1),

    C = s^2 (A^T A)^-1,    s^2 = |r|^2 / (m - k)
"""

import numpy as np


def standard_errors(residual: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute standard errors of the unknowns and their correlation.

    Parameters
    ----------
    residual : ndarray, shape (m,)
    slope : ndarray, shape (m, k)

    Returns
    -------
    errors : ndarray, shape (k,)
        Infinite for unknowns that the readings do not determine.
    correlation : ndarray, shape (k, k)
    """
    m, k = slope.shape
    free = max(m - k, 1)
    length = np.linalg.norm(slope, axis=0)
    size = 1.0 / np.where(length > 0.0, length, 1.0)
    # columns of length one, so that the rank does not depend on units
    scaled = slope * size
    # (A^T A)^-1 = V S^-2 V^T over the singular values above rounding
    _, singular, directions = np.linalg.svd(scaled, full_matrices=False)
    determined = singular > 1e-10 * singular[0]
    inverse = (directions[determined].T / singular[determined] ** 2) @ directions[determined]
    # sigma_i = s sqrt(C_ii); the columns are unscaled on return
    deviation = np.sqrt(np.diag(inverse) * (residual @ residual) / free)
    # an unknown with a component in the null space is not determined by the data
    undetermined = np.any(np.abs(directions[~determined]) > 1e-6, axis=0)
    root = np.sqrt(np.maximum(np.diag(inverse), 1e-300))
    deviation = np.where(undetermined, np.inf, deviation)
    # correlation C_ij / sqrt(C_ii C_jj)
    return deviation * size, inverse / np.outer(root, root)

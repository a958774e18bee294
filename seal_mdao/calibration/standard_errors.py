"""Standard errors and correlation of unknowns that were found by least squares.

With the residuals r of m readings of equal scatter, their derivatives A in k unknowns and the weights W
of the squares, the covariance is, to first order at the optimum (G. A. F. Seber, C. J. Wild, *Nonlinear
Regression*, 1989, Sect. 2.1),

    C = s^2 B B^T,    B = (W^(1/2) A)^+ W^(1/2),    s^2 = |r|^2 / (m - k)

which is s^2 (A^T A)^-1 for equal weights.
"""

import numpy as np


def standard_errors(
    residual: np.ndarray, slope: np.ndarray, weight: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Compute standard errors of the unknowns and their correlation.

    Parameters
    ----------
    residual : ndarray, shape (m,)
        W^(1/2) r, whose squares were minimised.
    slope : ndarray, shape (m, k)
        W^(1/2) A.
    weight : ndarray, shape (m,), optional
        Diagonal of W; 1 unless given.

    Returns
    -------
    errors : ndarray, shape (k,)
        Infinite for unknowns that the readings do not determine.
    correlation : ndarray, shape (k, k)
    """
    m, k = slope.shape
    free = max(m - k, 1)
    root = np.ones(m) if weight is None else np.sqrt(weight)
    # s^2 = |r|^2 / (m - k) of the residuals without weights
    variance = np.sum((residual / root) ** 2) / free
    length = np.linalg.norm(slope, axis=0)
    size = 1.0 / np.where(length > 0.0, length, 1.0)
    # columns of length one, so that the rank does not depend on units
    scaled = slope * size
    # B B^T over the singular values above rounding, W^(1/2) A = U S V^T, B = V S^-1 U^T W^(1/2)
    left, singular, directions = np.linalg.svd(scaled, full_matrices=False)
    determined = singular > 1e-10 * singular[0]
    inverse = (directions[determined].T / singular[determined]) @ (left[:, determined].T * root)
    inverse = inverse @ inverse.T
    # sigma_i = s sqrt(C_ii); the columns are unscaled on return
    deviation = np.sqrt(np.diag(inverse) * variance)
    # an unknown with a component in the null space is not determined by the data
    undetermined = np.any(np.abs(directions[~determined]) > 1e-6, axis=0)
    spread = np.sqrt(np.maximum(np.diag(inverse), 1e-300))
    deviation = np.where(undetermined, np.inf, deviation)
    # correlation C_ij / sqrt(C_ii C_jj)
    return deviation * size, inverse / np.outer(spread, spread)

"""Nearly incompressible laws of the first isochoric invariant alone, W(T, J) = f(x).

x = I1 J^(-2/3) - 3 with I1 = T + 1 in plane strain; x = 0 without distortion.
"""

from abc import abstractmethod

import numpy as np

from seal_mdao.materials.isotropic import NO_VALUE, Isotropic


class FirstInvariant(Isotropic):
    """Base class of laws given by f(x), f' and f'', and the derivatives of f' in their constants."""

    @abstractmethod
    def invariant_energy(self, x):
        """Evaluate f(x), shape of ``x``."""

    @abstractmethod
    def invariant_derivatives(self, x):
        """Evaluate f' and f'', two arrays of the shape of ``x``, or numbers."""

    @abstractmethod
    def invariant_constants(self, x):
        """Evaluate d f' / d constant for all constants but ``bulk_modulus``: arrays, or numbers."""

    @np.errstate(**NO_VALUE)
    def energy(self, t, j):
        """Evaluate the isochoric strain energy density f(x), shape of ``t``."""
        return self.invariant_energy((t + 1.0) * np.asarray(j) ** (-2.0 / 3.0) - 3.0)

    @np.errstate(**NO_VALUE)
    def derivatives(self, t, j):
        """Evaluate W_T, W_J, W_TT, W_TJ, W_JJ, shape (5, ...)."""
        x, x_t, x_j = _distortion(t, j)
        # x_T = J^(-2/3),  x_J = -2/3 (T + 1) J^(-5/3),  x_TT = 0
        x_tj = -2.0 / 3.0 * x_t / j
        x_jj = -5.0 / 3.0 * x_j / j
        # W_A = f' x_A,  W_AB = f'' x_A x_B + f' x_AB
        first, second = self.invariant_derivatives(x)
        return np.array(
            [
                first * x_t,
                first * x_j,
                second * x_t * x_t,
                second * x_t * x_j + first * x_tj,
                second * x_j * x_j + first * x_jj,
            ]
        )

    @np.errstate(**NO_VALUE)
    def constant_derivatives(self, t, j):
        """Evaluate d(W_T, W_J) / d constant, shape (n_constants, 2, ...)."""
        x, x_t, x_j = _distortion(t, j)
        # d(W_T, W_J)/dc = (df'/dc) (x_T, x_J); f does not depend on the bulk modulus, the last constant
        slopes = [*self.invariant_constants(x), 0.0]
        return np.array([[slope * x_t, slope * x_j] for slope in slopes])


def _distortion(t, j):
    """Evaluate x = (T + 1) J^(-2/3) - 3 and its derivatives in T and J."""
    x_t = np.asarray(j) ** (-2.0 / 3.0)
    return (t + 1.0) * x_t - 3.0, x_t, -2.0 / 3.0 * (t + 1.0) * x_t / j

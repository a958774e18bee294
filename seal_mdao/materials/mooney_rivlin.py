"""Nearly incompressible Mooney-Rivlin rubber in plane strain.

Isochoric invariants and F_33 = 1. With T = F : F and J = det F of the in-plane deformation gradient,
I1 = T + 1 and I2 = T + J^2, so that the energy is a function of T and J alone:

    W_dev(T, J) = C10 ((T + 1) J^(-2/3) - 3) + C01 ((T + J^2) J^(-4/3) - 3)
    W_vol(J)    = K/2 (J - 1)^2, with J projected on the background cell (refs. [29], [32])

    P = 2 W_T F + W_J cof F
"""

from dataclasses import dataclass

import numba as nb
import numpy as np


@nb.njit(cache=True, error_model="numpy", inline="always")
def unit_energy_gradients(t, j):
    """W_T and W_J of the two isochoric terms, each for a constant of one: C10 first, then C01."""
    a = j ** (-1.0 / 3.0)
    a2, i = a * a, 1.0 / j
    a4 = a2 * a2
    return (
        a2, -2.0 / 3.0 * (t + 1.0) * a2 * i,
        a4, (2.0 * j * j - 4.0 * t) / 3.0 * a4 * i,
    )  # fmt: skip


@nb.njit(cache=True, error_model="numpy", inline="always")
def energy_derivatives(t, j, c10, c01):
    """W_T, W_J, W_TJ, W_JJ of the isochoric energy (W_TT = 0), in the unit of C10.

    Parameters
    ----------
    t, j : float
        F : F and det F in the plane.
    """
    a2, first_j, a4, second_j = unit_energy_gradients(t, j)
    i = 1.0 / j
    w_t = c10 * a2 + c01 * a4
    w_j = c10 * first_j + c01 * second_j
    w_tj = -(2.0 * c10 * a2 + 4.0 * c01 * a4) * i / 3.0
    w_jj = (
        (10.0 / 9.0 * c10 * (t + 1.0) * a2 + c01 * (28.0 / 9.0 * t - 2.0 / 9.0 * j * j) * a4)
        * i
        * i
    )
    return w_t, w_j, w_tj, w_jj


@nb.njit(cache=True, error_model="numpy", inline="always")
def von_mises(t, j, c10, c01):
    """Von Mises stress from the deviatoric Cauchy stress, with its derivatives in T and J.

    s = (2/J) dev[ (C10 J^(-2/3) + C01 J^(-4/3) I1) b - C01 J^(-4/3) b^2 ] has principal values that
    depend on T and J only; the in-plane pair enters as mean m and half difference d.

    Returns
    -------
    tuple of float
        sigma_vm, d sigma_vm / dT, d sigma_vm / dJ.
    """
    a2 = j ** (-2.0 / 3.0)
    i = 1.0 / j
    p, q = 2.0 * c10 * a2 * i, 2.0 * c01 * a2 * a2 * i
    p_j, q_j = -5.0 / 3.0 * p * i, -7.0 / 3.0 * q * i
    # in the plane S = (p + q) b + q J^2 I, across it S_33 = p + q T
    dd = 0.25 * (t * t - 4.0 * j * j)
    r = p + q
    e = 0.5 * r * t + q * j * j - p - q * t  # m - S_33
    square = 3.0 * r * r * dd + e * e
    value = square**0.5
    if value == 0.0:
        return 0.0, 0.0, 0.0
    r_j = p_j + q_j
    e_t = 0.5 * r - q
    e_j = 0.5 * r_j * t + q_j * j * j + 2.0 * q * j - p_j - q_j * t
    half = 0.5 / value
    by_t = half * (3.0 * r * r * 0.5 * t + 2.0 * e * e_t)
    by_j = half * (6.0 * r * r_j * dd - 6.0 * r * r * j + 2.0 * e * e_j)
    return value, by_t, by_j


@dataclass(frozen=True)
class MooneyRivlin:
    """Material constants (any one stress unit; the door seal uses kPa).

    Attributes
    ----------
    c10, c01 : float
        Mooney-Rivlin constants, initial shear modulus 2 (c10 + c01).
    bulk_modulus : float
    """

    c10: float = 80.0
    c01: float = 20.0
    bulk_modulus: float = 80_000.0

    def __post_init__(self):
        for name in ("c10", "c01", "bulk_modulus"):
            value = getattr(self, name)
            if not np.isfinite(value):
                raise ValueError(f"{name} must be a finite number, got {value}")
        if self.c10 + self.c01 <= 0.0 or self.c10 < 0.0 or self.c01 < 0.0:
            raise ValueError(
                f"c10 = {self.c10} and c01 = {self.c01} must not be negative and not both zero"
            )
        if self.bulk_modulus <= 0.0:
            raise ValueError(f"bulk_modulus = {self.bulk_modulus} must be positive")

    @property
    def shear_modulus(self) -> float:
        """2 (C10 + C01)."""
        return 2.0 * (self.c10 + self.c01)

    def energy(self, F: np.ndarray) -> np.ndarray:
        """Isochoric strain energy density W_dev of deformation gradients ``F`` (..., 2, 2)."""
        t, j = np.einsum("...ij,...ij", F, F), _det(F)
        return self.c10 * ((t + 1) * j ** (-2 / 3) - 3) + self.c01 * (
            (t + j**2) * j ** (-4 / 3) - 3
        )

    def stress(self, F: np.ndarray) -> np.ndarray:
        """First Piola-Kirchhoff stress of ``energy``, shape (..., 2, 2)."""
        t, j = np.einsum("...ij,...ij", F, F), _det(F)
        w_t, w_j, _, _ = energy_derivatives(t, j, self.c10, self.c01)
        return 2.0 * _on(w_t) * F + _on(w_j) * cofactor(F)

    def tangent(self, F: np.ndarray) -> np.ndarray:
        """dP_ij / dF_kl of ``energy``, shape (..., 2, 2, 2, 2)."""
        t, j = np.einsum("...ij,...ij", F, F), _det(F)
        w_t, w_j, w_tj, w_jj = (_on(_on(w)) for w in energy_derivatives(t, j, self.c10, self.c01))
        cof = cofactor(F)
        identity = np.einsum("ik,jl->ijkl", np.eye(2), np.eye(2))
        eps = np.array([[0.0, 1.0], [-1.0, 0.0]])
        dcof = np.einsum("ik,jl->ijkl", eps, eps)
        mixed = np.einsum("...ij,...kl->...ijkl", F, cof) + np.einsum(
            "...ij,...kl->...ijkl", cof, F
        )
        both = np.einsum("...ij,...kl->...ijkl", cof, cof)
        return 2 * w_t * identity + 2 * w_tj * mixed + w_jj * both + w_j * dcof

    def von_mises(self, F: np.ndarray) -> np.ndarray:
        """Von Mises stress of the deviatoric Cauchy stress, shape (...)."""
        t, j = np.einsum("...ij,...ij", F, F), _det(F)
        return np.vectorize(lambda a, b: von_mises(a, b, self.c10, self.c01)[0], otypes=[float])(
            t, j
        )


def cofactor(F: np.ndarray) -> np.ndarray:
    """cof F = d(det F)/dF of in-plane gradients, shape (..., 2, 2)."""
    cof = np.empty_like(F)
    cof[..., 0, 0], cof[..., 0, 1] = F[..., 1, 1], -F[..., 1, 0]
    cof[..., 1, 0], cof[..., 1, 1] = -F[..., 0, 1], F[..., 0, 0]
    return cof


def _det(F):
    return F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]


def _on(scalar):
    return np.asarray(scalar)[..., None, None]

"""Base class of isotropic hyperelastic laws in plane strain, with stresses and tangents from the
energy.

With lambda_3 = 1 the energy of an isotropic solid is a function of T = F : F and J = det F of the
in-plane deformation gradient alone, W(T, J):

    P = 2 W_T F + W_J cof F
    sigma = (2 / J) W_T F F^T + W_J 1      (Cauchy, in the plane)

A law defines W, its derivatives and those in its constants; everything else is computed here.
"""

from abc import ABC, abstractmethod
from copy import copy
from dataclasses import fields, replace
from typing import ClassVar

import numpy as np

from seal_mdao import values

NO_VALUE = {"invalid": "ignore", "divide": "ignore", "over": "ignore"}
"""For ``numpy.errstate``, where a law is not defined and returns NaN."""

STEP = 1e-30
"""Size of complex steps."""
MOST_BULK = 1e7
"""Largest ratio of bulk to shear modulus; rounding errors are 1e-16 bulk moduli times a strain."""
MOST_CONSTANT = 1e12
"""Largest size of a constant, so that squares of stresses are finite numbers."""


class Isotropic(ABC):
    """Base class of materials; a law is a frozen dataclass whose fields are its constants.

    Arrays ``t`` and ``j`` have the same shape. T is dimensionless; W, stresses and moduli are in
    one unit of stress of the user's choice. A law may be undefined for a state (J <= 0, chains beyond
    the limiting extension): its energy and derivatives are then NaN, without a warning.

    Attributes
    ----------
    bulk_modulus : float
        K of the volumetric energy K/2 (J_c - 1)^2 of the projected J, which is not part of W; 0 for a
        compressible law, whose W is the complete energy.
    valid : pair of float, or None
        Least and largest principal stretch for which its constants are known; None where the law does
        not say.
    moduli : tuple of str
        Names of the constants that have the unit of stress; the others have none.
    """

    bulk_modulus: float
    moduli: ClassVar[tuple[str, ...]] = ("bulk_modulus",)
    valid: ClassVar[tuple[float, float] | None] = None

    # ---- to be defined by a law ----

    @abstractmethod
    def energy(self, t, j) -> np.ndarray:
        """Evaluate the strain energy density W per undeformed volume, shape of ``t``; complex
        arguments and constants are allowed (complex step)."""

    @abstractmethod
    def derivatives(self, t, j) -> np.ndarray:
        """Evaluate W_T, W_J, W_TT, W_TJ, W_JJ, shape (5, ...)."""

    @abstractmethod
    def constant_derivatives(self, t, j) -> np.ndarray:
        """Evaluate d(W_T, W_J) / d constant, shape (n_constants, 2, ...); zero for
        ``bulk_modulus``."""

    def constant_energies(self, t, j) -> np.ndarray:
        """Evaluate dW / d constant, shape (n_constants, ...), by complex steps of ``energy``."""
        return self._by_constants("energy", t, j)

    def volumetric_constants(self, j) -> np.ndarray:
        """Evaluate dV / d constant, shape (n_constants, ...), by complex steps of ``volumetric``."""
        return self._by_constants("volumetric", j)

    def _by_constants(self, method: str, *state) -> np.ndarray:
        # dW/dc = Im W(c + i h) / h, exact for a step as small as 1e-30
        slopes = [getattr(self._stepped(name), method)(*state).imag / STEP for name in self.names]
        return np.array([np.broadcast_to(slope, np.shape(state[0])) for slope in slopes])

    def _stepped(self, name: str):
        """Copy the law with an imaginary step in one constant, unchecked."""
        other = copy(self)
        object.__setattr__(other, name, getattr(self, name) + 1j * STEP)
        return other

    # ---- constants by name ----

    @property
    def constants(self) -> dict[str, float]:
        """Values by name, in the order of ``names``."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the constants; ``bulk_modulus`` last where there is one."""
        return tuple(self.constants)

    def with_(self, **constants):
        """Return the same law with other constants.

        Raises
        ------
        ValueError
            If a name is not one of ``names``, or the constants give no stable material.
        """
        self._refuse_unknown(constants)
        return replace(self, **constants)

    def _refuse_unknown(self, constants):
        unknown = [name for name in constants if name not in self.names]
        if unknown:
            raise ValueError(
                f"{type(self).__name__} has no constant {', '.join(unknown)}; the constants are "
                f"{', '.join(self.names)}"
            )

    # ---- stress across the plane ----

    def across(self, t, j) -> np.ndarray:
        """Evaluate the Cauchy stress sigma_33 across the plane, d/dT and d/dJ, shape (3, ...).

        Valid for an energy of the isochoric stretches J^(-1/3) lambda, whose stress has no trace. A
        compressible law overrides this, since W(T, J) alone does not determine dW/dlambda_3.
        """
        # sigma_33 = -(sigma_11 + sigma_22) = -2 m
        return -2.0 * _mean_stress(t, j, self.derivatives(t, j))

    def across_constant_derivatives(self, t, j) -> np.ndarray:
        """Evaluate d sigma_33 / d constant, shape (n_constants, ...)."""
        rates = self.constant_derivatives(t, j)
        # dm/dc = (dW_T/dc) T / J + dW_J/dc
        return -2.0 * (rates[:, 0] * t / j + rates[:, 1])

    def volumetric(self, j) -> np.ndarray:
        """Evaluate V(J) of a compressible law, shape of ``j``; complex constants are allowed
        (complex step).

        A law defines it if its energy is sum_i f(lambda_i) + V(J) of the principal stretches, with
        f and V and their slopes zero at 1. Then V' is the stress across the plane, and ``hoop_stretch``
        knows the energy at every stretch across it, which bodies of revolution need.
        """
        raise NotImplementedError(
            f"the compressible law {type(self).__name__} does not define the volumetric part V(J) "
            "of its strain energy, which this analysis needs; add the method volumetric to its "
            "class"
        )

    # ---- three principal stretches, lambda_3 not fixed at 1 ----

    def principal_stress(self, stretches) -> np.ndarray:
        """Evaluate principal Kirchhoff stresses lambda_i dW/dlambda_i, shape (3, ...).

        An isochoric energy depends on ratios of stretches alone, W = W(T, J) at (lambda_1/lambda_3,
        lambda_2/lambda_3, 1), so that W(T, J) of plane strain covers all states. A compressible law
        overrides the three ``principal_`` methods, as it does ``across``.

        Parameters
        ----------
        stretches : ndarray, shape (3, ...)
        """
        first, second, t, j = _in_plane(stretches)
        w_t, w_j, *_ = self.derivatives(t, j)
        # T = a_1 + a_2, J^2 = a_1 a_2 with a_i = (lambda_i / lambda_3)^2:
        # tau_i = 2 W_T a_i + W_J J, i = 1, 2;  tau_3 = -tau_1 - tau_2
        return _trace_free(2.0 * w_t * first + w_j * j, 2.0 * w_t * second + w_j * j)

    def principal_tangent(self, stretches) -> np.ndarray:
        """Evaluate d tau_i / d ln lambda_j of Kirchhoff stresses, symmetric, shape (3, 3, ...)."""
        first, second, t, j = _in_plane(stretches)
        w_t, w_j, w_tt, w_tj, w_jj = self.derivatives(t, j)
        # d tau_i/d ln lambda_j = 4 W_TT a_i a_j + 2 W_TJ J (a_i + a_j) + W_JJ J^2 + W_J J
        #     + 4 W_T a_i delta_ij
        volume = w_jj * j * j + w_j * j

        def entry(a, b):
            return 4.0 * w_tt * a * b + 2.0 * w_tj * j * (a + b) + volume

        rows = [
            _trace_free(entry(first, first) + 4.0 * w_t * first, entry(first, second)),
            _trace_free(entry(first, second), entry(second, second) + 4.0 * w_t * second),
        ]
        return np.array([*rows, -rows[0] - rows[1]])

    def principal_constants(self, stretches) -> np.ndarray:
        """Evaluate d tau_i / d constant of Kirchhoff stresses, shape (n_constants, 3, ...)."""
        first, second, t, j = _in_plane(stretches)
        rates = self.constant_derivatives(t, j)
        by_t, by_j = 2.0 * rates[:, 0], rates[:, 1] * j
        pair = _trace_free(by_t * first + by_j, by_t * second + by_j)
        return np.moveaxis(pair, 0, 1)

    # ---- stresses and tangents from the energy ----

    @property
    def shear_modulus(self) -> float:
        """Shear modulus of the undeformed state, 2 W_T at T = 2, J = 1."""
        return 2.0 * float(self.derivatives(2.0, 1.0)[0])

    @property
    def initial_bulk_modulus(self) -> float:
        """Bulk modulus of the undeformed state: ``bulk_modulus`` plus the contribution of W."""
        # K = A_1111 - 4/3 G,  A_1111 = 2 W_T + 4 W_TT + 4 W_TJ + W_JJ,  G = 2 W_T
        w_t, _, w_tt, w_tj, w_jj = (float(w) for w in self.derivatives(2.0, 1.0))
        return self.bulk_modulus + 4.0 * (w_tt + w_tj) + w_jj - 2.0 / 3.0 * w_t

    def stress(self, F: np.ndarray) -> np.ndarray:
        """Evaluate the first Piola-Kirchhoff stress P = dW/dF of in-plane gradients (..., 2, 2)."""
        w_t, w_j, *_ = self.derivatives(*invariants(F))
        # P = 2 W_T F + W_J cof F
        return 2.0 * w_t[..., None, None] * F + w_j[..., None, None] * cofactor(F)

    def tangent(self, F: np.ndarray) -> np.ndarray:
        """Evaluate the tangent dP_ij / dF_kl, shape (..., 2, 2, 2, 2)."""
        w_t, w_j, w_tt, w_tj, w_jj = self.derivatives(*invariants(F))[..., None, None, None, None]
        # A = 2 W_T I + 4 W_TT F (x) F + 2 W_TJ (F (x) cof F + cof F (x) F) + W_JJ cof F (x) cof F
        #     + W_J d(cof F)/dF,   I_ijkl = delta_ik delta_jl,   d(cof F)_ij/dF_kl = eps_ik eps_jl
        eps = np.array([[0.0, 1.0], [-1.0, 0.0]])
        identity = np.einsum("ik,jl->ijkl", np.eye(2), np.eye(2))
        cof = cofactor(F)
        mixed = _dyad(F, cof)
        return (
            2.0 * w_t * identity
            + 4.0 * w_tt * _dyad(F, F)
            + 2.0 * w_tj * (mixed + np.einsum("...ijkl->...klij", mixed))
            + w_jj * _dyad(cof, cof)
            + w_j * np.einsum("ik,jl->ijkl", eps, eps)
        )

    def von_mises(self, t, j) -> np.ndarray:
        """Evaluate the von Mises stress sqrt(3/2 dev sigma : dev sigma), d/dT and d/dJ, shape (3, ...).

        At zero stress, where the square root is not differentiable, the derivatives are set to zero.
        """
        # in the plane: mean m = W_T T / J + W_J, half difference d = (W_T / J) sqrt(T^2 - 4 J^2)
        # sigma_vm^2 = 3 d^2 + (m - sigma_33)^2
        t, j = np.asarray(t), np.asarray(j)
        w = self.derivatives(t, j)
        shear, spread, away = self._deviator(t, j, w)
        return von_mises_rows(
            [shear, w[2] / j, (w[3] - shear) / j], [spread, 2.0 * t, -8.0 * j], away
        )

    def von_mises_constants(self, t, j) -> np.ndarray:
        """Evaluate d sigma_vm / d constant, shape (n_constants, ...); zero at zero stress."""
        t, j = np.asarray(t), np.asarray(j)
        shear, spread, away = self._deviator(t, j, self.derivatives(t, j))
        value = np.sqrt(3.0 * shear * shear * spread + away[0] * away[0])
        rates = self.constant_derivatives(t, j)
        # d(m - sigma_33)/dc
        away_rates = rates[:, 0] * t / j + rates[:, 1] - self.across_constant_derivatives(t, j)
        return _over(3.0 * shear * spread * rates[:, 0] / j + away[0] * away_rates, value)

    def _deviator(self, t, j, w):
        """Evaluate W_T / J, T^2 - 4 J^2, and m - sigma_33 with its derivatives."""
        return w[0] / j, squared_difference(t, j), _mean_stress(t, j, w) - self.across(t, j)


def invariants(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Evaluate T = F : F and J = det F of in-plane gradients (..., 2, 2)."""
    return (
        np.einsum("...ij,...ij", F, F),
        F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0],
    )


def cofactor(F: np.ndarray) -> np.ndarray:
    """Evaluate cof F = d(det F)/dF of in-plane gradients, shape (..., 2, 2)."""
    cof = np.empty_like(F)
    cof[..., 0, 0], cof[..., 0, 1] = F[..., 1, 1], -F[..., 1, 0]
    cof[..., 1, 0], cof[..., 1, 1] = -F[..., 0, 1], F[..., 0, 0]
    return cof


def squared_difference(t, j) -> np.ndarray:
    """Evaluate T^2 - 4 J^2 = (lambda_1^2 - lambda_2^2)^2 of the two stretches in the plane."""
    square = (t - 2.0 * j) * (t + 2.0 * j)
    # rounding of T and J must not make the square of a difference negative
    return np.where(square.real > 0.0, square, 0.0 * square)


def von_mises_rows(shear, spread, away) -> np.ndarray:
    """Evaluate sigma_vm = sqrt(3 shear^2 spread + away^2) and its derivatives, rows as of the arguments.

    Parameters
    ----------
    shear, spread, away : sequence of n + 1 arrays
        W_T / J, T^2 - 4 J^2 of the plane, and the mean stress in the plane less that across, each
        followed by its n derivatives. The derivatives of the stress are zero where it is zero.
    """
    value = np.sqrt(3.0 * shear[0] * shear[0] * spread[0] + away[0] * away[0])
    # sigma_vm d(sigma_vm) = 3 shear (d(shear) spread + shear d(spread) / 2) + away d(away)
    slopes = [
        3.0 * shear[0] * (s * spread[0] + 0.5 * shear[0] * d) + away[0] * a
        for s, d, a in zip(shear[1:], spread[1:], away[1:], strict=True)
    ]
    return np.array([value, *(_over(slope, value) for slope in slopes)])


def _mean_stress(t, j, w):
    """Evaluate half the trace of the Cauchy stress in the plane, d/dT and d/dJ."""
    w_t, w_j, w_tt, w_tj, w_jj = w
    # m = W_T T / J + W_J
    # m_T = W_TT T / J + W_T / J + W_TJ,   m_J = W_TJ T / J - W_T T / J^2 + W_JJ
    ratio = t / j
    return np.array(
        [
            w_t * ratio + w_j,
            w_tt * ratio + w_t / j + w_tj,
            w_tj * ratio - w_t * ratio / j + w_jj,
        ]
    )


def _in_plane(stretches):
    """Compute squares of lambda_1 / lambda_3 and lambda_2 / lambda_3, their sum T, and J."""
    stretches = np.asarray(stretches)
    first, second = stretches[0] / stretches[2], stretches[1] / stretches[2]
    return first * first, second * second, first * first + second * second, first * second


def _trace_free(first, second):
    """Complete two entries to three whose sum is zero."""
    return np.array([first, second, -first - second])


def _dyad(A, B):
    return np.einsum("...ij,...kl->...ijkl", A, B)


def _over(slope, value):
    """Divide slope / value, zero where the value is zero."""
    zero = value == 0.0
    return np.where(zero, 0.0, slope / np.where(zero, 1.0, value))


def checked(material, positive=(), nonnegative=(), real=()) -> None:
    """Convert the named fields of a law to floats and validate their sign and size (``MOST_CONSTANT``).

    Raises
    ------
    ValueError
        With the name of the constant.
    """
    bounds = [
        (positive, {"above": 0.0}),
        (nonnegative, {"low": 0.0}),
        (real, {"low": -MOST_CONSTANT}),
    ]
    for names, least in bounds:
        for name in names:
            where = f"{name} of {type(material).__name__}"
            value = values.real(where, getattr(material, name), high=MOST_CONSTANT, **least)
            object.__setattr__(material, name, value)


def check_bulk(material) -> None:
    """Validate the bulk modulus K: Poisson's ratio not negative, and K / G not above ``MOST_BULK``.

    Raises
    ------
    ValueError
        With both moduli.
    """
    shear, bulk = material.shear_modulus, material.bulk_modulus
    # nu = (3 K - 2 G) / (6 K + 2 G)
    if 3.0 * bulk < 2.0 * shear:
        ratio = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)
        raise ValueError(
            f"bulk_modulus = {bulk:g} of {type(material).__name__} gives a Poisson's ratio of "
            f"{ratio:.3g} with the shear modulus {shear:g}; it must be at least 2/3 of the shear "
            f"modulus, {2.0 * shear / 3.0:.6g} (the bulk modulus of rubber is several hundred "
            "times its shear modulus)"
        )
    if not bulk <= MOST_BULK * shear:
        raise ValueError(
            f"bulk_modulus of {type(material).__name__} must be at most {MOST_BULK:g} times the shear "
            f"modulus {shear:g}, got {bulk:g}"
        )

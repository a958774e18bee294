"""Storakers' compressible law for foam rubber and other foams.

W = sum 2 mu/alpha^2 [lambda_1^alpha + lambda_2^alpha + lambda_3^alpha - 3 + (J^(-alpha b) - 1) / b],
b = nu / (1 - 2 nu)
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from seal_mdao.materials.isotropic import NO_VALUE
from seal_mdao.materials.stretch_powers import PowerTerm, StretchPowers, checked_terms


@dataclass(frozen=True)
class Hyperfoam(StretchPowers):
    """Hyperfoam law of compressible elastomers (B. Storakers, J. Mech. Phys. Solids 34 (1986) 125).

    W holds the complete energy: J is not projected. Constants by name: ``mu_1``, ``mu_2``, ...,
    ``alpha_1``, ..., ``nu_1``, ...

    Attributes
    ----------
    mu : tuple of float
        Moduli; their sum, the initial shear modulus, must be positive.
    alpha : tuple of float
        Exponents, 1e-6 to 200 in size.
    nu : tuple of float
        Poisson's ratios, above -1 and below 1/2; the initial bulk modulus is
        sum 2 mu (1/3 + nu / (1 - 2 nu)). At zero a stretch causes no lateral stress.
    """

    mu: tuple[float, ...]
    alpha: tuple[float, ...]
    nu: tuple[float, ...]

    bulk_modulus: ClassVar[float] = 0.0

    def __post_init__(self):
        checked_terms(self, ("mu", "alpha", "nu"))
        if not sum(self.mu) > 0.0:
            raise ValueError(
                f"the initial shear modulus sum(mu) of Hyperfoam must be positive: mu = {self.mu}"
            )
        for i, nu in enumerate(self.nu, 1):
            if not -1.0 < nu < 0.5:
                raise ValueError(
                    f"nu_{i} of Hyperfoam must lie between -1 and 1/2, got {nu}; for nearly "
                    "incompressible rubber use the law Ogden instead of Hyperfoam"
                )
        if not self.initial_bulk_modulus > 0.0:
            raise ValueError(
                f"the initial bulk modulus of Hyperfoam must be positive: mu = {self.mu}, "
                f"nu = {self.nu} give {self.initial_bulk_modulus}"
            )

    @property
    def terms(self):
        """Terms of the sum over powers."""
        # lambda_1^alpha + lambda_2^alpha = 2 J^(alpha/2) C and h = (J^(-alpha b) - 1) / b - 2:
        # k = 2 / alpha^2, q = alpha / 2, r = alpha b and their derivatives in alpha
        return tuple(
            PowerTerm(m, a, 2.0 / a**2, 0.5 * a, a * b, -4.0 / a**3, 0.5, b)
            for m, a, b in zip(self.mu, self.alpha, self._b, strict=True)
        )

    def rest(self, term, log_j):
        """Evaluate h = (J^(-alpha b) - 1) / b - 2, which is -alpha ln J - 2 for b = 0."""
        # (e^y - 1) / b = -alpha ln J (e^y - 1) / y with y = -alpha b ln J
        y = -term.r * log_j
        at_zero = y == 0.0
        return (
            -term.alpha * log_j * np.where(at_zero, 1.0, np.expm1(y) / np.where(at_zero, 1.0, y))
            - 2.0
        )

    @np.errstate(**NO_VALUE)
    def volumetric(self, j):
        """Evaluate V = sum 2 mu/alpha^2 [(J^(-alpha b) - 1) / b + alpha ln J]."""
        log_j = np.log(j)
        return sum(
            m.mu * m.scale * (self.rest(m, log_j) + 2.0 + m.alpha * log_j) for m in self.terms
        )

    @np.errstate(**NO_VALUE)
    def further_constants(self, log_j, j):
        """Evaluate d(W_T, W_J) / d nu, by way of r = alpha b."""
        # W_J = mu k (... - 2 q J^(-r - 1)):  dW_J/dnu = mu k 2 q ln J J^(-r - 1) alpha db/dnu
        zero = np.zeros_like(log_j)
        return [
            np.array(
                [
                    zero,
                    m.mu
                    * m.scale
                    * 2.0
                    * m.q
                    * log_j
                    * np.exp(-m.r * log_j)
                    / j
                    * m.alpha
                    * b_rate,
                ]
            )
            for m, b_rate in zip(self.terms, self._b_rates, strict=True)
        ]

    @np.errstate(**NO_VALUE)
    def across(self, t, j):
        """Evaluate sigma_33 and its derivatives in T and J."""
        j = np.asarray(j)
        log_j = np.log(j)
        # sigma_33 = (1/J) dW/dlambda_3 = (1/J) sum 2 mu/alpha (1 - J^-r),  k alpha = 2 / alpha
        value = -sum(m.mu * m.scale * m.alpha * np.expm1(-m.r * log_j) for m in self.terms) / j
        # d sigma_33/dJ = (1/J) [ (1/J) sum 2 mu/alpha r J^(-r) - sigma_33 ]
        slope = sum(m.mu * m.scale * m.alpha * m.r * np.exp(-m.r * log_j) for m in self.terms)
        return np.array([value, np.zeros_like(value), (slope / j - value) / j])

    @np.errstate(**NO_VALUE)
    def across_constant_derivatives(self, t, j):
        """Evaluate d sigma_33 / d constant: all mu, all alpha, all nu."""
        j = np.asarray(j)
        log_j, by_mu, by_alpha, by_nu = np.log(j), [], [], []
        for m, b_rate in zip(self.terms, self._b_rates, strict=True):
            tension, factor = -np.expm1(-m.r * log_j), 2.0 / m.alpha
            # J sigma_33 = sum mu (2/alpha) (1 - J^-r),  d(1 - J^-r)/dr = ln J J^-r
            fall = log_j * np.exp(-m.r * log_j)
            by_mu.append(factor * tension)
            by_alpha.append(m.mu * factor * (m.r_rate * fall - tension / m.alpha))
            by_nu.append(m.mu * factor * fall * m.alpha * b_rate)
        return np.array([*by_mu, *by_alpha, *by_nu]) / j

    @np.errstate(**NO_VALUE)
    def principal_stress(self, stretches):
        """Evaluate principal Kirchhoff stresses, shape (3, ...)."""
        # tau_i = sum 2 mu/alpha (lambda_i^alpha - J^(-alpha b)),  ln J = sum ln lambda_i
        log = np.log(np.asarray(stretches))
        return sum(
            2.0 * m.mu / m.alpha * (np.exp(m.alpha * log) - np.exp(-m.r * log.sum(axis=0)))
            for m in self.terms
        )

    @np.errstate(**NO_VALUE)
    def principal_tangent(self, stretches):
        """Evaluate d tau_i / d ln lambda_j, shape (3, 3, ...)."""
        # d tau_i/d ln lambda_j = sum 2 mu (lambda_i^alpha delta_ij + b J^(-alpha b))
        log = np.log(np.asarray(stretches))
        own = sum(2.0 * m.mu * np.exp(m.alpha * log) for m in self.terms)
        volume = sum(
            2.0 * m.mu * b * np.exp(-m.r * log.sum(axis=0))
            for m, b in zip(self.terms, self._b, strict=True)
        )
        return np.einsum("ij,j...->ij...", np.eye(3), own) + volume

    @np.errstate(**NO_VALUE)
    def principal_constants(self, stretches):
        """Evaluate d (Kirchhoff stress) / d constant: all mu, all alpha, all nu."""
        log = np.log(np.asarray(stretches))
        log_j, by_mu, by_alpha, by_nu = log.sum(axis=0), [], [], []
        for m, b, b_rate in zip(self.terms, self._b, self._b_rates, strict=True):
            power, volume, factor = np.exp(m.alpha * log), np.exp(-m.r * log_j), 2.0 / m.alpha
            by_mu.append(factor * (power - volume))
            # d(lambda^alpha - J^(-alpha b))/d alpha = ln lambda lambda^alpha + b ln J J^(-alpha b)
            slope = log * power + b * log_j * volume
            by_alpha.append(m.mu * factor * (slope - (power - volume) / m.alpha))
            # d tau/dnu = (2 mu/alpha) alpha ln J J^(-alpha b) db/dnu
            by_nu.append(np.broadcast_to(2.0 * m.mu * b_rate * log_j * volume, log.shape))
        return np.array([*by_mu, *by_alpha, *by_nu])

    @property
    def _b(self):
        return tuple(nu / (1.0 - 2.0 * nu) for nu in self.nu)

    @property
    def _b_rates(self):
        """Evaluate db / dnu = 1 / (1 - 2 nu)^2."""
        return tuple(1.0 / (1.0 - 2.0 * nu) ** 2 for nu in self.nu)

"""Uniaxial, planar and equibiaxial tests of a material law: nominal stress as a function of stretch.

The logarithms of the principal stretches are e = pulled ln(lambda) + free ln(x), with lambda the
stretch that is imposed and x that of the free directions:

    uniaxial      (lambda, x, x)
    planar        (lambda, 1, x)      a wide strip between clamps, "pure shear"
    equibiaxial   (lambda, lambda, x)

For a compressible law x follows from tau . free = 0, with the Kirchhoff stresses tau. A nearly
incompressible rubber is taken as incompressible: x from J = 1, and a pressure, which does no work,
makes the free directions free of stress. In both cases n P lambda = tau . (pulled + r free) with n
pulled directions and r = d ln x / d ln lambda at J = 1, since the factor of r is zero or cancels the
pressure. (R. W. Ogden, Non-linear Elastic Deformations, 7.2.)
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.materials.isotropic import Isotropic

NEWTON_STEPS = 60
"""Limit of Newton iterations for the free stretch; a few suffice from the starting point used."""
LONGEST_STEP = 0.5
"""Largest change of ln x in one iteration."""


@dataclass(frozen=True)
class Mode:
    """A kind of test.

    Attributes
    ----------
    name : str
    pulled, free : tuple of int
        1 for each of the three directions with the imposed or the free stretch.
    """

    name: str
    pulled: tuple
    free: tuple

    @property
    def incompressible_rate(self) -> float:
        """r = d ln x / d ln lambda at J = 1."""
        return -sum(self.pulled) / sum(self.free)

    @property
    def along(self) -> np.ndarray:
        """Direction of the work of the imposed stretch, shape (3,)."""
        # (pulled + r free) / n
        free = self.incompressible_rate * np.array(self.free)
        return (np.array(self.pulled) + free) / sum(self.pulled)

    def stretches(self, stretch, lateral) -> np.ndarray:
        """Compute the three principal stretches, shape (3, m)."""
        # ln lambda_i = pulled_i ln(lambda) + free_i ln(x)
        log, across = np.log(stretch), np.log(lateral)
        return np.exp(np.multiply.outer(self.pulled, log) + np.multiply.outer(self.free, across))


UNIAXIAL = Mode("uniaxial", (1, 0, 0), (0, 1, 1))
PLANAR = Mode("planar", (1, 0, 0), (0, 0, 1))
EQUIBIAXIAL = Mode("equibiaxial", (1, 1, 0), (0, 0, 1))
MODES = {mode.name: mode for mode in (UNIAXIAL, PLANAR, EQUIBIAXIAL)}


def is_compressible(law: Isotropic) -> bool:
    """Return whether a law is compressible; otherwise J = 1 is assumed."""
    return law.bulk_modulus == 0.0


def lateral_stretch(law: Isotropic, mode: Mode, stretch) -> np.ndarray:
    """Solve for the stretch x of the free directions, shape of ``stretch``; NaN without convergence."""
    log = np.log(np.asarray(stretch, float))
    if not is_compressible(law):
        # J = 1: ln x = r ln lambda
        return np.exp(mode.incompressible_rate * log)
    free = np.array(mode.free, float)
    # start from the linear solution, exact for a foam with equal nu:
    # free . A (pulled ln lambda + free ln x) = 0 with the tangent A of the undeformed state
    pull = free @ law.principal_tangent(np.ones(3))
    across, change = float(-(pull @ np.array(mode.pulled)) / (pull @ free)) * log, np.inf
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            state = mode.stretches(np.exp(log), np.exp(across))
            # Newton for f = free . tau = 0 in ln x,  df/d ln x = free . (d tau/d ln lambda) free
            force = free @ law.principal_stress(state)
            slope = np.einsum("i,ij...,j->...", free, law.principal_tangent(state), free)
            step = np.clip(-force / slope, -LONGEST_STEP, LONGEST_STEP)
            across, change = across + step, np.abs(step)
            # converged quadratically: the next change would be below rounding
            if not np.any(change > 1e-9):
                break
    return np.where(change <= 1e-9, np.exp(across), np.nan)


def nominal_stress(law: Isotropic, mode: Mode, stretch) -> np.ndarray:
    """Compute the nominal stress in a pulled direction, in the unit of the constants.

    Parameters
    ----------
    law : Isotropic
    mode : Mode
    stretch : array_like
        Positive; below 1 in compression.
    """
    stretch = np.asarray(stretch, float)
    state = mode.stretches(stretch, lateral_stretch(law, mode, stretch))
    # P = along . tau / lambda
    return mode.along @ law.principal_stress(state) / stretch


@dataclass(frozen=True, eq=False)
class ModeResponse:
    """Response of a law in one mode.

    Attributes
    ----------
    stress, lateral : ndarray, shape (m,)
        Nominal stress and free stretch.
    stress_rates, lateral_rates : ndarray, shape (n_constants, m)
        Their derivatives in the constants.
    """

    stress: np.ndarray
    lateral: np.ndarray
    stress_rates: np.ndarray
    lateral_rates: np.ndarray


def response(law: Isotropic, mode: Mode, stretch) -> ModeResponse:
    """Compute stress, free stretch and their exact derivatives in the constants of the law."""
    stretch = np.asarray(stretch, float)
    lateral = lateral_stretch(law, mode, stretch)
    state, along = mode.stretches(stretch, lateral), mode.along
    # P = along . tau / lambda
    stress = along @ law.principal_stress(state) / stretch
    rates = law.principal_constants(state)
    by_constant = np.einsum("i,ki...->k...", along, rates)
    if not is_compressible(law):
        return ModeResponse(stress, lateral, by_constant / stretch, np.zeros_like(by_constant))
    # free . tau = 0 for all constants c:  d ln x/dc = -(free . d tau/dc) / (free . A free)
    # d(n P lambda)/dc = along . (d tau/dc + A free d ln x/dc),  dx/dc = x d ln x/dc
    free, tangent = np.array(mode.free, float), law.principal_tangent(state)
    pull = np.einsum("i,ij...->j...", free, tangent)
    moved = -np.einsum("i,ki...->k...", free, rates) / np.einsum("i,i...->...", free, pull)
    total = by_constant + np.einsum("i,i...->...", along, pull) * moved
    return ModeResponse(stress, lateral, total / stretch, lateral * moved)

"""Inflation of a cylinder of layers of any isotropic laws: the exact solution by a shooting method.

With r(R) the deformed radius and S = P_R the radial Piola-Kirchhoff stress, both continuous across
the layers,

    r' = lambda,   S' = (P_theta(lambda, r / R) - S) / R,   P_R(lambda, r / R) = S gives lambda,

from r = stretch * bore inside to S = 0 outside (radial equilibrium; R. W. Ogden, Non-linear Elastic
Deformations, 5.3). The stresses are complex-step derivatives of the laws' energies, so of the laws
nothing else is used that the analysis uses.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root_scalar

from seal_mdao.materials.isotropic import Isotropic

STEP = 1e-30


def principal_stress(material: Isotropic, first, second):
    """dW/d(first) of the principal stretches in the plane, K/2 (J - 1)^2 included."""
    along = first + 1j * STEP
    energy = material.energy(along * along + second * second, along * second)
    jacobian = first * second
    return np.imag(energy) / STEP + material.bulk_modulus * (jacobian - 1.0) * second


def free_stretch(material: Isotropic, second: float, stress: float = 0.0, guess=None) -> float:
    """The stretch whose principal stress is ``stress`` where the other stretch is ``second``."""
    guess = 1.0 / second if guess is None else guess
    # an isochoric law is stiff in J alone: the secant starts with a step as small as its answer
    start = guess * (1.0 + 1e-6)
    solution = root_scalar(
        lambda x: principal_stress(material, x, second) - stress,
        x0=guess, x1=start, method="secant", xtol=1e-12,
    )  # fmt: skip
    if not solution.converged:
        raise RuntimeError(f"no stretch gives the stress {stress} beside the stretch {second}")
    return float(solution.root)


def bore_pressure(layers, stretch: float, rtol: float = 1e-9) -> float:
    """Pressure on the deformed bore at a bore stretch.

    Parameters
    ----------
    layers : sequence of (Isotropic, float, float)
        Law, inner and outer radius, from inside out.
    """
    bore, size = layers[0][1], layers[0][0].shear_modulus

    def outside(stress):
        state, last = np.array([stretch * bore, stress]), None
        for material, inner, outer in layers:
            last = [None]

            def rates(R, y, material=material, last=last):
                hoop = y[0] / R
                last[0] = radial = free_stretch(material, hoop, y[1], last[0])
                return [radial, (principal_stress(material, hoop, radial) - y[1]) / R]

            path = solve_ivp(rates, (inner, outer), state, method="DOP853", rtol=rtol, atol=rtol)
            state = path.y[:, -1]
        return state[1]

    start = -0.5 * size * np.log(stretch)
    solution = root_scalar(outside, x0=start, x1=1.1 * start, method="secant", rtol=1e-8)
    return float(-solution.root / stretch)

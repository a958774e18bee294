"""Bodies of revolution under fluid pressure: thick walls, and bodies with the pressure all round."""

import numpy as np
import pytest
from scipy.integrate import quad

from verification.cylinder import inflation_pressure
from verification.immersed import immersed
from verification.thick_walls import BORE, MATERIAL, OUTSIDE, SPHERE, TUBE, bore_errors, exact_bore


def orders(errors):
    return np.log2(errors[:-1] / errors[1:])


# ---- reference ----


def test_reference_of_the_tube_is_the_closed_form_of_incompressible_rubber():
    """Up to the compression p / K."""
    pressure = MATERIAL.shear_modulus * inflation_pressure(exact_bore(TUBE) / BORE)
    assert pressure == pytest.approx(TUBE.pressure, rel=5e-3)


def test_reference_of_the_sphere_is_the_integral_of_incompressible_rubber():
    """p = int dW/dlambda / (lambda^3 - 1) dlambda from the outside to the bore, up to p / K."""
    bore = exact_bore(SPHERE) / BORE
    outside = (1.0 + (bore**3 - 1.0) * (BORE / OUTSIDE) ** 3) ** (1 / 3)

    def slope(stretch):
        # W = C10 (2 l^2 + l^-4 - 3) + C01 (2 l^-2 + l^4 - 3)
        first = MATERIAL.c10 * (4.0 * stretch - 4.0 * stretch**-5)
        second = MATERIAL.c01 * (4.0 * stretch**3 - 4.0 * stretch**-3)
        return (first + second) / (stretch**3 - 1.0)

    assert quad(slope, outside, bore)[0] == pytest.approx(SPHERE.pressure, rel=5e-3)


# ---- convergence ----


@pytest.mark.parametrize(
    ("wall", "basis_order", "cells", "order", "finest"),
    [
        (TUBE, 1, (8, 16, 32), 2.0, 1e-4),
        # the load at the ends of the bore and straight sides are of second order
        (TUBE, 2, (8, 16, 32), 2.0, 1e-4),
        (SPHERE, 1, (4, 8, 16), 1.9, 3e-3),
        (SPHERE, 2, (8, 16, 32), 1.5, 3e-3),
    ],
)
def test_bore_converges_with_the_particles(wall, basis_order, cells, order, finest):
    errors = bore_errors(wall, cells, basis_order)
    assert orders(errors).min() >= order, errors
    assert errors[-1] <= finest


@pytest.mark.parametrize("bore", [None, 0.0, 1.0])
@pytest.mark.parametrize("uneven", [0.0, 0.2])
def test_a_body_with_pressure_all_round_shrinks_uniformly(bore, uneven):
    """F, h, displacements and volume to rounding, on any particles: the load acts where the consistent
    integration has the boundary."""
    found = np.array([immersed(cells, bore, uneven) for cells in (4, 8)])
    assert (found <= 1e-10).all(), found

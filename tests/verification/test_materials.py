"""Every shipped law through the analysis, against quadrature of its own energy."""

import numpy as np
import pytest

from verification.cylinder import BORE, OUTSIDE, inflation_pressure
from verification.layered_cylinder import bore_pressure, free_stretch, principal_stress
from verification.material_bodies import (
    BULK,
    LAWS,
    WIDEST,
    compression_errors,
    cylinder_error,
    layered_error,
)
from verification.tolerances import TOLERANCES

LEVELS = ((4, 8), (8, 16), (16, 32))


@pytest.mark.parametrize("walls", [False, True], ids=["free sides", "between walls"])
@pytest.mark.parametrize("law", LAWS)
def test_compressed_block(figure, law, walls):
    force, width = compression_errors(LAWS[law], walls)
    name = f"block {'between walls' if walls else 'with free sides'}, {law}: "
    figure(name + "platen force", force, TOLERANCES["compression"])
    figure(name + "width", width, TOLERANCES["compression"])


@pytest.mark.parametrize("law", LAWS)
def test_inflated_cylinder(figure, law):
    error = cylinder_error(LAWS[law])
    figure(f"inflated cylinder, {law}: pressure", error, TOLERANCES["cylinder"])


@pytest.mark.parametrize(
    ("inner", "outer"),
    [("neo-Hookean", "Gent"), ("hyperfoam, nu = 0.3", "Yeoh")],
    ids=["two rubbers", "foam in rubber"],
)
def test_cylinder_of_two_layers_converges(figure, inner, outer):
    # twice as stiff outside, so that exchanged layers could not pass
    stiff = LAWS[outer].with_(**STIFFER[outer])
    errors = np.array([layered_error(LAWS[inner], stiff, cells) for cells in LEVELS])
    assert np.all(errors[1:] < 0.6 * errors[:-1])
    figure(f"cylinder of {inner} in {outer}: pressure", errors[-1], TOLERANCES["layers"])
    exchanged = bore_pressure([(stiff, BORE, 1.5), (LAWS[inner], 1.5, OUTSIDE)], WIDEST)
    right = bore_pressure([(LAWS[inner], BORE, 1.5), (stiff, 1.5, OUTSIDE)], WIDEST)
    assert abs(exchanged / right - 1.0) > 100.0 * errors[-1]


STIFFER = {
    "Gent": {"shear_modulus": 2.0, "bulk_modulus": 2.0 * BULK},
    "Yeoh": {"c10": 1.0, "bulk_modulus": 2.0 * BULK},
}


def test_exact_pressure_tends_to_the_closed_form():
    """The incompressible Mooney-Rivlin cylinder: what is left falls like mu / K."""
    law = LAWS["Mooney-Rivlin"]
    pressures = [
        bore_pressure([(law.with_(bulk_modulus=10.0 * k * BULK), BORE, OUTSIDE)], 2.0)
        for k in (1.0, 10.0)
    ]
    away = np.abs(np.array(pressures) / inflation_pressure(2.0) - 1.0)
    assert away[0] < 1e-4
    assert away[0] / away[1] == pytest.approx(10.0, rel=0.01)


def test_exact_stress_of_a_foam_without_poisson_effect():
    """P = 2 mu / alpha (l^(alpha - 1) - 1 / l), and no stress across."""
    foam, stretch = LAWS["hyperfoam, nu = 0"], 0.6
    (mu,), (alpha,) = foam.mu, foam.alpha
    exact = 2.0 * mu / alpha * (stretch ** (alpha - 1.0) - 1.0 / stretch)
    assert principal_stress(foam, stretch, 1.0) == pytest.approx(exact, rel=1e-14)
    assert free_stretch(foam, stretch) == pytest.approx(1.0, rel=1e-12)

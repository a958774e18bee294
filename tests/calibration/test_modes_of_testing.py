"""Nominal stress of the three tests: textbooks, work along the path, foams, derivatives."""

import numpy as np
import pytest
from laws import LAWS, moved, principal_energy, principal_forces, size

from seal_mdao.calibration.loading_modes import (
    EQUIBIAXIAL,
    MODES,
    PLANAR,
    UNIAXIAL,
    is_compressible,
    lateral_stretch,
    nominal_stress,
    response,
)
from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.ogden import Ogden

STRETCHES = np.array([0.5, 0.8, 0.95, 1.0, 1.05, 1.3, 1.8])
FOAMS = {
    "one": Hyperfoam((70.0,), (6.2,), (0.3,)),
    "two": Hyperfoam((60.0, 25.0), (6.2, -3.1), (0.3, 0.1)),
    "crushable": Hyperfoam((60.0, 25.0), (6.2, -3.1), (0.0, 0.0)),
}


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
def test_mooney_rivlin_by_the_textbook(mode):
    """Treloar, The Physics of Rubber Elasticity, 10: with e the lateral strains of each mode."""
    c10, c01, L = 80.0, 20.0, STRETCHES
    exact = {
        "uniaxial": 2 * (L - L**-2) * (c10 + c01 / L),
        "planar": 2 * (L - L**-3) * (c10 + c01),
        "equibiaxial": 2 * (L - L**-5) * (c10 + c01 * L**2),
    }[mode.name]
    found = nominal_stress(MooneyRivlin(c10, c01), mode, L)
    # some 20 operations on numbers of the size of the moduli times L^5
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-12 * 100.0 * 2.0**5)


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
def test_ogden_by_his_formula(mode):
    law, L = LAWS["ogden_3"], STRETCHES
    power = {"uniaxial": -0.5, "planar": -1.0, "equibiaxial": -2.0}[mode.name]
    exact = sum(
        m * (L ** (a - 1) - L ** (power * a - 1)) for m, a in zip(law.mu, law.alpha, strict=True)
    )
    np.testing.assert_allclose(
        nominal_stress(law, mode, L), exact, rtol=0.0, atol=1e-12 * size(law) * 2.0**5
    )


@pytest.mark.parametrize("name", [name for name in LAWS if not name.startswith("foam")])
@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
def test_work_of_the_test_is_the_energy_that_is_stored(mode, name):
    """n P = dW/d lambda along the path of constant volume, by complex step of the published W."""
    law, h = LAWS[name], 1e-30
    for stretch in STRETCHES:
        pull = stretch + 1j * h
        state = [
            pull**p * pull ** (mode.incompressible_rate * f)
            for p, f in zip(mode.pulled, mode.free, strict=True)
        ]
        if isinstance(law, Gent) and np.sum(np.square(state)).real - 3 >= law.limit:
            assert np.isnan(nominal_stress(law, mode, stretch))
            continue
        work = principal_energy(law, state).imag / h / sum(mode.pulled)
        found = nominal_stress(law, mode, stretch)
        assert found == pytest.approx(work, rel=1e-11, abs=1e-12 * size(law))


@pytest.mark.parametrize("foam", FOAMS.values(), ids=FOAMS)
@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
def test_foam_is_free_where_it_should_be(mode, foam):
    """Forces of the published energy: zero in the free directions, P in the pulled ones."""
    lateral = lateral_stretch(foam, mode, STRETCHES)
    for stretch, across in zip(STRETCHES, lateral, strict=True):
        state = mode.stretches(stretch, across)
        force = principal_forces(foam, state)
        assert np.abs(force * mode.free).max() <= 1e-11 * size(foam)
        stress = nominal_stress(foam, mode, stretch)
        assert np.abs((force - stress) * mode.pulled).max() <= 1e-11 * size(foam) + 1e-12 * abs(
            stress
        )


def test_lateral_stretch_of_a_foam_with_one_ratio():
    """lambda^-nu, lambda^(-nu / (1 - nu)), lambda^(-2 nu / (1 - nu)): exact at every stretch."""
    nu = 0.3
    for mode, power in (
        (UNIAXIAL, -nu), (PLANAR, -nu / (1 - nu)), (EQUIBIAXIAL, -2 * nu / (1 - nu)),
    ):  # fmt: skip
        found = lateral_stretch(FOAMS["one"], mode, STRETCHES)
        np.testing.assert_allclose(found, STRETCHES**power, rtol=1e-13)


def test_equibiaxial_tension_is_uniaxial_compression():
    """The same states but for a pressure: P_b lambda_b = -P_u lambda_u, lambda_u = lambda_b^-2."""
    for law in (LAWS["yeoh"], LAWS["ogden_3"], MooneyRivlin()):
        b = np.array([1.1, 1.5, 2.0])
        u = b**-2.0
        left = nominal_stress(law, EQUIBIAXIAL, b) * b
        np.testing.assert_allclose(left, -nominal_stress(law, UNIAXIAL, u) * u, rtol=1e-11)


@pytest.mark.parametrize("name", [*LAWS, "one", "two"])
@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
def test_derivatives_in_the_constants(mode, name):
    """Against central differences: rounding over the step, and its square, are below 1e-7."""
    law = {**LAWS, **FOAMS}[name]
    found = response(law, mode, STRETCHES)
    there = np.isfinite(found.stress)
    for k, constant in enumerate(law.names):
        step = 1e-5 * max(1e-1, abs(law.constants[constant]))
        ends = [response(moved(law, constant, way * step), mode, STRETCHES) for way in (1, -1)]
        for values, rates in (("stress", found.stress_rates), ("lateral", found.lateral_rates)):
            quotient = (getattr(ends[0], values) - getattr(ends[1], values)) / (2 * step)
            scale = max(np.abs(rates[k][there]).max(), 1e-11 * size(law) / step)
            assert np.abs(quotient - rates[k])[there].max() <= 1e-6 * scale, (constant, values)


@pytest.mark.parametrize("name", [*LAWS, *FOAMS])
def test_principal_tangent(name):
    """d tau / d ln lambda, symmetric, and without resistance to volume where the law is isochoric."""
    law, h = {**LAWS, **FOAMS}[name], 1e-6
    for state in ([1.2, 0.9, 1.1], [0.7, 0.8, 1.3], [1.0, 1.0, 1.0]):
        state = np.array(state)
        tangent = law.principal_tangent(state)
        ends = [
            [law.principal_stress(state * np.exp(way * e)) for e in np.eye(3)] for way in (h, -h)
        ]
        quotient = (np.array(ends[0]) - np.array(ends[1])) / (2 * h)
        bound = 1e-8 * size(law)  # h^2 of a cubic term, and rounding 1e-16 / h
        np.testing.assert_allclose(tangent, quotient, rtol=0.0, atol=bound * 10)
        np.testing.assert_allclose(tangent, tangent.T, rtol=0.0, atol=1e-12 * size(law))
        if not is_compressible(law):
            assert np.abs(tangent.sum(axis=0)).max() <= 1e-11 * size(law)


def test_small_strain_is_the_shear_modulus():
    """P / strain at rest: 3 G, 4 G and 6 G for rubber."""
    h = 1e-6
    for law in (LAWS["gent"], Ogden((140.0,), (2.7,))):
        for mode, times in ((UNIAXIAL, 3), (PLANAR, 4), (EQUIBIAXIAL, 6)):
            ends = nominal_stress(law, mode, [1 + h, 1 - h])
            slope = (ends[0] - ends[1]) / (2 * h)
            assert slope == pytest.approx(times * law.shear_modulus, rel=1e-8)

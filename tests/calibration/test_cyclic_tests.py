"""Cyclic tests: recognised by their order, softening fitted together with the law, its errors."""

import math

import numpy as np
import pytest

from seal_mdao.calibration.cycles import SoftenedLaw, unloadings
from seal_mdao.calibration.data import MaterialDataError, ModeData, material_tests
from seal_mdao.calibration.law_fit import fit
from seal_mdao.calibration.loading_modes import MODES, nominal_stress
from seal_mdao.calibration.material_stability import UnstableMaterialError
from seal_mdao.calibration.softening_fit import first_loading, fit_softening
from seal_mdao.materials.gent import Gent
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.ogden_roxburgh import OgdenRoxburgh
from seal_mdao.materials.yeoh import Yeoh

SOFTENING = OgdenRoxburgh(1.8, 12.0, 0.15)
YEOH = Yeoh(150.0, -8.0, 2.0)


def cycles(*tops, points=10):
    """Stretches from 1 to every one of ``tops`` and back to 1."""
    parts = [np.linspace(*ends, points)[1:] for top in tops for ends in ((1.0, top), (top, 1.0))]
    return np.concatenate(parts)


LOOPS = cycles(1.3, 1.6, 2.0)


def made(law, softening=SOFTENING, stretch=LOOPS, modes=("uniaxial",), noise=0.0, seed=0):
    """Tests of a law with softening; the stretch 1 is without information."""
    rng, found = np.random.default_rng(seed), {}
    for mode in modes:
        data = ModeData(stretch, stretch, None, 1)
        stress = SoftenedLaw(law, softening).response(MODES[mode], data).stress
        found[mode] = stretch, stress + noise * rng.normal(size=stress.size)
    return material_tests(found, "loops.csv")


# ---- order ----

ORDERS = {
    "one cycle": (cycles(1.5), 1),
    "three": (LOOPS, 3),
    "in compression": (cycles(0.8, 0.6), 2),
    "tension and compression": (cycles(1.5, 0.7), 2),
    "through the undeformed state": (np.r_[1.2:1.6:5j, 1.5:0.6:10j], 1),
    "five readings": (np.array([1.5, 2.0, 1.5, 1.0]), 1),
    "not back to 1": (np.array([1.2, 1.4, 1.6, 1.5, 1.4, 1.6, 1.8]), 1),
    "ascending": (np.r_[0.5:2.0:9j], 0),
    "descending": (np.r_[2.0:0.5:9j], 0),
    "two specimens": (np.r_[1.1:2.0:9j, 1.1:2.0:9j], 0),
    "two in descending order": (np.r_[2.0:1.1:9j, 2.0:1.1:9j], 0),
    "tension, then ascending compression": (np.r_[1.1:2.0:9j, 0.5:0.9:9j], 0),
    "one reading back": (np.array([1.2, 1.4, 1.6, 1.3, 1.8]), 0),
    "scatter": (1.0 + np.array([0.1, 0.2, 0.3, 0.3, 0.295, 0.292, 0.4, 0.5]), 0),
}


@pytest.mark.parametrize(("stretch", "expected"), ORDERS.values(), ids=ORDERS)
def test_unloadings_are_counted(stretch, expected):
    assert unloadings(stretch) == expected


def test_the_order_of_cycles_is_that_of_the_test():
    """Other modes of the file are sorted, as before."""
    flat = np.array([1.5, 1.1, 0.5])
    own = {"uniaxial": (LOOPS, 9.0 * (LOOPS - 1.0)), "planar": (flat, flat - 1.0)}
    tests = material_tests(own)
    assert tests.cyclic
    np.testing.assert_array_equal(tests.modes["uniaxial"].stretch, LOOPS[LOOPS != 1.0])
    assert tests.modes["uniaxial"].unloadings == 3
    np.testing.assert_array_equal(tests.modes["planar"].stretch, np.sort(flat))
    # readings at the largest stretch so far: 9 of the first loading, and those beyond it
    primary = first_loading(tests)
    assert not primary.cyclic
    expected = [s for i, s in enumerate(LOOPS) if s >= LOOPS[: i + 1].max() and s > 1.0]
    assert primary.modes["uniaxial"].stretch.tolist() == expected
    assert primary.modes["planar"].stretch.size == 3


# ---- response ----


def test_stress_of_cycles_against_the_closed_form():
    """Uniaxial Mooney-Rivlin rubber, reading by reading, tension and then compression."""
    c10, c01, (r, m, beta) = 80.0, 20.0, (1.8, 12.0, 0.15)
    stretch = cycles(1.3, 0.7, 2.0)
    largest, expected = 0.0, []
    for s in stretch:
        energy = c10 * (s**2 + 2.0 / s - 3.0) + c01 * (2.0 * s + s**-2 - 3.0)
        largest = max(largest, energy)
        eta = 1.0 - math.erf((largest - energy) / (m + beta * largest)) / r
        expected.append(eta * 2.0 * (s - s**-2) * (c10 + c01 / s))
    law = SoftenedLaw(MooneyRivlin(c10, c01), OgdenRoxburgh(r, m, beta))
    found = law.response(MODES["uniaxial"], ModeData(stretch, stretch, None, 3))
    np.testing.assert_allclose(found.stress, expected, rtol=1e-11, atol=1e-9)
    # without unloadings it is the first loading
    flat = law.response(MODES["planar"], ModeData(stretch, stretch))
    np.testing.assert_array_equal(flat.stress, nominal_stress(law.law, MODES["planar"], stretch))
    assert not flat.stress_rates[-3:].any()


@pytest.mark.parametrize("law", [YEOH, Gent(190.0, 22.0), Ogden((630.0, -10.0), (1.3, -2.0))])
@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
def test_derivatives_of_the_stress(law, mode):
    """Central differences, in all constants."""
    soft = SoftenedLaw(law, SOFTENING)
    data = ModeData(LOOPS, LOOPS, None, 3)
    rates = soft.response(mode, data).stress_rates
    for row, name in enumerate(soft.names):
        value = soft.constants[name]
        step = 1e-5 * abs(value)
        ends = [soft.with_(**{name: value + s * step}).response(mode, data) for s in (0.5, -0.5)]
        expected = (ends[0].stress - ends[1].stress) / step
        size = np.abs(expected).max()
        np.testing.assert_allclose(rates[row], expected, atol=1e-6 * size + 1e-9)


# ---- fit ----

KNOWN = {
    "yeoh": (YEOH, {}),
    "mooney_rivlin": (MooneyRivlin(80.0, 20.0), {"modes": ("uniaxial", "equibiaxial")}),
    "gent": (Gent(190.0, 22.0), {"stretch": cycles(1.3, 0.7, 2.0)}),
    "ogden": (Ogden((140.0,), (2.7,)), {"stretch": cycles(0.8, 0.6)}),
}


@pytest.mark.parametrize("weighting", ["relative", "absolute"])
@pytest.mark.parametrize("name", KNOWN)
def test_known_constants_come_back(name, weighting):
    law, options = KNOWN[name]
    found = fit_softening(name, made(law, **options), weighting=weighting)
    expected = SoftenedLaw(law, SOFTENING).constants
    assert found.tested_law.constants == pytest.approx(expected, rel=1e-6)
    assert found.errors["all"].max_kPa < 1e-6
    assert found.stable


def test_a_first_loading_of_another_mode_takes_part():
    """c01 follows from the planar test of another specimen, which has no unloadings."""
    law, stretch = MooneyRivlin(80.0, 20.0), np.linspace(0.6, 1.9, 14)
    flat = nominal_stress(law, MODES["planar"], stretch)
    loops = made(law).modes["uniaxial"]
    own = {"uniaxial": (loops.stretch, loops.stress), "planar": (stretch, flat)}
    found = fit_softening("mooney_rivlin", material_tests(own))
    expected = SoftenedLaw(law, SOFTENING).constants
    assert found.tested_law.constants == pytest.approx(expected, rel=1e-6)
    assert found.errors["planar"].max_kPa < 1e-6


def test_one_amplitude_gives_no_beta():
    """m is then m + beta W_max of the rubber."""
    law, stretch = MooneyRivlin(80.0, 20.0), cycles(1.8, 1.8)
    found = fit_softening("mooney_rivlin", made(law, stretch=stretch))
    largest = 80.0 * (1.8**2 + 2.0 / 1.8 - 3.0) + 20.0 * (2.0 * 1.8 + 1.8**-2 - 3.0)
    assert found.softening.r == pytest.approx(SOFTENING.r, rel=1e-6)
    assert found.softening.m == pytest.approx(SOFTENING.m + SOFTENING.beta * largest, rel=1e-6)
    assert found.softening.beta == 0.0
    assert "softening_beta" not in found.standard_errors


def test_standard_errors_are_those_of_repeated_tests():
    """50 tests with normal errors of 2 kPa: the spread of the constants is their standard error within
    20 %, and every constant is within four of them, nearly all within three."""
    expected = SoftenedLaw(YEOH, SOFTENING).constants
    fits = [
        fit_softening("yeoh", made(YEOH, noise=2.0, seed=seed), weighting="absolute")
        for seed in range(50)
    ]
    names = fits[0].unknowns
    assert names == ("c10", "c20", "c30", "softening_r", "softening_m", "softening_beta")
    away = np.array([[f.tested_law.constants[n] - expected[n] for n in names] for f in fits])
    errors = np.array([[f.standard_errors[n] for n in names] for f in fits])
    spread = np.sqrt(np.mean(away**2, axis=0))
    np.testing.assert_allclose(np.sqrt(np.mean(errors**2, axis=0)), spread, rtol=0.2)
    assert np.mean(np.abs(away) < 3.0 * errors) > 0.985
    assert np.all(np.abs(away) < 4.0 * errors)


# ---- errors ----


def with_stress(stretch, stress):
    return material_tests({"uniaxial": (stretch, stress)}, "loops.csv")


ELASTIC = nominal_stress(YEOH, MODES["uniaxial"], LOOPS)
REFUSED = {
    "no unloading": (made(YEOH, stretch=np.linspace(1.1, 2.0, 9)), "tests contains an unloading"),
    "no softening": (with_stress(LOOPS, ELASTIC), "r of the Mullins softening is not determined"),
    "plateau alone": (
        made(YEOH, OgdenRoxburgh(2.0, 0.01, 0.0)),
        "m and beta of the Mullins softening are not determined: .* beginning of the unloading",
    ),
    "too few below": (
        made(YEOH, stretch=np.array([1.2, 1.4, 1.6, 1.8, 1.7, 1.0])),
        "1 readings during unloading or reloading .below the largest earlier stretch. are too few "
        "for the 2",
    ),
    "too few of the law": (
        made(YEOH, stretch=np.array([1.3, 1.6, 1.5, 1.4, 1.3, 1.2])),
        "2 readings are too few for the 3 constants of yeoh",
    ),
}


@pytest.mark.parametrize(("tests", "expected"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_fitted_is_an_error(tests, expected):
    with pytest.raises(MaterialDataError, match=expected) as error:
        fit_softening("yeoh", tests)
    assert str(error.value).startswith(tests.source)


def test_stress_zero_in_all_of_a_test():
    with pytest.raises(MaterialDataError, match="every stress of the mode uniaxial is zero"):
        with_stress(LOOPS, 0.0 * LOOPS)


def test_a_compressible_law_is_refused():
    with pytest.raises(ValueError, match="nearly incompressible laws only, not for hyperfoam"):
        fit_softening("hyperfoam", made(YEOH), nu=0.2)


def test_an_unstable_first_loading_is_refused():
    """Beside softening the law of the first loading has to be stable, fitted to all readings."""
    law = Yeoh(150.0, -60.0, 2.0)
    with pytest.raises(UnstableMaterialError, match=r"loops.csv: yeoh .* is not stable: uniaxial"):
        fit_softening("yeoh", made(law, stretch=cycles(1.2, 1.4, 1.6)))
    found = fit_softening("yeoh", made(law, stretch=cycles(1.2, 1.4, 1.6)), allow_unstable=True)
    assert not found.stable
    assert found.law.c20 == pytest.approx(-60.0, rel=1e-6)
    # the first loading alone would not be stable, all readings together are
    stretch = cycles(1.2, 1.4, 1.6)
    top = [s >= stretch[: i + 1].max() for i, s in enumerate(stretch)]
    soft = [SoftenedLaw(Yeoh(150.0, c20, 2.0), SOFTENING) for c20 in (-35.0, -60.0)]
    data = ModeData(stretch, stretch, None, 3)
    first, below = (own.response(MODES["uniaxial"], data).stress for own in soft)
    tests = with_stress(stretch, np.where(top, first, below))
    with pytest.raises(UnstableMaterialError):
        fit("yeoh", first_loading(tests))
    assert fit_softening("yeoh", tests).stable


def test_a_law_without_softening_is_not_fitted_to_cycles():
    tests = made(YEOH)
    with pytest.raises(MaterialDataError, match=r"cyclic test \(unloadings: 3 in uniaxial"):
        fit("yeoh", tests)
    with pytest.raises(MaterialDataError, match="a range of stretches cannot be selected"):
        tests.between(1.1, 1.5)
    # the first loading alone is that of the law
    found = fit("yeoh", first_loading(tests))
    assert found.law.constants == pytest.approx(YEOH.constants, rel=1e-6)
    assert found.softening is None

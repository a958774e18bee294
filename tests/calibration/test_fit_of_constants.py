"""Known constants come back from their own stresses; what cannot be fitted is refused."""

import tomllib

import numpy as np
import pytest
from laws import LAWS

from seal_mdao.calibration.data import MaterialDataError, material_tests
from seal_mdao.calibration.law_fit import fit
from seal_mdao.calibration.loading_modes import MODES, lateral_stretch, nominal_stress
from seal_mdao.calibration.material_stability import UnstableMaterialError
from seal_mdao.calibration.residuals import residuals
from seal_mdao.calibration.seal_file import material_table
from seal_mdao.materials import by_name
from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.yeoh import Yeoh

STRETCHES = np.concatenate([np.linspace(0.5, 0.95, 8), np.linspace(1.05, 2.0, 10)])
KNOWN = {
    "neo_hookean": (NeoHookean(90.0), {}),
    "mooney_rivlin": (MooneyRivlin(80.0, 20.0), {}),
    "yeoh": (Yeoh(100.0, -8.0, 3.0), {}),
    "gent": (Gent(190.0, 22.0), {}),
    "ogden, one term": (Ogden((140.0,), (2.7,)), {}),
    "ogden, two": (Ogden((630.0, -10.0), (1.3, -2.0)), {"terms": 2}),
    "ogden, three": (LAWS["ogden_3"], {"terms": 3}),
    "hyperfoam, measured": (Hyperfoam((60.0,), (6.2,), (0.2,)), {}),
    "hyperfoam, two measured": (Hyperfoam((60.0, 25.0), (6.2, -3.1), (0.3, 0.2)), {"terms": 2}),
    "hyperfoam, given": (Hyperfoam((60.0, 25.0), (6.2, -3.1), (0.3, 0.3)), {"terms": 2, "nu": 0.3}),
}


def made(law, lateral=False, modes=MODES, noise=0.0):
    """Tests of a law."""
    rng, found = np.random.default_rng(3), {}
    for name in modes:
        stress = nominal_stress(law, MODES[name], STRETCHES)
        stress = stress + noise * rng.normal(size=stress.size)
        columns = [STRETCHES, stress]
        if lateral:
            columns.append(lateral_stretch(law, MODES[name], STRETCHES))
        found[name] = columns
    return material_tests(found)


def ordered(law):
    """Constants without regard to the order of terms."""
    fields = [getattr(law, f) for f in ("mu", "alpha", "nu") if hasattr(law, f)]
    return (
        np.array(sorted(zip(*fields, strict=True)))
        if fields
        else np.array(list(law.constants.values()))
    )


@pytest.mark.parametrize(
    ("name", "weighting"),
    [*((name, "relative") for name in KNOWN), ("yeoh", "absolute"), ("gent", "absolute")],
)
def test_known_constants_come_back(name, weighting):
    """From exact stresses: the square of rounding in the cost leaves half the digits times the
    condition of the Jacobian, which is below 1e3 where columns are scaled."""
    law, options = KNOWN[name]
    found = fit(
        name.split(",")[0], made(law, name.endswith("measured")), weighting=weighting, **options
    )
    assert found.cost < 1e-18
    np.testing.assert_allclose(ordered(found.law), ordered(law), rtol=1e-5)
    assert found.stable
    assert found.errors["all"].r2 == pytest.approx(1.0, abs=1e-12)
    assert found.agreeing >= 1


@pytest.mark.parametrize("name", ["yeoh", "gent", "ogden, two", "hyperfoam, measured"])
def test_derivatives_of_the_differences(name):
    """Of weighted stresses and free stretches, by central differences."""
    law, _ = KNOWN[name]
    lateral = name.startswith("hyperfoam")
    differences = residuals(made(law, lateral, noise=1.0), "relative", lateral)
    names = tuple(n for n in law.names if n != "bulk_modulus")
    _, slope = differences(law, names)
    for k, constant in enumerate(names):
        step = 1e-6 * abs(law.constants[constant])
        up, down = (
            differences(law.with_(**{constant: law.constants[constant] + way * step}), names)[0]
            for way in (1, -1)
        )
        quotient = (up - down) / (2 * step)
        # rounding 1e-15 of differences of size one over a step of 1e-6, and the step's square
        assert np.abs(quotient - slope[:, k]).max() <= 1e-7 * np.abs(slope[:, k]).max()


def test_the_same_call_gives_the_same_bits():
    tests = made(KNOWN["gent"][0], noise=2.0)
    first, second = (fit("ogden", tests, seed=4) for _ in range(2))
    assert first.law == second.law
    assert first.cost == second.cost


@pytest.mark.parametrize("counts", [(24, 24, 24), (400, 8, 30)])
def test_standard_errors_are_those_of_repeated_tests(counts):
    """A linear law under noise: the scatter of the constants over many tests is what the fit says, for
    modes of equal weight with any numbers of readings."""
    law = MooneyRivlin(80.0, 20.0)
    stretches = {name: np.linspace(0.7, 2.0, n) for name, n in zip(MODES, counts, strict=True)}
    stress = {name: nominal_stress(law, MODES[name], own) for name, own in stretches.items()}
    rng, constants, told = np.random.default_rng(8), [], []
    for _ in range(200):
        tests = material_tests(
            {
                name: (stretches[name], s + 2.0 * rng.normal(size=s.size))
                for name, s in stress.items()
            }
        )
        found = fit("mooney_rivlin", tests, weighting="absolute")
        constants.append([found.law.c10, found.law.c01])
        told.append([found.standard_errors["c10"], found.standard_errors["c01"]])
    # a standard deviation from 200 samples is good to 5 %; three times that
    scatter = np.std(constants, axis=0)
    np.testing.assert_allclose(np.sqrt(np.mean(np.square(told), axis=0)), scatter, rtol=0.15)


def test_planar_tests_alone_do_not_tell_c10_from_c01():
    """I1 = I2 there: only their sum is determined."""
    found = fit("mooney_rivlin", made(MooneyRivlin(80.0, 20.0), modes=["planar"]))
    assert found.law.c10 + found.law.c01 == pytest.approx(100.0, rel=1e-9)
    assert found.standard_errors["c10"] == found.standard_errors["c01"] == np.inf


def test_modes_count_the_same_however_many_readings():
    """Every reading of one mode twice: the same constants."""
    law = LAWS["gent"].with_(limit=30.0)
    tests = made(law)
    doubled = {
        name: (np.repeat(d.stretch, 2), np.repeat(d.stress, 2)) if name == "planar"
        else (d.stretch, d.stress) for name, d in tests.modes.items()
    }  # fmt: skip
    one, two = fit("mooney_rivlin", tests), fit("mooney_rivlin", material_tests(doubled))
    assert one.law.c10 == pytest.approx(two.law.c10, rel=1e-9)


def test_unstable_constants_are_refused_with_the_stretch():
    law = Yeoh(100.0, -18.0, 0.0)
    tests = made(law, modes=["uniaxial", "planar"])
    with pytest.raises(UnstableMaterialError, match=r"yeoh .* planar.*begins at a stretch of"):
        fit("yeoh", tests)
    found = fit("yeoh", tests, allow_unstable=True)
    assert not found.stable
    assert found.law.c20 == pytest.approx(-18.0, rel=1e-6)
    # within the range in which it is stable the same rubber can be fitted
    assert fit("yeoh", tests.between(0.8, 1.3)).stable


@pytest.mark.parametrize(
    ("law", "options", "words"),
    [
        ("rubber", {}, "law must be one of .'neo_hookean'"),
        ("yeoh", {"terms": 2}, "law yeoh has 1 to 1 terms, got 2"),
        ("ogden", {"terms": 4}, "law ogden has 1 to 3 terms"),
        ("yeoh", {"nu": 0.3}, "has no Poisson's ratio, got nu = 0.3"),
        ("hyperfoam", {"nu": 0.5}, "nu must be a number of at least"),
        ("hyperfoam", {}, "only to tests with the column lateral_stretch"),
        ("yeoh", {"weighting": "squares"}, "weighting must be one of .'relative', 'absolute'"),
        ("yeoh", {"bulk_modulus": -1.0}, "bulk_modulus of Yeoh must be a number above 0"),
        ("yeoh", {"margin": float("nan")}, "margin must be a number of at least 0"),
        ("yeoh", {"seed": -1}, "seed must be an integer of at least 0"),
    ],
)
def test_wrong_arguments(law, options, words):
    with pytest.raises(ValueError, match=words):
        fit(law, made(NeoHookean(90.0)), **options)


def test_too_few_readings():
    tests = material_tests({"uniaxial": ([1.2, 1.5], [50.0, 90.0])})
    with pytest.raises(
        MaterialDataError, match="2 readings are too few for the 3 constants of yeoh"
    ):
        fit("yeoh", tests)


@pytest.mark.parametrize("name", KNOWN)
def test_table_of_a_seal_file(name):
    """TOML that gives the law again, to the digits written."""
    law, _ = KNOWN[name]
    word = name.split(",")[0]
    read = tomllib.loads(material_table(law, word, "skin", ["a note"]))["material"]["skin"]
    assert read.pop("law") == word
    assert by_name.LAWS[word] is type(law)
    assert ordered(type(law)(**read)) == pytest.approx(ordered(law), rel=1e-7)
    with pytest.raises(ValueError, match=r"name of a material .*'a b'"):
        material_table(law, word, "a b")

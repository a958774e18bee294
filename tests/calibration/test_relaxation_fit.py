"""Known Prony series and shifts come back; what the data do not determine is said."""

import tomllib

import numpy as np
import pytest
from relaxation_cases import TAU, G, after_ramp, at_temperatures, relaxed

from seal_mdao.calibration.data import MaterialDataError
from seal_mdao.calibration.relaxation_data import relaxation_tests
from seal_mdao.calibration.relaxation_fit import fit_relaxation
from seal_mdao.calibration.relaxation_model import PronyModel, decay
from seal_mdao.calibration.relaxation_shift import Arrhenius, Wlf
from seal_mdao.calibration.seal_file import viscoelastic_table

TIME = np.geomspace(0.1, 1e5, 60)
DEGREES = (0.0, 23.0, 50.0, 80.0, 100.0)
SHIFTS = {"wlf": Wlf((8.0, 110.0), 23.0), "arrhenius": Arrhenius((90.0,), 23.0)}


def test_known_constants_come_back():
    """Three terms, found by the data; the residual leaves half the digits of rounding."""
    found = fit_relaxation(relaxation_tests([(TIME, -750.0 * relaxed(TIME))]))
    np.testing.assert_allclose(found.g, G, rtol=1e-7)
    np.testing.assert_allclose(found.tau, TAU, rtol=1e-7)
    assert found.long_term == pytest.approx(0.7, rel=1e-8)
    assert found.rms < 1e-9
    assert (found.shift, found.reference, found.factors) == (None, None, {})
    assert found.time_range == (pytest.approx(0.1), pytest.approx(1e5))
    # from 1e4 to 1e5 s only the slowest term falls
    assert found.fall_at_end == pytest.approx(G[2] * np.exp(-5.0) / 0.7, rel=1e-6)


@pytest.mark.parametrize("ramp", [0.05, 3.0, 60.0])
def test_the_ramp_of_the_loading_is_accounted_for(ramp):
    """The integral over a loading at a constant rate, and constants from readings after it."""
    time = ramp + np.geomspace(0.1, 1e5, 60)
    psi, _ = decay(time[:, None], TAU, ramp)
    np.testing.assert_allclose(0.7 + psi @ G, after_ramp(time, ramp), rtol=1e-13)
    found = fit_relaxation(relaxation_tests([(time, after_ramp(time, ramp))], ramp), terms=3)
    # after a ramp of 60 s the term of 1 s is at 1/60: six digits of rounding and the square root
    np.testing.assert_allclose(found.g, G, rtol=1e-5)
    np.testing.assert_allclose(found.tau, TAU, rtol=1e-5)


@pytest.mark.parametrize("shared", [True, False])
@pytest.mark.parametrize("name", SHIFTS)
def test_a_master_curve_of_several_temperatures(name, shared):
    shift, time = SHIFTS[name], np.geomspace(0.5, 1e4, 40)
    found = fit_relaxation(at_temperatures(shift, DEGREES, time, shared=shared), shift=name)
    assert found.reference == 23.0
    np.testing.assert_allclose(found.g, G, rtol=1e-6)
    np.testing.assert_allclose(found.tau, TAU, rtol=1e-6)
    np.testing.assert_allclose(found.shift.constants, shift.constants, rtol=1e-5)
    for degrees, (log_a, _) in found.factors.items():
        assert log_a == pytest.approx(shift.log_factor(degrees)[0], abs=1e-5)


@pytest.mark.parametrize("name", SHIFTS)
def test_the_shift_function_is_chosen_by_the_data(name):
    """Arrhenius' law is the WLF equation with c2 equal to the absolute reference temperature: the
    further constant has to be worth it."""
    shift, time = SHIFTS[name], np.geomspace(0.5, 1e4, 40)
    tests = at_temperatures(shift, DEGREES, time, shared=True, noise=1e-3)
    found = fit_relaxation(tests)
    assert found.shift.name == name
    for own, true, key in zip(
        found.shift.constants, shift.constants, found.shift.names, strict=True
    ):
        assert abs(own - true) < 4.0 * found.standard_errors[key]


def test_entropic_moduli():
    """Forces in proportion to the absolute temperature, of one specimen."""
    shift, time = SHIFTS["arrhenius"], np.geomspace(0.5, 1e4, 40)
    tests = at_temperatures(shift, DEGREES, time, shared=True, entropic=True)
    found = fit_relaxation(tests, entropic=True, shift="arrhenius", reference=50.0)
    np.testing.assert_allclose(found.g, G, rtol=1e-6)
    # the same law with its times at another reference
    a = np.exp(shift.log_factor(50.0)[0])
    np.testing.assert_allclose(found.tau, a * TAU, rtol=1e-6)
    assert found.shift.constants[0] == pytest.approx(90.0, rel=1e-6)
    assert fit_relaxation(tests, shift="arrhenius", reference=50.0).rms > 0.02


def test_given_relaxation_times():
    """g of the given times, of which an absent one is left out."""
    found = fit_relaxation(relaxation_tests([(TIME, relaxed(TIME))]), tau=[30, 1, 2000, 7e5])
    np.testing.assert_allclose(found.tau, TAU, rtol=1e-14)
    np.testing.assert_allclose(found.g, G, rtol=1e-7)
    assert found.names == ("g_1", "g_2", "g_3")


@pytest.mark.parametrize("shift", ["free", Wlf, Arrhenius])
def test_derivatives_of_the_forces(shift):
    """By central differences in all unknowns, after a ramp and with two specimens."""
    curves = [
        (np.geomspace(2.0, 1e3, 7), np.linspace(9.0, 5.0, 7), degrees, name)
        for name in "ab" for degrees in (0.0, 23.0, 50.0)
    ]  # fmt: skip
    tests = relaxation_tests(curves, 1.5)
    model = PronyModel(tests, 2, 23.0, shift, entropic=True)
    constants = {"free": [1.2, -2.0], Wlf: [8.0, 110.0], Arrhenius: [60.0]}[shift]
    x = np.concatenate([[0.5, 0.3, 0.2], np.log([0.8, 40.0]), constants, [0.7]])
    assert len(model.names) == x.size
    _, slopes = model.evaluate(x)
    for k in range(x.size):
        step = 1e-5 * max(abs(x[k]), 1.0)
        up, down = (model.evaluate(x + way * step * np.eye(x.size)[k])[0] for way in (1, -1))
        quotient = (up - down) / (2.0 * step)
        # the square of the step
        np.testing.assert_allclose(slopes[:, k], quotient, atol=1e-9)
        assert np.abs(slopes[:, k]).max() > 1e-4


def test_standard_errors_are_those_of_repeated_tests():
    """Readings at equal intervals of time, whose weights differ by a thousand."""
    g, tau = np.array([0.2, 0.1]), np.array([3.0, 200.0])
    time, rng = np.linspace(1.0, 1000.0, 300), np.random.default_rng(6)
    force, found, said = relaxed(time, g, tau), [], []
    for _ in range(80):
        tests = relaxation_tests([(time, force + 2e-3 * rng.normal(size=time.size))])
        own = fit_relaxation(tests, terms=2)
        found.append([*own.g, *np.log(own.tau)])
        said.append([own.standard_errors[name] for name in own.names])
    # a standard deviation from 80 samples is good to 8 %; three times that
    np.testing.assert_allclose(np.sqrt(np.mean(np.square(said), 0)), np.std(found, 0), rtol=0.24)
    # without bias beyond the scatter of the mean
    away = np.mean(found, 0) - np.append(g, np.log(tau))
    assert np.all(np.abs(away) < 4.0 * np.std(found, 0) / np.sqrt(80.0))


def test_band_of_the_curve_is_that_of_repeated_tests():
    time, rng, curves, said = np.geomspace(1.0, 1e3, 40), np.random.default_rng(1), [], []
    at = np.array([2.0, 30.0, 500.0])
    for _ in range(120):
        force = relaxed(time, np.array([0.2]), np.array([30.0])) + 3e-3 * rng.normal(size=time.size)
        own = fit_relaxation(relaxation_tests([(time, force)]), terms=1)
        curves.append(own.relaxed(at))
        said.append(own.relaxed_error(at))
    np.testing.assert_allclose(np.sqrt(np.mean(np.square(said), 0)), np.std(curves, 0), rtol=0.2)


@pytest.mark.parametrize("count", [1, 2])
def test_as_many_terms_as_the_data_justify(count):
    """Of ten noisy tests at most two have another number than the truth."""
    rng, wrong = np.random.default_rng(count), 0
    tau = np.geomspace(1.0, 1e4, count + 2)[1:-1]
    g = np.full(count, 0.3 / count)
    for _ in range(10):
        force = relaxed(TIME, g, tau) + 2e-3 * rng.normal(size=TIME.size)
        wrong += fit_relaxation(relaxation_tests([(TIME, force)])).g.size != count
    assert wrong <= 2


def test_a_power_law_is_followed_over_all_its_decades():
    """Rubber falls by a few per cent a decade, without an end: one term a decade or so."""
    found = fit_relaxation(relaxation_tests([(TIME, 500.0 * TIME**-0.03)]))
    assert 6 <= found.g.size <= 9
    assert np.abs(found.differences()).max() < 1.5e-3
    assert np.all(found.g > 0.0)
    # the last decade still falls by 1 - 10^-0.03, as is said
    assert found.fall_at_end == pytest.approx(1.0 - 10.0**-0.03, rel=0.1)
    trials = [own["rms"] for own in found.trials]
    assert np.all(np.diff(trials) < 0.0)


def test_a_decade_has_the_weight_of_a_decade():
    """A logger that takes a hundred times as many readings in the last decade: the same fit of a law
    that two terms cannot follow."""
    few = np.geomspace(1.0, 1e4, 81)
    many = np.unique(np.concatenate([few, np.geomspace(1e3, 1e4, 2001)]))
    one, two = (
        fit_relaxation(relaxation_tests([(time, time**-0.05)]), terms=2) for time in (few, many)
    )
    np.testing.assert_allclose(two.tau, one.tau, rtol=0.02)
    np.testing.assert_allclose(two.g, one.g, rtol=0.02)


def test_the_same_call_gives_the_same_bits():
    tests = at_temperatures(
        SHIFTS["wlf"], DEGREES, np.geomspace(1.0, 1e3, 20), shared=False, noise=2e-3
    )
    first, second = fit_relaxation(tests), fit_relaxation(tests)
    np.testing.assert_array_equal(first.unknowns, second.unknowns)


# ---- what cannot be fitted ----


def refused(curves, **options):
    with pytest.raises(MaterialDataError) as raised:
        fit_relaxation(relaxation_tests(curves, source="the file"), **options)
    return str(raised.value)


def test_no_relaxation():
    rising = (TIME, 100.0 + np.log(TIME))
    assert "the file: the test shows no stress relaxation, because the force rises" in refused(
        [rising]
    )
    flat = (TIME, 100.0 + np.random.default_rng(0).normal(size=TIME.size))
    assert "the test shows no stress relaxation" in refused([flat])


def test_a_force_that_falls_to_nothing():
    text = refused([(TIME, np.exp(-TIME / 3e4) + 1e-9)])
    assert (
        "does not determine a long-term modulus: the sum of the relaxing fractions g would be 1"
        in text
    )


def test_too_few_readings():
    curve = ([1.0, 10.0, 100.0, 1e3], [9.0, 8.0, 7.5, 7.4])
    assert "4 readings are too few for the 5 constants of a Prony series with 2 terms" in refused(
        [curve], terms=2
    )


def test_flat_curves_have_no_shift():
    """At 100 degrees all is over before the first reading."""
    time = np.geomspace(1.0, 1e3, 20)
    curves = [(time, relaxed(time, np.array([0.3]), np.array([60.0])), 20.0, "a")]
    curves.append((time, 0.5 + 1e-3 * np.random.default_rng(2).normal(size=20), 100.0, "b"))
    text = refused(curves)
    assert "the shift of the relaxation times from 20 to 100 °C cannot be determined" in text
    # nor from the flat one
    text = refused(curves, reference=100.0)
    assert "the shift of the relaxation times from 100 to 20 °C cannot be determined" in text


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            {"shift": "wlf"},
            "shift wlf can be fitted only to tests at 3 or more temperatures, but data has 0",
        ),
        ({"shift": "vft"}, "shift must be one of .'wlf', 'arrhenius'"),
        (
            {"reference": 23.0},
            "reference temperature .* must be one of the tested temperatures .none is given",
        ),
        (
            {"entropic": True},
            "entropic moduli .* can be fitted only to tests at several temperatures",
        ),
        ({"terms": 0}, "terms must be an integer of at least 1"),
        ({"terms": 2, "tau": [1.0]}, "terms .* and tau .* exclude each other"),
        ({"tau": []}, "tau must be 1 to 12 positive numbers"),
        ({"tau": [1.0, -1.0]}, "tau must be 1 to 12 positive numbers"),
        ({"tau": [1.0, 1.0]}, "must differ from each other"),
    ],
)
def test_wrong_arguments(options, words):
    with pytest.raises(ValueError, match=words):
        fit_relaxation(relaxation_tests([(TIME, relaxed(TIME))]), **options)


def test_constants_without_information_have_infinite_errors():
    """A relaxation time that ends between two readings: g and tau are not determined."""
    time = np.array([1.0, 1e3, 2e3, 4e3, 8e3, 1.6e4])
    found = fit_relaxation(relaxation_tests([(time, relaxed(time, G[:1], TAU[:1]))]), terms=1)
    # exp(-1000) is zero: one reading for g, tau and the instantaneous force
    assert found.standard_errors["g_1"] == found.standard_errors["ln_tau_1"] == np.inf
    assert np.isfinite(found.correlation).all()


@pytest.mark.parametrize("name", [None, *SHIFTS])
def test_table_of_a_seal_file(name):
    """TOML that gives the constants again, to the digits written."""
    if name:
        time = np.geomspace(0.5, 1e4, 40)
        tests = at_temperatures(SHIFTS[name], DEGREES, time, shared=True)
    else:
        tests = relaxation_tests([(TIME, relaxed(TIME))])
    found = fit_relaxation(tests, shift=name)
    text = viscoelastic_table(found, "instantaneous", "skin", ["a note"])
    read = tomllib.loads(text)["material"]["skin"]["viscoelastic"]
    np.testing.assert_allclose(read.pop("g"), found.g, rtol=1e-7)
    np.testing.assert_allclose(read.pop("tau"), found.tau, rtol=1e-7)
    assert read.pop("moduli") == "instantaneous"
    if name:
        assert read.pop(name) == pytest.approx(found.shift.table(), rel=1e-7)
    assert not read
    with pytest.raises(ValueError, match=r"name of a material .*'a b'"):
        viscoelastic_table(found, material="a b")
    with pytest.raises(ValueError, match="moduli must be one of"):
        viscoelastic_table(found, "initial")

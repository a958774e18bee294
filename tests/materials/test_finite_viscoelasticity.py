"""Coefficients of relaxation, the second Piola-Kirchhoff stress and its moduli."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.materials import hoop_stretch
from seal_mdao.materials.viscoelastic import Arrhenius, PronySeries, WilliamsLandelFerry
from seal_mdao.structure.relaxation import CellCoefficients, RelaxationHistory, advanced
from seal_mdao.structure.second_stress import (
    along_gradient,
    green_rates,
    second_stress,
    stress_moduli,
)

SHIFTS = {
    "none": None,
    "wlf": WilliamsLandelFerry(4.0, 150.0, 23.0),
    "arrhenius": Arrhenius(50.0, 23.0),
}
DURATION, TEMPERATURE = np.array([0.3, 40.0]), np.array([60.0, 5.0])


def series(shift, instantaneous) -> PronySeries:
    return PronySeries((0.3, 0.2), (2.0, 150.0), instantaneous, shift)


@pytest.mark.parametrize("instantaneous", [False, True])
@pytest.mark.parametrize("shift", SHIFTS.values(), ids=SHIFTS)
def test_rates_of_coefficients(shift, instantaneous):
    own = series(shift, instantaneous)
    rates, step = own.step_rates(DURATION, TEMPERATURE), 1e-6
    given = own.constants | {"duration": DURATION, "temperature": TEMPERATURE}
    assert set(rates) == set(given) - ({"temperature"} if shift is None else set())

    def at(name, change):
        if name == "duration":
            return own.step(DURATION + change, TEMPERATURE)
        if name == "temperature":
            return own.step(DURATION, TEMPERATURE + change)
        return own.with_(**{name: own.constants[name] + change}).step(DURATION, TEMPERATURE)

    for name, found in rates.items():
        for part, one, other in zip(found, at(name, step), at(name, -step), strict=True):
            # truncation h^2 and rounding eps / h of central differences
            np.testing.assert_allclose(part, (one - other) / (2 * step), rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("instantaneous", [False, True])
@pytest.mark.parametrize("shift", SHIFTS.values(), ids=SHIFTS)
def test_relaxation_function_and_its_rates(shift, instantaneous):
    own, step = series(shift, instantaneous), 1e-6
    value, rates = own.relaxed(DURATION, TEMPERATURE)
    # one strain at the start and steps without change: Q_i+ = a_i Q_i, with Q_i = beta_i S
    keep = own.step(DURATION, TEMPERATURE).keep.prod(axis=1)
    scale = 1.0 if instantaneous else 2.0
    assert value == pytest.approx(scale * (0.5 + np.array([0.3, 0.2]) @ keep), rel=1e-14)
    given = own.constants | {"duration": DURATION, "temperature": TEMPERATURE}
    assert set(rates) == set(given) - ({"temperature"} if shift is None else set())

    def at(name, change):
        if name == "duration":
            return own.relaxed(DURATION + change, TEMPERATURE)[0]
        if name == "temperature":
            return own.relaxed(DURATION, TEMPERATURE + change)[0]
        return own.with_(**{name: own.constants[name] + change}).relaxed(DURATION, TEMPERATURE)[0]

    for name, found in rates.items():
        # of arrays that of each entry
        units = np.eye(2) if name in {"duration", "temperature"} else [1.0]
        slopes = [(at(name, step * u) - at(name, -step * u)) / (2 * step) for u in units]
        np.testing.assert_allclose(np.ravel(found), np.ravel(slopes), rtol=1e-7, atol=1e-9)


def test_coefficients_of_long_and_short_steps():
    own = series(None, False)
    nothing, for_ever = (
        own.step(np.array([0.0]), TEMPERATURE[:1]),
        own.step(np.array([1e6]), TEMPERATURE[:1]),
    )
    # k = 1 / (1 - sum g) and 1, nothing is kept
    assert nothing.factor[0] == pytest.approx(2.0, rel=1e-15)
    assert nothing.factor[0] == pytest.approx(own.short_time_factor, rel=1e-15)
    assert for_ever.factor[0] == pytest.approx(1.0, rel=1e-15)
    np.testing.assert_array_equal(nothing.keep, 1.0)
    assert for_ever.keep.max() < 1e-300
    short = series(None, True)
    assert short.short_time_factor == 1.0
    assert short.step(np.array([1e6]), TEMPERATURE[:1]).factor[0] == pytest.approx(0.5, rel=1e-15)


def test_shifts_over_the_temperature():
    # c1 x / (c2 + x) decades at x = 50 K: 4 * 50 / 200 = 1
    log, _ = SHIFTS["wlf"].log_factor(np.array([73.0]))
    assert np.exp(log[0]) == pytest.approx(0.1, rel=1e-14)
    # E/R (1/T - 1/T_r)
    log, _ = SHIFTS["arrhenius"].log_factor(np.array([100.0]))
    assert log[0] == pytest.approx(50e3 / 8.314462618 * (1 / 373.15 - 1 / 296.15), rel=1e-14)
    with pytest.raises(ValueError, match="only above -127 degC"):
        SHIFTS["wlf"].log_factor(np.array([-127.0]))


@pytest.mark.parametrize(
    ("g", "tau", "words"),
    [((0.5, 0.5), (1.0, 2.0), "sum"), ((0.5,), (1.0, 2.0), "one relaxation"), ((), (), "at least one"),
     ((-0.1,), (1.0,), "negative"), ((0.1,), (0.0,), "above 0"), ((0.1,), (np.inf,), "finite")],
)  # fmt: skip
def test_impossible_series_are_refused(g, tau, words):
    with pytest.raises(ValueError, match=words):
        PronySeries(g, tau)


# ---- S, E, dS/dE ----

LAWS = {
    "mooney_rivlin": sm.MooneyRivlin(80.0, 20.0, 1e4),
    "ogden": sm.Ogden((60.0, -5.0), (2.0, -2.0), 1e4),
    "hyperfoam": sm.Hyperfoam((60.0, 20.0), (4.0, -1.0), (0.2, 0.3)),
}
GRADIENT = np.array([1.2, 0.3, -0.1, 0.9])
"""F_11, F_12, F_21, F_22."""


def state(gradient, h, around):
    """F, J - 1 and h as of ``Deformation``, and T, J, h."""
    f11, f12, f21, f22 = gradient
    j = h * (f11 * f22 - f12 * f21)
    f = np.array([*gradient, j - 1.0, *([h] if around else [])])
    return f, (np.array(gradient @ gradient), np.array(j), *([np.array(h)] if around else []))


def stress(material, gradient, h, around):
    f, own = state(gradient, h, around)
    w = hoop_stretch.derivatives(material, *own)
    return f, second_stress(f, w[0], w[1], *([w[5]] if around else [])), stress_moduli(f, w)


@pytest.mark.parametrize("around", [False, True])
@pytest.mark.parametrize("material", LAWS.values(), ids=LAWS)
def test_stress_is_the_derivative_of_the_energy(material, around):
    """P = F S and P_h = h S_33 against differences of W, dS/dE : E' against differences of S."""
    h, step = (1.15 if around else 1.0), 1e-6
    f, found, moduli = stress(material, GRADIENT, h, around)
    np.testing.assert_allclose(moduli, moduli.T, rtol=1e-13, atol=1e-12 * np.abs(moduli).max())
    p = along_gradient(f, found[:, None])[:, 0]

    def energy(gradient, h):
        return hoop_stretch.energy(material, *state(gradient, h, around)[1])

    for row in range(5 if around else 4):
        change = np.zeros(5)
        change[row] = step
        ends = [(GRADIENT + s * change[:4], h + s * change[4]) for s in (1, -1)]
        quotient = np.subtract(*(energy(*end) for end in ends)) / (2 * step)
        assert p[row] == pytest.approx(quotient, rel=1e-7, abs=1e-7)
        quotient = np.subtract(*(stress(material, *end, around)[1] for end in ends)) / (2 * step)
        rate = np.eye(5)[row, : 5 if around else 4]
        strain = green_rates(f, rate[:, None])[:, 0]
        np.testing.assert_allclose(moduli @ strain, quotient, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("around", [False, True])
def test_second_stress_does_not_turn_with_the_body(around):
    """S of R F is that of F, so what is carried along the path knows no rotation."""
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    turned = (turn @ GRADIENT.reshape(2, 2)).ravel()
    for material in LAWS.values():
        _, one, moduli = stress(material, GRADIENT, 1.15 if around else 1.0, around)
        _, other, after = stress(material, turned, 1.15 if around else 1.0, around)
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12 * np.abs(one).max())
        np.testing.assert_allclose(moduli, after, rtol=1e-12, atol=1e-12 * np.abs(moduli).max())


def test_strain_rates_and_stresses_are_conjugate():
    """S : E' = P : F' for any S."""
    rng = np.random.default_rng(1)
    for around in (False, True):
        f = state(GRADIENT, 1.15, around)[0]
        own, rate = rng.normal(size=3 + around), rng.normal(size=4 + around)
        p = along_gradient(f, own[:, None])[:, 0]
        assert own @ green_rates(f, rate[:, None])[:, 0] == pytest.approx(p @ rate, rel=1e-13)


def test_random_histories_dissipate():
    """The work of Q_i from rest to rest is not negative, for 1,000 random histories of F at J = 1."""
    rng, material = np.random.default_rng(7), sm.MooneyRivlin(80.0, 20.0, 1e4)
    own, parts, count = series(None, False), 25, 1000
    # F = R exp(A) with A symmetric of trace 0: eight random states, ends at 1, the last one a rest
    corners = np.zeros((11, 3, count))
    corners[1:9] = rng.uniform(-0.5, 0.5, (8, 3, count))
    places = np.arange(1, 10 * parts + 1) / parts
    low = np.minimum(places.astype(int), 9)
    within = (places - low)[:, None, None]
    stretch, shear, angle = np.moveaxis(
        (1.0 - within) * corners[low] + within * corners[low + 1], 1, 0
    )
    durations = np.repeat(10.0 ** rng.uniform(-1.0, 2.5, 10), parts) / parts
    size = np.maximum(np.hypot(stretch, shear), 1e-12)
    sinh = np.sinh(size) / size
    u11, u22, u12 = np.cosh(size) + sinh * stretch, np.cosh(size) - sinh * stretch, sinh * shear
    c, s = np.cos(angle), np.sin(angle)
    f = np.stack(
        [c * u11 - s * u12, c * u12 - s * u22, s * u11 + c * u12, s * u12 + c * u22], axis=-1
    )
    history = RelaxationHistory(0.0, np.zeros((1, count, 3)), np.zeros((2, 1, count, 3)))
    work, strain = np.zeros(count), np.zeros((count, 3))
    for now, duration in zip(f, durations, strict=True):
        state = np.concatenate([now, np.zeros((count, 1))], axis=1)
        w = hoop_stretch.derivatives(material, (now**2).sum(axis=1), np.ones(count))
        found = own.step(np.array([duration]), np.zeros(1))
        spread = (
            part[..., None] * np.ones(count) for part in (found.factor, found.keep, found.take)
        )
        after = advanced(
            history, CellCoefficients(*spread), second_stress(state, w[0], w[1])[None], 0.0
        )
        # E = (C - 1) / 2, with 2 E_12, and int Q : dE by the mean of both ends
        f11, f12, f21, f22 = now.T
        green = 0.5 * np.stack(
            [f11**2 + f21**2 - 1.0, f12**2 + f22**2 - 1.0, 2.0 * (f11 * f12 + f21 * f22)], axis=-1
        )
        mean = 0.5 * (history.viscous + after.viscous).sum(axis=0)[0]
        work += (mean * (green - strain)).sum(axis=1)
        history, strain = after, green
    assert work.min() > 0.0

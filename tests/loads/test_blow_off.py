"""The pressure at which a fluid comes through: when it falls, its derivatives, seals that hold."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from fluid_seals import gasket, quotient, states, steps_of

import seal_mdao as sm
from seal_mdao.analysis.path_result import Status
from seal_mdao.errors import LoadPathError
from seal_mdao.measures.fluid import BlowOffPressure
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.profiles import caption

PRESSURE = 1950.0
"""At 2000 kPa a point is so close to the change from stick to slip that quotients go across it."""
NAMES = ("c10", "bulk_modulus", "lid_normal_penalty", "lid_friction", "squeeze", "fluid_pressure")
BLOW_OFF = BlowOffPressure("fluid")


@pytest.fixture(scope="module")
def blown():
    result = sm.analyze(gasket(PRESSURE), keep_factors=True)
    assert result.converged, result.failure
    return result


def table(result, method="adjoint", names=NAMES):
    return sm.differentiate(result, names, [BLOW_OFF], method).blow_off_pressure[0]


def prescribed(result):
    """Load steps with a dry end; no step was cut."""
    assert len(result.path.steps) == len(result.path.nominal_steps)
    return [s for s in result.path.steps if result.response("fluid", s).outputs[-1, 0] == 0.0]


def test_it_is_where_the_fluid_comes_through(blown):
    """Between the last load step with a dry end and the first one without."""
    last = blown.term("fluid").pressure_at(prescribed(blown)[-1].fraction)
    assert 0.0 < last < PRESSURE
    assert last < blown.value(BLOW_OFF)[0] < last + PRESSURE / 20
    assert not BLOW_OFF.missing(blown)


def test_high_pressures_are_written_without_an_exponent():
    seal = gasket(12000.0)
    assert caption(SimpleNamespace(seal=seal), seal.n_steps - 1).endswith(", fluid 12000 kPa")


def test_it_falls_when_the_squeeze_falls():
    values = [
        sm.analyze(gasket(PRESSURE, squeeze=squeeze)).value(BLOW_OFF)[0]
        for squeeze in (0.14, 0.17, 0.2)
    ]
    assert values[0] < 0.85 * values[1] < 0.85 * 0.9 * values[2]


def test_from_the_other_end_it_is_the_same(blown):
    """But for the cloud, which is not its own mirror image: at half the spacing the pressure is 3.6 %
    higher, and the two ends differ by 0.07 %."""
    other = sm.analyze(gasket(PRESSURE, end="start"))
    assert other.value(BLOW_OFF)[0] == pytest.approx(blown.value(BLOW_OFF)[0], rel=0.036)
    push = [result.response("lid").total[0] for result in (blown, other)]
    assert push[0] > 0.0 > push[1]


def test_more_load_steps_say_the_same():
    values = [sm.analyze(gasket(PRESSURE, steps=n)).value(BLOW_OFF)[0] for n in (20, 40)]
    assert values[0] == pytest.approx(values[1], rel=0.002)


def test_direct_and_adjoint_agree(blown):
    direct, adjoint = (table(blown, method) for method in ("direct", "adjoint"))
    assert (np.abs(direct - adjoint) <= 1e-9 * np.abs(direct).max()).all()


@pytest.mark.parametrize(
    "name",
    ["everything", *(pytest.param(n, marks=pytest.mark.long) for n in ("squeeze", "lid_friction"))],
)
def test_derivatives_against_central_differences(blown, rng, name):
    """To 1e-4 of itself, at two steps: the derivative in the friction is small beside its value."""
    names, seal = NAMES, blown.seal
    way = steps_of(seal, names) * rng.uniform(0.5, 1.0, seal.n_offsets + len(names))
    if name != "everything":
        way *= np.arange(way.size) == seal.n_offsets + names.index(name)
    exact = table(blown) @ way
    assert exact != 0.0
    until = states(blown)[: len(prescribed(blown))]
    for step in (1e-4, 2e-5):
        found = quotient(seal, names, step * way, [BLOW_OFF], until)[0] / step
        assert abs(found - exact) <= 1e-4 * abs(exact)


def test_a_seal_that_holds_says_more_than_was_applied():
    """A tenth more, whatever design and load steps: nothing for an optimiser to gain or to fear."""
    result = sm.analyze(gasket(600.0, steps=6))
    assert result.converged
    assert result.value(BLOW_OFF)[0] == pytest.approx(660.0)
    (text,) = (own for own in result.warnings if own.startswith("blow_off_pressure"))
    assert "the complete pressure of the fluid 'fluid', 600 kPa" in text
    for method in ("direct", "adjoint"):
        found = table(result, method)
        assert not found[:-1].any()
        assert found[-1] == pytest.approx(1.1)


def test_a_fluid_that_comes_through_in_the_first_load_step():
    """Straight between what the profiles press with before it comes and what they do then."""
    result = sm.analyze(gasket(4000.0, steps=2))
    before, after = (
        result.response("fluid", step).outputs[:, 1].max()
        for step in result.path.nominal_steps[3:5]
    )
    found = result.value(BLOW_OFF)[0]
    assert 0.0 < found < 2000.0
    assert before + found / 2000.0 * (after - before) == pytest.approx(1.05 * found)


def test_where_nothing_closes_there_is_nothing_to_blow_off():
    result = sm.analyze(gasket(10.0, squeeze=0.5e-3, steps=2))
    assert result.value(BLOW_OFF)[0] == 0.0
    assert not table(result).any()


def test_a_path_that_ends_where_the_seal_gives_way(blown):
    """The line through the last two converged steps ends after a tenth of the pressure."""
    shorter = replace(
        blown.path, steps=prescribed(blown), status=Status.NOT_CONVERGED, failure="so"
    )
    result = replace(blown, path=shorter)
    last = blown.term("fluid").pressure_at(prescribed(blown)[-1].fraction)
    assert last < result.value(BLOW_OFF)[0] <= last + 0.1 * PRESSURE
    direct, adjoint = (table(result, method) for method in ("direct", "adjoint"))
    assert direct[NAMES.index("squeeze") + 4] > 0.0
    assert (np.abs(direct - adjoint) <= 1e-9 * np.abs(direct).max()).all()


def test_a_path_that_ends_afterwards_has_the_pressure_and_its_derivatives(blown):
    """Far more pressure than the body bears: load steps as large as before, until it is crushed."""
    options = sm.NewtonOptions(tolerance=1e-12, max_cuts=0, max_iterations=9, damped_iterations=0)
    result = sm.analyze(replace(gasket(40.0 * PRESSURE, steps=800), newton=options))
    assert not result.converged
    assert result.value(BLOW_OFF)[0] == pytest.approx(blown.value(BLOW_OFF)[0], rel=1e-9)
    np.testing.assert_allclose(table(result)[:-1], table(blown)[:-1], rtol=1e-6)
    with pytest.raises(LoadPathError):
        sm.differentiate(result, NAMES, [Reaction("lid")])


def test_a_path_that_ends_before_has_none():
    result = sm.analyze(gasket(PRESSURE, squeeze=1.9, close=2, steps=2))
    assert not result.converged
    with pytest.raises(LoadPathError, match="could not be completed at load step"):
        result.value(BLOW_OFF)

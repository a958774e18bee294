"""The measure ``time_to_force_fraction``: value, derivatives, and a fraction that is not reached."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from block_files import DESIGN, FIXED, LID, exact_seal, read, text
from quotients import quotients
from test_viscoelastic import HOT, SERIES, SHIFTED, constants, relaxing

import seal_mdao as sm

MEASURES = """\
[[measure]]
type = "time_to_force_fraction"
fraction = 0.68
[[measure]]
type = "time_to_force_fraction"
name = "along_travel"
fraction = 0.9
direction = "travel"
"""
STAGES = """
stage = [
  { translate = [0.1, -0.5], steps = 3, duration = 0.5 }, { steps = 3, duration = 50.0 },
  { steps = 2, duration = 200.0 }, { translate = [0, 0.1], steps = 2, duration = 2.0 },
]
"""
BLOCK = relaxing(
    text(FIXED, LID, DESIGN, MEASURES),
    SHIFTED,
    STAGES,
    HOT.replace("80.0, 80.0", "60.0, 60.0, 60.0"),
)
STEPS = {
    "tau_2": 1e-1, "duration_1": 1e-4, "duration_2": 1e-2, "temperature": 1e-2, "lid_friction": 1e-4,
    "boundary_offsets[1]": 2e-5,
}  # fmt: skip


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    seal = exact_seal(tmp_path_factory.mktemp("time"), BLOCK)
    found = sm.analyze(seal, keep_factors=True)
    found.require_converged()
    return found


def test_the_force_at_this_time_is_the_fraction(result):
    """Linear in the logarithm of time between load steps, as the force at a time is."""
    forces, times = result.path.reaction("lid")[:, 1], result.seal.terms()[0].environment.time
    found = result.value("time_to_force_fraction")[0]
    at = times.at([3, 4, 5, 6, 7, 8]) - 0.5
    assert at[0] < found < at[-1]
    k = int(np.searchsorted(at, found))
    assert forces[2 + k] < 0.68 * forces[2] < forces[1 + k]
    first = times.first[1] if k <= 3 else times.first[2]
    begin = at[0] if k <= 3 else at[3]
    log = np.log(first + np.array([at[k - 1], found, at[k]]) - begin)
    part = (log[1] - log[0]) / (log[2] - log[0])
    force = forces[1 + k] + part * (forces[2 + k] - forces[1 + k])
    assert force == pytest.approx(0.68 * forces[2], rel=1e-12)
    assert result.value("along_travel")[0] < found
    assert not any("decreases only to" in text for text in result.warnings)


@pytest.fixture(scope="module")
def derivatives(result):
    names = constants(result.seal)
    return [sm.differentiate(result, names, None, how) for how in ("direct", "adjoint")]


@pytest.mark.parametrize("name", STEPS)
def test_derivatives_of_the_time(result, derivatives, name):
    direct, adjoint = derivatives
    column = direct.parameters.index(name)
    for measure, (quotient, bound) in quotients(result.seal, name, STEPS[name]).items():
        one, other = (np.atleast_2d(own[measure])[:, column] for own in (direct, adjoint))
        size = np.abs(np.atleast_2d(direct[measure])).max()
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-11 * size)
        assert np.all(np.abs(one - quotient) <= bound), measure
        assert bound.max() <= 1e-4 * max(np.abs(one).max(), np.abs(quotient).max(), 1e-2), measure


def test_a_direction_that_turns_with_the_motion(result):
    """Along the travel of the lid, whose first stage has a parameter across it."""
    structure, contact, *others = result.seal.definitions
    rates = np.zeros((1, *contact.motion.rates.shape[1:]))
    rates[0, 1:, 0] = 1.0
    motion = replace(contact.motion, rates=rates, names=("across",))
    seal = replace(result.seal, definitions=(structure, replace(contact, motion=motion), *others))
    swept = sm.analyze(seal, keep_factors=True)
    quotient, bound = (own.item() for own in quotients(seal, "across", 1e-4)["along_travel"])
    for how in ("direct", "adjoint"):
        found = sm.differentiate(swept, ("across",), None, how)
        exact = np.ravel(found["along_travel"])[found.parameters.index("across")]
        assert abs(exact - quotient) <= bound
        assert bound <= 1e-4 * abs(exact)


def test_a_fraction_that_is_not_reached_is_no_number(tmp_path):
    given = BLOCK.replace("fraction = 0.68", "fraction = 0.1")
    result = sm.analyze(exact_seal(tmp_path, given), keep_factors=True)
    forces = result.path.reaction("lid")[:, 1]
    assert np.isnan(result.value("time_to_force_fraction")[0])
    for method in ("direct", "adjoint"):
        rates = sm.differentiate(result, ("c10",), method=method)
        assert np.isnan(rates.time_to_force_fraction).all()
        assert np.isfinite(rates.reaction).all()
    (said,) = [text for text in result.warnings if "decreases only to" in text]
    assert (
        f"within the dwell of 250 s the force decreases only to {forces[7] / forces[2]:.4g} of"
        in said
    )
    with pytest.raises(
        sm.LoadPathError, match=r"time_to_force_fraction cannot be evaluated: .*decreases only to"
    ):
        result.admissible_values(result.measures())


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("fraction = 0.68", "fraction = 1.5", "fraction"),
        ("fraction = 0.68", "fraction = 0.68\nstage = 3", "the next stage is not a dwell"),
        ("fraction = 0.68", "fraction = 0.68\nstage = 4", "the next stage is not a dwell"),
        ("fraction = 0.68", "fraction = 0.68\nstage = 9", "but the motion has only 4 stages"),
        ("fraction = 0.68", "fraction = 0.68\ntravel = 0.2", "travel and stage are given together"),
        ("fraction = 0.68", "stage = 1", "the key 'fraction' is missing"),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path, old, new, words):
    with pytest.raises(sm.SealFileError, match=words):
        read(tmp_path, BLOCK.replace(old, new))


def test_a_seal_that_does_not_relax_has_none(tmp_path):
    with pytest.raises(sm.SealFileError, match="needs a viscoelastic material"):
        read(tmp_path, text(FIXED, LID, MEASURES))


def test_chosen_load_steps_resolve_the_time(tmp_path):
    """Also in a dwell, in which displacements hardly change."""
    few = "\nstage = [{ translate = [0, -0.5], duration = 0.1 }, { duration = 1e6 }]\n"
    many = few.replace("0.1 }", "0.1, steps = 32 }").replace("1e6 }", "1e6, steps = 160 }")
    block = text(FIXED, LID, '[[measure]]\ntype = "time_to_force_fraction"\nfraction = 0.65\n')
    times = [
        sm.analyze(sm.build_seal(read(tmp_path, relaxing(block, SERIES, stages)))).value(
            "time_to_force_fraction"
        )[0]
        for stages in (few, many)
    ]
    assert times[0] == pytest.approx(times[1], rel=0.01)


@pytest.mark.long
def test_chosen_load_steps_before_the_dwell_are_short_enough(tmp_path):
    """An error of 0.1 % of the force at the beginning of the dwell is one of 2 % of the time."""
    few = (Path(__file__).parent / "warm_lip.toml").read_text(encoding="utf-8")
    many = few.replace("duration = 0.1 }", "duration = 0.1, steps = 128 }").replace(
        "1000.0 }", "1000.0, steps = 240 }"
    )
    times = [
        sm.analyze(sm.build_seal(read(tmp_path, own))).value("time_to_force_fraction")[0]
        for own in (few, many)
    ]
    assert times[0] == pytest.approx(times[1], rel=0.005)

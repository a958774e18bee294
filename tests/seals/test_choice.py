"""Load steps and penalties by tolerance: the promised errors hold, and derivatives stay exact."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from two_profiles import two_profiles

import seal_mdao as sm
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.work import StrainEnergy
from seal_mdao.seals import adjusted_penalties, steps_and_penalties
from seal_mdao.seals.door.door_seal import options_of, with_options
from seal_mdao.seals.penalty_error import SMALL, Penalty, least_scale
from seal_mdao.seals.profiles import profile_histories
from seal_mdao.seals.refined_steps import divided, force_difference, measure_difference
from seal_mdao.seals.result import UNUSABLE, Known, analyze_particles
from seal_mdao.seals.settings import seal_of
from seal_mdao.seals.steps_and_penalties import choose

TOLERANCE = 5e-3
SHORT = {"depth": 6.5, "start": 10.03}


@pytest.fixture(scope="module")
def chosen():
    return sm.door_seal(steps="auto", step_tolerance=TOLERANCE, **SHORT)


def test_measures_are_within_the_tolerance_of_four_times_as_many(chosen):
    ends = np.array(options_of(chosen).step_ends)
    finer = tuple(divided(ends, 4).tolist())
    coarse = sm.analyze(chosen)
    fine = sm.analyze(with_options(chosen, n_steps=len(finer), step_ends=finer))
    assert measure_difference(coarse, fine) <= TOLERANCE
    assert force_difference(coarse, fine, np.arange(3, len(finer), 4)) <= TOLERANCE


def test_as_many_equal_steps_are_further_off(chosen):
    """They are small where contact needs it: less error of the gaps than equal steps."""
    n = chosen.n_steps
    lengths = np.diff(options_of(chosen).step_ends, prepend=0.0)
    assert lengths.max() >= 2.0 * lengths.min()
    equal = sm.door_seal(n_steps=n, **SHORT)
    finest = sm.analyze(with_options(equal, n_steps=16 * n))
    errors = []
    for seal in (chosen, equal):
        result = sm.analyze(seal)
        errors.append(abs(result.gap_square_sum / finest.gap_square_sum - 1.0))
    assert errors[0] < errors[1]


def test_derivatives_with_unequal_steps(chosen, rng):
    offsets = 0.02 * rng.uniform(-1.0, 1.0, 25)
    seal = with_options(chosen, newton=sm.NewtonOptions(tolerance=1e-12))
    result = sm.analyze(seal, offsets, keep_factors=True)
    direct, adjoint = (
        sm.differentiate(result, ("depth", "door_radius"), method=m) for m in ("direct", "adjoint")
    )
    for name in ("von_mises", "reaction", "gap"):
        a, b = getattr(direct, name), getattr(adjoint, name)
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-9 * np.abs(a).max())
    depth, step = options_of(seal).depth, 1e-5
    sides = [sm.analyze(seal, offsets, {"depth": depth + s * step}) for s in (1.0, -1.0)]
    quotient = (sides[0].reaction[-1] - sides[1].reaction[-1]) / (2.0 * step)
    # rounding of the force (relative 1e-12) over the step, and the step squared
    np.testing.assert_allclose(
        direct.reaction[:, direct.parameters.index("depth")], quotient, rtol=1e-5
    )


def test_division_keeps_the_ends():
    ends = np.array([0.3, 0.5, 1.0])
    np.testing.assert_allclose(divided(ends, [1, 1, 2]), [0.3, 0.5, 0.75, 1.0])
    assert set(ends) <= set(divided(ends, 4))


def test_a_tolerance_that_is_not_reached_is_told(monkeypatch):
    monkeypatch.setattr("seal_mdao.seals.refined_steps.ROUNDS", 2)
    choice = choose(sm.door_seal(n_steps=1, **SHORT), 1e-9, coarse=8)
    assert 16 < len(choice.ends) == choice.seal.n_steps <= 32
    assert choice.seal.step_error == choice.step_error > 1e-9
    (text,) = choice.seal.warnings
    assert text.startswith(
        f"{len(choice.ends)} load steps cause an estimated error of {choice.step_error:.1%}"
    )
    # the path of the last round is the analysis
    result = sm.analyze(choice.seal)
    assert text in result.warnings
    assert result.trustworthy == (choice.step_error <= UNUSABLE)
    assert not replace(result, seal=replace(result.seal, step_error=2.0 * UNUSABLE)).trustworthy


def jumping(error):
    """Differences of two paths that do not fall with the steps."""
    return lambda coarse, fine, at, by_penalties=False: error


def test_divisions_end_where_they_do_not_help(monkeypatch):
    monkeypatch.setattr("seal_mdao.seals.refined_steps.difference", jumping(0.2))
    seal = sm.door_seal(n_steps=1, depth=0.6)
    choice = choose(seal, TOLERANCE, coarse=1)
    # three divisions of all or most of the steps: the third error is not half of the first
    assert choice.step_error >= 0.2
    assert len(choice.ends) <= 8
    # of first order: no end before the tolerance
    errors = iter(0.2 * 0.5 ** np.arange(12))
    monkeypatch.setattr(
        "seal_mdao.seals.refined_steps.difference", lambda *given, **options: next(errors)
    )
    assert choose(seal, 0.01, coarse=1).step_error <= 0.02


def test_errors_that_rise_at_first_do_not_end_the_divisions(monkeypatch):
    """As those of a lip whose tip begins to slide within a long load step."""
    errors = iter([7.6e-3, 1.96e-2, 1.25e-2, 5.75e-3, 2.3e-5, 1e-6])
    monkeypatch.setattr(
        "seal_mdao.seals.refined_steps.difference", lambda *given, **options: next(errors)
    )
    choice = choose(sm.door_seal(n_steps=1, depth=0.6), TOLERANCE, coarse=1)
    assert choice.step_error <= TOLERANCE
    assert choice.seal.step_error == 0.0


def test_a_seal_that_stands_free_at_the_end_is_compared_with_its_path():
    """Closed and opened again: force, energy and contact are zero but for rounding at the end."""
    energy = StrainEnergy()
    seal = replace(two_profiles(0.0, steps=1, way="back"), standard=(energy,))
    choice = choose(seal, TOLERANCE, coarse=12)
    assert choice.step_error <= TOLERANCE
    assert set(range(1, seal.n_steps + 1)) <= set(choice.ends)
    end = sm.analyze(seal.with_ends(choice.ends))
    assert end.value(energy)[0] < 1e-9 * least_scale(energy, end) / SMALL


def test_one_component_of_a_force_is_compared_with_all_of_it():
    """A flat door without friction is pressed straight up: what is across is rounding."""
    across = Reaction("door", components=(0,))
    fine = sm.analyze(sm.door_seal(door="flat", friction=0.0, depth=1.0, n_steps=8))
    up = fine.path.reaction("door")[:, 1].max()
    assert abs(fine.value(across)[0]) < 1e-6 * up
    assert least_scale(across, fine) == up


def test_a_door_in_chosen_steps_has_one_stage(chosen):
    result = sm.analyze(chosen)
    (history,) = profile_histories(result)
    assert set(history.stage) == {1}
    np.testing.assert_allclose(
        history.travel,
        options_of(chosen).motion.ends * options_of(chosen).motion.travel,
        rtol=1e-12,
    )


def test_settings_keep_supports_and_steps():
    seal = sm.door_seal(accuracy="engineering", n_steps=2, step_ends=(0.25, 1.0))
    again = seal_of(seal.settings())
    assert again.key == seal.key
    assert again.settings() == seal.settings()


@pytest.mark.parametrize(
    ("name", "options"),
    [("accuracy", {"accuracy": "best"}), ("steps", {"steps": "few"}),
     ("step_ends", {"n_steps": 2, "step_ends": (0.5, 0.9)}),
     ("step_ends", {"n_steps": 3, "step_ends": (0.5, 1.0)}),
     ("step_ends", {"n_steps": 2, "step_ends": (0.0, 1.0)}),
     ("support", {"support": (2.0,)}), ("support", {"support": (2.0, 0.9)})],
)  # fmt: skip
def test_wrong_options_are_refused_by_name(name, options):
    with pytest.raises(ValueError, match=name):
        sm.door_seal(**options)


@pytest.mark.parametrize("same", [1, 9, 20])
def test_a_path_resumed_after_common_steps_has_the_same_bits(same):
    """The steps after ``same`` are halved: resumed, and from the beginning."""
    seal = sm.door_seal(n_steps=24, **SHORT)
    ends = np.arange(1.0, 25.0)
    finer = divided(ends, np.where(np.arange(24) < same, 1, 2))
    states, particles = {}, seal.nominal_particles
    analyze_particles(seal.with_ends(ends), particles, known=Known(states=states))
    assert list(states) == list(range(1, 25))
    fresh, further, reported = seal.with_ends(finer), {}, []
    resumed = analyze_particles(
        fresh,
        particles,
        callback=reported.append,
        known=Known(resume=states[same], states=further),
    ).path
    complete = analyze_particles(fresh, particles).path
    # no step of the first ones is solved again, all are reported
    assert list(further) == list(range(same + 1, len(finer) + 1))
    assert len(reported) == len(finer)
    assert all(a is b for a, b in zip(resumed.steps, states[same].steps, strict=False))
    assert resumed.step_cuts == complete.step_cuts
    for a, b in zip(resumed.steps, complete.steps, strict=True):
        assert a.d.tobytes() == b.d.tobytes()
        assert (a.residuals, a.nominal, a.fraction, a.stable) == (
            b.residuals, b.nominal, b.fraction, b.stable
        )  # fmt: skip


def test_a_choice_resumes_after_the_steps_that_it_does_not_divide(monkeypatch):
    """With the derivatives at hand, and only where the penalties are the same."""
    resumed = []

    def solved(*arguments, known, **options):
        resumed.append(0 if known.resume is None else len(known.resume.steps))
        return analyze_particles(*arguments, known=known, **options)

    monkeypatch.setattr(steps_and_penalties, "analyze_particles", solved)
    seal = sm.door_seal(n_steps=1, **SHORT)
    found = choose(seal, TOLERANCE)
    assert resumed[0] == 0
    assert max(resumed) > 0
    # the ends that were divided last come after those that were taken
    assert found.ends[resumed[-1] - 1] < found.ends[-1]


def _raise_groups(monkeypatch, too_costly):
    """Raise two groups that err by a factor of 4 until ``too_costly`` (seal) stops it.

    Returns the chosen penalties and the penalties of every path; a seal is its penalties here.
    """
    paths, groups = [], [frozenset({"rigid"}), frozenset({"itself"})]

    class Penalties(dict):
        def with_parameters(self, raised):
            return Penalties(self | raised)

    def run(seal, ends, more):
        paths.append(dict(seal))
        return seal

    replaced = {
        "_groups": lambda seal, names: [group for group in groups if group <= set(names)],
        "adjusted_penalties": lambda seal, names, tolerance: {
            name: 4.0 for name in names if seal[name] < 4.0
        },
        "is_too_costly": lambda result, before: too_costly(result),
        "with_own_parameters": lambda seal: seal,
    }
    for name, function in replaced.items():
        monkeypatch.setattr(adjusted_penalties, name, function)
    seal = Penalties(rigid=1.0, itself=1.0)
    found, _ = adjusted_penalties.with_adjusted_penalties(seal, seal, frozenset(seal), 1.0, run)
    return dict(found), paths


def test_penalties_of_rigid_contacts_and_self_contact_are_raised_in_one_path(monkeypatch):
    found, paths = _raise_groups(monkeypatch, lambda seal: False)
    assert found == {"rigid": 4.0, "itself": 4.0}
    assert paths == [found]


def test_penalties_that_converge_badly_do_not_keep_back_the_others(monkeypatch):
    found, _ = _raise_groups(monkeypatch, lambda seal: seal["itself"] > 1.0)
    assert found == {"rigid": 4.0, "itself": 1.0}
    found, _ = _raise_groups(monkeypatch, lambda seal: seal["rigid"] > 1.0)
    assert found == {"rigid": 1.0, "itself": 4.0}


@pytest.mark.parametrize(
    ("iterations", "excess", "force", "factor"),
    [
        (12.0, 0.05, 1.0, 0.075),  # 1.5 x 0.05: two thirds of the tolerance remain as error
        (12.0, 1e-4, 1.0, 1.0 / 30.0),  # no lower at once
        (12.0, 0.2, 1.0, None),  # an error that is not far below the tolerance
        (8.0, 0.05, 1.0, None),  # iterations that converge well
        (12.0, 0.05, 0.0, None),  # no contact at the end, where errors are estimated
        (12.0, 2.0, 0.0, 3.0),  # raised all the same
    ],
)
def test_penalties_with_which_iterations_converge_badly_are_lowered(
    monkeypatch, iterations, excess, force, factor
):
    values, tolerance = {"normal": 4e5, "tangent": 1e4}, 1e-3
    replaced = {
        "_groups": lambda seal, names: [frozenset(names)],
        "relative_error": lambda result, names: excess * tolerance,
        "penalty_values": lambda seal, names: values,
        "most_penalty": lambda seal: 1e12,
        "penalties_of": lambda seal: [Penalty(name, name, "plate", 1.0) for name in values],
    }
    for name, function in replaced.items():
        monkeypatch.setattr(adjusted_penalties, name, function)
    # three load steps, one of them with most of the iterations
    result = SimpleNamespace(
        seal=None,
        newton_iterations=np.array([4.0, 4.0, 3.0 * iterations - 8.0]),
        path=SimpleNamespace(
            nominal_steps=[
                SimpleNamespace(responses=[SimpleNamespace(force=np.array([0.0, force]))])
            ],
            index_of=lambda label: 0,
        ),
    )
    found = adjusted_penalties.adjusted_penalties(result, values, tolerance)
    expected = {} if factor is None else {key: own * factor for key, own in values.items()}
    # two significant digits
    assert found == pytest.approx(expected, rel=0.05)

"""Increments that leave the path: found by the energy that is left over, halved, and reported."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from energy_bounds import energy_bounds

import seal_mdao as sm
from seal_mdao.analysis import limit_points, load_path
from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.jumps import jump_of, without_gain
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.path_result import Status
from seal_mdao.contact.friction import OPEN, SLIP, STICK, ContactHistory, ContactLaw

LIP = Path(__file__).parents[2] / "examples" / "slipping_lip.toml"
TRAVEL = 9.0
FRICTIONS = (0.0, 0.02, 0.3)
FURTHER_FRICTIONS = (1e-4, 1e-3, 0.01, 0.05, 0.1, 0.15, 0.2)
WITHIN = 0.02
"""Of force and of the travel of the jump, between numbers of load steps."""


@cache
def lip(tmp, friction, n_steps, points="particles"):
    text = LIP.read_text(encoding="utf-8")
    text = text.replace("friction = 0.0\n", f'friction = {friction}\ncontact_points = "{points}"\n')
    path = tmp / f"lip_{friction}_{n_steps}_{points}.toml"
    path.write_text(text.replace("steps = 72", f"steps = {n_steps}"), encoding="utf-8")
    return sm.analyze(sm.build_seal(sm.read_seal_file(path)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("lips")


def curve(result, every=1):
    """Travel, force along it and states of all points at every so many nominal steps."""
    force = result.path.reaction("rod")[:, 0]
    states = np.array([own.branch for own in result.path.at_nominal("rod")])
    travel = TRAVEL * np.arange(1, len(force) + 1) / len(force)
    return travel[every - 1 :: every], force[every - 1 :: every], states[every - 1 :: every]


def agree(results):
    """Forces up to the first limit point, its travel, and where the last one lets go of the lip.

    A point that lands sticks for one load step, however long that is: forces are compared where all
    runs have the same points in contact, in the same state. The force has no bound on its slope at a
    limit point, so they are compared up to where that point lies within the tolerance of its travel.
    """
    assert all(result.converged for result in results), [r.failure for r in results]
    firsts, lasts = zip(
        *((r.critical_points[0].travel, r.critical_points[-1].travel) for r in results), strict=True
    )
    assert max(firsts) <= (1.0 + WITHIN) * min(firsts)
    assert max(lasts) <= (1.0 + WITHIN) * min(lasts)
    travel, force, states = curve(results[0])
    for result in results[1:]:
        every = len(result.path.nominal_steps) // len(travel)
        _, other, its = curve(result, every)
        same = (states == its).all(axis=1)
        before = travel < (1.0 - WITHIN) * min(firsts)
        assert same[before].mean() > 0.8
        assert np.abs(other - force)[before & same].max() <= WITHIN * np.abs(force[before]).max()


@pytest.mark.parametrize("friction", [1e-4, 0.05])
def test_the_lip_lets_go_where_it_does_with_smaller_steps(folder, friction):
    """With 72 steps it sprang back at 5.5 mm, without a word."""
    agree([lip(folder, friction, n_steps) for n_steps in (72, 144)])


@pytest.mark.parametrize(
    "friction",
    [
        *(pytest.param(own, marks=pytest.mark.long) for own in FRICTIONS),
        *(pytest.param(own, marks=pytest.mark.release) for own in FURTHER_FRICTIONS),
    ],
)
def test_the_lip_lets_go_at_one_travel(folder, friction):
    agree([lip(folder, friction, n_steps) for n_steps in (72, 144, 288)])


def test_no_motion_leads_to_more_energy_than_the_loading_supplies(folder):
    """With contact at averages, descent found folded material with 96 mJ/m more at 3.6 mm."""
    one, other = (lip(folder, 0.3, 72, points) for points in ("averages", "particles"))
    assert one.converged
    _, most, work = energy_bounds(one.path).T
    assert (-most <= work).all()
    (jump,), (its,) = one.critical_points, other.critical_points
    assert jump.travel == pytest.approx(its.travel, rel=WITHIN)


def test_a_point_that_alternates_between_open_and_stick_passes_through_slip(folder):
    """At 3.6 mm the next point of the lip lands and slips. Iterations that passed over slip cycled, in
    every part of the step, and with other rounding the path left its branch there."""
    path = lip(folder, 0.3, 72, "averages").path
    (step,) = (own for own in path.steps if own.fraction == 29.0)
    (before,) = (own for own in path.steps if own.fraction == 28.0)
    branch, its = (own.responses[path.index_of("rod")].branch for own in (step, before))
    landed = np.flatnonzero((branch != OPEN) & (its == OPEN))
    assert branch[landed].tolist() == [SLIP]
    # Newton's and mixed iterations of the whole step, both at most twice
    assert step.iterations <= 4 * sm.NewtonOptions().max_iterations


def test_a_path_that_only_gains_energy_ends_with_the_reason(folder, monkeypatch):
    """Descent alone finds an equilibrium, one of ten steps later."""
    path = lip(folder, 0.05, 72).path
    last, later, correct = path.steps[10], path.steps[20], load_path.corrected
    lost = Solution(Status.NOT_CONVERGED, np.zeros(1), (1.0,))

    def corrected(increment, guess):
        return correct(increment, guess) if increment.target <= last.fraction else lost

    def descend(increment, guess):
        far = increment.evaluate(later.d, tangent=False)
        return Solution(Status.CONVERGED, far.d, (far.size,), far)

    monkeypatch.setattr(load_path, "corrected", corrected)
    monkeypatch.setattr(limit_points, "relax", lambda increment, guess: lost)
    monkeypatch.setattr(limit_points, "descend", descend)
    ended = solve_path(path.problem, 72)
    assert not ended.converged
    assert ended.steps[-1].fraction == last.fraction
    assert "stores more energy than the loading supplies" in ended.damped


def test_a_state_that_stores_more_than_the_loading_supplies_is_no_step(folder):
    path = lip(folder, 0.05, 72).path
    last, later = path.steps[10], path.steps[20]
    target = last.fraction + 0.1
    increment = Increment(path.problem, target, last.after, sm.NewtonOptions(), last)
    far = increment.evaluate(later.d, tangent=False)
    assert jump_of(increment, far, last.d) is Status.GAINED
    found = without_gain(increment, Solution(Status.CONVERGED, far.d, (), far))
    assert found.status is Status.GAINED
    # less than half of a step from one step to the next is none
    near = increment.evaluate(last.d, tangent=False)
    assert jump_of(increment, near, 2.0 * last.d) is None


def test_elastic_slip_gives_back_no_more_than_it_stored():
    law = ContactLaw(1e4, 200.0, 0.5)
    before = ContactHistory(np.array([STICK, SLIP, OPEN]), np.array([[0.0, 1.0, 0.3]] * 3))
    after = ContactHistory(np.array([SLIP, OPEN, OPEN]), np.array([[0.0, 1.0, 0.1]] * 3))
    work = law.least_friction_work(before, after, np.array([1.0, 2.0, 4.0]))
    # w_t/2 (l1 s1^2 - l1 s1_0^2 - l2 s2_0^2)
    assert work == pytest.approx(100.0 * (0.01 - 0.09 - 2.0 * 0.09), rel=1e-14)


def test_the_limit_point_tells_what_is_released(folder):
    """About all that was stored a step before: nothing holds the tip in the end."""
    result = lip(folder, 1e-4, 72)
    (jump,) = result.critical_points
    before = [step for step in result.path.steps if step.fraction <= jump.fraction][-1]
    stored = result.term("structure").energy(before.d, before.fraction)
    assert jump.kind == "limit"
    assert jump.released == pytest.approx(stored, rel=0.05)
    assert stored > 10.0
    assert jump.moved > 5.0
    assert "releases at least 19 mJ/m" in jump.text


def test_a_path_of_equilibria_releases_nothing(nominal, frictionless):
    """And costs no step: the bound is never positive, in slip and in stick."""
    for result in (nominal, frictionless):
        least, most, work = energy_bounds(result.path).T
        assert least.max() <= 1e-9 * work.max()
        assert (least < 0.0).sum() > 20
        # and gains nothing
        assert (-most <= work).all()
    # bounds of long increments enclose those of short ones
    short, long = (
        energy_bounds(nominal.path).reshape(-1, 5, 3).sum(axis=1),
        energy_bounds(nominal.path, 5),
    )
    assert (long[:, 0] <= short[:, 0]).all()
    assert (long[:, 1] >= short[:, 1]).all()
    assert nominal.step_cuts == 0


def test_steps_that_the_predictor_meets_cost_nothing(monkeypatch):
    """Energies are looked at where the predictor misses more than 3 % of the step alone."""
    asked = []
    found = load_path.jump_of.__globals__["released_energy"]
    monkeypatch.setitem(
        load_path.jump_of.__globals__, "released_energy", lambda *a: asked.append(a) or found(*a)
    )
    assert len(sm.analyze(sm.door_seal()).path.steps) == 105
    assert 0 < len(asked) < 12


def test_the_primary_branch_is_followed_as_far_as_newton_goes(folder, tmp_path):
    """No increment is refused there; the lip springs back early again."""
    text = LIP.read_text(encoding="utf-8").replace("friction = 0.0\n", "friction = 0.01\n")
    path = tmp_path / "primary.toml"
    path.write_text(text, encoding="utf-8")
    seal = sm.build_seal(sm.read_seal_file(path))
    primary = sm.analyze(replace(seal, newton=sm.NewtonOptions(branch="primary")))
    assert (
        np.flatnonzero(curve(primary)[1])[-1] < np.flatnonzero(curve(lip(folder, 0.01, 72))[1])[-1]
    )

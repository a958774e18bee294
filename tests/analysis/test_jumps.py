"""Increments that leave the path: found by the energy that is left over, halved, and reported."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from energy_bounds import energy_bounds

import seal_mdao as sm
from seal_mdao.analysis import load_path

LIP = Path(__file__).parents[2] / "examples" / "slipping_lip.toml"
TRAVEL = 9.0
FRICTIONS = (0.0, 1e-4, 1e-3, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3)
WITHIN = 0.02
"""Of force and of the travel of the jump, between numbers of load steps."""


@cache
def lip(tmp, friction, n_steps):
    text = LIP.read_text(encoding="utf-8")
    text = text.replace("friction = 0.0\n", f"friction = {friction}\n")
    path = tmp / f"lip_{friction}_{n_steps}.toml"
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


@pytest.mark.long
@pytest.mark.parametrize("friction", FRICTIONS)
def test_the_lip_lets_go_at_one_travel(folder, friction):
    agree([lip(folder, friction, n_steps) for n_steps in (72, 144, 288)])


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
        released, work = energy_bounds(result.path).T
        assert released.max() <= 1e-9 * work.max()
        assert (released < 0.0).sum() > 20
    assert nominal.step_cuts == 0


def test_steps_that_the_predictor_meets_cost_nothing(monkeypatch):
    """Energies are looked at where the predictor misses more than 3 % of the step alone."""
    asked = []
    found = load_path.jumped.__globals__["released_energy"]
    monkeypatch.setitem(
        load_path.jumped.__globals__, "released_energy", lambda *a: asked.append(a) or found(*a)
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

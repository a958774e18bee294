"""Rules by which the energy balance finds jumps, for given bounds of the released energy."""

from types import SimpleNamespace

import numpy as np
import pytest

from seal_mdao.analysis import jumps
from seal_mdao.analysis.jumps import FAR_AWAY, SMALL_BEND, is_far, jump_of, without_gain
from seal_mdao.analysis.path_result import Status
from seal_mdao.terms.term import ReleasedEnergy

EXTENT, ROUNDING = 10.0, 1e-9
AHEAD = 0.5
"""Predicted increment, larger than ``FAR_AWAY`` of the body."""
GUESS = np.array([[AHEAD, 0.0], [0.0, 0.0]])


@pytest.fixture
def judged(monkeypatch):
    """Judge an equilibrium that the predictor misses by a distance, with the bounds given."""
    particles = np.array([[0.0, 0.0], [EXTENT, 3.0]])
    problem = SimpleNamespace(
        rounding=ROUNDING, discretization=SimpleNamespace(particles=particles)
    )
    increment = SimpleNamespace(
        problem=problem, target=1.0, last=SimpleNamespace(d=np.zeros((2, 2)))
    )

    def judge(missed, least, most, work):
        bounds = ReleasedEnergy(least, most, work)
        monkeypatch.setattr(jumps, "released_energy", lambda *given: bounds)
        d = GUESS + np.array([[0.0, missed], [0.0, 0.0]])
        return jump_of(increment, SimpleNamespace(d=d), GUESS)

    judge.increment = increment
    return judge


def test_increments_that_the_predictor_meets_are_not_judged(judged):
    assert judged(0.99 * SMALL_BEND * AHEAD, 5.0, 6.0, 1.0) is None
    assert judged(1.01 * SMALL_BEND * AHEAD, 5.0, 6.0, 1.0) is Status.JUMPED


def test_near_equilibria_may_miss_the_work_of_the_loading(judged):
    near = 0.9 * AHEAD
    assert judged(near, 1.1, 2.0, 1.0) is Status.JUMPED
    assert judged(near, 0.9, 2.0, 1.0) is None
    # bounds on both sides of zero say nothing, however wide
    assert judged(near, -5.0, 0.5, 1.0) is None
    assert judged(near, -5.0, -0.9, 1.0) is None
    assert judged(near, -5.0, -1.1, 1.0) is Status.GAINED


def test_far_equilibria_may_miss_rounding_only(judged):
    far, error = 1.1 * AHEAD, ROUNDING * EXTENT
    assert judged(far, 1.1 * error, 2.0, 1.0) is Status.JUMPED
    assert judged(far, 0.9 * error, 2.0, 1.0) is None
    assert judged(far, -5.0, -0.9 * error, 1.0) is None
    assert judged(far, -5.0, -1.1 * error, 1.0) is Status.GAINED


def test_far_is_beyond_the_increment_and_a_part_of_the_body(judged):
    d = lambda missed, guess: guess + np.array([[0.0, 0.0], [missed, 0.0]])  # noqa: E731
    still, least = 1e-3 * GUESS, FAR_AWAY * EXTENT
    for guess, most in ((GUESS, AHEAD), (still, least)):
        assert not is_far(judged.increment, d(0.99 * most, guess), guess)
        assert is_far(judged.increment, d(1.01 * most, guess), guess)


@pytest.mark.parametrize(("most", "status"), [(-0.9, "CONVERGED"), (-1.1, "GAINED")])
def test_equilibria_with_more_energy_than_supplied_are_not_accepted(
    judged, monkeypatch, most, status
):
    bounds = ReleasedEnergy(-5.0, most, 1.0)
    monkeypatch.setattr(jumps, "released_energy", lambda *given: bounds)
    found = jumps.Solution(Status.CONVERGED, GUESS, (0.0,), SimpleNamespace(d=GUESS))
    assert without_gain(judged.increment, found).status is Status[status]

"""Points that begin to touch: what is predicted of them, and what it spares."""

import numpy as np
import pytest
from verification.differences import contact_states

import seal_mdao as sm
from seal_mdao.analysis import load_path, predictor
from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.predictor import predict
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.touching import TOLERANCE, at_rest_where_it_touches


@pytest.fixture(scope="module")
def result():
    """Few steps: many points begin to touch in one."""
    return sm.analyze(sm.door_seal(rays=116, n_steps=16, depth=6.0))


def predicted(result, nominal):
    """Euler's predictor of a nominal step, what is made of it, and the increment."""
    path = result.path
    problem, last = PathProblem(path.discretization, result.seal.terms()), path.steps[nominal - 1]
    increment = Increment(
        problem, nominal + 1.0, last.after, result.seal.newton, last, problem.factorize_at(last)
    )
    euler = predict(increment)[0]
    return euler, at_rest_where_it_touches(increment, euler), increment


def answer(increment, d):
    """Response of the door at displacements ``d``."""
    return increment.evaluate(d, tangent=False).responses[1]


def first_touch(result):
    return int(np.argmax(contact_states(result).any(axis=1)))


def test_of_the_points_that_the_door_would_meet_those_touch_that_do(result):
    step = first_touch(result)
    assert step > 0
    euler, found, increment = predicted(result, step)
    met, touching = (answer(increment, d).branch for d in (euler, found))
    converged = contact_states(result)[step] != 0
    assert np.count_nonzero(met) > 5 * np.count_nonzero(converged)
    np.testing.assert_array_equal(touching != 0, converged)
    off, before = (np.abs(d - result.path.steps[step].d).max() for d in (found, euler))
    assert off < 0.05 * before


def test_the_body_is_linear_and_the_contact_law_is_not(result):
    """K (d - guess) + P^T f(d) = 0, with K of the last step and all of f."""
    began = np.flatnonzero(np.diff(np.count_nonzero(contact_states(result), axis=1)) > 0) + 1
    assert began.size > 3
    for step in began:
        euler, found, increment = predicted(result, step)
        problem, last = increment.problem, increment.last
        term, layout = problem.terms[1], problem.discretization.layout
        now = answer(increment, found)
        new = (last.responses[1].branch == 0).astype(int)
        load = term.point_loads(now.force, new * now.branch)
        layout.condense_force(load)
        moved = layout.gather(increment.factor.solve(load[: layout.n_equations]))
        scale = np.abs(moved).max()
        assert scale > 0.0
        np.testing.assert_allclose(euler - found, moved, rtol=0.0, atol=100 * TOLERANCE * scale)


def test_where_nothing_begins_to_touch_the_predictor_stays(result):
    began = np.diff(np.count_nonzero(contact_states(result), axis=1))
    step = int(np.argmin(np.abs(began))) + 1
    euler, found, _ = predicted(result, step)
    assert found is euler


def test_the_path_is_the_same_with_fewer_iterations_and_cuts(monkeypatch):
    """With Newton's method alone: mixed iterations make up for much of a bad predictor."""
    monkeypatch.setattr(load_path, "mixed_newton", lambda _, d: Solution(Status.SINGULAR, d, ()))
    seal = sm.door_seal(rays=116, n_steps=8)
    found = sm.analyze(seal)
    monkeypatch.setattr(predictor, "at_rest_where_it_touches", lambda _, guess: guess)
    plain = sm.analyze(seal)
    assert found.step_cuts < plain.step_cuts
    assert found.newton_iterations.sum() < plain.newton_iterations.sum()
    np.testing.assert_allclose(found.reaction, plain.reaction, rtol=0.0, atol=1e-7)

"""Linear steps that satisfy the contact law of walls that touch each other, and what they spare."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.analysis import linear_contact, load_path, newton
from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.linear_contact import TOLERANCE, predicted, with_contact
from seal_mdao.analysis.predictor import predict
from seal_mdao.analysis.problem import PathProblem

FOLDED_LIP = Path(__file__).parents[1] / "contact" / "folded_lip.toml"


@pytest.fixture(scope="module")
def stiff_lip():
    """A lip that lays itself on its body, with stiff self-contact."""
    seal = sm.build_seal(sm.read_seal_file(FOLDED_LIP))
    own = {"self_contact_normal_penalty": 1e6, "self_contact_tangent_penalty": 1e5}
    return seal.with_parameters(own)


@pytest.fixture(scope="module")
def folded(stiff_lip):
    return sm.analyze(stiff_lip)


def increments(result):
    """Increments of the path, with the contact that is linearised at their beginning."""
    path = result.path
    problem = PathProblem(path.discretization, result.seal.terms())
    for last, step in pairwise(path.steps):
        increment = Increment(
            problem, step.fraction, last.after, result.seal.newton, last, problem.factorize_at(last)
        )
        iteration = problem.begin_mixed(last, step.fraction)
        yield increment, problem.linear_contacts(iteration, increment.history)


def moved_by(increment, contact, deviation):
    """K^-1 B^T of forces (m, 2)."""
    layout, total = increment.problem.discretization.layout, 0.0
    for point in np.flatnonzero(deviation.any(axis=1)):
        for load, force in zip(contact.loads(point), deviation[point], strict=True):
            layout.condense_force(load)
            total = total + force * load[: layout.n_equations]
    return layout.gather(increment.factor.solve(total))


def test_the_body_is_linear_and_the_contact_law_is_not(folded):
    """d = d_Euler - K^-1 B^T f(B (d - d_n)) for the forces f beyond the linearised ones."""
    corrected = 0
    for increment, contacts in increments(folded):
        euler = predict(increment)[0]
        found = predicted(increment, euler)
        if not contacts:
            assert found is None
            continue
        (contact,) = contacts
        deviation, _ = contact.deviation(contact.motion(found))
        scale = max(np.linalg.norm(deviation), np.linalg.norm(contact.linearization.forces))
        if np.linalg.norm(deviation) <= 1e2 * TOLERANCE * scale:
            continue
        moved = moved_by(increment, contact, deviation)
        assert np.abs(moved).max() > 0.0
        np.testing.assert_allclose(euler - found, moved, atol=1e3 * TOLERANCE * np.abs(moved).max())
        corrected += 1
    assert corrected >= 4


def test_forces_at_a_converged_step_are_the_linearised_ones(folded):
    """With the history of the step that was linearised, where nothing has moved."""
    loaded = 0
    for step in folded.path.steps:
        problem = folded.path.problem
        iteration = problem.begin_mixed(step, step.fraction)
        for contact in problem.linear_contacts(iteration, step.before):
            deviation, slopes = contact.deviation(contact.motion(step.d))
            forces = contact.linearization.forces
            size = max(np.abs(forces).max(), 1e-300)
            np.testing.assert_allclose(deviation, 0.0, atol=1e-10 * size)
            np.testing.assert_allclose(slopes, 0.0, atol=1e-9)
            loaded += forces.any()
    assert loaded >= 4


def test_slopes_are_those_of_the_forces(folded, rng):
    """Central differences of the forces within one state of every point, with a study of the step."""
    checked = 0
    for _, contacts in increments(folded):
        for contact in contacts:
            closed = contact.linearization.forces[:, 0] < 0.0
            if not closed.any():
                continue
            motion = np.where(closed[:, None], 1e-7 * rng.standard_normal((len(contact), 2)), 0.0)
            way = rng.standard_normal(motion.shape) * closed[:, None]
            _, slopes = contact.deviation(motion)
            exact, errors = np.einsum("mij,mj->mi", slopes, way), []
            for h in (1e-9, 1e-10):
                ahead, back = (contact.deviation(motion + s * h * way)[0] for s in (1.0, -1.0))
                errors.append(np.abs((ahead - back) / (2.0 * h) - exact).max())
            checked += 1
            assert min(errors) <= 1e-4 * max(np.abs(exact).max(), 1e5)
    assert checked >= 4


def test_a_step_with_the_states_of_the_tangent_stays(folded):
    for increment, contacts in increments(folded):
        last = increment.last
        iteration = increment.problem.begin_mixed(last, last.fraction)
        own = increment.problem.linear_contacts(iteration, last.before)
        assert len(own) == len(contacts)
        np.testing.assert_array_equal(
            with_contact(increment, own, last.d, increment.factor), last.d
        )


def test_stiff_walls_are_not_cut_and_the_path_is_the_same(stiff_lip, folded, monkeypatch):
    """Equilibrium is that of Newton's method in cut steps, to its tolerance."""
    assert folded.converged
    assert folded.step_cuts == 0
    monkeypatch.setattr(newton, "with_contact", lambda _increment, _contacts, d, _factor: d)
    monkeypatch.setattr(load_path, "predicted", lambda _increment, _euler: None)
    plain = sm.analyze(stiff_lip)
    assert plain.converged
    assert plain.step_cuts >= 5
    assert folded.newton_iterations.sum() < 0.7 * plain.newton_iterations.sum()
    np.testing.assert_allclose(folded.reaction, plain.reaction, rtol=0.0, atol=1e-6)


def test_ten_times_stiffer_walls_are_hardly_cut(folded):
    """16 cuts where the small problem has to be solved to more digits than a gap has."""
    own = {"self_contact_normal_penalty": 1e7, "self_contact_tangent_penalty": 1e6}
    stiffer = sm.analyze(folded.seal.with_parameters(own))
    assert stiffer.converged
    assert stiffer.step_cuts <= 2
    np.testing.assert_allclose(stiffer.reaction, folded.reaction, rtol=0.0, atol=0.3)


def unsolved(result):
    """Increments whose states change, and for which no linear step is found that satisfies the law."""
    count = 0
    for increment, contacts in increments(result):
        euler = predict(increment)[0]
        changes = any(own.deviation(own.motion(euler))[0].any() for own in contacts)
        count += bool(changes and predicted(increment, euler) is euler)
    return count


def test_newtons_method_needs_the_line_search(folded, monkeypatch):
    """Full steps go to and fro between states of points on both walls."""
    assert unsolved(folded) == 0
    monkeypatch.setattr(linear_contact, "SMALLEST", 1.0)
    assert unsolved(folded) >= 1

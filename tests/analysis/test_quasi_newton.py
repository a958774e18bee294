"""Iterations with an old factor: same path as Newton's, one factorisation a step, ways back."""

import numpy as np
import pytest
from bodies import dense, internal, square, wave
from verification.differences import contact_states, same_sequence

import seal_mdao as sm
from seal_mdao.analysis import load_path, quasi_newton
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.quasi_newton import BroydenSteps, CarriedFactor
from seal_mdao.equilibrium.corrected_factor import CorrectedFactor
from seal_mdao.equilibrium.linear_solver import SparseStorage
from seal_mdao.seals.door.door_seal import with_options
from seal_mdao.structure.deformation import particle_gradients

STEPS = 28


class Inverse:
    """A factor of a dense matrix."""

    def __init__(self, matrix):
        self.matrix = matrix

    def solve(self, rhs):
        return np.linalg.solve(self.matrix, rhs)


@pytest.fixture(scope="module")
def model():
    """Pressed 3 mm; contact grows, sticks and slips."""
    return sm.door_seal(depth=3.0, n_steps=STEPS, solver="superlu")


@pytest.fixture(scope="module")
def quasi(model):
    return sm.analyze(model, keep_factors=True)


@pytest.fixture
def without(monkeypatch):
    """Newton's method alone."""
    monkeypatch.setattr(SparseStorage, "reuses_factors", False)


@pytest.fixture
def factorisations(monkeypatch):
    """A list that grows by one with every factorisation."""
    counted, factorize = [], SparseStorage.factorize

    def counting(storage, *values):
        counted.append(storage.n)
        return factorize(storage, *values)

    monkeypatch.setattr(SparseStorage, "factorize", counting)
    return counted


def rotation(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def test_path_is_that_of_newton(model, quasi, without):
    newton = sm.analyze(model)
    assert quasi.converged
    assert len(quasi.path.steps) == len(newton.path.steps)
    assert contact_states(quasi).any()
    assert same_sequence(quasi, newton)
    size = np.abs(newton.path.steps[-1].d).max()
    for found, expected in zip(quasi.path.steps, newton.path.steps, strict=True):
        np.testing.assert_allclose(found.d, expected.d, rtol=0.0, atol=1e-9 * size)


def test_incremental_history_too(model, without, monkeypatch):
    """Two predictors are tried there before the iterations begin."""
    incremental = with_options(model, friction_history="incremental")
    newton = sm.analyze(incremental)
    monkeypatch.setattr(SparseStorage, "reuses_factors", True)
    found = sm.analyze(incremental)
    assert same_sequence(found, newton)
    np.testing.assert_allclose(found.reaction, newton.reaction, rtol=0.0, atol=1e-7)


def test_sensitivities_are_those_of_newton(model, quasi, without):
    newton = sm.analyze(model, keep_factors=True)
    for method in ("direct", "adjoint"):
        found, expected = (sm.differentiate(r, method=method) for r in (quasi, newton))
        for name in ("von_mises", "reaction"):
            scale = np.abs(expected[name]).max()
            difference = np.abs(found[name] - expected[name]).max()
            assert difference < 1e-8 * scale


def test_forces_and_factor_of_a_step_are_those_of_its_configuration(model, quasi, rng):
    disc = quasi.path.discretization
    problem, door = PathProblem(disc, model.terms()), quasi.path.index_of("door")
    for step in quasi.path.steps[10::6]:
        assembly = problem.assemble_at(step)
        np.testing.assert_array_equal(assembly.responses[door].force, step.responses[door].force)
        rhs = rng.standard_normal(disc.layout.n_equations)
        again = assembly.factorize()
        np.testing.assert_array_equal(step.factor.solve(rhs), again.solve(rhs))


def test_one_factorisation_a_step_once_the_door_touches(model, factorisations):
    after = []
    result = sm.analyze(model, callback=lambda step: after.append(len(factorisations)))
    n_contact = np.count_nonzero(contact_states(result), axis=1)
    touched = int(np.argmax(n_contact > 0))
    assert touched > 0
    assert n_contact[-1] > n_contact[touched]
    np.testing.assert_array_equal(np.diff(after)[touched:], 1)
    assert result.newton_iterations[touched + 1 :].max() <= 12
    # before it touches nothing moves; the undeformed tangent is one more
    np.testing.assert_array_equal(after[:touched], np.arange(touched) + 2)


@pytest.fixture
def outcomes(monkeypatch):
    """A list that grows by one status with every try of an old factor."""
    found = []

    def watched(*args):
        answer = quasi_newton.quasi_newton(*args)
        found.append(answer.status)
        return answer

    monkeypatch.setattr(load_path, "quasi_newton", watched)
    return found


def test_old_factors_lead_to_every_step_the_first_touch_included(model, outcomes):
    sm.analyze(model)
    assert set(outcomes) == {Status.CONVERGED}
    assert len(outcomes) == STEPS


def test_what_does_not_converge_falls_back_to_the_path_of_newton(model, without, monkeypatch):
    """With no iterations allowed, and with a wrong inverse, every step is Newton's, bit for bit."""
    newton = sm.analyze(model)
    monkeypatch.setattr(SparseStorage, "reuses_factors", True)
    wrong = lambda factor, rhs: -10.0 * factor.factor.solve(rhs)  # noqa: E731
    for target, name, value in (
        (quasi_newton, "LIMIT", 0), (CarriedFactor, "solve", wrong),
    ):  # fmt: skip
        with monkeypatch.context() as patch:
            patch.setattr(target, name, value)
            found = sm.analyze(model)
        for a, b in zip(found.path.steps, newton.path.steps, strict=True):
            np.testing.assert_array_equal(a.d, b.d)
            assert len(a.residuals) >= len(b.residuals)
            assert a.residuals[len(a.residuals) - len(b.residuals) :] == b.residuals
        assert found.newton_iterations.sum() > newton.newton_iterations.sum()


def test_same_bits_again_after_another_design(model, quasi):
    sm.analyze(model, np.full(model.n_offsets, 0.05))
    again = sm.analyze(model)
    for a, b in zip(again.path.steps, quasi.path.steps, strict=True):
        np.testing.assert_array_equal(a.d, b.d)
        assert a.residuals == b.residuals


def test_band_is_factorised_in_every_iteration(monkeypatch):
    def never(*args):
        raise AssertionError("a banded factor is overwritten by the next tangent")

    monkeypatch.setattr(load_path, "quasi_newton", never)
    assert sm.analyze(sm.door_seal(depth=0.5, n_steps=10)).converged


def test_carried_factor_is_exact_for_a_rigid_rotation(rng):
    """The tangent of a turned body is the turned tangent."""
    disc = square(rng, solver="superlu", fixed="nothing")
    layout, x, turn = disc.layout, disc.particles, rotation(0.4)
    d = wave(disc, 0.05)
    turned = (x + d) @ turn.T - x
    shift = np.eye(layout.n_equations)
    before, after = (dense(layout, internal(disc, at)[1]) + shift for at in (d, turned))
    gradients = np.broadcast_to(turn, (len(x), 2, 2))
    rhs = rng.standard_normal(layout.n_equations)
    found = CarriedFactor(Inverse(before), gradients, layout).solve(rhs)
    expected = np.linalg.solve(after, rhs)
    tolerance = 1e-14 * np.linalg.cond(after) * np.abs(expected).max()
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=tolerance)
    assert np.abs(np.linalg.solve(before, rhs) - expected).max() > 0.1 * np.abs(expected).max()


@pytest.mark.parametrize("inner", [None, 0.4])
def test_gradients_of_a_homogeneous_deformation(rng, inner):
    """In plane strain, and in a body of revolution with this inner radius."""
    disc, gradient = square(rng, inner=inner), np.array([[1.2, 0.3], [-0.1, 0.9]])
    d, out = disc.particles @ (gradient - np.eye(2)).T, np.empty((len(disc.particles), 2, 2))
    raw = disc.transformation.coefficients(d)
    particle_gradients(disc.cells.raw, disc.body.cells, raw, out)
    np.testing.assert_allclose(out, np.broadcast_to(gradient, out.shape), rtol=0.0, atol=1e-11)


def test_gradient_of_a_particle_at_no_cell_is_the_unit_matrix(rng):
    disc = square(rng)
    d, out = wave(disc, 0.1), np.empty((len(disc.particles), 2, 2))
    cells = np.where(disc.body.cells == 0, 1, disc.body.cells)
    particle_gradients(disc.cells.raw, cells, disc.transformation.coefficients(d), out)
    np.testing.assert_array_equal(out[0], np.eye(2))


def test_corrected_factor_solves_with_the_sum(rng):
    matrix = 4.0 * np.eye(12) + rng.standard_normal((12, 12)) / 4.0
    columns, change = rng.standard_normal((3, 12)), rng.standard_normal((3, 3))
    change[:, 1] = 0.0  # singular, as that of a frictionless point
    rhs = rng.standard_normal(12)
    found = CorrectedFactor(Inverse(matrix), columns, change).solve(rhs)
    expected = np.linalg.solve(matrix + columns.T @ change @ columns, rhs)
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12)


def test_broyden_steps_are_those_of_the_updated_matrix(rng):
    """B + F s^T / s^T s after every full step s = -B^-1 F."""
    n = 6
    slope = np.eye(n) + 0.2 * rng.standard_normal((n, n))

    def residual(x):
        return slope @ x + 0.1 * x**3 - 1.0

    matrix, steps, x = np.eye(n), BroydenSteps(), np.zeros(n)
    for _ in range(8):
        force = residual(x)
        step = steps.next(-force)
        np.testing.assert_allclose(step, -np.linalg.solve(matrix, force), rtol=0.0, atol=1e-9)
        x = x + step
        matrix = matrix + np.outer(residual(x), step) / (step @ step)
    assert np.linalg.norm(residual(x)) < 1e-3 * np.linalg.norm(residual(np.zeros(n)))

"""Residual and tangent of the whole problem on the converged path of the seal."""

from dataclasses import replace

import numpy as np
import pytest
from bodies import dense
from verification.differences import contact_states

import seal_mdao as sm
from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.newton import newton
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.predictor import predict
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.contact.friction import OPEN, SLIP, STICK
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.seals.door.door_seal import with_options


@pytest.fixture(scope="module", params=["accumulated", "incremental"])
def pressed(request, nominal, drawn_model):
    """The nominal seal under the corner door, with either friction history."""
    if request.param == "accumulated":
        return nominal
    return sm.analyze(with_options(drawn_model, friction_history=request.param))


def problem_of(result):
    return PathProblem(result.path.discretization, result.seal.terms())


def state_of(assembly):
    """Contact states of an assembly."""
    return assembly.responses[1].state


def interesting(result):
    """The last steps with a point that begins to touch, and with many sticking or slipping points."""
    path, after = result.path, contact_states(result)
    before = np.array([step.before[path.index_of("door")].state for step in path.steps])
    touching = ((before == OPEN) & (after != OPEN)).any(axis=1)
    sticking, slipping = (after == STICK).sum(axis=1), (after == SLIP).sum(axis=1)
    places = {np.flatnonzero(touching)[-1], sticking.argmax(), slipping.argmax(), len(after) - 1}
    return [path.steps[int(i)] for i in places]


def evaluated(problem, step, d):
    return problem.evaluate(d, step.fraction, step.before)


def test_converged_steps_are_in_equilibrium(pressed):
    """And are found again from the record, whatever slip directions an iteration left behind."""
    problem = problem_of(pressed)
    for place, step in enumerate(pressed.path.steps[::5]):
        problem.term("door")._previous[:] = place % 3 - 1
        assembly = problem.assemble_at(step)
        assert assembly.size <= 1e-11 or assembly.rounding
        found, kept = assembly.responses[1], pressed.response("door", step)
        np.testing.assert_array_equal(found.state, kept.state)
        np.testing.assert_array_equal(found.force, kept.force)
        np.testing.assert_array_equal(found.history.variables, kept.history.variables)


def test_tangent_is_the_derivative_of_the_residual(pressed, rng):
    """Rubber, stick, slip, first touch and curvature together; five-point differences."""
    problem = problem_of(pressed)
    layout = pressed.path.discretization.layout
    for step in interesting(pressed):
        assembly = problem.assemble_at(step)
        matrix, state = dense(layout, assembly.values), state_of(assembly)
        direction = rng.standard_normal(layout.n_equations)
        spread, h = layout.gather(direction), 1e-6
        values = []
        for k in (-2, -1, 1, 2):
            beside = evaluated(problem, step, step.d + k * h * spread)
            values.append(beside.residual)
            np.testing.assert_array_equal(state_of(beside), state)
        slope = (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * h)
        exact = matrix @ direction
        np.testing.assert_allclose(slope, exact, rtol=0.0, atol=2e-8 * np.abs(exact).max())


def test_error_after_one_iteration_is_quadratic_in_the_error_before(pressed, rng):
    """Newton started beside converged steps, close enough that the contact states stay."""
    problem = problem_of(pressed)
    layout = pressed.path.discretization.layout
    once = sm.NewtonOptions(tolerance=1e-30, max_iterations=1)
    for step in interesting(pressed):
        direction = layout.gather(rng.standard_normal(layout.n_equations))
        size = []
        for h in (2e-6, 1e-6, 5e-7):
            increment = Increment(problem, step.fraction, step.before, once)
            found = newton(increment, step.d + h * direction)
            assert found.status is Status.NOT_CONVERGED
            np.testing.assert_array_equal(state_of(found.assembly), step.responses[1].state)
            size.append(found.residuals)
        before, after = np.log(size).T
        order = np.diff(after) / np.diff(before)
        np.testing.assert_allclose(order, 2.0, atol=0.1)


def test_an_evaluation_depends_on_its_arguments_alone_and_changes_no_other(pressed):
    """Evaluated again, with others in between, whose points slip in other directions."""
    problem = problem_of(pressed)
    for step in interesting(pressed):
        first = problem.assemble_at(step)
        copies = [first.values.copy(), first.forces.copy(), first.responses[1].copied()]
        problem.evaluate(0.9 * step.d, step.fraction, step.before, first.iteration)
        start = problem.begin_mixed(step, step.fraction)
        mixed = problem.evaluate(step.d, step.fraction, step.before, start, mixed=True)
        again = problem.evaluate(step.d, step.fraction, step.before)
        for found in (first, again):
            np.testing.assert_array_equal(found.values, copies[0])
            np.testing.assert_array_equal(found.forces, copies[1])
            for one, other in zip(found.responses[1][:4], copies[2][:4], strict=True):
                np.testing.assert_array_equal(one, other)
        others = problem.evaluate(step.d, step.fraction, step.before, start, mixed=True)
        np.testing.assert_array_equal(others.values, mixed.values)
        for name in ("d", "values"):
            with pytest.raises(AttributeError):
                setattr(first, name, None)


def test_newton_is_quadratic_once_the_contact_set_settles(nominal):
    """Last pair of residuals above rounding in every step: r_{k+1} <= C r_k^2."""
    constants = []
    for step in nominal.path.steps:
        r = np.array(step.residuals)
        above = np.flatnonzero((r[1:] > 1e-10) & (r[:-1] < 1e-2))
        if above.size:
            k = above[-1]
            constants.append(r[k + 1] / r[k] ** 2)
    # in the other steps the predictor leaves one correction above rounding
    assert len(constants) > 35
    assert np.median(constants) < 3.0
    assert np.max(constants) < 200.0


def test_predictor_is_second_order_accurate_in_the_step(nominal):
    """Its error is quadratic in the motion while the contact states stay."""
    problem, step = problem_of(nominal), nominal.path.steps[60]
    factor, options, errors = problem.factorize_at(step), sm.NewtonOptions(1e-12), []
    for share in (0.2, 0.1, 0.05):
        target = step.fraction + share
        increment = Increment(problem, target, step.after, options, step, factor)
        guess = predict(increment)[0]
        found = newton(increment, guess)
        assert found.status is Status.CONVERGED
        np.testing.assert_array_equal(state_of(found.assembly), step.responses[1].state)
        errors.append(np.abs(guess - found.d).max())
    assert np.all(np.log2(np.array(errors[:-1]) / errors[1:]) > 1.8)


@one_blas_thread
def test_factor_of_a_step_is_that_of_its_converged_tangent(nominal, rng):
    """To the last bit, under the limit of threads under which the path made it."""
    problem, layout = problem_of(nominal), nominal.path.discretization.layout
    for step in nominal.path.steps[40::30]:
        rhs, again = rng.standard_normal(layout.n_equations), problem.factorize_at(step)
        np.testing.assert_array_equal(step.factor.solve(rhs), again.solve(rhs))


def test_step_cannot_be_changed(nominal):
    with pytest.raises(AttributeError):
        nominal.path.steps[0].d = None
    assert replace(nominal.path.steps[0], iterations=3).iterations == 3

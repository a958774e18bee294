"""Stepping: cuts, what is recorded, where a path ends and what it says then; equilibrium."""

import re

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.analysis.body import discretize
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.loading import LoadProgram, still_profile
from seal_mdao.analysis.loads import edge_points, internal_forces, point_loads
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import Status
from seal_mdao.contact.friction import OPEN, SLIP
from seal_mdao.geometry.profile import circle_profile
from seal_mdao.rkpm.shape_functions import PointSet


def test_cut_steps_are_recorded_with_their_parts(cut):
    """Every cut adds one converged step, at a dyadic share of the nominal one."""
    path, positions = cut.path, cut.model.positions
    parts = [step for step in path.steps if step.nominal < 0]
    assert path.converged
    assert path.step_cuts == len(parts) >= 2
    assert len(path.steps) == 105 + path.step_cuts
    assert [step.nominal for step in path.nominal_steps] == list(range(105))
    assert np.all(np.diff([step.fraction for step in path.steps]) > 0.0)
    for step in parts:
        k = int(step.fraction)
        share = step.fraction - k
        assert 0.0 < share < 1.0
        assert share * 2**cut.model.newton.max_cuts % 1.0 == 0.0
        between = positions[k] + share * (positions[k + 1] - positions[k])
        np.testing.assert_allclose(step.position, between, rtol=1e-14)


def test_no_step_takes_more_iterations_than_allowed(cut):
    assert max(step.iterations for step in cut.path.steps) <= 4


def test_results_count_nominal_steps_only(cut):
    path = cut.path
    assert path.reaction.shape == (105, 2)
    assert path.newton_iterations.shape == (105,)
    assert path.newton_iterations.sum() == sum(step.iterations for step in path.steps)
    assert path.contact_state.shape == (105 + path.step_cuts, 51)
    np.testing.assert_allclose(path.positions, cut.model.positions[1:], rtol=0.0, atol=1e-14)


def test_every_step_begins_with_the_history_that_the_last_one_left(cut):
    for last, step in zip(cut.path.steps, cut.path.steps[1:], strict=False):
        np.testing.assert_array_equal(step.before.state, last.after.state)
        np.testing.assert_array_equal(step.before.variables, last.after.variables)


def test_cuts_hardly_change_the_path(cut, drawn):
    """Halved steps are steps like any other; the accumulated rule needs no particular length."""
    np.testing.assert_allclose(cut.reaction, drawn.reaction, rtol=0.0, atol=0.02)
    np.testing.assert_allclose(cut.deformed(), drawn.deformed(), rtol=0.0, atol=1e-3)


def test_callback_sees_every_nominal_step_once_and_in_order():
    seen = []
    result = sm.analyze(sm.door_seal(depth=1.0, n_steps=15), callback=seen.append)
    assert [step.nominal for step in seen] == list(range(15))
    assert all(a is b for a, b in zip(seen, result.path.steps, strict=True))


def test_path_that_fails_says_where(buckled):
    """Frictionless drawn seal: plain Newton ends where it buckles sideways."""
    path = buckled.path
    done = len(path.nominal_steps)
    assert not buckled.converged
    assert path.status is Status.NOT_CONVERGED
    assert 4.0 < buckled.door_travel[-1] < 9.0
    step, fraction, x, y, residual, iterations, contact, slipping = re.search(
        r"load step (\d+) \(path parameter ([\d.]+), profile at x = (\S+), y = (\S+)\): .*"
        r"relative residual (\S+) after (\d+) iterations; (\d+) points in contact, (\d+) slipping",
        path.failure,
    ).groups()
    last = path.steps[-1]
    assert int(step) == done + 1
    assert last.fraction < float(fraction) <= done + 1
    first, second = buckled.model.positions[done : done + 2, 1]
    assert float(x) == 0.0
    assert float(y) == pytest.approx(first + (float(fraction) - done) * (second - first), rel=1e-3)
    assert float(residual) > buckled.model.newton.tolerance
    assert int(iterations) == buckled.model.newton.max_iterations
    assert abs(int(contact) - np.sum(last.after.state != OPEN)) <= 2
    assert int(slipping) == int(contact)


def test_path_that_fails_used_all_its_cuts(buckled):
    path, options = buckled.path, buckled.model.newton
    smallest = np.diff([step.fraction for step in path.steps]).min()
    assert smallest >= 0.5**options.max_cuts
    assert path.step_cuts >= options.max_cuts


def test_measures_of_a_failed_path_are_refused(buckled):
    with pytest.raises(sm.LoadPathError, match="could not be completed") as error:
        _ = buckled.end
    assert error.value.result is buckled
    for name in ("von_mises", "gap", "gap_square_sum", "max_penetration"):
        with pytest.raises(sm.LoadPathError):
            getattr(buckled, name)
    assert np.isfinite(buckled.reaction).all()


def test_without_cuts_the_path_ends_at_the_first_difficult_step(cut):
    model = cut.model.with_(
        newton=sm.NewtonOptions(tolerance=1e-11, max_iterations=4, max_cuts=0, damped_iterations=0)
    )
    result = sm.analyze(model)
    first = next(step for step in cut.path.steps if step.nominal < 0)
    assert not result.converged
    assert result.step_cuts == 0
    assert len(result.path.steps) == int(first.fraction)
    np.testing.assert_array_equal(result.reaction, cut.reaction[: len(result.reaction)])


def test_body_that_starts_inside_the_door_is_refused():
    """A design that bulges by 0.2 mm, a door that starts 0.1 mm above the drawn seal."""
    model = sm.door_seal(start=9.6)
    offsets = np.concatenate([np.full(14, 0.2), np.zeros(11)])
    with pytest.raises(ValueError, match="inside the rigid profile") as error:
        sm.analyze(model, offsets)
    depth = float(re.search(r"starts (\S+) inside", str(error.value))[1])
    assert depth == pytest.approx(0.1, rel=1e-2)


def test_steps_before_touching_move_nothing(drawn):
    for step in drawn.path.steps[:4]:
        assert not step.d.any()
        assert not step.reaction.any()
        assert step.gap.min() == pytest.approx(step.position[1] - 9.5, abs=1e-12)


def test_base_does_not_move_and_contact_points_are_particles(drawn):
    """Physical displacements: those that the contact sees, zero where imposed."""
    model = drawn.model
    for step in (30, 104):
        displacement = drawn.path.displacement(step)
        np.testing.assert_allclose(displacement[model.grid.base], 0.0, atol=1e-14)
        np.testing.assert_allclose(
            drawn.deformed(step)[model.body.contact],
            drawn.path.nominal_steps[step].contact_x,
            rtol=0.0,
            atol=1e-13,
        )


def test_coefficients_are_not_displacements(drawn):
    """The reproducing kernel does not interpolate; results must go through the shape functions."""
    assert np.abs(drawn.path.displacement() - drawn.path.steps[-1].d).max() > 1e-2


def test_base_carries_the_door(drawn):
    """Equilibrium of forces and moments between door and base at several depths."""
    model, disc = drawn.model, drawn.path.discretization
    for place in (30, 60, 104):
        step = drawn.path.nominal_steps[place]
        base = internal_forces(disc, model.material, step.d)[model.grid.base]
        x = drawn.particles[model.grid.base]
        np.testing.assert_allclose(base.sum(axis=0), step.reaction, rtol=0.0, atol=1e-8)
        moment = np.sum(x[:, 0] * base[:, 1] - x[:, 1] * base[:, 0])
        y = step.contact_x
        from_door = np.sum(y[:, 0] * step.force[:, 1] - y[:, 1] * step.force[:, 0])
        assert moment == pytest.approx(from_door, abs=1e-7)


def test_coulomb_limit_holds_at_every_point_of_the_path(drawn, flat):
    """|T_t| <= mu |T_n| up to the curvature factor, and equality where the point slips."""
    for step in flat.path.steps:
        normal, tangential = step.force[:, 1], step.force[:, 0]
        limit = 0.25 * normal
        assert np.all(np.abs(tangential) <= limit + 1e-12)
        slip = step.after.state == SLIP
        np.testing.assert_allclose(np.abs(tangential[slip]), limit[slip], rtol=1e-10)
    assert np.all(drawn.path.steps[-1].force[:, 1] >= 0.0)


def test_forces_are_penalty_times_penetration(flat):
    step, disc = flat.path.steps[-1], flat.path.discretization
    touching = step.after.state != OPEN
    expected = flat.model.normal_penalty * disc.contact_length * np.maximum(-step.gap, 0.0)
    np.testing.assert_allclose(step.force[:, 1], expected, rtol=1e-12)
    np.testing.assert_array_equal(touching, step.gap < 0.0)
    assert flat.max_penetration == pytest.approx(-step.gap.min(), rel=1e-15)


def test_flat_door_keeps_the_seal_symmetric(flat):
    """Mirror symmetric section, door and law: x -> -x maps the solution on itself."""
    model, step = flat.model, flat.path.steps[-1]
    x = flat.deformed()
    rays = np.arange(58)
    for layer in range(3):
        here, mirror = x[model.grid.particle(rays, layer)], x[model.grid.particle(-rays, layer)]
        np.testing.assert_allclose(here, mirror * [-1.0, 1.0], rtol=0.0, atol=1e-7)
    assert flat.reaction[-1, 0] == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_array_equal(step.after.state, step.after.state[::-1])


def test_program_is_linear_between_its_steps(rng):
    positions, imposed = rng.standard_normal((4, 2)), rng.standard_normal((4, 5, 2))
    program = LoadProgram(positions, imposed)
    assert program.n_steps == 3
    for fraction in (0.0, 0.25, 1.0, 2.5, 3.0):
        k = min(int(fraction), 2)
        share = fraction - k
        point = program.at(fraction)
        np.testing.assert_allclose(
            point.position, (1 - share) * positions[k] + share * positions[k + 1], atol=1e-14
        )
        np.testing.assert_allclose(
            point.imposed, (1 - share) * imposed[k] + share * imposed[k + 1], atol=1e-14
        )
        assert point.force is None


def test_point_loads_have_the_resultant_and_the_moment_of_their_forces(rng):
    """sum Phi_I = 1 and sum Phi_I X_I = x carry over to generalised forces."""
    model = sm.door_seal()
    disc = discretize(model.body, model.drawn_particles)
    cells = model.body.cells[rng.integers(0, len(model.body.cells), 6)].reshape(3, 2, 4)
    cells[:, 1] = cells[:, 0]
    points = PointSet(cells.reshape(-1, 4), rng.dirichlet(np.ones(4), 6), 2)
    forces = rng.standard_normal((6, 2))
    loads, x = point_loads(disc, points, forces), points.at(disc.particles)
    np.testing.assert_allclose(loads.sum(axis=0), forces.sum(axis=0), atol=1e-11)
    np.testing.assert_allclose(loads.T @ disc.particles, forces.T @ x, atol=1e-9)


def test_edge_points_integrate_along_the_boundary():
    model = sm.door_seal()
    outer = model.grid.particle(np.arange(58), 2)
    edges = np.column_stack([outer, np.roll(outer, -1)])
    points, lengths = edge_points(edges, model.drawn_particles)
    x, ends = points.at(model.drawn_particles), model.drawn_particles[edges]
    size = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(size.sum(), rel=1e-14)
    cubic = np.sum(lengths * x[:, 0] ** 3)
    a, b = ends[:, 0, 0], ends[:, 1, 0]
    exact = np.sum(size * (a**3 + a**2 * b + a * b**2 + b**3) / 4)
    assert cubic == pytest.approx(exact, rel=1e-12, abs=1e-9)


def test_dead_load_is_balanced_by_the_base():
    """A small load on the top, no contact: the base carries it, and doubling it nearly doubles d."""
    model = sm.door_seal()
    disc = discretize(model.body, model.drawn_particles)
    top = model.grid.particle(29, 2)
    at_top = PointSet(np.array([[top]]), np.ones((1, 1)), 1)
    far = circle_profile((0.0, 500.0), 10.0)
    tops = []
    for size in (1e-3, 2e-3):
        load = point_loads(disc, at_top, np.array([[0.3 * size, -size]]))
        program = LoadProgram(still_profile(1), force=np.stack([0 * load, load]))
        path = solve_path(disc, model.material, far, model.law, program)
        held = internal_forces(disc, model.material, path.steps[-1].d)[model.grid.base]
        np.testing.assert_allclose(held.sum(axis=0), [-0.3 * size, size], rtol=0.0, atol=1e-9)
        tops.append(path.displacement()[top])
    np.testing.assert_allclose(tops[1], 2 * tops[0], rtol=1e-3)


def test_failed_path_holds_no_factors():
    """Drivers keep the exceptions of failed analyses, and these the path."""
    model = sm.door_seal(friction=0.0)
    failed = sm.analyze(model, keep_factors=True)
    assert not failed.converged
    assert all(step.factor is None for step in failed.path.steps)


# a design that slides under little friction, 0.01 mm
SLIDING = (
    5, -30, -26, 28, 3, -43, 5, 21, -8, -42, -3, 7, -19, -4, -2, 23, 43, 38, 45, -38, -35, 35, 50,
    -2, 26,
)  # fmt: skip


def test_incremental_history_starts_from_the_better_of_two_predictors(monkeypatch):
    """Friction that a sliding point loses at the start of a step is back at its end."""
    model = sm.door_seal(friction=0.15, friction_history="incremental")
    offsets = 0.01 * np.array(SLIDING)
    path = sm.analyze(model, offsets, 3.75).path
    assert path.converged
    assert path.step_cuts == 0
    both = PathProblem.predict
    for only in (slice(0, 1), slice(1, 2)):
        monkeypatch.setattr(PathProblem, "predict", lambda *a, only=only: both(*a)[only])
        one = sm.analyze(model, offsets, 3.75).path
        better = path.newton_iterations.sum() < one.newton_iterations.sum()
        assert better or not one.converged

"""Stepping: cuts, what is recorded, where a path ends and what it says then; equilibrium."""

import re
from dataclasses import replace

import numpy as np
import pytest
from bodies import inside, square
from seal_file.block_files import between_plates
from verification.differences import contact_states

import seal_mdao as sm
from seal_mdao.analysis import load_path
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.mixed_newton import mixed_newton
from seal_mdao.analysis.newton import SHORTEST_CYCLE, newton
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.contact.friction import OPEN, SLIP
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.seals.door.door_seal import options_of, with_options
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.points import edge_points, fixed_points, single_points


def heights(seal):
    """Height of the door at the start and after every nominal step."""
    return np.array([options_of(seal).motion.pose(k).position[1] for k in range(seal.n_steps + 1)])


def test_cut_steps_are_recorded_with_their_parts(cut):
    """At dyadic shares of the nominal one; most are solved as one in the end."""
    path = cut.path
    parts = [step for step in path.steps if step.nominal < 0]
    assert path.converged
    assert path.step_cuts > len(parts) >= 2
    assert len(path.steps) == 20 + len(parts)
    assert [step.nominal for step in path.nominal_steps] == list(range(20))
    assert np.all(np.diff([step.fraction for step in path.steps]) > 0.0)
    for step in parts:
        share = step.fraction % 1.0
        assert 0.0 < share < 1.0
        assert share * 2**cut.seal.newton.max_cuts % 1.0 == 0.0


def test_no_solution_takes_more_iterations_than_allowed(cut, monkeypatch):
    """Neither by Newton's method nor by the mixed iterations after it."""
    made = {newton: [], mixed_newton: []}

    def counted(solve):
        def counting(*args):
            found = solve(*args)
            made[solve].append(len(found.residuals) - 1)
            return found

        return counting

    for solve in made:
        monkeypatch.setattr(load_path, solve.__name__, counted(solve))
    sm.analyze(cut.seal)
    assert max(made[newton]) == max(made[mixed_newton]) == 3


def test_results_count_nominal_steps_only(cut):
    path = cut.path
    assert cut.reaction.shape == (20, 2)
    assert path.newton_iterations.shape == (20,)
    assert path.newton_iterations.sum() == sum(step.iterations for step in path.steps)
    assert contact_states(cut).shape == (len(path.steps), 51)
    np.testing.assert_allclose(9.5 - cut.travel, heights(cut.seal)[1:], rtol=0.0, atol=1e-14)


def test_every_step_begins_with_the_history_that_the_last_one_left(cut):
    for last, step in zip(cut.path.steps, cut.path.steps[1:], strict=False):
        before, after = step.before[1], last.after[1]
        np.testing.assert_array_equal(before.state, after.state)
        np.testing.assert_array_equal(before.variables, after.variables)


@pytest.mark.parametrize("rule", ["accumulated", "incremental"])
def test_cuts_do_not_change_the_path(rule):
    """A step that was halved is solved as one from where its parts led."""
    seal = sm.door_seal(friction_history=rule, n_steps=40, newton=sm.NewtonOptions(tolerance=1e-11))
    few = sm.NewtonOptions(tolerance=1e-11, max_iterations=3)
    cut, whole = sm.analyze(with_options(seal, newton=few)), sm.analyze(seal)
    assert cut.path.step_cuts > whole.path.step_cuts == 0
    assert len(cut.path.steps) == 40
    # each step stops within the tolerance of its forces; a stiff contact divides by little
    scale = np.abs(whole.reaction).max()
    np.testing.assert_allclose(cut.reaction, whole.reaction, rtol=0.0, atol=1e-8 * scale)
    np.testing.assert_allclose(cut.deformed(), whole.deformed(), rtol=0.0, atol=1e-8)
    np.testing.assert_array_equal(contact_states(cut), contact_states(whole))


def test_parts_of_a_step_hardly_change_the_path(cut, nominal):
    """Where they stay: the accumulated rule needs no particular length."""
    parted = sm.analyze(with_options(cut.seal, n_steps=105))
    np.testing.assert_allclose(parted.reaction, nominal.reaction, rtol=0.0, atol=0.02)
    np.testing.assert_allclose(parted.deformed(), nominal.deformed(), rtol=0.0, atol=1e-3)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_free_body_between_two_plates_finds_both_in_the_first_step(tmp_path, friction):
    """As if rigid it would move from one plate to the other and back in every iteration."""
    result = sm.analyze(between_plates(tmp_path, friction))
    assert result.converged
    assert result.path.step_cuts == 0
    assert result.critical_points == ()
    first = result.path.steps[0]
    lid, floor = (result.response(name, first) for name in ("lid", "floor"))
    assert np.all(lid.gap < 0.0)
    assert np.all(floor.gap < 0.0)
    np.testing.assert_allclose(lid.total[1], -floor.total[1], rtol=1e-8)


def test_callback_sees_every_nominal_step_once_and_in_order():
    seen = []
    result = sm.analyze(sm.door_seal(depth=1.0, n_steps=15), callback=seen.append)
    assert [step.nominal for step in seen] == list(range(15))
    assert all(a is b for a, b in zip(seen, result.path.steps, strict=True))


def test_path_that_fails_says_where(buckled):
    """Frictionless nominal seal: plain Newton ends where it buckles sideways."""
    path = buckled.path
    done = len(path.nominal_steps)
    assert not buckled.converged
    assert path.status in (Status.NOT_CONVERGED, Status.CYCLED)
    assert 4.0 < buckled.travel[-1] < 9.0
    step, fraction, residual, iterations, x, y, contact, slipping = re.search(
        r"load step (\d+) \(load parameter ([\d.]+)\): .*relative residual (\S+) after (\d+) "
        r"iterations; door at x = (\S+), y = (\S+), (\d+) points in contact, (\d+) slipping",
        path.failure,
    ).groups()
    last = path.steps[-1]
    assert int(step) == done + 1
    assert last.fraction < float(fraction) <= done + 1
    first, second = heights(buckled.seal)[done : done + 2]
    assert float(x) == 0.0
    assert float(y) == pytest.approx(first + (float(fraction) - done) * (second - first), rel=1e-3)
    assert float(residual) > buckled.seal.newton.tolerance
    # of Newton's method, and mixed ones from the same predictor, ended where they cycle
    least = 2 * SHORTEST_CYCLE
    assert least <= int(iterations) <= 2 * buckled.seal.newton.max_iterations
    assert abs(int(contact) - np.sum(last.after[1].state != OPEN)) <= 2
    assert int(slipping) == int(contact)


def test_path_that_fails_used_all_its_cuts(buckled):
    path, options = buckled.path, buckled.seal.newton
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
    model = with_options(cut.seal, newton=replace(cut.seal.newton, max_cuts=0))
    result = sm.analyze(model)
    assert not result.converged
    assert result.step_cuts == 0
    done = len(result.path.steps)
    assert 0 < done < 20
    np.testing.assert_array_equal(result.reaction, cut.reaction[:done])
    assert cut.path.newton_iterations[done] > cut.seal.newton.max_iterations


def test_steps_before_touching_move_nothing(nominal):
    for step in nominal.path.steps[:4]:
        assert not step.d.any()
        door = nominal.response("door", step)
        height = options_of(nominal.seal).motion.pose(step.fraction).position
        assert not door.total.any()
        assert door.gap.min() == pytest.approx(height[1] - 9.5, abs=1e-12)


def test_base_does_not_move_and_contact_points_are_particles(nominal):
    """Physical displacements: those that the contact sees, zero where imposed."""
    model = nominal.seal
    for step in (30, 104):
        displacement = nominal.path.displacement(step)
        np.testing.assert_allclose(displacement[options_of(model).grid.base], 0.0, atol=1e-14)
        np.testing.assert_allclose(
            nominal.deformed(step)[options_of(model).grid.free_outer],
            nominal.path.at_nominal("door")[step].x,
            rtol=0.0,
            atol=1e-13,
        )


def test_coefficients_are_not_displacements(nominal):
    """The reproducing kernel does not interpolate; results must go through the shape functions."""
    assert np.abs(nominal.path.displacement() - nominal.path.steps[-1].d).max() > 1e-2


def test_base_carries_the_door(nominal):
    """Equilibrium of forces and moments between door and base at several depths."""
    model, structure = nominal.seal, nominal.term("structure")
    for place in (30, 60, 104):
        step, door = nominal.path.nominal_steps[place], nominal.path.at_nominal("door")[place]
        base = structure.forces(step.d, step.fraction)[options_of(model).grid.base]
        x = nominal.particles[options_of(model).grid.base]
        np.testing.assert_allclose(base.sum(axis=0), door.total, rtol=0.0, atol=1e-8)
        moment = np.sum(x[:, 0] * base[:, 1] - x[:, 1] * base[:, 0])
        y, force = door.x, door.force
        from_door = np.sum(y[:, 0] * force[:, 1] - y[:, 1] * force[:, 0])
        assert moment == pytest.approx(from_door, abs=1e-7)


def test_coulomb_limit_holds_at_every_point_of_the_path(nominal, flat):
    """|T_t| <= mu |T_n| up to the curvature factor, and equality where the point slips."""
    for step in flat.path.responses("door"):
        normal, tangential = step.force[:, 1], step.force[:, 0]
        limit = 0.25 * normal
        assert np.all(np.abs(tangential) <= limit + 1e-12)
        slip = step.state == SLIP
        np.testing.assert_allclose(np.abs(tangential[slip]), limit[slip], rtol=1e-10)
    assert np.all(nominal.contact.force[:, 1] >= 0.0)


def test_forces_are_penalty_times_penetration(flat):
    step, length = flat.contact, flat.term("door").length
    touching = step.state != OPEN
    expected = options_of(flat.seal).normal_penalty * length * np.maximum(-step.gap, 0.0)
    np.testing.assert_allclose(step.force[:, 1], expected, rtol=1e-12)
    np.testing.assert_array_equal(touching, step.gap < 0.0)
    assert flat.max_penetration == pytest.approx(-step.gap.min(), rel=1e-15)


def test_flat_door_keeps_the_seal_symmetric(flat):
    """Mirror symmetric section, door and law: x -> -x maps the solution on itself."""
    grid, state = options_of(flat.seal).grid, flat.contact.state
    x = flat.deformed()
    rays = np.arange(58)
    for layer in range(3):
        here, mirror = (x[grid.particle(way, layer)] for way in (rays, -rays))
        np.testing.assert_allclose(here, mirror * [-1.0, 1.0], rtol=0.0, atol=1e-7)
    assert flat.reaction[-1, 0] == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_array_equal(state, state[::-1])


def test_imposed_displacements_are_linear_between_their_steps(rng):
    values = rng.standard_normal((4, 5, 2))
    imposed = ImposedDisplacements(values)
    for fraction in (0.0, 0.25, 1.0, 2.5, 3.0):
        k = min(int(fraction), 2)
        share = fraction - k
        np.testing.assert_allclose(
            imposed.at(fraction), (1 - share) * values[k] + share * values[k + 1], atol=1e-14
        )


def test_point_loads_have_the_resultant_and_the_moment_of_their_forces(rng):
    """sum Phi_I = 1 and sum Phi_I X_I = x carry over to generalised forces."""
    free = square(rng, fixed="nothing")
    points, forces = inside(rng, free), rng.standard_normal((5, 2))
    load = DeadLoad("pull", fixed_points(points, 1.0), forces, np.array([0.0, 1.0]))
    disc = discretize(free.body, free.particles, (load,))
    force, raw = np.zeros(disc.layout.force_size), np.zeros_like(disc.particles)
    load.on(disc, 0).add(raw, raw, 1.0, None, force, np.empty(0))
    disc.layout.condense_force(force)
    loads, x = -force[disc.layout.equations], points.at(disc.particles)
    np.testing.assert_allclose(loads.sum(axis=0), forces.sum(axis=0), atol=1e-11)
    np.testing.assert_allclose(loads.T @ disc.particles, forces.T @ x, atol=1e-9)


def test_edge_points_integrate_along_the_boundary():
    model = sm.door_seal()
    outer = options_of(model).grid.particle(np.arange(58), 2)
    edges = np.column_stack([outer, np.roll(outer, -1)])
    where = edge_points(edges)
    lengths, x = where.lengths(model.nominal_particles), where.points.at(model.nominal_particles)
    ends = model.nominal_particles[edges]
    size = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(size.sum(), rel=1e-14)
    cubic = np.sum(lengths * x[:, 0] ** 3)
    a, b = ends[:, 0, 0], ends[:, 1, 0]
    exact = np.sum(size * (a**3 + a**2 * b + a * b**2 + b**3) / 4)
    assert cubic == pytest.approx(exact, rel=1e-12, abs=1e-9)


def test_dead_load_is_balanced_by_the_base():
    """A small load on the top, no contact: the base carries it, and doubling it nearly doubles d."""
    model = sm.door_seal()
    top = options_of(model).grid.particle(29, 2)
    tops = []
    for size in (1e-3, 2e-3):
        at_top = fixed_points(single_points(top), 1.0)
        load = DeadLoad("pull", at_top, np.array([0.3 * size, -size]), np.array([0.0, 1.0]))
        terms = elastic_body(options_of(model).material), load
        path = solve_path(
            PathProblem(discretize(model.body, model.nominal_particles, terms), terms), 1
        )
        prescribed = path.problem.term("structure").forces(
            path.steps[-1].d, path.steps[-1].fraction
        )[options_of(model).grid.base]
        np.testing.assert_allclose(prescribed.sum(axis=0), [-0.3 * size, size], rtol=0.0, atol=1e-9)
        tops.append(path.displacement()[top])
    np.testing.assert_allclose(tops[1], 2 * tops[0], rtol=1e-3)


def test_failed_path_holds_no_factors():
    """Drivers keep the exceptions of failed analyses, and these the path."""
    model = sm.door_seal(friction=0.0, newton=sm.NewtonOptions(damped_iterations=10))
    failed = sm.analyze(model, keep_factors=True)
    assert not failed.converged
    assert all(step.factor is None for step in failed.path.steps)


# a design that slides under little friction, 0.01 mm
SLIDING = (
    5, -30, -26, 28, 3, -43, 5, 21, -8, -42, -3, 7, -19, -4, -2, 23, 43, 38, 45, -38, -35, 35, 50,
    -2, 26,
)  # fmt: skip


@pytest.mark.long
def test_incremental_history_starts_from_the_better_of_two_predictors(monkeypatch):
    """Friction that a sliding point loses at the start of a step is back at its end."""
    model = sm.door_seal(friction=0.15, friction_history="incremental")
    offsets = 0.01 * np.array(SLIDING)
    path = sm.analyze(model, offsets, {"door_radius": 3.75}).path
    assert path.converged
    assert path.step_cuts == 0
    both = load_path.predict
    for only in (slice(0, 1), slice(1, 2)):
        monkeypatch.setattr(
            load_path, "predict", lambda increment, only=only: both(increment)[only]
        )
        one = sm.analyze(model, offsets, {"door_radius": 3.75}).path
        better = path.newton_iterations.sum() < one.newton_iterations.sum()
        assert better or not one.converged

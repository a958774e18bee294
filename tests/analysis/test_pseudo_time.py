"""Damped motion where Newton's method finds no way: a seal that slides for a moment."""

from dataclasses import replace

import numpy as np
import pytest
from lines import check, slopes
from verification.differences import beside

import seal_mdao as sm
from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.pseudo_time import ending, relax
from seal_mdao.contact.friction import OPEN, STICK
from seal_mdao.seals.door.door_seal import with_options

# little friction; the last point that sticks begins to slide near the end of the path (0.01 mm)
OFFSETS = 0.01 * np.array([
    17, -6, -23, 36, -32, -49, 15, 22, -10, -49, 21, 7, -25, 20, 15, 23, 27, 37, 17, -8, -15, 13, 24,
    19, 12,
])  # fmt: skip
RADIUS = {"door_radius": 3.62}
NEWTON = sm.NewtonOptions(tolerance=1e-11)
STEP = 5e-6


@pytest.fixture(scope="module")
def model():
    return sm.door_seal(friction=0.14, corner_x=4.0, newton=NEWTON)


@pytest.fixture(scope="module")
def sliding(model):
    return sm.analyze(model, OFFSETS, RADIUS, keep_factors=True)


@pytest.fixture(scope="module")
def stuck(model):
    """The same path without damped motion."""
    newton = replace(NEWTON, damped_iterations=0)
    return sm.analyze(with_options(model, newton=newton), OFFSETS, RADIUS)


def test_newton_alone_ends_where_the_last_point_begins_to_slide(stuck):
    assert stuck.path.status is Status.CYCLED
    assert stuck.path.step_cuts >= 8
    states = stuck.response("door", stuck.path.steps[-1]).state
    assert np.sum(states == STICK) == 1


def test_damped_motion_completes_the_path(sliding, stuck):
    """In whole steps: the same until there, then on to the end of the nominal step."""
    done = int(stuck.path.steps[-1].fraction)
    path = sliding.path
    assert sliding.converged
    assert len(path.steps) == 105
    # iterations that cycle are followed by damped motion at once, not by shorter steps
    assert path.step_cuts == 0
    for one, other in zip(path.steps[:done], stuck.path.steps[:done], strict=True):
        np.testing.assert_array_equal(one.d, other.d)
    moved = np.abs(path.steps[done].d - path.steps[done - 1].d).max()
    assert moved < 0.2


def test_a_point_that_begins_to_slide_is_no_limit_point(sliding):
    """Newton's method fails there, but the path continues where the tangent says."""
    assert sliding.critical_points == ()


def test_what_it_finds_is_equilibrium(sliding, stuck, model):
    path = sliding.path
    problem = PathProblem(path.discretization, sliding.seal.terms())
    relaxed = path.steps[int(stuck.path.steps[-1].fraction)]
    found = problem.assemble_at(relaxed)
    assert found.size <= model.newton.tolerance or found.rounding
    state = found.responses[path.index_of("door")].state
    np.testing.assert_array_equal(state, sliding.response("door", relaxed).state)
    assert np.sum(state != OPEN) > 2


def test_steps_stay_whole_where_newtons_method_fails_beside_a_design():
    """With the incremental history a halved step is another path: stresses would jump by 0.1 kPa.

    An optimiser came here: in the last step Newton's method converges at some designs of a line and
    not at those between them.
    """
    few = replace(NEWTON, max_iterations=7)  # else rounding decides whether it converges
    seal = sm.door_seal(friction=0.15, friction_history="incremental", segments=32, newton=few)
    offsets = 1e-3 * np.array([
        18, -83, -409, 240, -89, -485, -54, 308, 56, -459, 54, 85, -379, 113, -113, 192, 423, 247, 319,
        -272, 12, 392, 471, 251, 193,
    ])  # fmt: skip
    along = np.linspace(-1e-3, 1e-3, 5)
    results = [sm.analyze(seal, offsets + t, {"door_radius": 3.848}) for t in along]
    assert any(result.step_cuts > 0 for result in results)
    assert all(len(result.path.steps) == 105 for result in results)
    stress = np.array([result.von_mises for result in results])
    bend = np.abs(np.diff(stress, 2, axis=0)).max()
    assert bend < 1e-2 * np.abs(np.diff(stress, axis=0)).max()


@pytest.mark.long
def test_derivatives_pass_through_it(sliding, model, rng):
    way = rng.uniform(-1.0, 1.0, model.n_offsets)

    def moved(t):
        return beside(sliding, OFFSETS + t * way)

    found = slopes(sliding, moved, STEP)
    check(found, sm.differentiate(sliding), np.append(way, 0.0))


def test_too_few_iterations_leave_the_failure_of_newton(model, stuck):
    few = with_options(model, newton=replace(NEWTON, damped_iterations=3))
    result = sm.analyze(few, OFFSETS, RADIUS)
    assert not result.converged
    assert result.path.failure == stuck.path.failure


def test_failure_names_the_option_that_helps(buckled):
    assert "within 80 iterations" in buckled.failure
    assert "damped_iterations of NewtonOptions" in buckled.failure
    assert buckled.failure.index("damped_iterations") < buckled.failure.index("n_steps")


def test_damped_motion_tells_how_far_it_is(model):
    class Watch:
        def __init__(self):
            self.seen = []

        def __call__(self, step):
            pass

        def damped(self, iteration, residual):
            self.seen.append((iteration, residual))

    watch = Watch()
    assert sm.analyze(model, OFFSETS, RADIUS, callback=watch).converged
    assert len(watch.seen) > 3
    assert watch.seen[-1][1] < 1e-8


def test_body_that_nothing_holds_moves_off(nominal):
    """From a place farther away than any seal goes."""
    problem = PathProblem(nominal.path.discretization, nominal.seal.terms())
    away = np.full_like(nominal.particles, 1000.0)
    found = relax(Increment(problem, 1.0, problem.no_history(), nominal.seal.newton), away)
    assert found.status is Status.MOVED_OFF
    assert "moves the seal away without limit" in ending(found.status, nominal.seal.newton)

"""Stable branches: what happens where equilibrium loses its stability."""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from bodies import dense
from seal_file.block_files import between_plates
from verification.differences import beside

import seal_mdao as sm
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.stability import _driving
from seal_mdao.seals.door.door_seal import DOOR, options_of, with_options

PRIMARY = sm.NewtonOptions(branch="primary")


def flat_door(**changes):
    return sm.door_seal(door="flat", friction=0.0, **changes)


@cache
def corner_door(corner_x, n_steps=105):
    return sm.analyze(sm.door_seal(friction=0.0, corner_x=corner_x, n_steps=n_steps))


@pytest.fixture(scope="module")
def swayed():
    return sm.analyze(flat_door())


@pytest.fixture(scope="module")
def upright():
    return sm.analyze(flat_door(newton=PRIMARY))


def lowest_eigenvalue(result, step):
    """Of the tangent, from all of its entries."""
    problem = PathProblem(result.path.discretization, result.seal.terms())
    layout = problem.discretization.layout
    return np.linalg.eigvalsh(dense(layout, problem.assemble_at(step).values))[0]


def work_of_the_door(result):
    """By the trapezoidal rule over all steps; the force of a step with a jump is that before it."""
    motion, force, height = options_of(result.seal).motion, [0.0], [options_of(result.seal).start]
    for step in result.path.steps:
        height.append(motion.pose(step.fraction).position[1])
        force.append(step.responses[result.path.index_of(DOOR)].total[1])
    force, height, work = np.array(force), np.array(height), 0.0
    starts = np.array([0.0, *(step.fraction for step in result.path.steps)])
    points = result.critical_points
    jumps = {np.searchsorted(starts, point.fraction, "right") - 1 for point in points}
    for k in range(len(height) - 1):
        mean = force[k] if k in jumps else 0.5 * (force[k] + force[k + 1])
        work += mean * (height[k] - height[k + 1])
    return work


def stored(result):
    """Strain and penalty energy at the end."""
    step = result.path.steps[-1]
    door = result.response(DOOR, step)
    inside = np.minimum(door.gap, 0.0)
    penalty = (
        0.5 * options_of(result.seal).normal_penalty * np.sum(result.term(DOOR).length * inside**2)
    )
    return result.term("structure").energy(step.d, step.fraction) + penalty


def test_flat_door_leaves_the_upright_branch(swayed, upright):
    """Upright it would carry 63.5 N/m; independent finite elements leave that at about 4.3 mm."""
    assert swayed.converged
    assert upright.reaction[-1, 1] == pytest.approx(63.5, abs=0.1)
    assert swayed.reaction[-1, 1] < 0.75 * upright.reaction[-1, 1]
    assert swayed.critical_points[0].kind == "branch"
    assert swayed.critical_points[0].travel == pytest.approx(4.3, abs=0.15)


@pytest.mark.release
def test_the_first_critical_travel_converges_with_the_cloud():
    """Twice as many particles along the boundary, a smaller difference, and both are small."""
    travel = [
        sm.analyze(flat_door(rays=rays, layers=layers, depth=4.9, n_steps=54))
        .critical_points[0]
        .travel
        for rays, layers in ((58, 3), (116, 5), (232, 5))
    ]
    first, second = np.abs(np.diff(travel))
    assert second < 0.8 * first
    assert first < 0.02 * travel[-1]


def test_both_branches_are_one_until_there(swayed, upright):
    places = np.flatnonzero(swayed.travel < swayed.critical_points[0].travel)
    assert places.size > 40
    for place in places:
        one, other = swayed.path.nominal_steps[place], upright.path.nominal_steps[place]
        np.testing.assert_array_equal(one.d, other.d)


def test_every_step_of_the_stable_branch_is_stable(swayed):
    assert all(step.stable for step in swayed.path.steps)
    for step in swayed.path.nominal_steps[40::16]:
        assert lowest_eigenvalue(swayed, step) > 0.0


def test_the_potential_has_a_rate_at_the_beginning_of_the_path(tmp_path):
    """There is no pose of a profile before the first one."""
    path = sm.analyze(between_plates(tmp_path, friction=0.0)).path
    # the block moved up into the lid by g, where Pi = w_n L g^2 / 2, with L = 8 mm; the lid moves
    # down by 0.025 mm in the first step
    g = 0.1
    moved = replace(path.start, d=path.start.d + np.array([0.0, g]))
    assert moved.fraction == 0.0
    # one-sided difference: relative error of half the motion within it, 1e-4 steps, over g
    assert _driving(path.problem, moved) == pytest.approx(1e7 * 8.0 * g * 0.025, rel=2e-5)


def test_the_other_branch_says_where_it_is_unstable(swayed, upright):
    unstable = [step for step in upright.path.steps if not step.stable]
    assert len(unstable) > 50
    for step in unstable[::18]:
        assert lowest_eigenvalue(upright, step) < 0.0
    # one point for every loss of stability, not for every unstable step
    stable = [True, *(step.stable for step in upright.path.steps)]
    losses = sum(before and not after for before, after in pairwise(stable))
    assert len(upright.critical_points) == losses < 5
    first = upright.critical_points[0]
    assert first.travel == pytest.approx(swayed.critical_points[0].travel, abs=0.1)
    assert (first.moved, first.released) == (0.0, 0.0)
    assert "on, and the analysis follows this unstable branch" in first.text
    assert any(
        "the equilibrium at the end of the analysis is not" in text for text in upright.warnings
    )
    assert not any("not stable" in text for text in swayed.warnings)


def test_the_critical_mode_is_a_sway(swayed):
    """To the right, and antisymmetric: the section and the door are symmetric."""
    grid, mode, rays = options_of(swayed.seal).grid, swayed.critical_points[0].mode, np.arange(58)
    assert np.abs(mode).max() == 1.0
    assert mode[:, 0].sum() > 0.0
    here, mirror = mode[grid.particle(rays, 1)], mode[grid.particle(-rays, 1)]
    np.testing.assert_allclose(here, mirror * [1.0, -1.0], atol=1e-3)


def test_the_same_bits_again(swayed):
    again = sm.analyze(flat_door())
    for one, other in zip(again.path.steps, swayed.path.steps, strict=True):
        np.testing.assert_array_equal(one.d, other.d)


@pytest.mark.parametrize(
    ("corner_x", "first"),
    [
        (2.0, 4.39),
        pytest.param(0.0, 5.74, marks=pytest.mark.long),
        pytest.param(4.0, 4.39, marks=pytest.mark.long),
    ],
)
def test_corner_door_completes_on_stable_branches(corner_x, first):
    result = corner_door(corner_x)
    assert result.converged
    assert all(step.stable for step in result.path.steps)
    assert 39.5 < result.reaction[-1, 1] < 41.5
    assert result.critical_points[0].travel == pytest.approx(first, abs=0.02)
    assert result.warnings == ()


@pytest.mark.parametrize("corner_x", [0.0, 2.0])
def test_energy_balances_over_the_jumps(corner_x):
    """The work of the door is stored or released; the jump at the corner releases a tenth of it."""
    result = corner_door(corner_x)
    released = sum(point.released for point in result.critical_points)
    work = work_of_the_door(result)
    assert released > 0.09 * work
    assert work == pytest.approx(stored(result) + released, rel=1e-3)
    # the error is small beside what the jumps released, too
    assert abs(work - stored(result) - released) < 0.01 * released


@pytest.mark.parametrize(
    "corner_x",
    [
        *(pytest.param(own, marks=pytest.mark.release) for own in (0.0, 2.0)),
        pytest.param(4.0, marks=pytest.mark.long),
    ],
)
def test_the_path_does_not_depend_on_the_number_of_steps(corner_x):
    coarse, middle, fine = (corner_door(corner_x, n) for n in (105, 210, 420))
    scale = fine.reaction[-1, 1]
    for other, every in ((middle, 2), (coarse, 4)):
        difference = other.reaction - fine.reaction[every - 1 :: every]
        # in the load step of a jump one path may have jumped and the other not
        away = np.ones(len(difference), bool)
        for point in (*other.critical_points, *fine.critical_points):
            away &= np.abs(other.travel - point.travel) > 0.11
        assert away.sum() > 0.6 * len(away)
        # the same equilibria: Newton's tolerance is left
        assert np.abs(difference[away]).max() < 1e-6 * scale
    for others in (coarse, middle):
        largest, its = (max(r.critical_points, key=lambda p: p.released) for r in (others, fine))
        assert largest.travel == pytest.approx(its.travel, abs=0.02)
        assert largest.released == pytest.approx(its.released, rel=1e-2)


@pytest.fixture(scope="module")
def beyond(tight):
    """A design that has jumped to the side of the corner door."""
    seal = sm.door_seal(friction=0.0, newton=tight, depth=8.0, n_steps=40)
    return sm.analyze(seal, design_beyond(seal), keep_factors=True)


def design_beyond(seal):
    return np.random.default_rng(5).uniform(-0.05, 0.05, seal.n_offsets)


def test_both_methods_agree_on_the_branch_taken(beyond):
    names = ("c10", "bulk_modulus", "depth", "normal_penalty")
    direct, adjoint = (
        sm.differentiate(beyond, names, method=method) for method in ("direct", "adjoint")
    )
    for name in ("von_mises", "reaction"):
        size = np.abs(direct[name]).max()
        np.testing.assert_allclose(direct[name], adjoint[name], rtol=0.0, atol=1e-9 * size)


@pytest.mark.long
def test_derivatives_are_those_of_the_branch_taken(beyond, rng):
    """Central differences of fourth order at the end; the jump comes at another travel in each."""
    assert max(point.moved for point in beyond.critical_points) > 3.0
    offsets, step = design_beyond(beyond.seal), 5e-5
    way = rng.uniform(-1.0, 1.0, beyond.seal.n_offsets)
    others = [beside(beyond, offsets + t * step * way) for t in (-2, -1, 1, 2)]
    for other in others:
        np.testing.assert_array_equal(other.contact.state, beyond.contact.state)
    found = sm.differentiate(beyond)
    for name, values in (
        ("von_mises", [other.von_mises for other in others]),
        ("reaction", [other.reaction[-1] for other in others]),
    ):
        quotient = np.array([1, -8, 8, -1]) @ np.array(values) / (12.0 * step)
        exact = found[name][-len(quotient) :] @ np.append(way, 0.0)
        # rounding: forces of 1e2 with a tolerance of 1e-11 and tangents of condition 1e5, over the step
        assert np.abs(quotient - exact).max() < 1e-6 * np.abs(exact).max(), name


def test_little_motion_allowed_names_what_was_lost(buckled):
    assert not buckled.converged
    assert "the seal snaps to the next stable equilibrium" in buckled.failure
    assert buckled.critical_points


def test_friction_steadies_the_seal(flat):
    assert flat.critical_points == ()
    assert all(step.stable for step in flat.path.steps)


def test_under_friction_the_determinant_is_only_watched():
    """The path is the same; the sign says that the tangent has been singular."""
    model = sm.door_seal(door="flat", friction=0.05)
    result, same = (sm.analyze(m) for m in (model, with_options(model, newton=PRIMARY)))
    assert result.converged
    assert {point.kind for point in result.critical_points} == {"unsymmetric"}
    np.testing.assert_array_equal(result.path.steps[-1].d, same.path.steps[-1].d)
    first = result.critical_points[0]
    assert "may not be stable" in first.text
    problem = PathProblem(result.path.discretization, result.seal.terms())
    place = round(first.fraction) - 1
    signs = []
    for step in result.path.nominal_steps[place - 1 : place + 1]:
        values = problem.assemble_at(step).values
        signs.append(np.linalg.slogdet(dense(problem.discretization.layout, values))[0])
    assert signs == [1.0, -1.0]

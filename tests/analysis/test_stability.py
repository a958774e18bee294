"""Stable branches: what happens where equilibrium loses its stability."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.analysis.problem import PathProblem


def flat_door(**changes):
    return sm.door_seal(door="flat", friction=0.0, **changes)


@pytest.fixture(scope="module")
def swayed():
    return sm.analyze(flat_door())


@pytest.fixture(scope="module")
def upright():
    return sm.analyze(flat_door(newton=sm.NewtonOptions(branch="primary")))


def travel(result, point):
    """Travel of the door at a critical point, mm."""
    return 9.5 - result.seal.motion.pose(point.fraction).position[1]


def lowest_eigenvalue(result, step):
    """Of the tangent, from all of its entries."""
    problem = PathProblem(result.path.discretization, result.seal.terms())
    problem.assemble_at(step)
    storage, n = problem.discretization.layout.storage, problem.discretization.layout.n_equations
    band = problem.values[: storage.size].reshape(n, storage.rows).T
    w = storage.width
    matrix = sum(np.diag(band[2 * w + k, : n - k], -k) for k in range(w + 1))
    return np.linalg.eigvalsh(matrix)[0]


def test_flat_door_leaves_the_upright_branch(swayed, upright):
    """Upright it would carry 63.5 N/m; independent finite elements leave that at about 4.3 mm."""
    assert swayed.converged
    assert upright.reaction[-1, 1] == pytest.approx(63.5, abs=0.1)
    assert swayed.reaction[-1, 1] < 0.75 * upright.reaction[-1, 1]
    first = swayed.path.critical_points[0]
    assert first.kind == "branch"
    assert travel(swayed, first) == pytest.approx(4.3, abs=0.15)


def test_both_branches_are_one_until_there(swayed, upright):
    places = np.flatnonzero(swayed.door_travel < travel(swayed, swayed.path.critical_points[0]))
    for place in places:
        one, other = swayed.path.nominal_steps[place], upright.path.nominal_steps[place]
        np.testing.assert_array_equal(one.d, other.d)


def test_no_step_of_the_stable_branch_is_unstable(swayed):
    assert all(step.stable for step in swayed.path.steps)
    for step in swayed.path.nominal_steps[40::16]:
        assert lowest_eigenvalue(swayed, step) > 0.0


def test_the_other_branch_says_where_it_is_unstable(swayed, upright):
    assert [p.kind for p in upright.path.critical_points] == ["branch", "branch"]
    unstable = [step for step in upright.path.steps if not step.stable]
    assert len(unstable) > 50
    for step in unstable[::18]:
        assert lowest_eigenvalue(upright, step) < 0.0
    for mine, its in zip(swayed.path.critical_points, upright.path.critical_points, strict=True):
        assert mine.fraction == pytest.approx(its.fraction, abs=1.0)


def test_the_critical_mode_is_a_sway(swayed):
    """All to the right, and antisymmetric: the section and the door are symmetric."""
    grid, point = swayed.seal.grid, swayed.path.critical_points[0]
    assert np.abs(point.mode).max() == 1.0
    assert point.mode[:, 0].sum() > 0.0
    rays = np.arange(58)
    here, mirror = point.mode[grid.particle(rays, 1)], point.mode[grid.particle(-rays, 1)]
    np.testing.assert_allclose(here, mirror * [1.0, -1.0], atol=1e-4)

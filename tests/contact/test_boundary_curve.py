"""The deformed boundary as a curve: how near, how smooth, and the kinematics of points near it."""

import numpy as np
import pytest

from seal_mdao.contact.boundary_curve import (
    N_PLACES,
    cubics,
    kinematics,
    masters,
    outward,
    project,
    rings,
)

POINTS, NEAREST = np.array([3, 7, 12, 20, 33]), np.array([25, 30, 38, 9, 14])


def ellipse(k, a=10.0, b=4.0):
    angle = 2.0 * np.pi * np.arange(k) / k
    return np.column_stack([a * np.cos(angle), b * np.sin(angle)])


@pytest.fixture
def crossed(rng):
    """A crooked loop, some of whose points lie near others."""
    x, ring = ellipse(40) + 0.05 * rng.standard_normal((40, 2)), rings([40])
    off = 0.05 * rng.standard_normal((len(POINTS), 1)) * outward(x, ring)[NEAREST]
    x[POINTS] = x[NEAREST] + off + 0.03 * rng.standard_normal((len(POINTS), 2))
    return x, ring


def places_near(x, ring):
    segments, s, found = project(x, x[POINTS], NEAREST, ring)
    assert found.all()
    nodes = np.column_stack([POINTS, masters(segments, ring)])
    return nodes, kinematics(x, nodes, segments, s)


def test_lines_are_reproduced_and_curvature_is_continuous():
    s = np.linspace(0.0, 1.0, 7)
    np.testing.assert_allclose(cubics(s, 0).sum(axis=1), 1.0, rtol=1e-14)
    np.testing.assert_allclose(cubics(s, 0) @ np.arange(-2.0, 4.0), s, atol=1e-14)
    zero, one = np.zeros(1), np.ones(1)
    for order in range(3):
        ahead, behind = cubics(zero, order)[0], cubics(one, order)[0]
        np.testing.assert_allclose([0.0, *ahead], [*behind, 0.0], atol=1e-14)


def test_the_curve_converges_with_the_fourth_power():
    """To a circle; 2 is what the distance from a chord does."""

    def error(k):
        x, ring = ellipse(k, 1.0, 1.0), rings([k])
        r = [cubics(np.full(k, s), 0) for s in (0.0, 0.3, 0.5)]
        nodes = x[masters(np.arange(k), ring)]
        return max(np.abs(np.hypot(*np.einsum("mb,mbi->im", w, nodes)) - 1.0).max() for w in r)

    errors = [error(k) for k in (20, 40, 80)]
    assert np.log2(errors[0] / errors[1]) > 3.8
    assert np.log2(errors[1] / errors[2]) > 3.9


def test_kinematics_against_central_differences(crossed):
    """Of first and second order, by all places. The step's square times third derivatives is below
    1e-8; rounding over the step 1e-11."""
    (x, ring), h = crossed, 1e-5
    nodes, exact = places_near(x, ring)
    for i in range(len(POINTS)):
        for column in range(N_PLACES):
            after, before = x.copy(), x.copy()
            at = nodes[i, column // 2], column % 2
            after[at] += h
            before[at] -= h
            a, b = places_near(after, ring)[1], places_near(before, ring)[1]
            for name in ("gap", "xi", "size"):
                found = (getattr(a, name)[i] - getattr(b, name)[i]) / (2.0 * h)
                assert abs(found - getattr(exact, f"{name}_1")[i, column]) < 1e-8
            for name in ("gap", "xi"):
                found = (getattr(a, f"{name}_1")[i] - getattr(b, f"{name}_1")[i]) / (2.0 * h)
                np.testing.assert_allclose(
                    getattr(exact, f"{name}_2")[i, :, column], found, atol=1e-8
                )


def test_gap_and_slip_do_not_know_of_rigid_motions(crossed):
    """So forces and moments of a touching pair balance."""
    x, ring = crossed
    nodes, found = places_near(x, ring)
    at = x[nodes]
    turn = np.stack([-at[..., 1], at[..., 0]], axis=2).reshape(len(nodes), -1)
    for by_places in (found.gap_1, found.xi_1, found.size_1):
        np.testing.assert_allclose(by_places[:, 0::2].sum(axis=1), 0.0, atol=1e-12)
        np.testing.assert_allclose(by_places[:, 1::2].sum(axis=1), 0.0, atol=1e-12)
        np.testing.assert_allclose((by_places * turn).sum(axis=1), 0.0, atol=1e-11)


def test_ways_round_two_loops():
    ring = rings([10, 8])
    way = ring.coordinate_change(np.array([0.5, 9.5, 17.5, 3.0]), np.array([9.5, 0.5, 10.5, 12.0]))
    np.testing.assert_allclose(way[:3], [1.0, -1.0, -1.0])
    assert np.isnan(way[3])
    assert ring.step(np.array([9, 17, 10]), 1).tolist() == [0, 10, 11]

"""The deformed boundary as a curve: how near, how smooth, and the kinematics of points near it."""

import numpy as np
import pytest

from seal_mdao.contact.boundary_curve import (
    BESIDE,
    N_PLACES,
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
    return nodes, kinematics(x, nodes, segments, s, ring)


def test_the_curve_runs_through_its_points_with_continuous_curvature():
    """It reproduces polynomials of fourth degree in xi at the points, lines everywhere."""
    ring, at = rings([12]), np.full(7, 4)
    s = np.linspace(0.0, 1.0, 7)
    np.testing.assert_allclose(ring.weights(at, s, 0).sum(axis=1), 1.0, rtol=1e-14)
    np.testing.assert_allclose(ring.weights(at, s, 0) @ np.arange(-2.0, 4.0), s, atol=1e-14)
    zero, one = np.zeros(1), np.ones(1)
    for order in range(3):
        ahead, behind = ring.weights(at[:1], zero, order)[0], ring.weights(at[:1], one, order)[0]
        np.testing.assert_allclose([0.0, *ahead], [*behind, 0.0], atol=1e-13)
        # d^n(s^4)/ds^n at the points a and a + 1
        powers = np.arange(-2.0, 4.0) ** 4
        assert ahead @ powers == pytest.approx(0.0, abs=1e-12)
        assert ring.weights(at[:1], one, 0)[0] == pytest.approx([0, 0, 0, 1, 0, 0], abs=1e-14)


def test_the_curve_is_smoothed_at_bends():
    """There it is the quasi-interpolation with cubic B-splines, control points (-1, 8, -1)/6."""
    bent = np.arange(12) % 12 < 9
    ring, at, zero = rings([12], bent=bent), np.array([4]), np.zeros(1)
    splines = np.convolve([1.0, 4.0, 1.0], [-1.0, 8.0, -1.0]) / 36.0
    np.testing.assert_allclose(ring.weights(at, zero, 0)[0], [*splines, 0.0], atol=1e-14)
    curvature = np.convolve([1.0, -2.0, 1.0], [-1.0, 8.0, -1.0]) / 6.0
    np.testing.assert_allclose(ring.weights(at, zero, 2)[0], [*curvature, 0.0], atol=1e-13)
    # and at the others it runs through its points; a uniform pressure is handed over as it is
    every, smoothing = np.arange(12), np.zeros((12, 12))
    weights = ring.weights(every, np.zeros(12), 0)
    np.add.at(smoothing, (every[:, None], masters(every, ring)), weights)
    assert smoothing[10] == pytest.approx(np.eye(12)[10], abs=1e-14)
    np.testing.assert_allclose(smoothing.sum(axis=0), 1.0, atol=1e-14)


def squares(h, beside):
    """Points of a square with sides of 4 h, two at every corner, and the first ones there."""
    side = h * np.array([beside, 1.0, 2.0, 3.0, 4.0 - beside])
    along = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    start = 4.0 * h * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    x = start[:, None] + side[:, None] * along[:, None]
    return x.reshape(-1, 2), np.tile([False, False, False, False, True], 4)


def test_sides_between_corners_are_straight():
    """Beside a corner the curve leaves the side by the fifth power of the way to the corner."""
    x, corner = squares(0.5, BESIDE)
    ring = rings([20], corner)
    s = np.linspace(0.0, 1.0, 101)

    def curve(segment):
        at = np.full(len(s), segment)
        return np.einsum("mb,mbi->mi", ring.weights(at, s, 0), x[masters(at, ring)])

    for segment in range(4):
        np.testing.assert_allclose(curve(segment)[:, 1], 0.0, atol=1e-15)
        # monotonic
        assert (np.diff(curve(segment)[:, 0]) > 0.0).all()
    around, inset = curve(4), 0.5 * BESIDE
    np.testing.assert_allclose(around[:, 1], inset * s**5, atol=1e-3 * inset)
    np.testing.assert_allclose(2.0 - around[:, 0], inset * (1.0 - s) ** 5, atol=1e-3 * inset)


def test_straight_sides_with_bends_are_not_smoothed():
    """The distances of points beside a corner are shorter than the others."""
    x, corner = squares(0.5, BESIDE)
    ring, every = rings([20], corner, bent=~corner & ~np.roll(corner, 1)), np.arange(20)
    for order, exact in ((0, x), (2, np.zeros((20, 2)))):
        weights = ring.weights(every, np.zeros(20), order)
        found = np.einsum("mb,mbi->mi", weights, x[masters(every, ring)])
        # around a corner the curve is bent on purpose
        np.testing.assert_allclose(found[~corner], exact[~corner], atol=1e-14)


def test_projections_within_two_segments_of_the_nearest_point_are_found():
    x, ring, every = ellipse(40), rings([40]), np.arange(40)
    for ahead in (-1.5, -0.5, 0.5, 1.5, 2.5, -2.5):
        segments, s = ring.step(every, int(np.floor(ahead))), np.full(40, 0.5)
        places = np.einsum("mb,mbi->mi", ring.weights(segments, s, 0), x[masters(segments, ring)])
        places += 0.01 * outward(x, ring)[segments]
        own, along, found = project(x, places, every, ring)
        assert found.all() == found.any() == (abs(ahead) < 2.0)
        if abs(ahead) < 2.0:
            np.testing.assert_array_equal(own, segments)
            np.testing.assert_allclose(along, 0.5, atol=0.01)


def test_a_point_that_faces_a_point_of_the_curve_is_found():
    """Rounding decides on which side of it the projection lies, but not whether there is one."""
    x, corner = squares(0.5, BESIDE)
    ring, every = rings([20], corner), np.arange(20)
    for angle in np.linspace(0.0, 1.5, 100):
        c, s = np.cos(angle), np.sin(angle)
        places = x @ np.array([[c, s], [-s, c]])
        segments, s, found = project(places, places + 1e-3 * outward(places, ring), every, ring)
        assert found.all()
        off = np.abs(segments + s - every)
        assert np.minimum(off, 20.0 - off).max() < 1e-2


def test_the_curve_converges_with_the_fourth_power():
    """To a circle; 2 is what the distance from a chord does."""

    def error(k):
        x, ring = ellipse(k, 1.0, 1.0), rings([k])
        r = [ring.weights(np.arange(k), np.full(k, s), 0) for s in (0.0, 0.3, 0.5)]
        nodes = x[masters(np.arange(k), ring)]
        return max(np.abs(np.hypot(*np.einsum("mb,mbi->im", w, nodes)) - 1.0).max() for w in r)

    errors = [error(k) for k in (20, 40, 80)]
    assert np.log2(errors[0] / errors[1]) > 3.8
    assert np.log2(errors[1] / errors[2]) > 3.9


def test_kinematics_against_central_differences(crossed):
    """Of first and second order, by all places. Differences of fourth order: their error is below the
    rounding of 1e-16 over the step, times the largest entries of 1e3."""
    (x, ring), h = crossed, 1e-5
    nodes, exact = places_near(x, ring)

    def moved(at, step):
        other = x.copy()
        other[at] += step * h
        return places_near(other, ring)[1]

    for i in range(len(POINTS)):
        for column in range(N_PLACES):
            at = nodes[i, column // 2], column % 2
            sampled = [moved(at, step) for step in (-2, -1, 1, 2)]

            def quotient(name, i=i, sampled=sampled):
                values = [getattr(found, name)[i] for found in sampled]
                return np.tensordot([1.0, -8.0, 8.0, -1.0], values, axes=1) / (12.0 * h)

            for name in ("gap", "xi", "size"):
                found = getattr(exact, f"{name}_1")[i, column]
                assert abs(found - quotient(name)) < 1e-8
            for name in ("gap", "xi"):
                found = getattr(exact, f"{name}_2")[i, :, column]
                np.testing.assert_allclose(found, quotient(f"{name}_1"), atol=1e-8)


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
    # xi is rounded up to the number of points at the end of the last segment
    assert ring.coordinate_change(np.array([18.0]), np.array([17.5])) == [0.5]
    assert ring.step(np.array([9, 17, 10]), 1).tolist() == [0, 10, 11]

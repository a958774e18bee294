"""The nearest point of cubic pieces against brute force, and the zeros of quintics it rests on."""

import numpy as np
import pytest
from doors import curve, normal
from scipy.optimize import minimize_scalar
from splines import SPLINES, rounded_corner

from seal_mdao.contact.cubic_projection import zeros_of_quintic
from seal_mdao.contact.kinematics import closest_point, contact_frame
from seal_mdao.geometry.profile import polyline_profile
from seal_mdao.geometry.spline_profile import cubic_profile

PROFILES = {name: build(*shape) for name, (build, shape) in SPLINES.items()}
PROFILES["corner"] = rounded_corner(0.5)


def place(profile, xi):
    """The point at a natural coordinate of the whole curve, beyond open ends too."""
    if profile.period > 0.0:
        xi = (xi - profile.start[0]) % profile.period + profile.start[0]
    piece = int(np.clip(np.searchsorted(profile.start, xi, "right") - 1, 0, len(profile.start) - 1))
    return curve(profile, piece, xi)[0]


def brute_force(profile, samples, points, x):
    """Least distance of x to a curve sampled at ``samples``, refined around the best ten."""
    best = np.argsort(np.linalg.norm(points - x, axis=1))[:10]
    found = [
        minimize_scalar(
            lambda xi: np.sum((place(profile, xi) - x) ** 2),
            bounds=(samples[max(i - 1, 0)], samples[min(i + 1, len(samples) - 1)]),
            method="bounded",
            options={"xatol": 1e-12},
        ).fun
        for i in best
    ]
    return np.sqrt(min(found))


def inside(name, points, x):
    """Whether x is in the rigid body, for points not too near its face."""
    if name == "ellipse":
        return np.hypot(*(x / [4.0, 2.5])) < 1.0
    # the face is walked with growing x: the body is above
    return x[1] > np.interp(x[0], *points.T)


@pytest.mark.parametrize("name", PROFILES)
def test_gap_is_the_distance_found_by_brute_force(name, rng):
    """Also far inside, between crests, where several places are nearest in their surroundings."""
    profile = PROFILES[name]
    end = profile.start[-1] + profile.length[-1]
    beyond = 0.0 if profile.period > 0.0 else 20.0
    samples = np.linspace(profile.start[0] - beyond, end + beyond, 3001)
    points = np.array([place(profile, xi) for xi in samples])
    several = 0
    for x in rng.uniform((-7.0, -5.0), (8.0, 6.0), (120, 2)):
        piece, xi, gap = closest_point(profile, *x)
        assert abs(gap) == pytest.approx(brute_force(profile, samples, points, x), abs=1e-9)
        if name != "corner" and abs(gap) > 1e-2:
            assert (gap < 0.0) == inside(name, points, x)
        away = np.linalg.norm(points - x, axis=1)
        several += np.sum((away[1:-1] < away[:-2]) & (away[1:-1] < away[2:])) > 1
        away = x - curve(profile, piece, xi)[0]
        assert away @ normal(profile, piece, xi) == pytest.approx(gap, abs=1e-14)
        # the residual of (18) is what rounding of x and x_c leaves
        rounding = 20 * np.finfo(float).eps * np.abs([*x, *curve(profile, piece, xi)[0]]).max()
        assert abs(away @ curve(profile, piece, xi)[1]) <= rounding * np.hypot(
            *curve(profile, piece, xi)[1]
        )
    assert several >= {"wave": 30, "ellipse": 5, "corner": 0}[name]


@pytest.mark.parametrize("name", ["ellipse", "wave"])
def test_points_beside_the_curve_find_their_place_again_on_both_sides(name):
    """Within the radius of curvature; c > 0 there."""
    profile = PROFILES[name]
    for piece in range(len(profile.kind)):
        for share in (0.0, 1e-13, 0.3, 0.9999999, 1.0):
            xi = profile.start[piece] + share * profile.length[piece]
            for gap in (-0.12, -1e-6, 0.0, 1e-3, 0.15):
                x = curve(profile, piece, xi)[0] + gap * normal(profile, piece, xi)
                there, found, distance = closest_point(profile, *x)
                way = found - xi
                if profile.period > 0.0:
                    way -= profile.period * np.round(way / profile.period)
                assert way == pytest.approx(0.0, abs=1e-13 * max(1.0, abs(xi)))
                assert distance == pytest.approx(gap, abs=2e-15)
                # at a joint too the frame is that of the curve, not of its tangent
                _, _, _, alpha, _, _, c = contact_frame(profile, there, found, distance)
                exact = normal(profile, piece, xi) @ curve(profile, piece, xi)[2]
                assert alpha == pytest.approx(exact, abs=1e-9)
                assert c > 0.0


@pytest.mark.parametrize("name", PROFILES)
def test_gap_is_continuous_across_all_joints(name):
    """Along a walk beside the curve: it changes by no more than what was walked."""
    profile = PROFILES[name]
    ways = [profile.start[0] + 1e-3 * k for k in range(int(1e3 * profile.length.sum()))]
    for distance in (-0.1, 0.1):
        walk = []
        for xi in ways[:: 1 + len(ways) // 6000]:
            piece = int(np.searchsorted(profile.start, xi, "right") - 1)
            walk.append(curve(profile, piece, xi)[0] + distance * normal(profile, piece, xi))
        gaps = np.array([closest_point(profile, *x)[2] for x in walk])
        np.testing.assert_allclose(gaps, distance, atol=1e-13)


def test_a_corner_between_cubics_is_continued_as_that_of_a_polyline(rng):
    """Straight cubic pieces and lines through the same vertices: the same gaps everywhere."""
    vertices = np.array([[-3.0, 0.5], [0.0, 0.0], [1.0, 2.0], [3.5, 1.5], [4.0, 4.0]])
    lines, edges = polyline_profile(vertices), np.diff(vertices, axis=0)
    knots = np.concatenate([lines.start, lines.start[-1:] + lines.length[-1:]])
    coefficients = np.zeros((4, 4, 2))
    coefficients[:, 0] = vertices[:-1]
    coefficients[:, 1] = edges / np.hypot(*edges.T)[:, None]
    cubics = cubic_profile(knots, coefficients)
    for x in rng.uniform((-5.0, -3.0), (7.0, 6.0), (300, 2)):
        expected, found = closest_point(lines, *x), closest_point(cubics, *x)
        assert found[0] == expected[0]
        np.testing.assert_allclose(found[1:], expected[1:], atol=1e-12)


def test_a_search_that_leaves_far_pieces_out_finds_the_same(rng):
    """In the circles around pieces and around runs of them."""
    for profile in (rounded_corner(0.05), SPLINES["ellipse"][0](4.0, 2.5)):
        everywhere = profile._replace(
            run_radius=np.full_like(profile.run_radius, np.inf),
            radius=np.full_like(profile.radius, np.inf),
        )
        for x, y in rng.uniform((-6.0, -4.0), (8.0, 8.0), (200, 2)):
            assert closest_point(profile, x, y) == closest_point(everywhere, x, y)


@pytest.mark.parametrize(
    "roots",
    [
        (0.1, 0.3, 0.5, 0.7, 0.9),
        (-0.5, 0.2, 0.2000001, 0.8, 3.0),
        (0.5, 0.5, 0.5, 0.5, 0.5),
        (-1.0, -2.0, 0.25, 0.25, 0.25),
        (-1.0, 2.0, 3.0, 0.9, 5.0),
        (0.0, 0.999, 0.4, 1.5, 1.6),
    ],
)
def test_zeros_that_change_the_sign_of_a_quintic_are_all_found(roots):
    p, zeros = np.poly(roots)[::-1].copy(), np.empty((2, 6))
    count = zeros_of_quintic(p, zeros)
    expected = sorted({r for r in roots if 0.0 < r <= 1.0 and roots.count(r) % 2 == 1})
    # rounding of the coefficients moves a zero by their size over the slope; one of multiplicity m
    # is known to the m-th root of that only
    rounding = 10 * np.finfo(float).eps * np.abs(p).sum()
    slope = np.array([np.prod([abs(r - e) for r in roots if r != e]) for e in expected])
    tolerance = (rounding / slope.min()) ** (1.0 / max(roots.count(e) for e in expected))
    assert count == len(expected)
    np.testing.assert_allclose(zeros[0, :count], expected, rtol=0.0, atol=tolerance)


def test_polynomials_of_lower_degree_have_their_zeros():
    for p in ([-0.3, 1.0, 0, 0, 0, 0], [0.08, -0.6, 1.0, 0, 0, 0], [1.0, 0, 0, 0, 0, 0]):
        zeros = np.empty((2, 6))
        count = zeros_of_quintic(np.array(p, float), zeros)
        expected = sorted(np.roots(np.trim_zeros(p, "b")[::-1]))
        np.testing.assert_allclose(zeros[0, :count], expected, atol=1e-15)

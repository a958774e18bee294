"""The projection (17), (18) against brute-force minimisation of the distance."""

import numpy as np
import pytest
from doors import FORMS, RADIUS, curve, normal
from scipy.optimize import minimize_scalar

from seal_mdao.contact.kinematics import closest_point
from seal_mdao.geometry.bounds import PIECES_A_RUN
from seal_mdao.geometry.curve import curve_point
from seal_mdao.geometry.profile import polyline_profile

CENTRE, LOW = np.array([6.0 - RADIUS, RADIUS]), -0.5 * np.pi


def chord_vertices():
    """Vertices of the door in 8 segments: the arc in 6 chords between two far ends."""
    angle = np.linspace(LOW, 0.0, 7)
    arc = CENTRE + RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.vstack([[-98.0, 0.0], arc, [6.0, 104.0]])


def along(vertices):
    """A polyline over its vertex number."""

    def point(s):
        i = np.clip(np.floor(s).astype(int), 0, len(vertices) - 2)
        return vertices[i] + (s - i)[..., None] * (vertices[i + 1] - vertices[i])

    return point, np.linspace(0.0, len(vertices) - 1, 8 * 400 + 1)


def corner(s):
    """Line, arc, line over s in [0, 3]."""
    a = LOW * (2.0 - np.clip(s, 1.0, 2.0))
    arc = CENTRE + RADIUS * np.stack([np.cos(a), np.sin(a)], -1)
    arc[..., 0] -= 100.0 * np.clip(1.0 - s, 0.0, 1.0)
    arc[..., 1] += 100.0 * np.clip(s - 2.0, 0.0, 1.0)
    return arc


def round_about(centre):
    return lambda s: np.array(centre) + RADIUS * np.stack([np.cos(s), np.sin(s)], -1)


CURVES = {
    "corner": (corner, np.linspace(0.0, 3.0, 3001)),
    "segments": along(chord_vertices()),
    "flat": (
        lambda s: np.stack([s, 0 * s], -1),
        np.linspace(-60.0, 60.0, 1201),
    ),
    "circle": (round_about((0.4, 1.0)), np.linspace(-0.1, 6.4, 1301)),
    "hollow": (round_about((0.5, 0.2)), np.linspace(-0.1, 6.4, 1301)),
}
INSIDE = {
    "corner": lambda x: (
        x[0] < 6.0
        and x[1] > 0.0
        and (np.hypot(*(x - CENTRE)) < RADIUS or x[0] < CENTRE[0] or x[1] > CENTRE[1])
    ),
    "flat": lambda x: x[1] > 0.0,
    "circle": lambda x: np.hypot(*(x - [0.4, 1.0])) < RADIUS,
    "hollow": lambda x: np.hypot(*(x - [0.5, 0.2])) > RADIUS,
}


def brute_force(form, x):
    """Distance of x to a curve: sampled, then minimised between the best sample's neighbours."""
    point, samples = CURVES[form]
    best = np.argmin(np.linalg.norm(point(samples) - x, axis=1))
    low, high = samples[max(best - 1, 0)], samples[min(best + 1, len(samples) - 1)]
    found = minimize_scalar(
        lambda s: np.sum((point(np.array(s)) - x) ** 2),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 1e-13},
    )
    return np.sqrt(found.fun)


def cloud_of_points(rng, count=60):
    return rng.uniform((-6.0, -5.0), (11.0, 10.0), (count, 2))


@pytest.mark.parametrize("form", ["corner", "flat", "circle", "hollow"])
def test_gap_is_the_signed_distance_to_the_rigid_body(form, rng):
    profile = FORMS[form](RADIUS)
    for x in cloud_of_points(rng):
        _, _, gap = closest_point(profile, *x)
        sign = -1.0 if INSIDE[form](x) else 1.0
        assert gap == pytest.approx(sign * brute_force(form, x), abs=1e-9)


def in_a_wedge(vertices, x):
    """Whether the nearest point of a polyline is a vertex that x sees between two edge normals."""
    nearest = np.argmin(np.linalg.norm(vertices - x, axis=1))
    if nearest in (0, len(vertices) - 1):
        return False
    before, after = (
        vertices[nearest] - vertices[nearest - 1],
        vertices[nearest + 1] - vertices[nearest],
    )
    away = x - vertices[nearest]
    return away @ before > 0.0 and away @ after < 0.0


def test_gap_of_a_polyline_is_the_signed_distance_outside_the_wedges_of_its_vertices(rng):
    profile, vertices = FORMS["segments"](RADIUS), chord_vertices()
    wedges = 0
    for x in cloud_of_points(rng, 150):
        _, _, gap = closest_point(profile, *x)
        distance = brute_force("segments", x)
        if in_a_wedge(vertices, x):
            wedges += 1
            assert 0.0 < gap < distance
        else:
            assert abs(gap) == pytest.approx(distance, abs=1e-9)
    assert wedges > 5


@pytest.mark.parametrize("form", FORMS)
def test_projection_is_perpendicular_and_gives_the_gap(form, rng):
    """Eqs. (17) and (18) hold at every point, between two segments too."""
    profile = FORMS[form](RADIUS)
    for x in cloud_of_points(rng):
        piece, xi, gap = closest_point(profile, *x)
        away = x - curve(profile, piece, xi)[0]
        assert away @ curve(profile, piece, xi)[1] == pytest.approx(0.0, abs=1e-12)
        assert away @ normal(profile, piece, xi) == pytest.approx(gap, abs=1e-12)


@pytest.mark.parametrize("form", ["corner", "segments"])
def test_gap_is_continuous_along_a_walk_round_the_corner(form):
    """Just outside, and in penetration; across all joints of the pieces."""
    profile = FORMS[form](RADIUS)
    for distance in (-0.05, 0.02, 0.5):
        reach = RADIUS + distance
        angle = np.linspace(LOW - 0.05, 0.05, 20001)
        walk = CENTRE + reach * np.column_stack([np.cos(angle), np.sin(angle)])
        gaps = np.array([closest_point(profile, *x)[2] for x in walk])
        assert np.abs(np.diff(gaps)).max() <= reach * (angle[1] - angle[0])


def test_natural_coordinate_grows_along_the_curve():
    """Arc length: the coordinate of the corner door differs by what was walked."""
    profile = FORMS["corner"](RADIUS)
    walk = [
        (-1.0, -0.1),
        (1.9, -0.1),
        (2.0 + 4.1 * np.sin(0.6), 4.0 - 4.1 * np.cos(0.6)),
        (6.1, 5.0),
    ]
    xi = [closest_point(profile, *x)[1] for x in walk]
    np.testing.assert_allclose(np.diff(xi), [2.9, 0.1 + 4.0 * 0.6, 4.0 * (np.pi / 2 - 0.6) + 1.0])


def test_segments_approach_the_exact_door_with_the_square_of_their_number():
    """The sagitta of a chord is r h^2 / 8."""
    exact = FORMS["corner"](RADIUS)
    angle = np.linspace(LOW, 0.0, 721)
    points = CENTRE + RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    assert max(abs(closest_point(exact, *x)[2]) for x in points) < 1e-14
    for chords in (10, 20, 40):
        profile = polyline_profile(chord_form(chords))
        sagitta = max(closest_point(profile, *x)[2] for x in points)
        assert sagitta == pytest.approx(RADIUS * (np.pi / 2 / chords) ** 2 / 8, rel=1e-2)


def chord_form(chords):
    angle = np.linspace(LOW, 0.0, chords + 1)
    arc = CENTRE + RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.vstack([[-98.0, 0.0], arc, [6.0, 104.0]])


def many_chords(count):
    """A wavy rigid face of many chords, and the same with all of them in sight of every search."""
    s = np.linspace(-8.0, 8.0, count + 1)
    profile = polyline_profile(np.column_stack([s, 0.6 * np.sin(2.0 * s) + 0.05 * s**2]))
    return profile, profile._replace(run_radius=np.full_like(profile.run_radius, np.inf))


def test_a_search_that_leaves_far_pieces_out_finds_the_same(rng):
    profile, all_in_sight = many_chords(500)
    assert profile.run_radius.size == 32
    for x, y in rng.uniform((-9.0, -3.0), (9.0, 5.0), (500, 2)):
        assert closest_point(profile, x, y) == closest_point(all_in_sight, x, y)


def test_circles_hold_their_pieces(rng):
    for profile in (many_chords(100)[0], FORMS["corner"](4.0), FORMS["circle"](4.0)):
        ends = np.isinf(profile.run_radius[[0, -1]])
        assert ends.all() if profile.period == 0.0 else not ends.any()
        for piece in range(profile.kind.size):
            run = piece // PIECES_A_RUN
            for share in (0.0, 0.3, 1.0):
                xi = profile.start[piece] + share * profile.length[piece]
                away = np.array(curve_point(profile, piece, xi)[0]) - profile.run_centre[run]
                assert np.hypot(*away) <= profile.run_radius[run] * (1.0 + 1e-12)


def test_few_circles_of_thousands_of_chords_reach_a_point():
    """The search looks at these chords only, and at the circles."""
    profile, all_in_sight = many_chords(4800)
    distances = np.hypot(*(profile.run_centre - np.array([1.0, -0.5])).T)
    looked_at = distances - profile.run_radius <= (distances + profile.run_radius).min()
    assert looked_at.sum() < 0.1 * looked_at.size
    assert closest_point(profile, 1.0, -0.5) == closest_point(all_in_sight, 1.0, -0.5)

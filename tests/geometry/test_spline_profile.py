"""Profiles of cubic pieces: splines through points, their derivatives, rates, ends and errors."""

import numpy as np
import pytest

from seal_mdao.contact.kinematics import closest_point
from seal_mdao.geometry.curve import curve_point, curve_velocity
from seal_mdao.geometry.profile import trace
from seal_mdao.geometry.spline_profile import chord_length, cubic_profile, spline_profile


def ring(count, a=3.0, b=2.0):
    phi = 2 * np.pi * np.arange(count) / count
    unit = np.column_stack([np.cos(phi), np.sin(phi)])
    return spline_profile(unit * [a, b], [unit * [1, 0], unit * [0, 1]], closed=True)


def bow(rise=0.4, parameter=None):
    """An open curve through points at uneven distances; the rate is that of ``rise``."""
    x = np.array([-3.0, -2.2, -0.5, 0.1, 1.4, 3.0])
    rate = np.column_stack([0.1 * x, np.cos(x)])
    points = np.column_stack([x, 0 * x]) + rise * rate
    return spline_profile(points, rate[np.newaxis], parameter=parameter), points


KNOTS = chord_length(bow()[1])
CURVES = {"ring": ring(12), "bow": bow()[0], "bow by chords": bow(parameter=KNOTS)[0]}


def curve(profile, piece, xi):
    return np.array(curve_point(profile, piece, xi))


@pytest.mark.parametrize("name", CURVES)
def test_pieces_join_with_two_continuous_derivatives(name):
    profile = CURVES[name]
    for piece in range(len(profile.kind) - (profile.period == 0.0)):
        end = profile.start[piece] + profile.length[piece]
        following = (piece + 1) % len(profile.kind)
        after = curve(profile, following, profile.start[following])
        np.testing.assert_allclose(curve(profile, piece, end)[:3], after[:3], atol=1e-13)


@pytest.mark.parametrize("name", CURVES)
def test_derivatives_along_the_curve(name):
    """Central differences of a cubic are exact but for the third derivative times h^2 / 6."""
    profile, h = CURVES[name], 1e-4
    for piece in range(len(profile.kind)):
        for share in (0.2, 0.7):
            xi = profile.start[piece] + share * profile.length[piece]
            here = curve(profile, piece, xi)
            slope = (curve(profile, piece, xi + h) - curve(profile, piece, xi - h)) / (2 * h)
            slope[0] -= here[3] * h**2 / 6
            np.testing.assert_allclose(slope[:3], here[1:], atol=1e-11)


@pytest.mark.parametrize("parameter", [False, True])
def test_the_last_point_of_a_closed_profile_may_repeat_the_first_one(parameter):
    """Angles from 0 to 2 pi give it up to rounding: the last side had a length of 1e-16 mm."""
    phi = np.linspace(0.0, 2 * np.pi, 13)
    unit = np.column_stack([np.cos(phi), np.sin(phi)])
    points, rates = unit * [3.0, 2.0], np.array([unit * [1, 0], unit * [0, 1]])
    assert 0.0 < np.abs(points[-1] - points[0]).max() < 1e-14
    knots = chord_length(points[:-1], closed=True) if parameter else None
    if parameter:
        np.testing.assert_array_equal(chord_length(points, closed=True), knots)
    one = spline_profile(points[:-1], rates[:, :-1], True, knots)
    other = spline_profile(points, rates, True, knots)
    for here, there in zip(one, other, strict=True):
        np.testing.assert_array_equal(here, there)


def test_the_curve_goes_through_its_points_at_their_parameters():
    profile, points = bow(parameter=KNOTS)
    found = [curve(profile, piece, profile.start[piece])[0] for piece in range(5)]
    np.testing.assert_allclose(found, points[:-1], atol=1e-15)
    np.testing.assert_array_equal(profile.start, KNOTS[:-1])
    np.testing.assert_allclose(curve(profile, 4, KNOTS[-1])[0], points[-1], atol=1e-14)
    assert profile.period == 0.0
    assert ring(12).period == 12.0


def test_open_ends_go_on_along_their_tangents():
    profile = bow()[0]
    for piece, xi, way in ((0, 0.0, -7.0), (4, 5.0, 9.0)):
        x, t, _, _ = curve(profile, piece, xi)
        there = curve(profile, piece, xi + way)
        np.testing.assert_allclose(there, [x + way * t, t, [0, 0], [0, 0]], atol=1e-13)
        normal = np.array([t[1], -t[0]]) / np.hypot(*t)
        found = closest_point(profile, *(x + way * t + 0.3 * normal))
        assert found == (piece, pytest.approx(xi + way, rel=1e-13), pytest.approx(0.3, rel=1e-12))


def test_a_spline_of_a_circle_converges_with_the_fourth_power_of_the_spacing():
    """Distances to the circle half-way between its points, measured by the projection too."""
    counts, errors = np.array([12, 24, 48, 96]), []
    for count in counts:
        phi = 2 * np.pi * (np.arange(count)[:, None] + np.linspace(0.1, 0.9, 5)).ravel() / count
        profile = ring(count, 3.0, 3.0)
        on_circle = 3.0 * np.column_stack([np.cos(phi), np.sin(phi)])
        errors.append(max(abs(closest_point(profile, *x)[2]) for x in on_circle))
    orders = np.diff(np.log(errors)) / np.diff(np.log(1.0 / counts))
    np.testing.assert_allclose(orders, 4.0, atol=0.1)
    assert errors[-1] < 1e-6


@pytest.mark.parametrize("shape", [0, 1])
def test_velocities_of_an_ellipse_are_the_derivatives_in_its_semi_axes(shape):
    """The curve is linear in them, so differences are exact to rounding at any step."""
    profile, h = ring(12), 0.25
    axes = np.array([3.0, 2.0])
    sides = [ring(12, *(axes + sign * h * np.eye(2)[shape])) for sign in (1, -1)]
    for piece in range(12):
        for xi in piece + np.array([0.0, 0.3, 1.0]):
            plus, minus = (curve(side, piece, xi)[:3] for side in sides)
            found = np.array(curve_velocity(profile, shape, piece, xi))
            np.testing.assert_allclose((plus - minus) / (2 * h), found, atol=1e-13)


def test_rates_are_exact_while_the_parameter_stays():
    h, (profile, _) = 0.5, bow(parameter=KNOTS)
    plus, minus = (bow(0.4 + s * h, KNOTS)[0].coefficient for s in (1, -1))
    np.testing.assert_allclose(profile.coefficient_rate[0], (plus - minus) / (2 * h), atol=1e-13)


@pytest.mark.parametrize("place", [(2.9, 0.7), (1.0, -1.5), (-3.6, 0.4), (0.4, 2.2)])
def test_gap_rates_of_an_ellipse_by_a_step_study(place):
    """g_n' = -e_n.V_c; the error of differences falls with h^2 down to 1e-8 and below."""
    profile, axes = ring(24), np.array([3.0, 2.0])
    piece, xi, _ = closest_point(profile, *place)
    t = curve(profile, piece, xi)[1]
    normal = np.array([t[1], -t[0]]) / np.hypot(*t)
    for shape in (0, 1):
        exact = -normal @ curve_velocity(profile, shape, piece, xi)[0]
        steps, errors = 10.0 ** -np.arange(1, 6), []
        for h in steps:
            gaps = [
                closest_point(ring(24, *(axes + sign * h * np.eye(2)[shape])), *place)[2]
                for sign in (1, -1)
            ]
            errors.append(abs((gaps[0] - gaps[1]) / (2 * h) - exact))
        assert errors[1] < 0.02 * errors[0] + 1e-9
        assert min(errors) < 1e-10


def test_cubic_pieces_that_are_straight_are_a_line():
    profile = cubic_profile([0.0, 2.0], [[[-1.0, 0.5], [0.6, 0.8], [0, 0], [0, 0]]])
    piece, xi, gap = closest_point(profile, 5.0, -1.0)
    away = np.array([6.0, -1.5])
    assert (piece, profile.n_shapes) == (0, 0)
    assert xi == pytest.approx(away @ [0.6, 0.8], rel=1e-14)
    assert gap == pytest.approx(away @ [0.8, -0.6], rel=1e-14)


def test_pictures_show_a_spline_with_its_ends():
    points = trace(bow()[0], 0.1, 5.0)
    assert np.abs(points).max() == 5.0
    assert len(points) > 60
    closed = trace(ring(24), 0.1, 5.0)
    np.testing.assert_allclose(closed[0], closed[-1], atol=1e-12)
    np.testing.assert_allclose(np.hypot(*(closed / [3.0, 2.0]).T), 1.0, atol=1e-4)


SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"points": [[0.0, 0.0]]}, r"shape \(n, 2\), n at least 2; got shape \(1, 2\)"),
        ({"points": SQUARE[:2], "closed": True}, "at least 3"),
        ({"points": [[0.0, 0.0], [np.nan, 1.0]]}, "finite"),
        ({"points": [[0.0, 0.0], [1.0, 1.0], [1.0, 1.0]]}, "point 1 of the profile coincides"),
        ({"points": [*SQUARE[:2], SQUARE[0]], "closed": True}, r"at least 3; got shape \(2, 2\)"),
        (
            {"points": [*SQUARE, SQUARE[0], SQUARE[0]], "closed": True},
            "point 3 of the profile coincides",
        ),
        (
            {"points": [*SQUARE, SQUARE[0]], "rates": [np.eye(4, 2)], "closed": True},
            "has other rates",
        ),
        ({"points": SQUARE, "rates": np.zeros((3, 2))}, r"shape \(S, 3, 2\), got \(3, 2\)"),
        ({"points": SQUARE, "parameter": [0.0, 1.0, 1.0]}, "3 increasing numbers"),
        ({"points": SQUARE, "parameter": [0.0, 1.0, 2.0], "closed": True}, "4 increasing numbers"),
    ],
)
def test_what_cannot_be_a_spline_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        spline_profile(**arguments)


def test_coefficients_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="must increase"):
        cubic_profile([0.0, 0.0], np.zeros((1, 4, 2)))
    with pytest.raises(ValueError, match=r"coefficients of shape \(1, 4, 2\)"):
        cubic_profile([0.0, 1.0], np.zeros((1, 3, 2)))

"""Rigid profiles: pieces that join, arc length, derivatives along the curve and in the radius."""

import numpy as np
import pytest

from seal_mdao.geometry.curve import CUBIC, curve_point, curve_velocity
from seal_mdao.geometry.profile import (
    PieceRates,
    Pieces,
    circle_profile,
    corner_profile,
    flat_profile,
    polyline_profile,
    rigid_profile,
    segmented_corner_profile,
    trace,
)

FORMS = {
    "corner": lambda r: corner_profile(2.0, r, 6.0),
    "segments": lambda r: segmented_corner_profile(2.0, r, 6.0, 12),
    "flat": lambda r: flat_profile(),
    "circle": lambda r: circle_profile((0.4, 1.0), r),
    "polyline": lambda r: polyline_profile(
        np.array([[0.0, 0.0], [r, 0.2], [1.5 * r, r**2]]),
        np.array([[[0.0, 0.0], [1.0, 0.0], [1.5, 2 * r]]]),
    ),
}
SHARES = (0.0, 0.2, 0.7, 1.0)


def places(profile):
    for piece in range(len(profile.kind)):
        for share in SHARES:
            yield piece, profile.start[piece] + share * profile.length[piece]


def curve(profile, piece, xi):
    return np.array(curve_point(profile, piece, xi))


@pytest.mark.parametrize("form", FORMS)
def test_derivatives_along_the_curve(form):
    profile, step = FORMS[form](4.0), 1e-4
    for piece, xi in places(profile):
        here = curve(profile, piece, xi)
        plus, minus = curve(profile, piece, xi + step), curve(profile, piece, xi - step)
        np.testing.assert_allclose((plus - minus)[:3] / (2 * step), here[1:], atol=2e-9)
        assert np.hypot(*here[1]) == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("form", FORMS)
def test_pieces_join_where_the_next_one_starts(form):
    profile = FORMS[form](4.0)
    for piece in range(len(profile.kind) - 1):
        end = profile.start[piece] + profile.length[piece]
        assert profile.start[piece + 1] == pytest.approx(end, rel=1e-15)
        before, after = curve(profile, piece, end), curve(profile, piece + 1, end)
        np.testing.assert_allclose(before[0], after[0], atol=1e-12)


def test_exact_door_has_no_kink():
    profile = FORMS["corner"](4.0)
    for piece in range(2):
        end = profile.start[piece] + profile.length[piece]
        before, after = curve(profile, piece, end)[1], curve(profile, piece + 1, end)[1]
        np.testing.assert_allclose(before, after, atol=1e-14)


@pytest.mark.parametrize("form", FORMS)
def test_curve_velocity_is_the_derivative_in_the_radius(form):
    """V_c, V_c,xi, V_c,xixi at fixed natural coordinate; differences of two steps agree."""
    profile = FORMS[form](4.0)
    assert profile.n_shapes == (form != "flat")
    for piece, xi in places(profile):
        if profile.n_shapes == 0:
            continue
        found = np.array(curve_velocity(profile, 0, piece, xi))
        for step, tolerance in ((1e-3, 1e-5), (1e-4, 1e-7)):
            plus, minus = (curve(FORMS[form](4.0 + s * step), piece, xi)[:3] for s in (1, -1))
            np.testing.assert_allclose((plus - minus) / (2 * step), found, atol=tolerance)


def test_curve_velocity_of_a_cubic_whose_start_moves(rng):
    """As that of a cubic behind a line whose length is a parameter; in it and beyond both ends."""
    coefficient, change = rng.standard_normal((2, 1, 4, 2))

    def made(t):
        pieces = Pieces([CUBIC], [(0.0, 0.0)], [0.0], [1.0], [0.3 + 0.7 * t], [2.0],
                        coefficient + t * change)  # fmt: skip
        return rigid_profile(pieces, PieceRates(start=[[0.7]], coefficient=change[None]))

    for xi in (-0.1, 0.4, 1.9, 2.5):
        found = np.array(curve_velocity(made(0.0), 0, 0, xi))
        sampled = [np.array(curve_point(made(t), 0, xi)[:3]) for t in (-2e-3, -1e-3, 1e-3, 2e-3)]
        quotient = np.tensordot([1.0, -8.0, 8.0, -1.0], sampled, 1) / 12e-3
        np.testing.assert_allclose(found, quotient, atol=1e-9)


def test_vertical_side_and_flat_of_the_door_stay_where_they_are():
    """When the radius changes; only the round part moves."""
    for radius in (3.0, 4.0, 5.0):
        for form in ("corner", "segments"):
            profile = FORMS[form](radius)
            last = len(profile.kind) - 1
            assert curve(profile, 0, 50.0)[0, 1] == 0.0
            end = profile.start[last] + 50.0
            np.testing.assert_allclose(curve(profile, last, end)[0, 0], 6.0, rtol=1e-15)
            # tangent points of the arc
            np.testing.assert_allclose(
                curve(profile, 0, profile.length[0])[0], [6.0 - radius, 0.0], atol=1e-12
            )
            np.testing.assert_allclose(
                curve(profile, last, profile.start[last])[0], [6.0, radius], atol=1e-12
            )


def test_segmented_door_has_the_number_of_pieces_asked_for():
    for segments in (4, 12, 32):
        profile = segmented_corner_profile(2.0, 4.0, 6.0, segments)
        assert len(profile.kind) == segments
        vertices = np.array([curve(profile, p, profile.start[p])[0] for p in range(1, segments)])
        np.testing.assert_allclose(np.hypot(*(vertices - [2.0, 4.0]).T), 4.0, rtol=1e-13)


def test_trace_runs_along_the_profile():
    profile = FORMS["corner"](4.0)
    points = trace(profile, 0.1, 12.0)
    assert np.all(np.abs(points) <= 12.0)
    on_arc = points[(points[:, 0] > 2.0) & (points[:, 1] < 4.0)]
    assert len(on_arc) > 60
    np.testing.assert_allclose(np.hypot(*(on_arc - [2.0, 4.0]).T), 4.0, rtol=1e-12)

"""Contact kinematics (22)-(26), (52)-(55): complex step on a general curve, differences on the door."""

import curves
import numpy as np
import pytest
from doors import FORMS, RADIUS, at_gap, normal, velocity

from seal_mdao.contact.kinematics import closest_point, contact_frame, rates

GAPS = (-0.2, -0.01, 0.3)
H = curves.STEP


def general_rates(x, w, v1=(0.0, 0.0), v2=(0.0, 0.0)):
    """``rates`` at a point beside the general curve."""
    _, args = curves.scalars(x)
    return rates(*curves.real(args), tuple(w), tuple(v1), tuple(v2))


def complex_rates(x_rate, tau_rate, x):
    """Rates of xi, g_n, e_t, e_n, |t| and c by complex step through the Newton projection."""
    xi, (e_t, e_n, size, *_, c, g_n) = curves.scalars(x + 1j * H * x_rate, 1j * H * tau_rate)
    return [np.imag(value) / H for value in (xi, g_n, e_t, e_n, size, c)]


def check(x, found, exact):
    """The five numbers of ``rates`` against rates of xi, g_n, e_t, e_n, |t| and c."""
    _, args = curves.scalars(x)
    e_t, e_n = np.real(args[0]), np.real(args[1])
    xi_rate, gap_rate, turn, size_rate, c_rate = found
    np.testing.assert_allclose(
        (xi_rate, gap_rate, size_rate, c_rate), (exact[0], exact[1], exact[4], exact[5]), rtol=1e-11
    )
    np.testing.assert_allclose(turn * e_n, exact[2], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(-turn * e_t, exact[3], rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("angle", [0.2, 1.9, 4.0])
def test_rates_for_a_moving_body_point_on_a_general_curve(gap, angle):
    """Eqs. (23)-(26): only the body point moves."""
    x, w = curves.beside(0.35, gap), np.array([np.cos(angle), np.sin(angle)])
    check(x, general_rates(x, w), complex_rates(w, 0.0, x))


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("motion", [(0.0, 0.0), (0.3, -0.8)])
def test_rates_for_a_moving_design_on_a_general_curve(gap, motion):
    """Eqs. (52)-(55): the curve changes its shape, with and without motion of the body point."""
    x, motion = curves.beside(0.35, gap), np.array(motion)
    v, v1, v2 = (curves.derivative(curves.B, 0.35, k) for k in range(3))
    check(x, general_rates(x, motion - v, v1, v2), complex_rates(motion, 1.0, x))


@pytest.mark.parametrize("gap", GAPS)
def test_tangential_slip_rate_is_equation_60(gap):
    """g_t = |t0| (xi - xi0) with both projections moving with the design."""
    x, x0 = curves.beside(0.35, gap), curves.beside(0.2, -0.03)
    motion, motion0 = np.array([0.3, -0.8]), np.array([-0.5, 0.4])
    xi0, args0 = curves.scalars(x0)
    xi, _ = curves.scalars(x)

    def rates_at(place, w):
        v, v1, v2 = (curves.derivative(curves.B, place, k) for k in range(3))
        return w - v, v1, v2

    xi_rate, *_ = general_rates(x, *rates_at(0.35, motion))
    xi0_rate, _, _, size0_rate, _ = rates(
        *curves.real(args0), *(tuple(value) for value in rates_at(0.2, motion0))
    )
    size0 = float(np.real(args0[2]))
    found = size0_rate * (xi - xi0).real + size0 * (xi_rate - xi0_rate)
    moved, _ = curves.scalars(x + 1j * H * motion, 1j * H)
    moved0, moved_args0 = curves.scalars(x0 + 1j * H * motion0, 1j * H)
    assert found == pytest.approx(np.imag(moved_args0[2] * (moved - moved0)) / H, rel=1e-11)


def places(form):
    """Piece and share of places to test on each form, away from the joints."""
    profile = FORMS[form](RADIUS)
    return profile, [(piece, share) for piece in range(len(profile.kind)) for share in (0.3, 0.6)]


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("gap", [-0.3, 0.2])
def test_rates_for_a_moving_body_point_on_the_real_profiles(form, gap):
    profile, where = places(form)
    for piece, share in where:
        x, xi = at_gap(profile, piece, share, gap)
        e_t, e_n, size, alpha, beta, gamma, c = contact_frame(profile, piece, xi, gap)
        assert closest_point(profile, *x)[0] == piece
        for w in np.eye(2):
            found = rates(e_t, e_n, size, alpha, beta, gamma, c, gap, tuple(w), (0, 0), (0, 0))
            sides = [observed(profile, x + s * 1e-4 * w) for s in (1, -1)]
            compare(found, e_t, e_n, sides, 1e-4, 1e-8)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("gap", [-0.3, 0.2])
def test_rates_for_a_changing_radius_on_the_real_profiles(form, gap):
    profile, where = places(form)
    step = 1e-4
    for piece, share in where:
        x, xi = at_gap(profile, piece, share, gap)
        e_t, e_n, size, alpha, beta, gamma, c = contact_frame(profile, piece, xi, gap)
        v, v1, v2 = velocity(profile, piece, xi)
        found = rates(e_t, e_n, size, alpha, beta, gamma, c, gap, tuple(-v), tuple(v1), tuple(v2))
        sides = [observed(FORMS[form](RADIUS + s * step), x) for s in (1, -1)]
        compare(found, e_t, e_n, sides, step, 1e-8)


def observed(profile, x):
    """xi, g_n, e_t, e_n, |t|, c of the projection of x."""
    piece, xi, gap = closest_point(profile, *x)
    e_t, e_n, size, _, _, _, c = contact_frame(profile, piece, xi, gap)
    return np.array([xi, gap, *e_t, *e_n, size, c])


def compare(found, e_t, e_n, sides, step, tolerance):
    difference = (sides[0] - sides[1]) / (2 * step)
    xi_rate, gap_rate, turn, size_rate, c_rate = found
    expected = [xi_rate, gap_rate, *turn * np.array(e_n), *-turn * np.array(e_t), size_rate, c_rate]
    np.testing.assert_allclose(difference, expected, rtol=0.0, atol=tolerance)


@pytest.mark.parametrize("form", FORMS)
def test_frame_scalars_belong_to_the_curve(form):
    """alpha is minus the curvature of the body seen from outside; beta = gamma = 0, |t| = 1."""
    profile, where = places(form)
    curvature = {"corner": -1 / RADIUS, "circle": -1 / RADIUS, "hollow": 1 / RADIUS}.get(form, 0.0)
    for piece, share in where:
        _, xi = at_gap(profile, piece, share, 0.0)
        e_t, e_n, size, alpha, beta, gamma, c = contact_frame(profile, piece, xi, -0.1)
        np.testing.assert_allclose(e_n, normal(profile, piece, xi), atol=1e-15)
        on_line = form == "corner" and piece != 1
        assert alpha == pytest.approx(0.0 if on_line else curvature, abs=1e-14)
        assert (size, beta, gamma) == pytest.approx((1.0, 0.0, 0.0), abs=1e-14)
        assert c == pytest.approx(1.0 + 0.1 * alpha, abs=1e-14)
        assert e_t[0] * e_n[1] - e_t[1] * e_n[0] == pytest.approx(-1.0, abs=1e-14)

"""The fictitious loads (57), (63), (66) and the slip rate (60), expanded term by term as the comments of
``contact.rigid_forces`` and ``contact.friction`` write them, against the package's columns."""

from types import SimpleNamespace

import numpy as np
import pytest
from doors import at_gap, linearized, velocity
from splines import SPLINES
from test_contact_tangents import normal_form, slip_form, stick_form

from seal_mdao.contact.friction import (
    CARRIED,
    FORCE_X,
    FORCE_Y,
    LENGTH,
    SHAPE,
    SIZE_0,
    STICK,
    XI_0,
    ContactLaw,
    X,
    Y,
)
from seal_mdao.contact.kinematics import contact_frame, rates

LAW, LENGTH_NOW, LENGTH_RATE = ContactLaw(90.0, 20.0, 0.25, True), 1.3, 0.37
# rates of the body point, V and z', now and at the step before
V, Z, BOTH_0 = np.array([0.3, -0.8]), np.array([-0.45, 0.2]), np.array([-0.5, 0.4])
PLACES = [("ellipse", 4), ("wave", 13), ("wave", 20)]


def point_of(profile, piece, share, gap, shape):
    """x, xi, the arguments of ``rates`` and V_c, V_c,xi, V_c,xixi at a point with a gap."""
    x, xi = at_gap(profile, piece, share, gap)
    e_t, e_n, *others = contact_frame(profile, piece, xi, gap)
    names = ("size", "alpha", "beta", "gamma", "c")
    args = (np.array(e_t), np.array(e_n), *others, gap)
    return SimpleNamespace(
        x=x, xi=xi, args=args, e_t=args[0], e_n=args[1], gap=gap,
        **dict(zip(names, others, strict=True)), v=velocity(profile, piece, xi, shape),
    )  # fmt: skip


def slip_rate(now, then, w, w_0):
    """Eq. (60) with g_n0 |t0| in the place of g_n |t0|."""
    nu, change = now.size * then.size / now.c, now.xi - then.xi
    g_t = then.size * change
    return (
        nu * now.e_t @ w
        + now.gap * then.size / now.c * now.e_n @ now.v[1]
        + (then.beta * g_t - then.size**2) / then.c * then.e_t @ w_0
        + (then.gap * then.beta * change - then.gap * then.size) / then.c * then.e_n @ then.v[1]
        + change * then.e_t @ then.v[1]
    )


def normal_load(now, w):
    """Eq. (57), the rate of the length apart."""
    load = normal_form(LAW, now.e_t, now.e_n, now.alpha, now.c, now.gap) @ w
    curved = now.gap * now.size / now.c * now.e_n @ now.v[1]
    return load - LAW.normal_penalty * curved * now.e_t


def rest_of_curvature(now):
    """What the print drops in (63), (66): turn and nu' of V_c,xi and V_c,xixi for w_t g_t = nu = 1."""
    v1_t, v1_n, v2_n = now.e_t @ now.v[1], now.e_n @ now.v[1], now.e_n @ now.v[2]
    square, curved = now.size**2, now.alpha * now.gap
    nu_rate = (
        -(square + curved) / (now.size * now.c) * v1_t
        + now.gap / now.c**2
        * (now.gamma * now.gap - now.beta * (2 * square + curved) / now.size) * v1_n
        + now.gap / now.c * v2_n
    )  # fmt: skip
    return now.size / now.c * v1_n * now.e_n + nu_rate * now.e_t


def stick_load(now, then, w, w_0):
    """Eq. (63), complete, the rate of the length apart."""
    nu, g_t, v1_0 = now.size * then.size / now.c, then.size * (now.xi - then.xi), then.v[1]
    both = now.c * then.c
    along = (
        2 * g_t * now.size / now.c * then.e_t @ v1_0
        + nu / then.c * (2 * then.beta * g_t - then.size**2) * then.e_t @ w_0
        + 2 * then.beta * then.gap * g_t * now.size / both * then.e_n @ v1_0
        - then.gap * now.size * then.size**2 / both * then.e_n @ v1_0
        + nu * now.gap * then.size / now.c * now.e_n @ now.v[1]
    )
    load = along * now.e_t + nu * g_t * rest_of_curvature(now)
    return stick_form(LAW, now.args, nu, g_t) @ w + LAW.tangent_penalty * load


def slip_load(now, then, w, w_0, sign):
    """Eq. (66), complete, the rate of the length apart."""
    nu, g_n, v1_0 = now.size * then.size / now.c, now.gap, then.v[1]
    along = (
        g_n * now.size / now.c * then.e_t @ v1_0
        + nu * then.beta * g_n / then.c * then.e_t @ w_0
        + then.beta * g_n * then.gap * now.size / (now.c * then.c) * then.e_n @ v1_0
    )
    load = along * now.e_t + nu * g_n * rest_of_curvature(now)
    w_t = -LAW.friction * LAW.normal_penalty * sign
    return slip_form(LAW, now.args, nu, sign) @ w + w_t * load


def observed(profile, now, then, shape):
    """Rates of the package for all velocities: force without that of the length, its own, slip."""
    xi_0_rate, _, _, size_0_rate, _ = rates(
        *then.args, tuple(BOTH_0 - then.v[0]), tuple(then.v[1]), tuple(then.v[2])
    )
    local = linearized(profile, LAW, now.x, (STICK, (then.xi, then.size, 0.0)), LENGTH_NOW)
    rate = (
        local[:, [X, Y]] @ (V + Z)
        + local[:, XI_0] * xi_0_rate + local[:, SIZE_0] * size_0_rate + local[:, SHAPE + shape]
    )  # fmt: skip
    forces = [FORCE_X, FORCE_Y]
    return rate[forces], local[forces, LENGTH] * LENGTH_RATE, rate[CARRIED]


@pytest.mark.parametrize("shape", [0, 1])
@pytest.mark.parametrize(("form", "piece"), PLACES)
@pytest.mark.parametrize("gap", [-0.2, -0.03])
def test_stick_load_and_slip_rate_are_the_complete_forms(form, piece, gap, shape):
    build, at = SPLINES[form]
    profile = build(*at)
    then = point_of(profile, piece, 0.38, -0.06, shape)
    now = point_of(profile, piece, 0.4, gap, shape)
    law_limit = LAW.friction * LAW.normal_penalty * abs(gap)
    assert abs(LAW.tangent_penalty * then.size * (now.xi - then.xi)) < law_limit
    w, w_0 = V - now.v[0], BOTH_0 - then.v[0]
    nu, g_t = now.size * then.size / now.c, then.size * (now.xi - then.xi)
    # b*(z; z') + b'_N + b'_T   Eqs. (58), (62)
    tangent = normal_form(LAW, now.e_t, now.e_n, now.alpha, now.c, gap)
    tangent = tangent + stick_form(LAW, now.args, nu, g_t)
    expected = tangent @ Z + normal_load(now, w) + stick_load(now, then, w, w_0)
    force, of_length, slip = observed(profile, now, then, shape)
    scale = np.abs(LENGTH_NOW * expected).max()
    np.testing.assert_allclose(force, LENGTH_NOW * expected, rtol=0.0, atol=1e-12 * scale)
    assert slip == pytest.approx(slip_rate(now, then, w + Z, w_0), rel=1e-11)
    # the last integrals: rate of the length times w_n g_n e_n + w_t nu g_t e_t
    traction = LAW.normal_penalty * gap * now.e_n + LAW.tangent_penalty * nu * g_t * now.e_t
    np.testing.assert_allclose(of_length, LENGTH_RATE * traction, rtol=1e-12)


@pytest.mark.parametrize("shape", [0, 1])
@pytest.mark.parametrize(("form", "piece"), PLACES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_slip_load_is_the_complete_form(form, piece, sign, shape):
    build, at = SPLINES[form]
    profile, gap = build(*at), -0.07
    then = point_of(profile, piece, 0.4 - 0.39 * sign, -0.06, shape)
    now = point_of(profile, piece, 0.4, gap, shape)
    slid = LAW.tangent_penalty * then.size * (now.xi - then.xi)
    assert sign * slid > LAW.friction * LAW.normal_penalty * abs(gap)
    w, w_0 = V - now.v[0], BOTH_0 - then.v[0]
    nu = now.size * then.size / now.c
    # b*(z; z') + b'_N + b'_T   Eqs. (58), (65)
    tangent = normal_form(LAW, now.e_t, now.e_n, now.alpha, now.c, gap)
    tangent = tangent + slip_form(LAW, now.args, nu, sign)
    expected = tangent @ Z + normal_load(now, w) + slip_load(now, then, w, w_0, sign)
    force, _, _ = observed(profile, now, then, shape)
    scale = np.abs(LENGTH_NOW * expected).max()
    np.testing.assert_allclose(force, LENGTH_NOW * expected, rtol=0.0, atol=1e-12 * scale)


def test_the_places_have_curvature_and_a_varying_coordinate():
    """alpha, beta, gamma, V_c,xi and V_c,xixi are there: no term of the forms is tested with a zero."""
    for form, piece in PLACES:
        build, at = SPLINES[form]
        for shape in (0, 1):
            own = point_of(build(*at), piece, 0.4, -0.07, shape)
            assert min(map(abs, (own.alpha, own.beta, own.gamma))) > 1e-3
            assert np.abs(own.v[1:]).max(axis=1).min() > 1e-3

"""The closed forms (35), (36), (41) with the slips of the print mended, and the package's tangents."""

import curves
import numpy as np
import pytest
from doors import FORMS, RADIUS, at_gap, press

from seal_mdao.contact.friction import OPEN, SLIP, STICK, ContactLaw
from seal_mdao.contact.kinematics import contact_frame, rates

LAW = ContactLaw(1e4, 1e2, 0.25, True)
H = curves.STEP


def normal_form(law, e_t, e_n, alpha, c, g_n):
    """Eq. (35)."""
    return law.normal_penalty * (np.outer(e_n, e_n) - alpha * g_n / c * np.outer(e_t, e_t))


def curvature_form(e_t, e_n, size, alpha, beta, gamma, c, g_n):
    """What (36) and (41) share, for a unit traction w_t g_t = 1 and v = 1."""
    mixed = alpha / c * (np.outer(e_n, e_t) + np.outer(e_t, e_n))
    straight = ((gamma * size - 2 * alpha * beta) * g_n - beta * size**2) / c**2
    return mixed + straight * np.outer(e_t, e_t)


def stick_form(law, args, v, g_t):
    """Eq. (36)."""
    e_t = args[0]
    return law.tangent_penalty * (v**2 * np.outer(e_t, e_t) + v * g_t * curvature_form(*args))


def slip_form(law, args, v, sign):
    """Eq. (41) with (39)."""
    e_t, e_n, g_n = args[0], args[1], args[-1]
    w_t = -law.friction * law.normal_penalty * sign
    return w_t * v * (np.outer(e_t, e_n) + g_n * curvature_form(*args))


def general_force(law, x, size_0, xi_0, sign):
    """Eq. (29) on the general curve: stick where ``sign`` is None."""
    xi, (e_t, e_n, size, _, _, _, c, g_n) = curves.scalars(x)
    v = size * size_0 / c
    traction = law.tangent_penalty * size_0 * (xi - xi_0)
    if sign is not None:
        traction = -law.friction * law.normal_penalty * sign * g_n
    return law.normal_penalty * g_n * e_n + traction * v * e_t


@pytest.mark.parametrize("gap", [-0.2, -0.01])
@pytest.mark.parametrize("sign", [None, 1.0, -1.0])
def test_closed_forms_are_exact_on_a_general_curve(gap, sign):
    """No higher-order terms are missing in (35), (36), (41), whatever |t|, beta and gamma."""
    x, size_0, xi_0 = curves.beside(0.35, gap), 1.2, 0.31
    exact = np.column_stack(
        [general_force(LAW, x + 1j * H * w, size_0, xi_0, sign).imag / H for w in np.eye(2)]
    )
    xi, args = curves.scalars(x)
    xi, args = xi.real, [np.real(a) for a in args]
    e_t, e_n, size, alpha, _, _, c, g_n = args
    v = size * size_0 / c
    closed = normal_form(LAW, e_t, e_n, alpha, c, g_n)
    if sign is None:
        closed = closed + stick_form(LAW, args, v, size_0 * (xi - xi_0))
    else:
        closed = closed + slip_form(LAW, args, v, sign)
    np.testing.assert_allclose(closed, exact, rtol=0.0, atol=1e-11 * np.abs(exact).max())


@pytest.mark.parametrize("gap", [-0.2, 0.1])
def test_rate_of_v_from_the_rates_of_its_factors_is_the_closed_form(gap):
    """d v = (v/c) { [((gamma|t| - 2 alpha beta) g_n - beta|t|^2)/c] e_t.dx + alpha e_n.dx }."""
    _, args = curves.scalars(curves.beside(0.35, gap))
    e_t, e_n, size, alpha, beta, gamma, c, g_n = curves.real(args)
    for w in ((1.0, 0.0), (0.0, 1.0)):
        _, _, _, size_rate, c_rate = rates(
            e_t, e_n, size, alpha, beta, gamma, c, g_n, w, (0.0, 0.0), (0.0, 0.0)
        )
        along = ((gamma * size - 2 * alpha * beta) * g_n - beta * size**2) / c
        closed = (along * np.dot(e_t, w) + alpha * np.dot(e_n, w)) / c
        assert size_rate / size - c_rate / c == pytest.approx(closed, rel=1e-12)


def placed(form, piece, gap):
    profile = FORMS[form](RADIUS)
    x, xi = at_gap(profile, piece, 0.45, gap)
    e_t, e_n, *others = contact_frame(profile, piece, xi, gap)
    return profile, x, xi, [np.array(e_t), np.array(e_n), *others, gap]


PLACES = [("corner", 0), ("corner", 1), ("segments", 3), ("circle", 0), ("hollow", 0)]


@pytest.mark.parametrize(("form", "piece"), PLACES)
@pytest.mark.parametrize("gap", [-0.3, -1e-3])
def test_stick_tangent_is_the_closed_form_and_symmetric(form, piece, gap):
    profile, x, xi, args = placed(form, piece, gap)
    size_0, elastic, xi_0 = 0.9, 0.004, xi - 0.003
    law = LAW._replace(friction=1e6)
    _, tangent, state, *_ = press(profile, law, x, (STICK, (xi_0, size_0, elastic)), length=1.7)
    e_t, e_n, size, alpha, _, _, c, _ = args
    g_t = elastic + size_0 * (xi - xi_0)
    closed = normal_form(law, e_t, e_n, alpha, c, gap)
    closed = closed + stick_form(law, args, size * size_0 / c, g_t)
    assert state == STICK
    np.testing.assert_allclose(tangent, 1.7 * closed, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(tangent, tangent.T, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize(("form", "piece"), PLACES)
@pytest.mark.parametrize("gap", [-0.3, -1e-3])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_slip_tangent_is_the_closed_form_and_not_symmetric(form, piece, gap, sign):
    profile, x, xi, args = placed(form, piece, gap)
    size_0 = 0.9
    _, tangent, state, *_ = press(
        profile, LAW, x, (STICK, (xi - 10.0 * sign, size_0, 0.0)), length=1.7
    )
    e_t, e_n, size, alpha, _, _, c, _ = args
    closed = normal_form(LAW, e_t, e_n, alpha, c, gap)
    closed = closed + slip_form(LAW, args, size * size_0 / c, sign)
    assert state == SLIP
    np.testing.assert_allclose(tangent, 1.7 * closed, rtol=0.0, atol=1e-9)
    skew = abs(tangent[0, 1] - tangent[1, 0])
    # only the first term of (41) is unsymmetric: mu w_n v
    v = size * size_0 / c
    assert skew == pytest.approx(1.7 * LAW.friction * LAW.normal_penalty * v, rel=1e-9)


@pytest.mark.parametrize(("form", "piece"), PLACES)
def test_tangent_of_a_straight_touch_is_normal_and_stick_form_over_the_share_behind(form, piece):
    """The slip counts from the place of touching: w_t is felt over g_n / (g_n - g_n0) of the step."""
    gap, gap_0 = -0.02, 0.06
    profile, x, xi, args = placed(form, piece, gap)
    _, tangent, *_ = press(profile, LAW, x, (OPEN, (xi, 1.0, gap_0)))
    e_t, e_n, size, alpha, _, _, c, _ = args
    closed = normal_form(LAW, e_t, e_n, alpha, c, gap)
    closed = closed + 0.25 * LAW.tangent_penalty * (size / c) ** 2 * np.outer(e_t, e_t)
    np.testing.assert_allclose(tangent, closed, rtol=0.0, atol=1e-10)

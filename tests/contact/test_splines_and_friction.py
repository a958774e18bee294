"""Friction on profiles with |t| != 1: what it measures, the history carried, and a fitted door."""

from itertools import pairwise

import numpy as np
import pytest
from doors import FORMS, at_gap, curve, linearized, normal, press
from scipy.integrate import quad
from splines import SPLINES, S, rounded_corner

from seal_mdao.contact.friction import (
    OPEN,
    SIZE,
    SLIP,
    SLIP_0,
    STICK,
    XI,
    XI_0,
    ContactLaw,
    X,
    uses_history,
)
from seal_mdao.geometry.curve import has_cubics
from seal_mdao.geometry.spline_profile import spline_profile

LAW = ContactLaw(1e4, 1e2, 0.25, True)
RULES = (True, False)
BUILD, SHAPE_OF_WAVE = SPLINES["wave"]
WAVE = BUILD(*SHAPE_OF_WAVE)


def beside(profile, xi, gap):
    piece = int(np.searchsorted(profile.start, xi, "right") - 1)
    return curve(profile, piece, xi)[0] + gap * normal(profile, piece, xi)


def size(profile, xi):
    """|t|."""
    return np.hypot(*curve(profile, int(np.searchsorted(profile.start, xi, "right") - 1), xi)[1])


def friction_force(profile, xi, force):
    e_n = normal(profile, int(np.searchsorted(profile.start, xi, "right") - 1), xi)
    return force @ [-e_n[1], e_n[0]]


def follow(profile, law, places, xi):
    """Forces, states and histories of a point that begins in stick at ``xi`` without slip."""
    history, out = (STICK, (xi, size(profile, xi), 0.0)), []
    for x in places:
        force, _, state, kept, *_ = press(profile, law, x, history)
        history = (state, kept)
        out.append((force, state, kept))
    return out


@pytest.mark.parametrize("accumulated", RULES)
def test_forces_do_not_depend_on_the_unit_of_the_natural_coordinate(accumulated):
    """xi and |t| change with it; slip, traction and v do not."""
    x = S + 0.3 * np.sin(S)
    points = np.column_stack([x, 0.6 * np.sin(1.5 * S)])
    forces = []
    for unit in (1.0, 2.5):
        profile = spline_profile(points, parameter=unit * np.arange(S.size))
        ways = unit * np.concatenate([np.linspace(14.2, 15.1, 8), np.linspace(15.0, 14.6, 5)])
        law = LAW._replace(accumulated=accumulated)
        path = follow(profile, law, [beside(profile, xi, -1e-3) for xi in ways], ways[0])
        forces.append([force for force, _, _ in path])
        assert {state for _, state, _ in path} == {STICK, SLIP}
    np.testing.assert_allclose(forces[1], forces[0], rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("accumulated", RULES)
def test_slip_of_steps_converges_to_the_arc_length(accumulated):
    """With the first power of the steps: each is measured by |t| at its beginning."""
    law, ends = LAW._replace(friction=1e6, accumulated=accumulated), (10.3, 13.8)
    exact = quad(lambda xi: size(WAVE, xi), *ends, points=[11.0, 12.0, 13.0], epsabs=1e-12)[0]
    errors = []
    for steps in (20, 40, 80, 160):
        ways = np.linspace(*ends, steps + 1)
        path = follow(WAVE, law, [beside(WAVE, xi, -1e-6) for xi in ways], ways[0])
        # that of one step under the incremental rule, from its force w_t v g_t, v = |t0| / |t|
        slips = [
            friction_force(WAVE, b, force) * size(WAVE, b) / size(WAVE, a) / law.tangent_penalty
            for (force, _, _), (a, b) in zip(path[1:], pairwise(ways), strict=True)
        ]
        slid = path[-1][2][2] if accumulated else np.sum(slips)
        errors.append(abs(slid - exact))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 1.0, atol=0.15)
    assert errors[-1] < 2e-2 * exact


@pytest.mark.parametrize("name", ["corner", "wave", "ellipse"])
@pytest.mark.parametrize("accumulated", RULES)
def test_points_use_their_history_as_told(name, accumulated):
    """The columns of the history vanish where ``uses_history`` says so, and only there; what slips
    uses |t0| alone, which moves in the direction of xi."""
    law = LAW._replace(accumulated=accumulated)
    profile = FORMS[name](4.0) if name in FORMS else SPLINES[name][0](*SPLINES[name][1])
    piece = 1 if name == "corner" else 13
    cases = {OPEN: (0.05, 0.0), STICK: (-1e-2, 1e-3), SLIP: (-1e-2, 3.0)}
    states = np.array(list(cases))
    used = dict(zip(states, uses_history(has_cubics(profile), states), strict=True))
    assert used == {OPEN: False, STICK: True, SLIP: name != "corner"}
    for expected, (gap, slip) in cases.items():
        x, xi = at_gap(profile, piece, 0.4, gap)
        history = (STICK, (xi - slip, 1.2, 1e-3))
        assert press(profile, law, x, history)[2] == expected
        local = linearized(profile, law, x, history)
        columns = local[:XI, XI_0 : SLIP_0 + 1].any(axis=0)
        kept = local[XI:, XI_0 : SLIP_0 + 1]
        if expected == STICK:
            assert columns.all()
        else:
            assert list(columns) == [False, expected == SLIP, False]
            assert not kept.any()
        # |t0| of the step before is carried on as its SIZE row: zero on arcs and lines
        turn = local[SIZE, X] * local[XI, X + 1] - local[SIZE, X + 1] * local[XI, X]
        assert turn == pytest.approx(0.0, abs=1e-12)
        assert local[SIZE, X : X + 2].any() == (name != "corner")


def slide_round(profile, law, steps=400, depth=5e-3):
    """Forces of a point that slides round the corner of a door at a depth, and back half-way."""
    arc = 4.0 - depth
    walk = np.concatenate([np.linspace(-2.0, 8.0, steps), np.linspace(8.0, 3.0, steps // 2)])
    angle = np.clip(walk / 4.0, 0.0, np.pi / 2)
    places = np.column_stack([
        2.0 + np.minimum(walk, 0.0) + arc * np.sin(angle),
        4.0 + np.maximum(walk - 2 * np.pi, 0.0) - arc * np.cos(angle),
    ])  # fmt: skip
    start = press(profile, law, places[0] + [0.0, -2 * depth], (OPEN, (0.0, 1.0, 1.0)))[3]
    history, forces = (OPEN, start), []
    for x in places:
        force, _, state, kept, *_ = press(profile, law, x, history)
        history = (state, kept)
        forces.append(force)
    return np.array(forces)


@pytest.mark.parametrize("accumulated", RULES)
def test_a_spline_of_the_door_has_its_forces_to_the_accuracy_of_the_fit(accumulated):
    """The curvature of the door jumps at two joints: the fit errs with the square of the spacing
    there, and the normal force is that error times the penalty."""
    law = LAW._replace(accumulated=accumulated)
    exact = slide_round(FORMS["corner"](4.0), law)
    scale, errors = np.linalg.norm(exact, axis=1).max(), []
    for spacing in (0.2, 0.1, 0.05, 0.025):
        found = slide_round(rounded_corner(spacing), law)
        errors.append(np.linalg.norm(found - exact, axis=1).max() / scale)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.15)
    # of a force of which 1e-2 is lost with a gap of 5e-5
    assert errors[-1] < 1e-3

"""Regularised Coulomb friction: limits (28), (29), both history rules, entering and leaving."""

import numpy as np
import pytest
from doors import FORMS, RADIUS, at_gap, normal, press

from seal_mdao.contact.friction import OPEN, SLIP, STICK, ContactLaw
from seal_mdao.contact.rigid_forces import APART, NOT_YET, PASSED, STUCK

LAW = ContactLaw(1e4, 1e2, 0.25, True)
RULES = (True, False)
FLAT = FORMS["flat"](RADIUS)
# open, straight below the origin
ABOVE = (OPEN, (100.0, 1.0, 0.5))
# on the flat, e_t = (1, 0) and e_n = (0, -1): a point at height h > 0 penetrates by h
DEPTH = 1e-3
LIMIT = LAW.friction * LAW.normal_penalty * DEPTH


def follow(law, places, profile=FLAT, history=ABOVE):
    """Press a point at one place after the other; list of (force, state, history)."""
    out = []
    for x in places:
        force, _, state, kept, _, _, _ = press(profile, law, x, history)
        history = (state, kept)
        out.append((force, state, history))
    return out


def sliding(motion, depth=DEPTH):
    return [(x, depth) for x in np.concatenate([[0.0], np.cumsum(motion)])]


@pytest.mark.parametrize("accumulated", RULES)
@pytest.mark.parametrize("form", FORMS)
def test_point_that_touches_straight_on_has_normal_force_only(form, accumulated):
    """Zero slip is counted from where it touched."""
    law = LAW._replace(accumulated=accumulated)
    profile = FORMS[form](RADIUS)
    x, xi = at_gap(profile, 0, 0.4, -DEPTH)
    before = (OPEN, (xi, 1.0, 0.03))
    force, _, state, kept, gap, _, _ = press(profile, law, x, before, length=0.7)
    assert state == STICK
    assert gap == pytest.approx(-DEPTH, rel=1e-9)
    exact = 0.7 * law.normal_penalty * gap * normal(profile, 0, xi)
    np.testing.assert_allclose(force, exact, atol=1e-10)
    np.testing.assert_allclose(kept, (xi, 1.0, 0.0), rtol=1e-12, atol=1e-12)


def test_point_that_touches_aslant_slides_from_where_it_touched():
    """On a straight way to the flat door the share of the way behind the door is exact."""
    start, end = np.array([0.0, -0.03]), np.array([0.012, DEPTH])
    share = DEPTH / (DEPTH + 0.03)
    _, (force, state, (_, kept)) = follow(LAW, [start, end])
    assert state == STICK
    assert kept[2] == pytest.approx(share * 0.012, rel=1e-9)
    assert force[0] == pytest.approx(LAW.tangent_penalty * share * 0.012, rel=1e-9)


@pytest.mark.parametrize("touched", [0.2, 0.5, 0.9])
def test_slip_after_touching_does_not_depend_on_the_steps(touched):
    """A straight way cut into steps anywhere, accumulated rule: the same traction at its end."""
    start, end = np.array([0.0, -DEPTH]), np.array([4e-3, DEPTH])
    way = [start + s * (end - start) for s in (0.0, 0.5 * touched, touched, 1.0)]
    force = follow(LAW, way)[-1][0]
    assert force[0] == pytest.approx(LAW.tangent_penalty * 2e-3, rel=1e-9)


@pytest.mark.parametrize("accumulated", RULES)
@pytest.mark.parametrize("form", FORMS)
def test_force_does_not_jump_when_a_point_touches_one_step_earlier(form, accumulated):
    """Just open or just closed at the previous step: the same force and the same history."""
    law, profile = LAW._replace(accumulated=accumulated), FORMS[form](RADIUS)
    x, xi = at_gap(profile, 0, 0.4, -DEPTH)
    results = [
        press(profile, law, x, history)
        for history in ((OPEN, (xi - 2e-3, 1.0, 1e-13)), (STICK, (xi - 2e-3, 1.0, 0.0)))
    ]
    np.testing.assert_allclose(results[0][0], results[1][0], rtol=1e-8)
    np.testing.assert_allclose(results[0][3], results[1][3], rtol=1e-8, atol=1e-12)


def test_normal_force_pushes_the_door_out_and_grows_with_penetration():
    for depth in (1e-4, 1e-3):
        force = press(FLAT, LAW, (0.0, depth), ABOVE, length=2.0)[0]
        np.testing.assert_allclose(force, (0.0, 2.0 * LAW.normal_penalty * depth), rtol=1e-12)


@pytest.mark.parametrize("accumulated", RULES)
@pytest.mark.parametrize("share", [-0.999, -0.4, 0.3, 0.999])
def test_traction_below_the_limit_sticks(accumulated, share):
    """Eq. (28): |w_t g_t| <= mu w_n |g_n| gives the traction w_t g_t."""
    law = LAW._replace(accumulated=accumulated)
    slip = share * LIMIT / law.tangent_penalty
    _, (force, state, (_, kept)) = follow(law, sliding([slip]))
    assert state == STICK
    assert force[0] == pytest.approx(law.tangent_penalty * slip, rel=1e-12)
    assert kept[2] == pytest.approx(slip if accumulated else 0.0, rel=1e-12)


@pytest.mark.parametrize("accumulated", RULES)
@pytest.mark.parametrize("share", [-30.0, -1.001, 1.001, 4.0])
def test_traction_above_the_limit_slips(accumulated, share):
    """Eq. (29): mu w_n |g_n| with the sign of g_t, so that the door resists the slip."""
    law = LAW._replace(accumulated=accumulated)
    slip = share * LIMIT / law.tangent_penalty
    _, (force, state, (_, kept)) = follow(law, sliding([slip]))
    assert state == SLIP
    assert force[0] == pytest.approx(np.sign(share) * LIMIT, rel=1e-12)
    elastic = np.sign(share) * LIMIT / law.tangent_penalty
    assert kept[2] == pytest.approx(elastic if accumulated else 0.0, rel=1e-12)


def test_accumulated_rule_is_the_return_mapping(rng):
    """Elastic-perfectly plastic in the slip, with a limit that follows the pressure."""
    motion, depth = rng.normal(0.0, 0.02, 60), DEPTH * rng.uniform(0.5, 1.5, 61)
    x = np.concatenate([[0.0], np.cumsum(motion)])
    path = follow(LAW, list(zip(x, depth, strict=True)))
    elastic, states = 0.0, []
    for i in range(1, 61):
        most = LAW.friction * LAW.normal_penalty * depth[i] / LAW.tangent_penalty
        trial = elastic + motion[i - 1]
        elastic = np.clip(trial, -most, most)
        force, state, (_, kept) = path[i]
        assert force[0] == pytest.approx(LAW.tangent_penalty * elastic, abs=1e-10)
        assert kept[2] == pytest.approx(elastic, abs=1e-12)
        assert state == (STICK if trial == elastic else SLIP)
        states.append(state)
    assert {STICK, SLIP} <= set(states)


def test_accumulated_stick_does_not_depend_on_the_number_of_steps():
    total = 0.8 * LIMIT / LAW.tangent_penalty
    for steps in (1, 7, 50):
        force = follow(LAW, sliding(np.full(steps, total / steps)))[-1][0]
        assert force[0] == pytest.approx(LAW.tangent_penalty * total, rel=1e-9)


def test_incremental_rule_measures_slip_from_the_previous_step_only():
    """Eq. (19) as printed: the traction of N equal steps is that of the last one."""
    law, total = LAW._replace(accumulated=False), 0.8 * LIMIT / LAW.tangent_penalty
    for steps in (1, 7, 50):
        force = follow(law, sliding(np.full(steps, total / steps)))[-1][0]
        assert force[0] == pytest.approx(law.tangent_penalty * total / steps, rel=1e-9)


@pytest.mark.parametrize("form", FORMS)
def test_rules_agree_in_the_step_of_touching_and_in_the_next_one_after_straight_touching(form):
    profile = FORMS[form](RADIUS)
    x, xi = at_gap(profile, 0, 0.4, -DEPTH)
    y = at_gap(profile, 0, 0.40002, -DEPTH)[0]
    paths = [
        follow(LAW._replace(accumulated=rule), (x, y), profile, (OPEN, (xi, 1.0, 0.1)))
        for rule in RULES
    ]
    for first, second in zip(*paths, strict=True):
        np.testing.assert_allclose(first[0], second[0], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("accumulated", RULES)
def test_point_that_leaves_contact_loses_its_history(accumulated):
    """It carries its gap in place of the slip, and begins again where it touches again."""
    law = LAW._replace(accumulated=accumulated)
    slip = 0.5 * LIMIT / law.tangent_penalty
    places = [(0.0, DEPTH), (slip, DEPTH), (2 * slip, -DEPTH), (2 * slip, DEPTH), (3 * slip, DEPTH)]
    path = follow(law, places)
    assert [state for _, state, _ in path] == [STICK, STICK, OPEN, STICK, STICK]
    np.testing.assert_array_equal(path[2][0], 0.0)
    np.testing.assert_allclose(path[2][2][1], (100.0 + 2 * slip, 1.0, DEPTH), rtol=1e-12)
    assert path[3][0][0] == 0.0
    assert path[4][0][0] == pytest.approx(law.tangent_penalty * slip, rel=1e-9)


def test_without_friction_every_point_slips_without_traction():
    path = follow(LAW._replace(friction=0.0), sliding([0.1, -0.3]))
    for force, state, _ in path[1:]:
        assert state == SLIP
        assert force[0] == 0.0


def test_without_friction_a_point_that_has_not_slid_does_not_stick():
    """The limit is zero and so is the traction: a stick tangent would hold it sideways."""
    (_, state, _), _ = follow(LAW._replace(friction=0.0), sliding([0.0]))
    assert state == SLIP


def test_touching_without_penetration_is_open():
    force, tangent, state, *_ = press(FLAT, LAW, (0.0, 0.0), (STICK, (100.0, 1.0, 0.1)))
    assert state == OPEN
    assert not force.any()
    assert not tangent.any()


@pytest.mark.parametrize("gap", [-0.4, -0.01])
def test_traction_on_an_arc_is_scaled_by_v(gap):
    """Eqs. (22), (27): v = |t| |t0| / c with c = 1 - g_n alpha, so that the slip does its work."""
    profile = FORMS["corner"](RADIUS)
    x, xi = at_gap(profile, 1, 0.5, gap)
    length, size_0, elastic = 1.3, 0.8, 0.01
    history = (STICK, (xi - 0.02, size_0, elastic))
    force, *_ = press(profile, LAW, x, history, length=length)
    e_n = normal(profile, 1, xi)
    e_t = np.array([-e_n[1], e_n[0]])
    c = 1.0 + gap / RADIUS
    g_t = elastic + size_0 * 0.02
    assert force @ e_n == pytest.approx(length * LAW.normal_penalty * gap, rel=1e-12)
    assert force @ e_t == pytest.approx(length * LAW.tangent_penalty * g_t * size_0 / c, rel=1e-9)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_point_that_would_slip_back_sticks_for_one_iteration(way):
    """It has passed the stick branch in between; the force is that of stick whatever the limit."""
    slip = way * 3.0 * LIMIT / LAW.tangent_penalty
    history = (STICK, (100.0 - slip, 1.0, 0.0))
    for previous, expected in ((NOT_YET, SLIP), (int(way), SLIP), (-int(way), STICK)):
        force, tangent, state, _, _, made, after = press(FLAT, LAW, (0.0, DEPTH), history, previous)
        assert state == expected
        assert made == (expected == STICK)
        assert after == (int(way) if expected == SLIP else STUCK)
        traction = LAW.tangent_penalty * slip if made else way * LIMIT
        assert force[0] == pytest.approx(traction, rel=1e-9)
        assert tangent[0, 0] == pytest.approx(LAW.tangent_penalty if made else 0.0, abs=1e-9)


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("before", [(OPEN, 1e-5), (OPEN, 7e-4), (OPEN, 9e-4), (STICK, 0.0)])
def test_point_that_was_open_passes_through_slip_where_it_slips_at_touch(way, before):
    """Taken to slip for one iteration, where the iterations alternate between open and stick."""
    state_0, carried = before
    history = (state_0, (100.0 - way * 0.02, 1.0, carried))
    at_touch = press(FLAT, LAW, (0.0, 1e-9), history)[2]
    for previous in (NOT_YET, APART, STUCK):
        passed = at_touch == SLIP and (previous == APART or (previous, state_0) == (NOT_YET, OPEN))
        _, _, state, _, _, made, after = press(FLAT, LAW, (0.0, DEPTH), history, previous)
        assert (state, made, after) == (STICK, 0, PASSED if passed else STUCK)
        force, tangent, state, _, _, made, after = press(
            FLAT, LAW, (0.0, DEPTH), history, previous, through_slip=True
        )
        assert (state, made) == ((SLIP, 1) if passed else (STICK, 0))
        assert after == (way if passed else STUCK)
        if passed:
            # +-mu w_n |g_n| and its derivatives
            assert force[0] == pytest.approx(way * LIMIT, rel=1e-9)
            exact = (0.0, way * LAW.friction * LAW.normal_penalty)
            np.testing.assert_allclose(tangent[0], exact, atol=1e-9)

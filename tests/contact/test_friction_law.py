"""Friction laws besides Coulomb's: limits, all derivatives of a point, what is refused."""

import numpy as np
import pytest
from doors import AT_REST, FORMS, RADIUS, at_gap, linearized, press

from seal_mdao.contact.friction import FRICTION, SLIP, STICK, ContactLaw
from seal_mdao.contact.friction_law import friction_law

STEP = 1e-4
# gap, state before, xi - xi0, |t0|, elastic slip or gap carried; and the state that follows
CASES = {
    "touch and stick": ((-0.07, 0, 0.04, 0.9, 0.05), STICK),
    "touch and slip": ((-0.07, 0, -3.0, 0.9, 0.05), SLIP),
    "stick": ((-0.07, SLIP, 0.01, 0.9, 0.02), STICK),
    "slip": ((-0.07, STICK, 3.0, 0.9, 0.02), SLIP),
    "slip back": ((-0.07, SLIP, -3.0, 0.9, 0.02), SLIP),
}


def coulomb(pressure, friction):
    return friction * pressure


def falling(pressure, forward, backward, reference):
    """Other limits for the two directions, neither of them proportional to the pressure."""
    share = (1.0 + pressure / reference) ** (-1.0 / 3.0)
    return forward * pressure * share, backward * pressure / share


def limited(pressure, friction, most):
    limit = friction * pressure
    return limit if limit.real < most.real else most


FALLING = (0.25, 0.2, 30.0)


def point(case, form="corner", piece=1):
    """A point of a case on a profile: its place and history."""
    gap, before, way, size_0, carried = CASES[case][0]
    x, xi = at_gap(FORMS[form](RADIUS), piece, 0.4, gap)
    return x, (before, [xi - way, size_0, carried])


@pytest.mark.parametrize("accumulated", [True, False])
@pytest.mark.parametrize("case", CASES)
def test_coulombs_law_as_one_of_its_own_is_the_same(case, accumulated):
    """Force, tangent, state, history and all columns, to rounding."""
    x, history = point(case)
    own = ContactLaw(90.0, 20.0, friction_law(coulomb, friction=0.25), accumulated)
    shipped = ContactLaw(90.0, 20.0, 0.25, accumulated)
    profile = FORMS["corner"](RADIUS)
    for found, expected in zip(press(profile, own, x, history), press(profile, shipped, x, history),
                               strict=True):  # fmt: skip
        np.testing.assert_allclose(found, expected, rtol=1e-14)
    found, expected = (linearized(profile, law, x, history, 1.3) for law in (own, shipped))
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13)


def outputs(values, before, form):
    """Force, what is carried and the gap, and the state, of inputs in the order of the package."""
    law = ContactLaw(values[6], values[7], friction_law(falling, **named(values[8:11])), True)
    force, _, state, kept, gap, _, _ = press(
        FORMS[form](values[11]), law, values[:2], (before, values[2:5]), length=values[5]
    )
    return np.array([*force, *kept, gap]), state


def named(constants):
    return dict(zip(("forward", "backward", "reference"), constants.tolist(), strict=True))


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(("form", "piece"), [("corner", 1), ("circle", 0), ("hollow", 0)])
def test_all_inputs_against_central_differences(case, form, piece):
    """Place, history, length, penalties, constants of the law and shape of the profile."""
    x, (before, variables) = point(case, form, piece)
    values = np.array([*x, *variables, 1.3, 90.0, 20.0, *FALLING, RADIUS])
    law = ContactLaw(90.0, 20.0, friction_law(falling, **named(values[8:11])), True)
    profile = FORMS[form](RADIUS)
    found = linearized(profile, law, x, (before, variables), 1.3, AT_REST)
    assert found.shape == (6, FRICTION + 3 + 1)
    for column, unit in enumerate(np.eye(values.size)):
        sides = []
        for k in (-2.0, -1.0, 1.0, 2.0):
            out, state = outputs(values + k * STEP * unit, before, form)
            assert state == CASES[case][1]
            sides.append(out)
        expected = (sides[0] - 8 * sides[1] + 8 * sides[2] - sides[3]) / (12 * STEP)
        np.testing.assert_allclose(
            found[:, column], expected, rtol=1e-7, atol=3e-8, err_msg=f"input {column}"
        )


def test_the_limit_of_a_direction_holds_for_slip_in_it():
    law, pressure = friction_law(falling, **named(np.array(FALLING))), 90.0 * 0.07
    share = (1.0 + pressure / 30.0) ** (-1.0 / 3.0)
    limits = {"slip": 0.25 * pressure * share, "slip back": -0.2 * pressure / share}
    for case, limit in limits.items():
        x, history = point(case)
        *_, kept, _, _, _ = press(FORMS["corner"](RADIUS), ContactLaw(90.0, 20.0, law), x, history)
        assert kept[2] * 20.0 == pytest.approx(limit, rel=1e-12)
    found = law.at(np.array([0.0, pressure]))
    assert not found[0].any()
    np.testing.assert_allclose(found[1, :, 0], [-limits["slip back"], limits["slip"]], rtol=1e-14)


def test_branches_on_real_parts():
    """Coulomb's law with a largest traction: its derivatives are those of the branch."""
    found = friction_law(limited, friction=0.5, most=5.0).at(np.array([4.0, 40.0]))
    np.testing.assert_allclose(
        found[:, 0], [[2.0, 0.5, 4.0, 0.0], [5.0, 0.0, 0.0, 1.0]], rtol=1e-14
    )


@pytest.mark.parametrize(("law", "constants", "message"), [
    (lambda pressure, a: abs(a * pressure), {"a": 0.3}, "with respect to pressure is wrong"),
    (lambda pressure, a: a if pressure > 1.0 else 0.0, {"a": 0.3}, "cannot be compiled"),
    (lambda pressure, a: max(a * pressure, 1.0), {"a": 0.3}, "cannot be compiled by Numba"),
    (lambda pressure, a: -a * pressure, {"a": 0.3}, "at least 0 kPa"),
    (lambda pressure, a: a * pressure, {}, "friction law .* has no value of its constant 'a'"),
    (lambda pressure, a: a * pressure, {"a": 0.3, "b": 1.0}, "has no constant 'b'; it has a"),
    (lambda pressure, a: a * pressure, {"a": np.nan}, "a of the friction law"),
    (lambda pressure, law: law * pressure, {"law": 1.0}, "the name 'law' of a constant is reserved"),
    (lambda *pressure: pressure[0], {}, "must be a function of the pressure"),
])  # fmt: skip
def test_laws_that_cannot_be_used(law, constants, message):
    with pytest.raises(ValueError, match=message) as caught:
        friction_law(law, **constants)
    assert "\n" not in str(caught.value)

"""All ten inputs of the local linearisation against differences, in every contact state."""

import numpy as np
import pytest
from doors import FORMS, RADIUS, at_gap, linearized, press

from seal_mdao.contact.friction import (
    CARRIED,
    FORCE_X,
    FORCE_Y,
    FRICTION,
    GAP,
    LENGTH,
    NORMAL_PENALTY,
    OPEN,
    SIZE,
    SIZE_0,
    SLIP,
    SLIP_0,
    STICK,
    TANGENT_PENALTY,
    XI,
    XI_0,
    ContactLaw,
    X,
    Y,
)
from seal_mdao.contact.friction import RADIUS as RADIUS_INPUT

PIECES = {"corner": (0, 1, 2), "segments": (0, 3), "circle": (0,), "hollow": (0,)}
# gap, state before, xi - xi0, |t0|, elastic slip or gap carried; and the state that follows
CASES = {
    "open": ((0.07, STICK, 0.01, 0.9, 0.02), OPEN),
    "touch and stick": ((-0.07, OPEN, 0.04, 0.9, 0.05), STICK),
    "touch and slip": ((-0.07, OPEN, -3.0, 0.9, 0.05), SLIP),
    "stick": ((-0.07, SLIP, 0.01, 0.9, 0.02), STICK),
    "slip": ((-0.07, STICK, 3.0, 0.9, 0.02), SLIP),
    "slip back": ((-0.07, SLIP, -3.0, 0.9, 0.02), SLIP),
}


def inputs(form, piece, case):
    """The ten inputs in the order of the package, and the state before."""
    (gap, before, slip, size_0, carried), _ = CASES[case]
    x, xi = at_gap(FORMS[form](RADIUS), piece, 0.4, gap)
    values = np.empty(10)
    values[[X, Y]] = x
    values[[XI_0, SIZE_0, SLIP_0, LENGTH]] = xi - slip, size_0, carried, 1.3
    values[[RADIUS_INPUT, NORMAL_PENALTY, TANGENT_PENALTY, FRICTION]] = RADIUS, 90.0, 20.0, 0.25
    return values, before


def outputs(form, values, before, accumulated):
    """The six outputs and the state."""
    law = ContactLaw(values[NORMAL_PENALTY], values[TANGENT_PENALTY], values[FRICTION], accumulated)
    history = (before, values[[XI_0, SIZE_0, SLIP_0]])
    force, _, state, kept, gap, _, _ = press(
        FORMS[form](values[RADIUS_INPUT]), law, values[[X, Y]], history, length=values[LENGTH]
    )
    out = np.empty(6)
    out[[FORCE_X, FORCE_Y]], out[[XI, SIZE, CARRIED]], out[GAP] = force, kept, gap
    return out, state


@pytest.mark.parametrize("accumulated", [True, False], ids=["accumulated", "incremental"])
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("form", PIECES)
def test_all_inputs_against_central_differences(form, case, accumulated):
    for piece in PIECES[form]:
        values, before = inputs(form, piece, case)
        law = ContactLaw(*values[[NORMAL_PENALTY, TANGENT_PENALTY, FRICTION]], accumulated)
        history = (before, values[[XI_0, SIZE_0, SLIP_0]])
        found = linearized(FORMS[form](RADIUS), law, values[[X, Y]], history, values[LENGTH])
        for column in range(10):
            step = 2e-5
            sides = []
            for sign in (1.0, -1.0):
                moved = values.copy()
                moved[column] += sign * step
                out, state = outputs(form, moved, before, accumulated)
                assert state == CASES[case][1]
                sides.append(out)
            difference = (sides[0] - sides[1]) / (2 * step)
            np.testing.assert_allclose(
                found[:, column], difference, rtol=1e-7, atol=3e-8, err_msg=f"input {column}"
            )


@pytest.mark.parametrize("case", CASES)
def test_rigid_motion_of_the_profile_is_minus_motion_of_the_point(case):
    """Which is how the depth of the door enters the sensitivities."""
    values, before = inputs("corner", 1, case)
    first, _ = outputs("corner", values, before, True)
    law = ContactLaw(*values[[NORMAL_PENALTY, TANGENT_PENALTY, FRICTION]], True)
    history = (before, values[[XI_0, SIZE_0, SLIP_0]])
    profile, shift = FORMS["corner"](RADIUS), np.array([0.4, -0.2])
    moved = profile._replace(origin=profile.origin + shift)
    found = linearized(profile, law, values[[X, Y]], history, values[LENGTH])
    there = linearized(moved, law, values[[X, Y]] + shift, history, values[LENGTH])
    np.testing.assert_allclose(there, found, rtol=1e-9, atol=1e-9)
    assert np.isfinite(first).all()


def test_tangent_is_the_first_two_columns_of_the_linearization():
    for case in CASES:
        values, before = inputs("corner", 1, case)
        law = ContactLaw(*values[[NORMAL_PENALTY, TANGENT_PENALTY, FRICTION]], True)
        history = (before, values[[XI_0, SIZE_0, SLIP_0]])
        profile = FORMS["corner"](RADIUS)
        _, tangent, *_ = press(profile, law, values[[X, Y]], history, length=values[LENGTH])
        found = linearized(profile, law, values[[X, Y]], history, values[LENGTH])
        np.testing.assert_array_equal(tangent, found[:2, :2])

"""All inputs of the local linearisation and the pose against differences, in every contact state."""

import numpy as np
import pytest
from doors import AT_REST, FORMS, RADIUS, at_gap, linearized, press
from splines import SPLINES

from seal_mdao.contact.friction import (
    CARRIED,
    FORCE_X,
    FORCE_Y,
    FRICTION,
    GAP,
    LENGTH,
    NORMAL_PENALTY,
    OPEN,
    SHAPE,
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
from seal_mdao.geometry.pose import Pose, quarter_turn, rigid_velocity

CURVES = {name: (build, (RADIUS,)) for name, build in FORMS.items() if name != "flat"} | SPLINES
PIECES = {"corner": (0, 1, 2), "segments": (0, 3), "circle": (0,), "hollow": (0,)}
PIECES |= {"ellipse": (0, 4), "wave": (0, 13, 31)}
PLACE, PIVOT = np.array([0.4, -0.3, np.pi / 6]), (1.5, -2.0)
TURNED = Pose.of(PLACE[:2], PLACE[2], PIVOT)
POSES = {"at rest": AT_REST, "turned": TURNED}
STEP = 1e-4
# gap, state before, xi - xi0, |t0|, elastic slip or gap carried; and the state that follows
CASES = {
    "open": ((0.07, STICK, 0.01, 0.9, 0.02), OPEN),
    "touch and stick": ((-0.07, OPEN, 0.04, 0.9, 0.05), STICK),
    "touch and slip": ((-0.07, OPEN, -3.0, 0.9, 0.05), SLIP),
    "stick": ((-0.07, SLIP, 0.01, 0.9, 0.02), STICK),
    "slip": ((-0.07, STICK, 3.0, 0.9, 0.02), SLIP),
    "slip back": ((-0.07, SLIP, -3.0, 0.9, 0.02), SLIP),
}


def profile_of(form):
    build, shape = CURVES[form]
    return build(*shape)


def inputs(form, piece, case, pose=AT_REST):
    """The inputs in the order of the package, and the state before."""
    (gap, before, slip, size_0, carried), _ = CASES[case]
    shape = CURVES[form][1]
    x, xi = at_gap(profile_of(form), piece, 0.4, gap)
    values = np.empty(SHAPE + len(shape))
    values[[X, Y]] = pose.places(x)
    values[[XI_0, SIZE_0, SLIP_0, LENGTH]] = xi - slip, size_0, carried, 1.3
    values[[NORMAL_PENALTY, TANGENT_PENALTY, FRICTION]] = 90.0, 20.0, 0.25
    values[SHAPE:] = shape
    return values, before


def law_of(values, accumulated):
    return ContactLaw(*values[[NORMAL_PENALTY, TANGENT_PENALTY, FRICTION]], accumulated)


def outputs(form, values, before, accumulated, pose=AT_REST):
    """The six outputs and the state."""
    history = (before, values[[XI_0, SIZE_0, SLIP_0]])
    force, _, state, kept, gap, _, _ = press(
        CURVES[form][0](*values[SHAPE:]), law_of(values, accumulated), values[[X, Y]], history,
        length=values[LENGTH], pose=pose,
    )  # fmt: skip
    out = np.empty(6)
    out[[FORCE_X, FORCE_Y]], out[[XI, SIZE, CARRIED]], out[GAP] = force, kept, gap
    return out, state


def outputs_of(form, before, accumulated, pose):
    return lambda values: outputs(form, values, before, accumulated, pose)


def linearization(form, values, before, accumulated, pose=AT_REST):
    history = (before, values[[XI_0, SIZE_0, SLIP_0]])
    return linearized(
        profile_of(form), law_of(values, accumulated), values[[X, Y]], history, values[LENGTH], pose
    )


def difference(outputs_at, place, unit, case):
    """Central difference of fourth order, and that all four sides have the state of the case."""
    sides = []
    for k in (-2.0, -1.0, 1.0, 2.0):
        out, state = outputs_at(place + k * STEP * unit)
        assert state == CASES[case][1]
        sides.append(out)
    return (sides[0] - 8 * sides[1] + 8 * sides[2] - sides[3]) / (12 * STEP)


@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize("accumulated", [True, False], ids=["accumulated", "incremental"])
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("form", PIECES)
def test_all_inputs_against_central_differences(form, case, accumulated, pose):
    for piece in PIECES[form]:
        values, before = inputs(form, piece, case, POSES[pose])
        found = linearization(form, values, before, accumulated, POSES[pose])
        for column, unit in enumerate(np.eye(values.size)):
            expected = difference(
                outputs_of(form, before, accumulated, POSES[pose]), values, unit, case
            )
            np.testing.assert_allclose(
                found[:, column], expected, rtol=1e-7, atol=3e-8, err_msg=f"input {column}"
            )


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("form", PIECES)
def test_rates_of_the_pose_against_central_differences(form, case):
    """Columns X and Y times the velocity relative to the rigid motion; the force turns with it."""
    piece = PIECES[form][len(PIECES[form]) // 2]
    values, before = inputs(form, piece, case, TURNED)
    local = linearization(form, values, before, True, TURNED)
    out, _ = outputs(form, values, before, True, TURNED)
    found = -local[:, [X, Y]] @ rigid_velocity(TURNED, values[np.newaxis, [X, Y]])[0]
    found[[FORCE_X, FORCE_Y], 2] += quarter_turn(out[[FORCE_X, FORCE_Y]])

    def moved(place):
        return outputs(form, values, before, True, Pose.of(place[:2], place[2], PIVOT))

    for k, unit in enumerate(np.eye(3)):
        expected = difference(moved, PLACE, unit, case)
        np.testing.assert_allclose(found[:, k], expected, rtol=1e-7, atol=3e-8, err_msg=f"rate {k}")


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("form", ["corner", "ellipse", "wave"])
def test_a_turned_problem_has_turned_forces_and_the_same_gap_and_slip(form, case):
    """Profile and point turned by 30 degrees about a pivot and shifted."""
    turn = TURNED.matrix
    for piece in PIECES[form]:
        values, before = inputs(form, piece, case)
        there, _ = inputs(form, piece, case, TURNED)
        out, state = outputs(form, values, before, True)
        out_there, state_there = outputs(form, there, before, True, TURNED)
        assert state_there == state
        expected = out.copy()
        expected[[FORCE_X, FORCE_Y]] = turn @ out[[FORCE_X, FORCE_Y]]
        # rounding of a point some 10 mm away times the stiffness of 90 and 1.3
        np.testing.assert_allclose(out_there, expected, rtol=0.0, atol=1e-12)
        local = linearization(form, values, before, True)
        local[[FORCE_X, FORCE_Y]] = turn @ local[[FORCE_X, FORCE_Y]]
        local[:, [X, Y]] = local[:, [X, Y]] @ turn.T
        found = linearization(form, there, before, True, TURNED)
        np.testing.assert_allclose(found, local, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("case", ["stick", "slip", "slip back"])
@pytest.mark.parametrize("form", ["circle", "hollow", "ellipse"])
def test_a_point_slides_over_the_seam_of_a_closed_profile(form, case):
    """Its history from the other side of the seam is one period away: the same forces and rates,
    but that the period changes with the shape."""
    values, before = inputs(form, 0, case)
    period = profile_of(form).period
    across = values.copy()
    across[XI_0] += period
    out, state = outputs(form, across, before, True)
    assert state == CASES[case][1]
    np.testing.assert_allclose(out, outputs(form, values, before, True)[0], rtol=1e-11)
    found = linearization(form, across, before, True)
    for column, unit in enumerate(np.eye(values.size)):
        expected = difference(outputs_of(form, before, True, AT_REST), across, unit, case)
        np.testing.assert_allclose(found[:, column], expected, rtol=1e-7, atol=3e-8)


def test_tangent_is_the_first_two_columns_of_the_linearization():
    for case in CASES:
        for form, piece in (("corner", 1), ("wave", 13)):
            values, before = inputs(form, piece, case, TURNED)
            history = (before, values[[XI_0, SIZE_0, SLIP_0]])
            _, tangent, *_ = press(
                profile_of(form), law_of(values, True), values[[X, Y]], history,
                length=values[LENGTH], pose=TURNED,
            )  # fmt: skip
            found = linearization(form, values, before, True, TURNED)
            np.testing.assert_array_equal(tangent, found[:2, :2])

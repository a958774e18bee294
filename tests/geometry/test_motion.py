"""Motion in stages: places along the path, rates of the waypoints, poses, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from seal_mdao.geometry.motion import (
    BEFORE,
    Motion,
    Stage,
    path_motion,
    staged_motion,
    straight_motion,
)
from seal_mdao.geometry.pose import Pose, in_frame, quarter_turn, rigid_velocity, turned


def closing(depth=3.0, swing=25.0):
    """Close, swing about a hinge while sliding, open."""
    stages = [
        Stage(4, (0.0, -depth), rates={"depth": (0.0, -1.0, 0.0)}),
        Stage(5, (1.0, 0.5), swing, rates={"swing": (0.0, 0.0, 1.0)}),
        Stage(2, (0.0, depth), rates={"depth": (0.0, 1.0, 0.0)}),
    ]
    return staged_motion(stages, start=(0.2, 1.0), pivot=(-4.0, 2.0))


def test_waypoints_are_reached_at_the_ends_of_the_stages():
    motion = closing()
    assert motion.n_steps == 11
    assert motion.names == ("depth", "swing")
    angle = np.deg2rad(25.0)
    for fraction, place in (
        (0, (0.2, 1.0, 0.0)),
        (4, (0.2, -2.0, 0.0)),
        (9, (1.2, -1.5, angle)),
        (11, (1.2, 1.5, angle)),
    ):
        np.testing.assert_allclose(motion.coordinates(fraction), place, atol=1e-15)


def test_places_between_lie_on_straight_lines():
    motion = closing()
    for fraction, share, first, last in ((1.3, 1.3 / 4, 0, 4), (7.75, 3.75 / 5, 4, 9)):
        ends = motion.coordinates(first), motion.coordinates(last)
        np.testing.assert_allclose(
            motion.coordinates(fraction), ends[0] + share * (ends[1] - ends[0]), atol=1e-15
        )


def test_rates_are_the_derivatives_of_the_places():
    """Linear in both parameters: differences are exact to rounding."""
    motion = closing()
    for fraction in (0.0, 1.3, 4.0, 6.5, 9.0, 10.1, 11.0):
        depth = closing(depth=4.0).coordinates(fraction) - closing(2.0).coordinates(fraction)
        swing = closing(swing=35.0).coordinates(fraction) - closing(swing=15.0).coordinates(
            fraction
        )
        np.testing.assert_allclose(motion.rates_at(fraction), [depth / 2, swing / 20], atol=1e-15)


def test_a_straight_motion_is_a_linspace_bit_for_bit():
    motion = straight_motion((0.0, 0.5), (0.0, -9.7), 105, {"depth": (0.0, -1.0)})
    y = np.linspace(0.5, -9.7, 106)
    for fraction in (0.0, 3.0, 17.625, 104.5, 105.0):
        first = min(int(fraction), 104)
        pose = motion.pose(fraction)
        assert pose.position[1] == y[first] + (fraction - first) * (y[first + 1] - y[first])
        assert (pose.position[0], pose.cos, pose.sin) == (0.0, 1.0, 0.0)
        np.testing.assert_array_equal(motion.rates_at(fraction), [[0.0, -fraction / 105, 0.0]])


def test_a_pose_without_rotation_subtracts_the_position_bit_for_bit(rng):
    pose = Pose.of((0.3, -1.7), 0.0, (5.0, 7.0))
    for x, y in rng.uniform(-10.0, 10.0, (50, 2)):
        assert in_frame(pose, x, y) == (x - 0.3, y + 1.7)
        assert turned(pose, (x, y)) == (x, y)


def test_pivot_moves_with_the_position_and_points_turn_about_it():
    pose = Pose.of((1.0, 2.0), np.pi / 2, (3.0, 0.0))
    np.testing.assert_allclose(pose.places(np.array([[3.0, 0.0], [4.0, 0.0]])), [[4, 2], [4, 3]])


def test_frames_are_inverse_to_each_other(rng):
    pose = Pose.of((1.0, 2.0), 0.7, (3.0, -1.0))
    points = rng.uniform(-5.0, 5.0, (20, 2))
    back = [in_frame(pose, *x) for x in pose.places(points)]
    np.testing.assert_allclose(back, points, atol=1e-14)


def test_rigid_velocity_is_the_derivative_of_places():
    place, h = np.array([1.0, 2.0, 0.7]), 1e-5
    points, pivot = np.array([[0.4, 0.1], [-2.0, 3.0]]), (3.0, -1.0)
    pose = Pose.of(place[:2], place[2], pivot)
    found = rigid_velocity(pose, pose.places(points))
    for k in range(3):
        plus, minus = (
            Pose.of(moved[:2], moved[2], pivot).places(points)
            for moved in (place + h * np.eye(3)[k], place - h * np.eye(3)[k])
        )
        np.testing.assert_allclose(found[:, :, k], (plus - minus) / (2 * h), atol=2e-10)
    np.testing.assert_array_equal(quarter_turn(np.array([2.0, 3.0])), [-3.0, 2.0])


GOOD = {"positions": np.zeros((3, 2)), "angles": np.zeros(3), "steps": [2, 3]}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"steps": []}, "positive integers, one per stage"),
        ({"steps": [2, 0]}, "positive integers, one per stage"),
        ({"steps": [2.0, 3.5]}, "positive integers, one per stage"),
        ({"positions": np.zeros((2, 2))}, r"positions .* must have shape \(3, 2\), got \(2, 2\)"),
        ({"angles": [0.0, np.inf, 0.0]}, "angles of a motion .* must have finite"),
        ({"pivot": (0.0, 0.0, 1.0)}, r"pivot .* must have shape \(2,\)"),
        (
            {"fractions": (0.5, 1.0, 0.5, 1.0)},
            r"at which load steps end must increase to 1 in every stage of \[2, 3\]",
        ),
        ({"fractions": (0.5, 1.0, 0.5, 0.9, 0.99)}, "must increase to 1"),
        ({"fractions": (0.5, 1.0, 0.5, 0.5, 1.0)}, "must increase to 1"),
        ({"clearance": (1.0,)}, r"clearance .* must have shape \(2,\)"),
        ({"retraction": [(1.0,)]}, r"retraction .* must have shape \(1, 2\)"),
        (
            {"clearance": (0.1, -0.1), "positions": [[0.0, 0.0], [0.0, -2.0], [0.0, 0.0]]},
            "must point against the first displacement of the motion",
        ),
        ({"names": ("a",)}, r"rates .* 1 parameter\(s\) must have shape \(1, 3, 3\)"),
        ({"names": ("a", "a"), "rates": np.zeros((2, 3, 3))}, "must have different names"),
    ],
)
def test_what_does_not_fit_is_refused(changes, message):
    assert Motion(**GOOD).n_steps == 5
    with pytest.raises(ValueError, match=message):
        Motion(**{**GOOD, **changes})


def test_places_outside_the_motion_are_refused():
    with pytest.raises(ValueError, match="end of the motion, which has 5 steps"):
        Motion(**GOOD).pose(5.1)
    with pytest.raises(ValueError, match="at least one stage"):
        staged_motion([])


def test_steps_that_end_elsewhere_leave_the_motion_as_it_is():
    """Places and rates are those of the old motion at the new ends, and between them."""
    motion = closing()
    ends = [0.5, 3.9, 4.0, 4.25, 9.0, 11.0]
    other = motion.with_ends(ends)
    assert (other.n_steps, other.names) == (6, motion.names)
    np.testing.assert_array_equal(other.steps, [3, 2, 1])
    np.testing.assert_array_equal(other.positions, motion.positions)
    for number, end in enumerate(ends):
        places = other.coordinates(number + 1.0), motion.coordinates(end)
        np.testing.assert_allclose(*places, atol=1e-15)
        if end in (4.0, 9.0, 11.0):
            np.testing.assert_array_equal(*places)
        np.testing.assert_allclose(other.rates_at(number + 1.0), motion.rates_at(end), atol=1e-15)
    np.testing.assert_allclose(other.coordinates(1.5), motion.coordinates(2.2), atol=1e-15)
    np.testing.assert_allclose(other.rates_at(5.5), motion.rates_at(10.0), atol=1e-15)
    again = other.with_ends([1.0, 2.5, 3.0, 5.0, 6.0])
    np.testing.assert_allclose(again.coordinates(2.0), motion.coordinates(3.95), atol=1e-15)


def test_stages_with_given_shares_are_those_of_ends_bit_for_bit():
    """What a file writes of chosen steps gives the motion that they were chosen for."""
    ends = np.array([0.1, 0.7, 1.0, 1.0 + 1.0 / 3.0, 2.0])
    shares = [tuple((ends[:3]).tolist()), tuple((ends[3:] - 1.0).tolist())]
    moves = ((0.3, -3.1), (1.7, 0.0))
    one = staged_motion([Stage(1, m, 10.0) for m in moves], (0.1, 0.2)).with_ends(ends)
    other = staged_motion(
        [Stage(s, m, 10.0) for s, m in zip(shares, moves, strict=True)], (0.1, 0.2)
    )
    np.testing.assert_array_equal(one.fractions, other.fractions)
    for fraction in (0.0, 0.5, 1.0, 2.7, 3.0, 4.2, 5.0):
        np.testing.assert_array_equal(one.coordinates(fraction), other.coordinates(fraction))


def test_travel_is_found_with_unequal_steps():
    """The inverse of the coordinates, and its slope by differences of a piecewise linear function."""
    motion = replace(closing(), angles=np.zeros(4)).with_ends([0.5, 3.9, 4.0, 4.25, 9.0, 11.0])
    for travel in (0.2, 1.3, 2.99, 3.4):
        fraction, rates = motion.at_travel(travel)
        done = np.hypot(*np.diff([motion.coordinates(f)[:2] for f in (0.0, min(fraction, 3.0))],
                                 axis=0)[0])  # fmt: skip
        if fraction > 3.0:
            done += np.hypot(*(motion.coordinates(fraction)[:2] - motion.positions[1]))
        np.testing.assert_allclose(done, travel, atol=1e-14)
        sides = [motion.moved({"depth": s * 1e-6}).at_travel(travel)[0] for s in (1.0, -1.0)]
        np.testing.assert_allclose(rates[0], (sides[0] - sides[1]) / 2e-6, atol=1e-7)


@pytest.mark.parametrize(
    "ends", [[4.0, 9.0], [9.0, 11.0], [4.0, 4.0, 9.0, 11.0], [0.0, 4.0, 9.0, 11.0], []]
)
def test_ends_that_do_not_fit_the_stages_are_refused(ends):
    with pytest.raises(ValueError, match="at which load steps end must increase"):
        closing().with_ends(ends)


def test_room_is_before_the_first_step_whatever_the_steps():
    """And goes along when a parameter moves the first waypoint."""
    motion = replace(closing(), clearance=(0.1, 0.5))
    for other in (motion, motion.with_ends([0.5, 3.9, 4.0, 9.0, 11.0]), motion.moved({"depth": 1})):
        begin = np.append(other.positions[0] + motion.clearance, 0.0)
        np.testing.assert_array_equal(other.coordinates(0.0), begin)
        middle = 0.5 * (begin + other.coordinates(1.0))
        np.testing.assert_allclose(other.coordinates(0.5), middle, atol=1e-15)
    ends = motion.with_ends([0.5, 4.0, 9.0, 11.0])
    np.testing.assert_array_equal(ends.coordinates(1.0), closing().coordinates(0.5))


def test_preliminary_increments_end_where_the_first_step_begins():
    """Load steps, travels and rates are those of the motion without them."""
    own = replace(closing(), clearance=(0.1, 0.5))
    motion = replace(own, retraction=[(0.0, 0.25), (0.1, 0.5)])
    begin = own.coordinates(0.0)
    assert (own.begins_at, motion.begins_at, motion.n_steps) == (0.0, -2.0, own.n_steps)
    for fraction, moved in ((-0.5, (0.0, 0.125)), (-1.0, (0.0, 0.25)), (-1.5, (0.05, 0.375))):
        expected = begin + np.array([*moved, 0.0])
        np.testing.assert_allclose(motion.coordinates(fraction), expected, atol=1e-15)
    for fraction in (-2.0, -3.5, BEFORE):  # others have more of them
        farthest = begin + np.array([0.1, 0.5, 0.0])
        np.testing.assert_array_equal(motion.coordinates(fraction), farthest)
        np.testing.assert_array_equal(motion.rates_at(fraction), own.rates_at(0.0))
        np.testing.assert_array_equal(own.coordinates(fraction), begin)
    for fraction in (0.0, 0.3, 4.5):
        np.testing.assert_array_equal(motion.coordinates(fraction), own.coordinates(fraction))
    np.testing.assert_array_equal(motion.travels, own.travels)
    assert motion.at_travel(0.1)[0] == own.at_travel(0.1)[0]
    ends = [0.5, 3.9, 4.0, 9.0, 11.0]
    np.testing.assert_array_equal(motion.with_ends(ends).retraction, motion.retraction)


def test_given_fractions_end_exactly_at_the_waypoints(rng):
    """w_first + 1.0 (w_last - w_first) is not w_last in floating-point numbers."""
    positions, angles = rng.normal(size=(21, 2)), rng.normal(size=21)
    motion = Motion(positions, angles, np.full(20, 2), fractions=np.tile([0.3, 1.0], 20))
    found = np.array([motion.coordinates(2.0 * stage) for stage in range(20)])
    np.testing.assert_array_equal(found, np.column_stack([positions, angles])[:20])


def test_stages_have_a_travel_or_a_duration():
    """A stage of 5 mm without a duration between two with one: its travel alone depends on a speed."""
    rates = {"depth": (0.6, 0.8, 0.0)}
    stages = [
        Stage(2, (0.0, -1.0), rates={"depth": (0.0, -1.0, 0.0)}, duration=4.0),
        Stage((0.2, 1.0), (3.0, 4.0), rates=rates),
        Stage(1, (0.0, 2.0), duration=0.5),
    ]
    motion = staged_motion(stages)
    travel, time = motion.timing
    np.testing.assert_allclose(travel, [0.0, 0.0, 0.0, 1.0, 5.0, 5.0], rtol=1e-15)
    np.testing.assert_allclose(time, [0.0, 2.0, 4.0, 4.0, 4.0, 4.5], rtol=1e-15)
    # 5 mm in the direction of the rate: both grow together
    np.testing.assert_allclose(
        motion.timed_travel_rates, [[0.0, 0.0, 0.0, 0.2, 1.0, 1.0]], rtol=1e-14
    )


def test_the_path_has_the_stages_of_the_first_motion_that_has_any():
    still, dwelling, moving = (
        staged_motion(stages)
        for stages in ([Stage(3)], [Stage(1), Stage(2)], [Stage(3, (0.0, -1.0))])
    )
    assert path_motion([still, dwelling, moving]) is dwelling
    assert path_motion([still, moving, dwelling]) is moving
    assert path_motion([still, staged_motion([Stage(3)])]) is still


def test_parameters_of_lengths_and_angles_have_units():
    stages = [
        Stage(2, (0.0, -3.0), rates={"depth": (0.0, -1.0, 0.0), "both": (0.0, 1.0, 1.0)}),
        Stage(1, rotate=10.0, rates={"fraction": (0.0, -3.0, 0.0), "turn": (0.0, 0.0, 1.0)}),
    ]
    motion = staged_motion(stages).with_placement("x", "y", "angle")
    found = {name: motion.unit(name) for name in motion.names}
    assert found == {
        "depth": "mm", "both": None, "fraction": None, "turn": "deg",
        "x": "mm", "y": "mm", "angle": "deg",
    }  # fmt: skip

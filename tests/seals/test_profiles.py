"""What happened at the profiles: stages, travel, load_segments of there and back, contact."""

from dataclasses import replace

import numpy as np
import pytest
from energy_bounds import energy_bounds
from two_profiles import two_profiles

import seal_mdao as sm
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.measures.contact_pressure import ContactWidth
from seal_mdao.seals.instabilities import Instability
from seal_mdao.seals.profiles import (
    ROTATION,
    TRAVEL,
    contacts,
    leading_motion,
    load_segments,
    position,
    profile_histories,
    stage_number,
    stage_of,
    true_pressure,
)


def test_there_and_back_is_one_course():
    motion = staged_motion([Stage(2, (0.0, -3.0)), Stage(3, (0.0, 1.5)), Stage(2, (2.0, 0.0))])
    there, across = load_segments(motion, 7)
    assert there.stages == (1, 2)
    assert there.steps == slice(0, 5)
    assert there.along == pytest.approx([1.5, 3.0, 2.5, 2.0, 1.5])
    assert across.stages == (3,)
    assert across.along == pytest.approx([1.0, 2.0])
    assert there.axis == TRAVEL


def test_courses_end_where_the_path_ended():
    motion = staged_motion([Stage(2, (0.0, -3.0)), Stage(2, (1.0, 0.0)), Stage(2, (0.0, 1.0))])
    found = load_segments(motion, 3)
    assert [load_segment.stages for load_segment in found] == [(1,), (2,)]
    assert found[1].along == pytest.approx([0.5])
    assert load_segments(motion, 0) == ()


def test_turns_are_counted_in_degrees_and_rests_join():
    motion = staged_motion(
        [
            Stage(1),
            Stage(2, rotate=30.0),
            Stage(1),
            Stage(1, rotate=-10.0),
            Stage(1, (1.0, 0.0), 5.0),
        ],
        pivot=(3.0, 4.0),
    )
    turning, both = load_segments(motion, 6)
    assert turning.axis == ROTATION
    assert turning.stages == (1, 2, 3, 4)
    assert turning.along == pytest.approx([0.0, 15.0, 30.0, 30.0, 20.0])
    assert both.axis == TRAVEL
    assert both.along == pytest.approx([1.0])


def test_a_loss_of_stability_names_its_stage():
    """Its travel is counted from the start of the stage; a path of one stage has no number."""
    seal = two_profiles(0.2)
    ends = np.cumsum(leading_motion(seal).steps)
    assert len(ends) > 2
    at = [0.5, ends[0], ends[0] + 1e-9, ends[1]]
    assert [stage_number(seal, fraction) for fraction in at] == [1, 1, 2, 2]
    assert stage_number(sm.door_seal(), 1.0) == 0
    point = Instability(3.0, 1.5, "branch", np.zeros((1, 2)), 0.0, 0.0, False, stage=2)
    assert "from travel 1.500 mm of stage 2 on" in point.text
    assert "from travel 1.500 mm on" in replace(point, stage=0).text


def test_a_loss_of_stability_in_a_stage_without_travel_names_the_turn():
    seal = two_profiles(0.2)
    turning = staged_motion([Stage(4, rotate=-3.0), Stage(2)])
    rubber, *both = seal.definitions
    both = (replace(own, motion=turning) for own in both)
    seal = replace(seal, definitions=(rubber, *both), n_steps=6)
    assert position(seal, 1.3) == "stage 1, turn -0.975°"
    assert position(seal, 5.5) == "stage 2, at rest"
    mode = np.zeros((1, 2))
    point = Instability(1.3, 0.0, "branch", mode, 0.0, 0.0, False, position=position(seal, 1.3))
    assert "from stage 1, turn -0.975° on" in point.text


def test_stage_of_a_step():
    motion = staged_motion([Stage(2, (0.0, -3.0)), Stage(1, (0.0, 1.5))])
    assert stage_of(motion, np.arange(3)).tolist() == [1, 1, 2]


def test_key_steps_and_words_of_the_door(nominal):
    assert nominal.key_steps() == nominal.steps_at([2.5, 5.0, 7.5, 10.0])
    assert nominal.caption(104) == "travel 10 mm"  # 105 steps from 0.5 mm above the top


def test_history_of_the_door(nominal):
    (door,) = profile_histories(nominal)
    assert door.label == "door"
    assert door.stage.tolist() == [1] * 105
    assert door.travel == pytest.approx(nominal.travel + 0.5, abs=1e-12)
    assert np.array_equal(door.force, nominal.reaction)
    assert door.place[:, 1] == pytest.approx(9.5 - nominal.travel)
    assert door.width[-1] == pytest.approx(nominal.value(ContactWidth("door"))[0], rel=1e-12)
    assert door.nominal_peak[-1] == pytest.approx(1e4 * -nominal.contact.gap.min(), rel=1e-12)
    undeformed = ContactWidth("door", nominal=True)
    assert door.nominal_width[-1] == pytest.approx(nominal.value(undeformed)[0], rel=1e-12)
    assert door.peak[-1] == true_pressure(nominal, contacts(nominal.seal)[0]).max()
    assert door.width[0] == door.peak[0] == 0.0


def test_profile_that_stands_still_follows_the_one_that_moves(nominal):
    still = staged_motion([Stage(105)])
    assert not still.moves
    (door,) = contacts(nominal.seal)
    assert leading_motion(nominal.seal) is not still
    assert door.motion.moves


def test_the_bound_of_the_released_energy_tends_to_zero_with_profiles_that_turn():
    """A wrong work of forces or moments would leave its part of it."""
    sums = []
    for steps in (6, 12, 24):
        released, most, _ = energy_bounds(sm.analyze(two_profiles(0.0, steps, "in")).path).T
        assert released.max() <= 1e-9
        assert most.min() >= -1e-9
        sums.append(released.sum())
    assert sums[0] < 0.0
    assert sums[1] / sums[0] == pytest.approx(0.5, abs=0.05)
    assert sums[2] / sums[1] == pytest.approx(0.5, abs=0.02)

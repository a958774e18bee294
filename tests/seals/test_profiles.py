"""What happened at the profiles: stages, travel, courses of there and back, contact."""

import numpy as np
import pytest
from energy_bounds import energy_bounds
from two_profiles import two_profiles

import seal_mdao as sm
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.measures.contact_pressure import ContactWidth
from seal_mdao.seals.profiles import (
    contacts,
    courses,
    leading_motion,
    moves,
    profile_histories,
    stage_of,
    true_pressure,
)


def test_there_and_back_is_one_course():
    motion = staged_motion([Stage(2, (0.0, -3.0)), Stage(3, (0.0, 1.5)), Stage(2, (2.0, 0.0))])
    there, across = courses(motion, 7)
    assert there.stages == (1, 2)
    assert there.steps == slice(0, 5)
    assert there.along == pytest.approx([1.5, 3.0, 2.5, 2.0, 1.5])
    assert across.stages == (3,)
    assert across.along == pytest.approx([1.0, 2.0])
    assert not there.turns


def test_courses_end_where_the_path_ended():
    motion = staged_motion([Stage(2, (0.0, -3.0)), Stage(2, (1.0, 0.0)), Stage(2, (0.0, 1.0))])
    found = courses(motion, 3)
    assert [course.stages for course in found] == [(1,), (2,)]
    assert found[1].along == pytest.approx([0.5])
    assert courses(motion, 0) == ()


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
    turning, both = courses(motion, 6)
    assert turning.turns
    assert turning.stages == (1, 2, 3, 4)
    assert turning.along == pytest.approx([0.0, 15.0, 30.0, 30.0, 20.0])
    assert not both.turns
    assert both.along == pytest.approx([1.0])


def test_stage_of_a_step():
    motion = staged_motion([Stage(2, (0.0, -3.0)), Stage(1, (0.0, 1.5))])
    assert stage_of(motion, np.arange(3)).tolist() == [1, 1, 2]


def test_key_steps_and_words_of_the_door(drawn):
    assert drawn.key_steps() == drawn.steps_at([2.5, 5.0, 7.5, 10.0])
    assert drawn.caption(104) == "travel 10 mm"  # 105 steps from 0.5 mm above the top


def test_history_of_the_door(drawn):
    (door,) = profile_histories(drawn)
    assert door.label == "door"
    assert door.stage.tolist() == [1] * 105
    assert door.travel == pytest.approx(drawn.travel + 0.5, abs=1e-12)
    assert np.array_equal(door.force, drawn.reaction)
    assert door.place[:, 1] == pytest.approx(9.5 - drawn.travel)
    assert door.width[-1] == pytest.approx(drawn.value(ContactWidth("door"))[0], rel=1e-12)
    assert door.nominal_peak[-1] == pytest.approx(1e4 * -drawn.contact.gap.min(), rel=1e-12)
    nominal = ContactWidth("door", nominal=True)
    assert door.nominal_width[-1] == pytest.approx(drawn.value(nominal)[0], rel=1e-12)
    assert door.peak[-1] == true_pressure(drawn, contacts(drawn.seal)[0]).max()
    assert door.width[0] == door.peak[0] == 0.0


def test_profile_that_stands_still_follows_the_one_that_moves(drawn):
    still = staged_motion([Stage(105)])
    assert not moves(still)
    (door,) = contacts(drawn.seal)
    assert leading_motion(drawn.seal) is not still
    assert moves(door.motion)


def test_the_bound_of_the_released_energy_tends_to_zero_with_profiles_that_turn():
    """A wrong work of forces or moments would leave its part of it."""
    sums = []
    for steps in (6, 12, 24):
        released, _ = energy_bounds(sm.analyze(two_profiles(0.0, steps, "in")).path).T
        assert released.max() <= 1e-9
        sums.append(released.sum())
    assert sums[0] < 0.0
    assert sums[1] / sums[0] == pytest.approx(0.5, abs=0.05)
    assert sums[2] / sums[1] == pytest.approx(0.5, abs=0.02)

"""Reaction along the travel: at the travels that were asked for, whatever the load steps."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import openmdao.api as om
import pytest
from pressed_block import pressed_block

import seal_mdao as sm
from seal_mdao.geometry.motion import Motion, Stage, staged_motion, straight_motion
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.door.door_seal import CURVE_TRAVELS, DOOR, with_options

TIGHT = sm.NewtonOptions(tolerance=1e-11)
COARSE = sm.door_seal(n_steps=20, newton=TIGHT)
BOTH = Reaction(DOOR, (1.3, 5.0, 10.0), name="curve")


@pytest.fixture(scope="module")
def coarse():
    return sm.analyze(COARSE, keep_factors=True)


def test_values_lie_at_the_travels_whatever_the_load_steps(coarse, nominal):
    """20 load steps end at 2.125, 4.225, ... mm; 105 at 2, 4, ... mm."""
    for result in (coarse, nominal):
        (curve,) = result.measures(("reaction_curve",))
        assert curve.travels == CURVE_TRAVELS
        travel = np.concatenate([[-0.5], result.travel])
        force = np.concatenate([[0.0], result.reaction[:, 1]])
        expected = np.interp(CURVE_TRAVELS, travel, force)
        np.testing.assert_allclose(result.value(curve), expected, rtol=1e-11)
        assert result.value(curve)[-1] == result.reaction[-1, 1]


def test_both_components_at_travels_of_the_users_choice(coarse):
    values = coarse.value(BOTH).reshape(3, 2)
    for component in (0, 1):
        expected = np.interp(BOTH.travels, coarse.travel, coarse.reaction[:, component])
        np.testing.assert_allclose(values[:, component], expected, rtol=1e-10)


def test_travels_stay_where_they_are_when_the_depth_is_an_input(tmp_path):
    """The values of a path to 8 mm are not those of a path to 10 mm drawn together."""
    curve = Reaction(DOOR, (2.0, 4.0), (1,), name="reaction_curve")
    group = sm.SealGroup(seal=COARSE, measures=(curve,), parameters=("depth",))
    problem = om.Problem(group, reports=None, work_dir=tmp_path)
    problem.setup()
    problem.set_val("depth", 8.0)
    problem.run_model()
    result = sm.analyze(with_options(COARSE, depth=8.0))
    expected = np.interp(curve.travels, result.travel, result.reaction[:, 1])
    np.testing.assert_allclose(problem.get_val("reaction_curve"), expected, rtol=1e-10)
    problem.set_val("depth", 3.0)
    with pytest.raises(om.AnalysisError, match="needs the force at 4 mm of travel"):
        problem.run_model()
    assert np.isnan(problem.get_val("reaction_curve")).all()


@pytest.mark.parametrize("method", ["direct", "adjoint"])
@pytest.mark.parametrize("name", ["depth", "door_radius", "friction"])
def test_derivatives_are_those_of_the_interpolated_values(coarse, method, name):
    """Central differences; in the depth the load steps move away under fixed travels."""
    inside = Reaction(DOOR, (1.3, 5.0, 9.0), name="curve")
    found = sm.differentiate(coarse, (name,), (inside,), method)["curve"][:, -1]
    start = coarse.seal.scalars[name].value

    def values(change):
        return sm.analyze(COARSE, None, {name: start + change}).value(inside)

    errors = []
    for step in (1e-4, 1e-5):
        quotient = (values(step) - values(-step)) / (2.0 * step)
        errors.append(np.abs(quotient - found).max())
    # truncation falls with the square of the step; Newton's method leaves 1e-11 of the forces
    assert min(errors) <= TIGHT.tolerance * np.abs(coarse.reaction).max() / 1e-4
    assert np.abs(found).max() > 1e-2


def test_travels_of_any_motion_are_counted_along_its_path():
    """The block's roll: pressed down, then dragged aside."""
    block = pressed_block()
    result = sm.analyze(block, keep_factors=True)
    motion = result.term("roll").motion
    places = np.array([motion.coordinates(n)[:2] for n in range(motion.n_steps + 1)])
    travel = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))])
    forces = np.vstack([np.zeros(2), result.path.reaction("roll")])
    asked = (0.0, 0.37 * travel[-1], 0.9 * travel[-1], travel[-1])
    measure = Reaction("roll", asked)
    expected = np.column_stack([np.interp(asked, travel, forces[:, i]) for i in (0, 1)])
    np.testing.assert_allclose(result.value(measure), expected.ravel(), rtol=1e-9, atol=1e-12)


def closing(depth, aside=0.0):
    stages = [
        Stage(4, rotate=5.0),
        Stage(5, (0.5, -depth), rates={"depth": (0.0, -1.0, 0.0), "aside": (1.0, 0.0, 0.0)}),
        Stage(3, rotate=10.0),
        Stage(6, (2.0 + aside, depth), rates={"depth": (0.0, 1.0, 0.0)}),
    ]
    motion = staged_motion(stages)
    return motion.moved({"aside": aside}) if aside else motion


def test_steps_at_a_travel_and_their_rates():
    motion = closing(3.0)
    first, whole = np.hypot(0.5, 3.0), motion.travel
    assert whole == pytest.approx(first + np.hypot(2.0, 3.0))
    for travel, fraction in (
        (0.0, 0.0),
        (0.2 * first, 5.0),
        (first + 0.5 * (whole - first), 15.0),
        (whole, 18.0),
    ):
        assert motion.at_travel(travel)[0] == pytest.approx(fraction, abs=1e-12)
    for travel in (0.2, 1.7, first + 0.3, whole - 0.1):
        _, rates = motion.at_travel(travel)
        for i, name in enumerate(motion.names):
            up, down = (motion.moved({name: h}).at_travel(travel)[0] for h in (1e-5, -1e-5))
            # rounding of 18 steps over the step
            assert rates[i] == pytest.approx((up - down) / 2e-5, abs=1e-9)


def test_travels_within_a_first_step_with_clearance():
    """The place after as many steps is the one at that travel, also when the way turns."""
    rates = {"depth": (0.0, -1.0), "aside": (1.0, 0.0)}
    motion = replace(straight_motion((0.0, 10.0), (1.0, 4.0), 4, rates), clearance=(0.05, 0.3))
    unit = np.array([1.0, -6.0]) / np.hypot(1.0, 6.0)
    for travel in (0.0, 0.4, 1.5):
        fraction, slopes = motion.at_travel(travel)
        assert 0.0 < fraction < 1.0
        along = (motion.coordinates(fraction)[:2] - motion.positions[0]) @ unit
        assert along == pytest.approx(travel, abs=1e-14)
        for i, name in enumerate(motion.names):
            up, down = (motion.moved({name: h}).at_travel(travel)[0] for h in (1e-5, -1e-5))
            assert slopes[i] == pytest.approx((up - down) / 2e-5, abs=1e-9)
    assert motion.at_travel(motion.travel * 0.25)[0] == pytest.approx(1.0, abs=1e-14)


def test_a_travel_within_rounding_of_the_path_is_its_end():
    for end in np.linspace(-0.5, -3.7, 7):
        motion = straight_motion((0.0, 10.1), (0.0, end), 7)
        for travel in (10.1 - end, np.nextafter(motion.travel, 99.0)):
            assert motion.at_travel(travel)[0] == pytest.approx(7.0, abs=1e-14)


@pytest.mark.parametrize("travel", [-0.1, 7.0, np.nan])
def test_travels_beyond_the_path_are_refused(travel):
    motion = Motion([(0.0, 1.0), (0.0, -1.0)], [0.0, 0.0], [3])
    with pytest.raises(ValueError, match="mm is beyond the end of the motion, which is at a"):
        motion.at_travel(travel)


@pytest.mark.parametrize(
    "wrong",
    [{"travels": (-1.0,)}, {"travels": (np.nan,)}, {"components": (2,)}, {"components": ()}],
)
def test_wrong_travels_and_components_are_refused(wrong):
    with pytest.raises(ValueError, match="reaction_curve"):
        Reaction(DOOR, name="reaction_curve", **wrong)
    assert all(a < b for a, b in pairwise(CURVE_TRAVELS))

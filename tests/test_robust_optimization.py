"""The robust problem: its scenarios, limits and gradients."""

import numpy as np
import pytest
from scipy.special import ndtr

import seal_mdao as sm
from seal_mdao.distributions import Uniform
from seal_mdao.door_optimization import PRESSURE_SHARE, STRESS_SHARE, robust_door_task
from seal_mdao.optimization import (
    DRAWING,
    MEAN,
    Limit,
    RunOptions,
    Task,
    optimization_problem,
)
from seal_mdao.robust_optimization import GOALS, Robust, RobustGoal, nominal_numbers
from seal_mdao.scenarios.variation import Variation
from seal_mdao.seals.profiles import leading_motion
from seal_mdao.tolerances.file import OF_THE_DOOR, read_tolerances
from seal_mdao.tolerances.placement import with_clearance
from seal_mdao.tolerances.tolerance_set import Tolerance, Tolerances

COST = "gap_square_integral"
DRAWN = {"friction": 0.25, "hardness": 1.0, "depth": 0.0}


@pytest.fixture(scope="module")
def seal():
    """Short, with large steps; its middle opens."""
    return sm.door_seal(depth=8.0, n_steps=18, start=10.1)


@pytest.fixture(scope="module")
def tolerances():
    return read_tolerances(OF_THE_DOOR)


def test_scenarios_are_the_drawing_and_wide_ones(seal, tolerances):
    goal = RobustGoal(widen=1.5)
    made, narrow = goal.scenarios(tolerances, seal, 8, 3), tolerances.samples(seal, 8, seed=3)
    assert len(made) == 9
    names = [variation.name for variation in made.variations]
    for name, number in DRAWN.items():
        assert made.numbers[0, names.index(name)] == number
    assert not made.offsets[0].any()
    np.testing.assert_allclose(made.offsets[1:], 1.5 * narrow.offsets, rtol=1e-14)
    away = made.numbers[1:] - tolerances.means
    np.testing.assert_allclose(away, 1.5 * (narrow.numbers - tolerances.means), atol=1e-14)


def test_scenarios_that_are_too_wide_are_refused_before_anything_is_analysed(seal):
    """Friction from 0.05 to 0.4 becomes negative at 1.5 times the distance from 0.225."""
    friction = Tolerances((Tolerance(Variation("friction"), Uniform(0.05, 0.4)),))
    with pytest.raises(ValueError, match=r"scenario \d+ of 17 \(friction = -0.* 1.5 times as far"):
        RobustGoal(widen=1.5).scenarios(friction, seal, 16, 0)
    assert len(RobustGoal(widen=1.0).scenarios(friction, seal, 16, 0)) == 17


def test_levels_are_those_of_the_narrow_distribution():
    """Of a normal distribution 1.5 times as wide, its own quantiles; rounded to three digits."""
    assert RobustGoal(widen=1.0).levels == pytest.approx((0.025, 0.975))
    low, high = RobustGoal(widen=1.5).levels
    assert low == pytest.approx(1.0 - high)
    assert high == pytest.approx(ndtr(1.959964 / 1.5), abs=5.01e-4)


@pytest.mark.parametrize("minimize", GOALS)
def test_limits_are_those_of_the_drawn_seal_and_gradients_exist(
    seal, tolerances, minimize, tmp_path
):
    goal = RobustGoal(minimize)
    nominal = sm.analyze(seal)
    robust = Robust(goal, goal.scenarios(tolerances, seal, 2, 0), workers=0)
    problem = optimization_problem(
        robust_door_task(nominal, goal), RunOptions(work_dir=tmp_path), robust
    )
    problem.run_model()
    norm, pressures = (
        nominal.value(m) for m in nominal.measures(["stress_norm", "patch_pressure"])
    )
    constraints = problem.model.get_constraints()
    by_name = {meta["name"].split(".")[-1]: meta for meta in constraints.values()}
    stress = by_name["stress_norm_scenarios"]
    assert stress["upper"] == pytest.approx(max(STRESS_SHARE * norm[0], 100.0))
    at_drawing = problem.get_val("stress_norm_scenarios")[0, 0]
    assert at_drawing == pytest.approx(norm[0], rel=1e-12)
    floor = by_name["patch_pressure_mean"]
    np.testing.assert_allclose(floor["lower"], PRESSURE_SHARE * pressures)
    objective = "robust_cost" if minimize == "mean_std" else f"{COST}_highest"
    if minimize == "mean_std":
        parts = (problem.get_val(f"{COST}_{ending}")[0] for ending in ("mean", "std"))
        mean, std = parts
        assert problem.get_val(objective)[0] == pytest.approx(mean + 2.0 * std)
    totals = problem.compute_totals([objective], ["boundary_offsets"])
    assert np.abs(totals[objective, "boundary_offsets"]).max() > 0.0


def test_numbers_that_change_nothing(seal):
    of = (Variation("friction"), Variation("c10", "factor"), Variation("depth", "shift"))
    np.testing.assert_array_equal(nominal_numbers(of, seal), [0.25, 1.0, 0.0])
    with pytest.raises(ValueError, match='use kind "factor" or "shift"'):
        nominal_numbers((Variation("both", "value", ("c10", "c01")),), seal)


@pytest.mark.parametrize(
    "wrong", [{"minimize": "best"}, {"band": 0.0}, {"share": 0.4}, {"widen": 0.5}]
)
def test_goals_that_make_no_sense_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        RobustGoal(**wrong)


def test_room_is_enough_for_a_boundary_that_is_off(seal):
    """Half a millimetre above the bounds of the designs; the steps end where they did."""
    offsets = np.concatenate([np.full(14, 0.9), np.zeros(11)])
    with pytest.raises(sm.GeometryError, match="overlaps the rigid profile"):
        sm.analyze(seal, offsets)
    roomy = with_clearance(seal)
    assert sm.analyze(roomy, offsets).path.steps
    ends = [leading_motion(own).coordinates(own.n_steps) for own in (seal, roomy)]
    np.testing.assert_array_equal(*ends)


def test_limits_hold_where_they_are_asked_for():
    """The low quantile of the samples satisfies the lower limit, the high one the upper."""
    robust = Robust(RobustGoal(widen=1.0), None)
    both = Limit("reaction", 40.0, 80.0, entry=1)
    assert robust.outputs(both) == [
        ("reaction_q2_5", {"lower": 40.0, "ref": 80.0, "indices": [1]}),
        ("reaction_q97_5", {"upper": 80.0, "ref": 80.0, "indices": [1]}),
    ]
    assert robust.outputs(Limit("width", lower=2.0)) == [("width_q2_5", {"lower": 2.0, "ref": 2.0})]
    assert robust.outputs(Limit("width", upper=0.0, over=MEAN)) == [
        ("width_mean", {"upper": 0.0, "ref": 1.0})
    ]
    assert robust.outputs(Limit("norm", upper=3.0, over=DRAWING)) == [
        ("norm_scenarios", {"upper": 3.0, "ref": 3.0, "indices": [0]})
    ]
    values = np.array([[0.0, 50.0], [60.0, 90.0], [60.0, 40.0]])
    assert both.satisfied(values).tolist() == [True, False, True]
    floors = Limit("pressure", np.array([1.0, 45.0]), over=MEAN)
    assert floors.satisfied(values).tolist() == [False, True, False]


def test_an_output_that_is_limited_twice_has_two_names(seal, tolerances, tmp_path):
    goal = RobustGoal()
    limits = (
        Limit("reaction", upper=80.0, entry=1),
        Limit("reaction", 1.0),
    )
    again = Limit("reaction", upper=9.0, entry=0)
    task = Task(
        seal, COST, 1.0, (COST, "reaction"), {"boundary_offsets": {"upper": 0.5}}, (*limits, again)
    )
    scenarios = goal.scenarios(tolerances, seal, 2, 0)
    run, robust = RunOptions(work_dir=tmp_path), Robust(goal, scenarios, workers=0)
    problem = optimization_problem(task, run, robust)
    problem.final_setup()
    found = problem.model.get_constraints()
    assert len(found) == 3
    assert [meta["alias"] is None for meta in found.values()] == [True, True, False]

"""The flags of problem (71): what they constrain, and that the optimum keeps it."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.door_optimization import (
    FORCE_BAND,
    PRESSURE_SHARE,
    STRESS_SHARE,
    DoorProblem,
    door_task,
)
from seal_mdao.optimization import OPTIMIZERS, RunOptions, optimization_problem

SEAL = sm.door_seal(n_steps=21)


@pytest.fixture(scope="module")
def start():
    return sm.analyze(SEAL)


def value(result, name):
    """Values of a measure by its name."""
    return result.value(result.measures((name,))[0])


def problem_with(tmp_path, driver=None, **flags):
    """The problem with these flags."""
    run = RunOptions(driver, work_dir=tmp_path)
    return optimization_problem(door_task(run.analyze(SEAL), DoorProblem(**flags)), run)


def limits(tmp_path, **flags):
    """Constraints and objectives of the problem, by name."""
    problem = problem_with(tmp_path, **flags)
    problem.final_setup()
    driver = problem.driver
    return {**driver._cons, **driver._objs}


def test_plain_problem_has_point_measures(tmp_path):
    assert limits(tmp_path).keys() == {"area", "von_mises", "gap_square_sum"}


def test_clamped_load_is_a_band_around_the_whole_curve(tmp_path, start):
    found = limits(tmp_path, clamp_load=True)["reaction_curve"]
    curve = value(start, "reaction_curve")
    assert curve.size == 5
    for side, share in (("lower", 1 - FORCE_BAND), ("upper", 1 + FORCE_BAND)):
        np.testing.assert_allclose(found[side], share * curve, rtol=1e-12)


def test_pressure_floor_is_a_share_of_each_patch(tmp_path, start):
    found = limits(tmp_path, pressure_floor=True)["patch_pressure"]
    pressure = value(start, "patch_pressure")
    assert pressure.size == 2
    np.testing.assert_allclose(found["lower"], PRESSURE_SHARE * pressure, rtol=1e-12)


def test_stress_norm_and_integral_take_the_place_of_the_point_measures(tmp_path, start):
    found = limits(tmp_path, stress_norm=True, gap_integral=True, keep_force=True)
    assert found.keys() == {"area", "stress_norm", "gap_square_integral", "reaction"}


@pytest.mark.long
def test_optimum_of_all_flags_keeps_what_they_ask(tmp_path, start):
    pytest.importorskip("ipyopt")
    problem = problem_with(
        tmp_path, OPTIMIZERS["IPOPT"](), clamp_load=True, pressure_floor=True, stress_norm=True,
        gap_integral=True,
    )  # fmt: skip
    assert problem.run_driver().success
    end = sm.analyze(
        SEAL, problem.get_val("boundary_offsets"),
        {"door_radius": problem.get_val("door_radius")[0]},
    )  # fmt: skip
    ratio = {
        name: value(end, name) / value(start, name)
        for name in ("gap_square_integral", "reaction_curve", "patch_pressure", "stress_norm")
    }
    assert ratio["gap_square_integral"][0] <= 5e-4
    assert np.abs(ratio["reaction_curve"] - 1.0).max() <= FORCE_BAND + 1e-4
    assert ratio["patch_pressure"].min() >= PRESSURE_SHARE - 1e-4
    assert ratio["stress_norm"][0] <= STRESS_SHARE + 1e-4
    assert end.area <= 110.0 + 1e-2


def test_restart_settings_hold_every_flag(tmp_path):
    problem = problem_with(tmp_path, clamp_load=True)
    assert '"clamp_load": true' in problem.model.options["problem_settings"]


def test_gap_that_is_rounding_is_refused():
    """Under the flat door the points that open do so by less than a penalty leaves."""
    with pytest.raises(ValueError, match="the nominal seal has no gap above"):
        door_task(sm.analyze(sm.door_seal(door="flat")))

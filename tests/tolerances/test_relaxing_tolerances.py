"""Tolerances of a seal that relaxes: series, relaxation times, temperature and durations scatter."""

from dataclasses import replace

import numpy as np
import pytest
from relaxing_files import written

import seal_mdao as sm
from seal_mdao.distributions import Normal
from seal_mdao.file_optimization import file_task
from seal_mdao.optimization import RunOptions, optimization_problem
from seal_mdao.robust_optimization import Robust, RobustGoal
from seal_mdao.tolerances.placement import with_clearance
from seal_mdao.tolerances.tolerance_set import Tolerance, Tolerances
from seal_mdao.tolerances.tolerance_study import ToleranceStudy

STD = {"g_2": 0.02, "tau_1": 0.2, "temperature": 4.0, "duration_2": 3.0, "wlf_c1": 0.4}
"""Standard deviations of parameters of the relaxation, in their units."""
RELAXING = "force_after_dwell", "retained_force"


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    return sm.read_seal_file(written(tmp_path_factory.mktemp("relaxing")))


@pytest.fixture(scope="module")
def seal(file):
    return replace(sm.build_seal(file), newton=sm.NewtonOptions(tolerance=1e-11))


def scattered(size):
    """Normal deviations of all of them, times ``size``."""
    return Tolerances(tuple(
        Tolerance(sm.Variation(name, "shift"), Normal(0.0, size * std)) for name, std in STD.items()
    ))  # fmt: skip


def test_the_first_order_estimate_has_the_effects_of_time(seal, tmp_path):
    """A quarter of the tolerances leaves a sixteenth of its error; every parameter has an effect."""
    errors = []
    for size in (2.0, 0.5):
        study = ToleranceStudy(seal, scattered(size), RELAXING)
        sampled = study.run(tmp_path / f"{size}.sqlite", 4)
        estimate = study.first_order()
        errors.append(np.abs(estimate.at(sampled.scenarios) - sampled.values).max(axis=0))
    assert np.all(estimate.variances[:, :-1] > 1e-8 * estimate.variances.sum(axis=1)[:, None])
    assert np.all(errors[1] < errors[0] / 12.0)


def test_robust_problem_of_a_seal_that_relaxes(file, seal, tmp_path):
    """The limit holds for a quantile of the scenarios, whose gradient is that of the quotient."""
    roomy, goal = with_clearance(seal), RobustGoal()
    scenarios = goal.scenarios(scattered(1.0), roomy, 2, 0)
    robust = Robust(goal, scenarios, workers=0)
    task = file_task(file, sm.analyze(roomy))
    problem = optimization_problem(task, RunOptions(work_dir=tmp_path), robust)
    problem.run_model()
    ((limit, _),) = robust.outputs(task.limits[0])
    values = problem.get_val("force_after_dwell_scenarios").ravel()
    assert np.ptp(values) > 0.01 * values.mean()
    totals = problem.compute_totals([limit], ["boundary_offsets"])
    exact, step = totals[limit, "boundary_offsets"], 1e-4
    ends = []
    for sign in (1.0, -1.0):
        problem.set_val("boundary_offsets", sign * step * np.array([0.0, 1.0, 0.5]))
        problem.run_model()
        ends.append(problem.get_val(limit)[0])
    quotient = (ends[0] - ends[1]) / (2.0 * step)
    assert quotient == pytest.approx(float(exact[0] @ [0.0, 1.0, 0.5]), rel=1e-6)

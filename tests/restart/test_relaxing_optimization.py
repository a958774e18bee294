"""An optimisation of a seal that relaxes continues after it was stopped as if it had not been."""

import numpy as np
import openmdao.api as om
from relaxing_files import written

import seal_mdao as sm
from seal_mdao.file_optimization import file_task
from seal_mdao.optimization import RunOptions, continue_run, optimization_problem, uno_driver
from seal_mdao.recording.recorded_seals import recorded_problem
from seal_mdao.recording.recorder_file import open_model


def problem_of(file, seal, iterations, recorder=None):
    run = RunOptions(uno_driver(iterations), recorder)
    return optimization_problem(file_task(file, run.analyze(seal)), run)


def designs(path):
    """Boundary offsets of all recorded cases in order."""
    reader = om.CaseReader(path)
    cases = reader.get_cases("driver", recurse=False)
    return np.array([case.get_design_vars(scaled=False)["boundary_offsets"] for case in cases])


def test_continued_run_is_the_uninterrupted_one(tmp_path):
    file = sm.read_seal_file(written(tmp_path))
    seal = sm.build_seal(file)
    for name, iterations in (("whole.sql", 4), ("cases.sql", 2)):
        problem = problem_of(file, seal, iterations, tmp_path / name)
        problem.run_driver()
        problem.cleanup()
    # durations and series are recorded with the seal
    recorded = recorded_problem(open_model(tmp_path / "cases.sql")).seal
    assert recorded.key == seal.key
    again = problem_of(file, recorded, 4)
    continue_run(again, tmp_path / "cases.sql")
    again.run_driver()
    again.cleanup()
    assert again.driver.reused_evaluations >= 2
    whole, found = (designs(tmp_path / name) for name in ("whole.sql", "cases.sql"))
    assert len(whole) > 4
    np.testing.assert_array_equal(found, whole)

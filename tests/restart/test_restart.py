"""A run that was cut off continues as if nothing had happened."""

import os
import shutil
import signal
import sqlite3
import threading
import time
from functools import partial
from pathlib import Path

import numpy as np
import openmdao.api as om
import pytest
from valley import Valley, designs, kill_at, killed, record, valley_problem

import seal_mdao as sm
from seal_mdao.recording import run_log
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.recording.recorder import record_all

# Python 3.12 and newer warn of forks; the children here only compute and write a file
pytestmark = pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")


def whole_run(make_driver, on_call=None, **options):
    """Problem and recorded designs of a run from start to end, in ``whole.sql``."""
    problem = record(valley_problem(make_driver(**options), on_call), "whole.sql")
    result = problem.run_driver()
    problem.cleanup()
    return problem, result, designs("whole.sql")


def cut_run(make_driver, call):
    """A run that is killed in its ``call``-th analysis."""
    assert killed(record(valley_problem(make_driver(), kill_at(call))).run_driver)


def continued(make_driver, path="./cases.sql", on_call=None, **options):
    problem = valley_problem(make_driver(**options), on_call)
    sm.restart(problem, path)
    result = problem.run_driver()
    problem.cleanup()
    return problem, result


def gradient_counters(path):
    connection = sqlite3.connect(path)
    rows = connection.execute("SELECT counter FROM driver_derivatives ORDER BY id").fetchall()
    connection.close()
    return [row[0] for row in rows]


@pytest.mark.parametrize("call", [2, 3, 7, 12])
def test_continued_run_is_bitwise_the_uninterrupted_one(make_driver, call):
    whole, result, expected = whole_run(make_driver)
    assert result.success
    assert len(expected) > 13
    cut_run(make_driver, call)
    assert np.array_equal(designs(), expected[: call - 1])
    problem, again = continued(make_driver)
    assert again.success
    assert again.exit_status == result.exit_status
    assert again.iter_count == result.iter_count
    assert np.array_equal(designs(), expected)
    assert gradient_counters("cases.sql") == gradient_counters("whole.sql")
    assert problem.get_val("f") == whole.get_val("f")
    assert np.array_equal(problem.get_val("x"), whole.get_val("x"))


def test_nothing_recorded_is_analysed_again_but_the_start(make_driver):
    _, _, expected = whole_run(make_driver)
    cut_run(make_driver, 9)
    problem, _ = continued(make_driver)
    assert problem.driver.reused_evaluations == 7
    assert problem.model.valley.calls == len(expected) - 8 + 1
    # one gradient may have been in flight
    assert problem.model.valley.gradients <= len(gradient_counters("whole.sql")) - 3


@pytest.mark.parametrize("gradient", [1, 4])
def test_kill_in_a_gradient(make_driver, gradient):
    _, _, expected = whole_run(make_driver)

    def in_gradient(component, _):
        if component.gradients == gradient:
            os.kill(os.getpid(), signal.SIGKILL)

    problem = record(valley_problem(make_driver()))
    problem.model.valley.options["on_gradient"] = in_gradient
    assert killed(problem.run_driver)
    assert len(gradient_counters("cases.sql")) == gradient - 1
    continued(make_driver)
    assert np.array_equal(designs(), expected)
    assert gradient_counters("cases.sql") == gradient_counters("whole.sql")


def run_and_die(make_driver, call, delay):
    """Record a run and kill this process ``delay`` seconds after a call of the model has begun."""

    def die_soon(component=None, *_):
        if component is None or component.calls == call:
            threading.Timer(delay, os.kill, (os.getpid(), signal.SIGKILL)).start()

    if call == 0:
        die_soon()
    slow = valley_problem(make_driver(), die_soon)
    slow.model.valley.options["on_gradient"] = lambda *_: time.sleep(1e-3)
    record(slow).run_driver()
    time.sleep(60.0)


def test_kill_at_any_moment(make_driver, rng):
    """Also before the first case, while the file is made, and while a case is written."""
    _, result, expected = whole_run(make_driver)
    lengths = []
    for call in (0, 1, 2, 5, 11, len(expected)):
        Path("cases.sql").unlink(missing_ok=True)
        assert killed(partial(run_and_die, make_driver, call, rng.uniform(0.0, 5e-3)))
        already = designs() if Path("cases.sql").exists() else expected[:0]
        lengths.append(len(already))
        assert np.array_equal(already, expected[: len(already)])
        if Path("cases.sql").exists():
            _, again = continued(make_driver)
            assert again.success == result.success
            assert np.array_equal(designs(), expected)
    assert lengths[0] < lengths[-1]


def test_many_cuts_one_after_the_other(make_driver):
    _, result, expected = whole_run(make_driver)
    shutil.copy("whole.sql", "kept.sql")
    cut_run(make_driver, 2)
    for _ in range(4):
        problem = valley_problem(make_driver(), kill_at(4))
        sm.restart(problem, "./cases.sql")
        assert killed(problem.run_driver)
    assert len(designs()) == 1 + 4 * 2
    problem, again = continued(make_driver)
    assert np.array_equal(designs(), expected)
    assert again.success == result.success
    log = run_log.read("cases.sql")
    assert [run.cut_off for run in log] == [True] * 5 + [False]


def test_completed_run_is_completed_at_once(make_driver):
    _, result, expected = whole_run(make_driver)
    problem, again = continued(make_driver, "./whole.sql")
    assert problem.model.valley.calls <= 2  # the start as a check, and the end for its state
    assert again.success
    assert again.exit_status == result.exit_status
    assert np.array_equal(designs("whole.sql"), expected)
    assert problem.get_val("f")[0] < 1.0


def test_iteration_limit_is_lifted(make_driver):
    _, _, expected = whole_run(make_driver)
    problem = record(valley_problem(make_driver(maxiter=5)))
    assert not problem.run_driver().success
    problem.cleanup()
    already = len(designs())
    problem, result = continued(make_driver)
    assert result.success
    assert problem.model.valley.calls < len(expected)
    assert np.array_equal(designs()[:already], expected[:already])
    assert np.array_equal(problem.get_val("x"), expected[-1])


# the last evaluation before these is not the best one
WORSE = {"UnoDriver": 12, "IpoptDriver": 8}


def valley_values(x):
    """The objective at designs (n, 3); infinite where the constraint is violated."""
    before, after = x[:, :-1], x[:, 1:]
    f = ((1.0 - before) ** 2 + 20.0 * (after - before**2) ** 2).sum(axis=1)
    return np.where((x**2).sum(axis=1) <= 2.0, f, np.inf)


def test_the_result_is_the_best_of_all_recorded_designs(make_driver):
    """A limit of one iteration repeats two designs; the result is the last case of the file."""
    cut_run(make_driver, WORSE[type(make_driver()).__name__])
    already, ends = designs(), []
    best = int(valley_values(already).argmin())
    assert 2 < best < len(already) - 1
    for _ in range(2):
        problem, result = continued(make_driver, maxiter=1)
        assert not result.success
        assert np.array_equal(problem.get_val("x"), already[best])
        assert np.array_equal(designs()[-1], problem.get_val("x"))
        ends.append(len(designs()))
    # the same result is recorded once
    assert ends == [len(already) + 1] * 2
    read = read_optimization("cases.sql")
    assert np.array_equal(read.design["x"][-1], designs()[-1])
    # the run itself continues as without them
    _, result = continued(make_driver)
    assert result.success
    assert np.array_equal(designs()[-1], whole_run(make_driver)[2][-1])


def test_a_lower_limit_keeps_the_result_of_a_completed_run(make_driver):
    problem = record(valley_problem(make_driver()))
    problem.run_driver()
    problem.cleanup()
    already = designs()
    for limit in (4, 5):
        problem, _ = continued(make_driver, maxiter=limit)
        assert np.array_equal(problem.get_val("x"), already[-1])
        assert np.array_equal(designs()[-1], problem.get_val("x"))


def test_lost_gradient_is_made_up_for(make_driver):
    _, _, expected = whole_run(make_driver)
    counters = gradient_counters("whole.sql")
    shutil.copy("whole.sql", "cases.sql")
    connection = sqlite3.connect("cases.sql")
    with connection:
        connection.execute("DELETE FROM driver_derivatives WHERE counter > ?", (counters[3],))
        connection.execute("DELETE FROM driver_iterations WHERE counter > ?", (counters[4],))
    connection.close()
    continued(make_driver)
    assert np.array_equal(designs(), expected)
    assert gradient_counters("cases.sql") == counters


def test_failed_analyses_are_not_repeated(make_driver):
    _, _, easy = whole_run(make_driver)
    hole = easy[len(easy) // 2]  # on the way of both drivers

    def fails_at(x):
        return np.abs(x - hole).max() < 1e-3

    def fails(component, x):
        if fails_at(x):
            raise om.AnalysisError("no solution here")

    whole, result, expected = whole_run(make_driver, on_call=fails)
    assert whole.driver.failed_analyses > 0

    def must_not_fail(component, x):
        assert not fails_at(x)

    problem, again = continued(make_driver, "./whole.sql", on_call=must_not_fail)
    assert problem.driver.failed_analyses == whole.driver.failed_analyses
    assert again.exit_status == result.exit_status
    assert np.array_equal(designs("whole.sql"), expected)


def test_analysis_that_ctrl_c_cut_off_is_repeated(make_driver):
    _, _, expected = whole_run(make_driver)

    def interrupt(component, _):
        if component.calls == 8:
            raise KeyboardInterrupt

    problem = record(valley_problem(make_driver(), interrupt))
    problem.run_driver()
    problem.cleanup()
    _, result = continued(make_driver)
    assert result.success
    assert np.array_equal(designs()[-(len(expected) - 7) :], expected[7:])


def test_evaluation_that_an_error_cut_off_is_repeated(make_driver):
    _, _, expected = whole_run(make_driver)

    def stumble(component, _):
        if component.calls == 8:
            raise MemoryError("no memory left")

    problem = record(valley_problem(make_driver(), stumble))
    with pytest.raises(MemoryError):
        problem.run_driver()
    problem.cleanup()
    reader = om.CaseReader("cases.sql")
    last = reader.get_case(-1)
    assert not last.success
    assert last.msg.startswith("unfinished: MemoryError")
    assert last.msg.endswith("no memory left")
    assert run_log.read("cases.sql")[0].message == "Ended by an exception"
    _, result = continued(make_driver)
    assert result.success
    assert np.array_equal(designs()[8:], expected[7:])


def test_plain_recorder_gets_the_whole_run(make_driver):
    _, _, expected = whole_run(make_driver)
    cut_run(make_driver, 9)
    problem = valley_problem(make_driver(hotstart_file="./cases.sql"))
    problem.driver.add_recorder(om.SqliteRecorder("./plain.sql"))
    problem.driver.recording_options["record_derivatives"] = True
    problem.run_driver()
    problem.cleanup()
    assert np.array_equal(designs("plain.sql"), expected)
    assert gradient_counters("plain.sql") == gradient_counters("whole.sql")


def test_empty_file_begins_at_the_start(make_driver):
    _, _, expected = whole_run(make_driver)
    cut_run(make_driver, 1)
    assert len(designs()) == 0
    _, result = continued(make_driver)
    assert result.success
    assert np.array_equal(designs(), expected)


def test_start_comes_from_the_file(make_driver):
    problem = record(valley_problem(make_driver(maxiter=2)))
    problem.set_val("x", [0.3, -0.7, 0.1])
    problem.run_driver()
    problem.cleanup()
    problem, _ = continued(make_driver)
    assert designs()[0].tolist() == [0.3, -0.7, 0.1]
    assert problem.driver.reused_evaluations > 0
    elsewhere = valley_problem(make_driver(hotstart_file="./cases.sql"))
    with pytest.raises(ValueError, match="the initial values of the design variables differ"):
        elsewhere.run_driver()


def test_other_model_is_noticed(make_driver):
    cut_run(make_driver, 5)
    problem = valley_problem(make_driver(), steep=20.001)
    sm.restart(problem, "./cases.sql")
    with pytest.raises(
        ValueError, match=r"recorded with another model: at the initial design.*valley\.f"
    ):
        problem.run_driver()
    problem.cleanup()


def test_another_processor_takes_the_recorded_steps(make_driver):
    """At the start its values differ in their last digits."""
    _, _, expected = whole_run(make_driver)
    cut_run(make_driver, 9)
    problem = valley_problem(make_driver(maxiter=3))
    problem.model.valley.options["rounding"] = 1e-12
    sm.restart(problem, "./cases.sql")
    problem.run_driver()
    problem.cleanup()
    # the start and, where the limit is met, the best of all recorded designs, the last one
    assert problem.model.valley.calls <= 2
    assert problem.driver.reused_evaluations >= 3
    assert np.array_equal(designs(), expected[:8])
    assert np.array_equal(problem.get_val("x"), expected[7])


def test_file_without_the_constraint_is_refused(make_driver):
    problem = valley_problem(make_driver())
    problem.driver.add_recorder(om.SqliteRecorder("./cases.sql"))
    problem.driver.recording_options["record_constraints"] = False
    problem.run_driver()
    problem.cleanup()
    with pytest.raises(
        ValueError, match="contains all design variables, the objective and the constraints"
    ):
        sm.restart(valley_problem(make_driver()), "./cases.sql")


def test_wrong_files_and_drivers(make_driver, tmp_path):
    problem = valley_problem(make_driver())
    with pytest.raises(ValueError, match="is not a file"):
        sm.restart(problem, "nowhere.sql")
    for text in ("", "some text that is no database"):
        (tmp_path / "text.sql").write_text(text)
        with pytest.raises(ValueError, match="not a file of an OpenMDAO recorder"):
            sm.restart(problem, "./text.sql")
    with pytest.raises(TypeError, match="load_case"):
        sm.restart(valley_problem(om.ScipyOptimizeDriver()), "./cases.sql")


class OneSided(om.ExplicitComponent):
    """f = (x - 1)^4 + max(0, y)^2: y has no effect where it is negative, as at the optimum."""

    def setup(self):
        self.add_input("x", 3.0)
        self.add_input("y", 0.5)
        self.add_output("f")
        self.declare_partials("*", "*")

    def compute(self, inputs, outputs):
        outputs["f"] = (inputs["x"] - 1.0) ** 4 + np.maximum(0.0, inputs["y"]) ** 2

    def compute_partials(self, inputs, partials):
        partials["f", "x"] = 4.0 * (inputs["x"] - 1.0) ** 3
        partials["f", "y"] = 2.0 * np.maximum(0.0, inputs["y"])


def test_first_jacobian_is_not_looked_at_twice(make_driver):
    """A variable without effect is an error at the start of a run only, also of a continued one."""

    def problem(**options):
        made = om.Problem(
            driver=make_driver(singular_jac_behavior="error", **options), reports=None
        )
        made.model.add_subsystem("c", OneSided(), promotes=["*"])
        made.model.add_design_var("x", lower=-5.0, upper=5.0)
        made.model.add_design_var("y", lower=-1.0, upper=1.0)
        made.model.add_objective("f")
        made.setup()
        return made

    first = record(problem(maxiter=5))
    first.run_driver()
    first.cleanup()
    assert first.get_val("y")[0] < 0.0
    again = problem()
    sm.restart(again, "./cases.sql")
    assert again.run_driver().success
    assert again.driver.reused_evaluations > 0
    assert again.driver.result.deriv_evals > 0
    again.cleanup()


def test_a_bare_name_is_the_same_file_for_the_recorder_and_the_restart(make_driver, tmp_path):
    """In the output folder of the problem, as OpenMDAO has it."""
    for driver in (make_driver(maxiter=2), make_driver()):
        problem = valley_problem(driver)
        folder = Path(problem.get_outputs_dir(mkdir=True))
        (folder / "kept.sql").unlink(missing_ok=True)
        record_all(driver, sm.RestartRecorder("kept.sql"))
        problem.run_driver()
        problem.cleanup()
        assert (folder / "kept.sql").is_file()
        assert not Path("kept.sql").exists()
        again = valley_problem(make_driver())
        shutil.copy(folder / "kept.sql", Path(again.get_outputs_dir(mkdir=True)) / "kept.sql")
        sm.restart(again, "kept.sql")
        again.run_driver()
        again.cleanup()
        assert again.driver.reused_evaluations > 2
        hot = valley_problem(make_driver(hotstart_file="kept.sql"))
        shutil.copy(folder / "kept.sql", Path(hot.get_outputs_dir(mkdir=True)) / "kept.sql")
        hot.run_driver()
        assert hot.driver.reused_evaluations > 2


def unrelated_problem(make_driver, grouped=True, **options):
    """The valley with a component on whose output no response depends."""
    problem = om.Problem(driver=make_driver(**options), reports=None)
    problem.options["group_by_pre_opt_post"] = grouped
    problem.model.add_subsystem("valley", Valley(), promotes=["*"])
    total = om.ExecComp("total = sum(x)", x={"shape": 3}, total={"val": 100.0})
    problem.model.add_subsystem("sum", total, promotes=["*"])
    problem.model.add_design_var("x", lower=-3.0, upper=3.0)
    problem.model.add_objective("f", ref=3.0)
    problem.model.set_input_defaults("x", np.array([-1.0, 0.5, 0.3]))
    problem.setup()
    return problem


@pytest.mark.parametrize("run_before", [(True, False), (False, True)])
def test_values_computed_only_after_the_optimisation_do_not_matter(make_driver, run_before):
    """Whether the model was run before the recorded run, or before the restart."""
    problem = record(unrelated_problem(make_driver, maxiter=3))
    again = unrelated_problem(make_driver)
    for each in [own for own, run in zip((problem, again), run_before, strict=True) if run]:
        each.run_model()
    problem.run_driver()
    problem.cleanup()
    sm.restart(again, "./cases.sql")
    again.run_driver()
    again.cleanup()
    assert again.driver.reused_evaluations >= 3
    assert again.get_val("total") == pytest.approx(again.get_val("x").sum(), rel=1e-15)


@pytest.mark.parametrize("recorder", [sm.RestartRecorder, om.SqliteRecorder])
def test_continued_without_these_values_in_files_of_any_recorder(make_driver, recorder):
    problem = unrelated_problem(make_driver, maxiter=3)
    record_all(problem.driver, recorder(Path("cases.sql").absolute()))
    problem.run_driver()
    problem.cleanup()
    again = unrelated_problem(make_driver)
    again.run_model()
    sm.restart(again, "./cases.sql")
    again.run_driver()
    again.cleanup()
    assert again.driver.reused_evaluations >= 3


@pytest.mark.parametrize("grouped", [True, False])
def test_recorded_values_belong_to_their_designs(make_driver, grouped):
    """OpenMDAO computes no outputs on which no response depends, unless its option is off."""
    problem = record(unrelated_problem(make_driver, grouped))
    problem.run_driver()
    problem.cleanup()
    reader = om.CaseReader("cases.sql")
    cases = [reader.get_case(name) for name in reader.list_cases("driver", out_stream=None)]
    assert len(cases) > 5
    for case in cases:
        assert ("total" in case.outputs) is not grouped
        if not grouped:
            assert case["total"] == pytest.approx(case["x"].sum(), rel=1e-15)


def test_the_last_of_two_runs_is_continued(make_driver):
    """Of a problem whose run_driver was called twice, with other starts."""
    starts = [-1.0, 0.5, 0.3], [0.3, -0.7, 0.1]
    _, _, alone = whole_run(make_driver)
    problem = record(valley_problem(make_driver()))
    for start, limit in zip(starts, (200, 3), strict=True):
        problem.set_val("x", start)
        problem.driver.options["maxiter"] = limit
        problem.run_driver()
    problem.cleanup()
    whole = valley_problem(make_driver())
    whole.set_val("x", starts[1])
    whole.run_driver()
    again, _ = continued(make_driver)
    assert again.driver.reused_evaluations < len(alone)
    assert np.array_equal(again.get_val("x"), whole.get_val("x"))
    cases = sqlite3.connect("cases.sql").execute("SELECT COUNT(*) FROM driver_iterations")
    assert cases.fetchone()[0] == len(alone) + whole.driver.iter_count

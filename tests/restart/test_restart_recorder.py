"""A recorder file is complete from the moment it has its name, and readable after any kill."""

import os
import shutil
import signal
import sqlite3
from importlib import metadata
from pathlib import Path

import numpy as np
import openmdao.api as om
import pytest
from valley import designs, killed, record, valley_problem

import seal_mdao as sm
from seal_mdao.recording import run_log
from seal_mdao.recording.recorder import RestartRecorder, copy_record

pytestmark = pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")


def run(make_driver, path="cases.sql", append=False, **options):
    problem = record(valley_problem(make_driver(**options)), path, append)
    result = problem.run_driver()
    problem.cleanup()
    return result


def kill_in(monkeypatch, name, call=1):
    """Kill the process at the start of a method of the recorder."""
    method, calls = getattr(om.SqliteRecorder, name), []

    def die(*arguments, **more):
        calls.append(name)
        if len(calls) == call:
            os.kill(os.getpid(), signal.SIGKILL)
        return method(*arguments, **more)

    monkeypatch.setattr(om.SqliteRecorder, name, die)


@pytest.mark.parametrize(
    ("method", "call"),
    [("_initialize_database", 1), ("startup", 1), ("record_viewer_data", 1),
     ("record_metadata_system", 1), ("record_metadata_system", 2), ("record_metadata_solver", 1),
     ("record_iteration_driver", 1), ("record_derivatives_driver", 1)],
)  # fmt: skip
def test_file_is_complete_or_not_there(make_driver, monkeypatch, method, call):
    """Whatever the recorder is doing when it is killed; an earlier file stays until then."""
    problem = record(valley_problem(make_driver()))
    with monkeypatch.context() as patched:
        kill_in(patched, method, call)
        assert killed(problem.run_driver)
    if Path("cases.sql").exists():
        assert len(designs()) <= 1
        continued = valley_problem(make_driver())
        sm.restart(continued, "./cases.sql")
        assert continued.run_driver().success
        continued.cleanup()
    else:
        assert method in ("_initialize_database", "startup", "record_viewer_data") or call == 1
    run(make_driver, "whole.sql")
    if Path("cases.sql").exists():
        assert np.array_equal(designs(), designs("whole.sql"))


def test_earlier_file_stays_until_the_new_one_is_complete(make_driver, monkeypatch):
    run(make_driver)
    before, length = Path("cases.sql").read_bytes(), len(designs())
    problem = record(valley_problem(make_driver()))
    with monkeypatch.context() as patched:
        kill_in(patched, "record_viewer_data")
        assert killed(problem.run_driver)
    assert Path("cases.sql").read_bytes() == before
    run(make_driver, maxiter=1)
    assert len(designs()) < length
    assert not list(Path().glob("*.new*"))


def test_kill_inside_a_transaction_leaves_a_readable_file(make_driver):
    """SQLite's journal of the unfinished transaction is rolled back by whoever reads next."""
    run(make_driver)
    expected = designs()

    def write_half():
        connection = sqlite3.connect("cases.sql")
        connection.execute("PRAGMA cache_size=1")
        text = "x" * 200_000
        for number in range(50):
            connection.execute(
                "INSERT INTO driver_iterations(counter, iteration_coordinate, inputs) VALUES(?,?,?)",
                (1000 + number, f"rank0:half|{number}", text),
            )
        os.kill(os.getpid(), signal.SIGKILL)

    assert killed(write_half)
    assert Path("cases.sql-journal").exists()
    shutil.copytree(Path(), "as_left")
    copy_record("as_left/cases.sql", "copied.sql")
    assert np.array_equal(designs("copied.sql"), expected)
    assert np.array_equal(designs(), expected)


def test_journal_of_another_file_is_not_applied(make_driver):
    run(make_driver)
    expected = designs()
    Path("cases.sql-journal").write_bytes(b"\\xd9\\xd5\\x05\\xf9\\x20\\xa1\\x63\\xd7" + bytes(600))
    run(make_driver)
    assert np.array_equal(designs(), expected)


def test_append_begins_a_file_that_is_not_there(make_driver):
    run(make_driver, append=True)
    expected = designs()
    run(make_driver, "other.sql")
    assert np.array_equal(designs("other.sql"), expected)


def test_log_of_the_runs(make_driver):
    result = run(make_driver, maxiter=2)
    problem = valley_problem(make_driver())
    sm.restart(problem, "./cases.sql")
    again = problem.run_driver()
    problem.cleanup()
    first, second = run_log.read("cases.sql")
    assert [first.cut_off, second.cut_off] == [False, False]
    assert (first.success, second.success) == (False, True)
    assert first.message == result.exit_status != second.message == again.exit_status
    assert first.options["maxiter"] == 2
    assert second.options["hotstart_file"].endswith("cases.sql")
    assert first.driver == second.driver == type(problem.driver).__name__
    assert first.versions["seal_mdao"] == sm.__version__
    assert first.versions["openmdao"] == metadata.version("openmdao")
    assert second.analyses == again.model_evals > 0
    assert second.iterations == again.iter_count
    assert first.begun <= first.ended <= second.begun <= second.ended


def test_every_run_of_one_problem_is_logged(make_driver):
    """Until the file is closed the model may run without its driver, too."""
    problem = record(valley_problem(make_driver(maxiter=2)))
    ends = [problem.run_driver()]
    analyses = [ends[0].model_evals]
    problem.set_val("x", [0.2, 0.1, 0.4])
    ends.append(problem.run_driver())
    analyses.append(ends[1].model_evals)
    problem.run_model()
    problem.cleanup()
    first, second = run_log.read("cases.sql")
    assert [first.analyses, second.analyses] == analyses
    assert first.begun <= first.ended <= second.begun <= second.ended
    assert not first.cut_off


def test_file_of_the_plain_recorder_has_no_log(make_driver):
    problem = valley_problem(make_driver())
    problem.driver.add_recorder(om.SqliteRecorder("./plain.sql"))
    problem.run_driver()
    problem.cleanup()
    assert run_log.read("plain.sql") == []


def test_copy_onto_itself_changes_nothing(make_driver):
    run(make_driver)
    before = Path("cases.sql").read_bytes()
    copy_record("cases.sql", Path("cases.sql").absolute())
    assert Path("cases.sql").read_bytes() == before


def test_text_is_not_copied(tmp_path):
    (tmp_path / "text.sql").write_text("this is no database at all, just a line of text" * 40)
    with pytest.raises(ValueError, match="is not a recorder file"):
        copy_record("text.sql", "copy.sql")
    assert not Path("copy.sql").exists()
    assert not Path("copy.sql.new").exists()


def test_two_problems_with_one_recorder_keep_counting(make_driver):
    """Recorders of the problem and of its driver share the counter of the cases."""
    problem = valley_problem(make_driver())
    recorder = RestartRecorder(Path("cases.sql").absolute())
    problem.driver.add_recorder(recorder)
    problem.add_recorder(recorder)
    problem.run_driver()
    problem.record("final")
    problem.cleanup()
    reader = om.CaseReader("cases.sql")
    assert reader.get_case("final").counter > reader.get_case(-1).counter

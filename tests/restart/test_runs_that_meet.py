"""Two runs and one file: one of them writes, the other reports it in one line."""

import os
import signal
import sqlite3
from contextlib import closing, suppress
from pathlib import Path

import openmdao.api as om
import pytest
from filelock import FileLock
from valley import designs, record, valley_problem

import seal_mdao as sm
from seal_mdao.recording import run_log
from seal_mdao.recording.claim import RecorderBusyError, claim
from seal_mdao.recording.evaluations import RestartError
from seal_mdao.recording.recorder import copy_record

pytestmark = pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")


@pytest.fixture
def finished(make_driver):
    """``cases.sql`` of a finished run."""
    problem = record(valley_problem(make_driver()), "cases.sql")
    problem.run_driver()
    problem.cleanup()
    return "./cases.sql"


def contents(path):
    with closing(sqlite3.connect(path)) as connection:
        return list(connection.iterdump())


def test_two_restarts_of_one_file_do_not_interleave(make_driver, finished):
    first = valley_problem(make_driver())
    sm.restart(first, finished)
    before = contents(finished)
    lock = claim(finished)
    try:
        with pytest.raises(
            RecorderBusyError, match=r"another process is writing the recorder file .*cases\.sql"
        ):
            first.run_driver()
    finally:
        lock.release()
    assert contents(finished) == before


def test_two_runs_into_one_file_leave_the_first_one_its_own(make_driver):
    """The second begins while the first is at work, and ends at once."""
    seen = []

    def second_run(component, _):
        if component.calls == 3:
            second = record(valley_problem(make_driver()), "cases.sql")
            with pytest.raises(RecorderBusyError):
                second.run_driver()
            seen.append(len(designs()))

    problem = record(valley_problem(make_driver(), second_run), "cases.sql")
    assert problem.run_driver().success
    problem.cleanup()
    assert seen == [2]
    assert len(designs()) > 10
    assert not run_log.read("cases.sql")[-1].cut_off


def test_lock_ends_with_its_process():
    child = os.fork()
    if child == 0:
        claim("cases.sql")
        os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)
    claim("cases.sql").release()


def test_lock_leaves_no_file():
    claim("cases.sql").release()
    assert not Path(".cases.sql.lock").exists()


def test_lock_on_a_deleted_file_is_not_taken(monkeypatch):
    """Another run deletes the file between opening and locking it: this lock would exclude nobody."""
    cases, real, taken = Path("cases.sql").absolute(), FileLock.acquire, []
    name = cases.with_name(".cases.sql.lock")

    def acquire(lock, *given, **more):
        real(lock, *given, **more)
        taken.append(lock)
        if len(taken) == 1:
            name.unlink()

    monkeypatch.setattr("seal_mdao.recording.claim.FileLock.acquire", acquire)
    lock = claim(cases)
    assert len(taken) == 2
    assert not taken[0].is_locked
    with pytest.raises(RecorderBusyError):
        claim(cases)
    lock.release()


def test_copy_does_not_replace_a_file_that_a_run_writes(finished):
    lock = claim("other.sql")
    try:
        with pytest.raises(RecorderBusyError):
            copy_record(finished, "other.sql")
    finally:
        lock.release()


def test_refused_restart_leaves_the_file_as_it_was(make_driver, finished):
    before = contents(finished)

    problem = valley_problem(make_driver(), steep=21.0)
    sm.restart(problem, finished)
    with pytest.raises(RestartError, match="another model"):
        problem.run_driver()
    problem.cleanup()
    assert contents(finished) == before
    assert [run.cut_off for run in run_log.read(finished)] == [False]


def test_file_of_a_run_interrupted_in_its_first_analysis_is_begun_afresh(make_driver):
    def interrupt(component, _):
        raise KeyboardInterrupt

    problem = record(valley_problem(make_driver(), interrupt), "cases.sql")
    with suppress(KeyboardInterrupt):
        problem.run_driver()
    problem.cleanup()
    again = valley_problem(make_driver())
    sm.restart(again, "./cases.sql")
    assert again.run_driver().success
    again.cleanup()
    reader = om.CaseReader("cases.sql")
    assert len(reader.list_cases("driver", out_stream=None)) > 10

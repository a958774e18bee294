"""A study that is killed continues, and its file is that of one that was not."""

import os
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing

import numpy as np
import pytest
from quick_study import quick_study

from seal_mdao.recording.claim import RecorderBusyError
from seal_mdao.scenarios.processes import Processes
from seal_mdao.tolerances.record import StudyFileError, StudyRecord
from seal_mdao.tolerances.tolerance_study import ToleranceStudy

COUNT = 24
CHECKED = "SELECT number, status, message, {} FROM results ORDER BY number"


def table(path, query):
    with closing(sqlite3.connect(path)) as connection:
        return connection.execute(query).fetchall()


def results(path):
    """All that does not depend on the clock."""
    with closing(sqlite3.connect(path)) as connection:
        names = [row[1] for row in connection.execute("PRAGMA table_info(results)")]
    measures = ", ".join(f'"{name}"' for name in names[5:])
    assert measures
    return table(path, CHECKED.format(measures))


def assert_same_study(path, other):
    assert len(results(path)) == COUNT
    assert results(path) == results(other)
    for name in ("samples", "study"):
        assert table(path, f"SELECT * FROM {name}") == table(other, f"SELECT * FROM {name}")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """File of a study that was not interrupted."""
    path = tmp_path_factory.mktemp("whole") / "samples.sqlite"
    sampled = quick_study().run(path, COUNT)
    assert sampled.completed.all()
    return path


def test_interrupted_and_resumed(whole, study, tmp_path):
    path = tmp_path / "samples.sqlite"
    seen = []

    def until_ten(number, outcome):
        seen.append(number)
        if len(seen) == 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study.run(path, COUNT, callback=until_ten)
    assert [row[0] for row in table(path, "SELECT number FROM results")] == seen
    sampled = study.run(path, COUNT, callback=lambda number, _: seen.append(number))
    assert sorted(seen) == list(range(COUNT))
    assert_same_study(path, whole)
    values = np.array([row[3:] for row in results(whole)])
    np.testing.assert_array_equal(sampled.values, values)


@pytest.mark.long
def test_two_processes_write_the_same_file(whole, study, tmp_path):
    with Processes(2) as workers:
        study.run(tmp_path / "samples.sqlite", COUNT, workers=workers)
    assert_same_study(tmp_path / "samples.sqlite", whole)


SCRIPT = """
import sys
from quick_study import quick_study

if __name__ == "__main__":
    print("begun", flush=True)
    tell = lambda number, outcome: print(number, flush=True)
    quick_study().run(sys.argv[1], int(sys.argv[2]), workers=int(sys.argv[3]), callback=tell)
"""


def started(tmp_path, path, workers):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    folders = os.pathsep.join([os.path.dirname(__file__), os.getcwd()])
    command = [sys.executable, script, path, str(COUNT), str(workers)]
    return subprocess.Popen(
        command, env=os.environ | {"PYTHONPATH": folders}, text=True, stdout=subprocess.PIPE,
        start_new_session=True,
    )  # fmt: skip


def killed_somewhere(tmp_path, path, moment, workers) -> list:
    """Kill a study ``moment`` seconds after its first result; the numbers that it has told of."""
    process = started(tmp_path, path, workers)
    told = [process.stdout.readline() for _ in range(2)]
    time.sleep(moment)
    process.send_signal(signal.SIGKILL)
    told += process.communicate()[0].splitlines()
    return [int(line) for line in told[1:] if line.strip().isdigit()]


def check_killed(tmp_path, whole, study, moments, workers):
    path = tmp_path / "samples.sqlite"
    for moment in moments:
        told = killed_somewhere(tmp_path, path, moment, workers)
        kept = {row[0]: row for row in results(path)}
        assert {*told} <= {*kept}
        expected = {row[0]: row for row in results(whole)}
        assert all(row == expected[number] for number, row in kept.items())
    study.run(path, COUNT)
    assert_same_study(path, whole)


def test_sigkill_of_the_whole_study_loses_nothing_that_was_told(whole, study, tmp_path):
    check_killed(tmp_path, whole, study, [0.02], workers=0)


@pytest.mark.parametrize(
    "seed",
    [pytest.param(n, marks=pytest.mark.release if n > 1 else pytest.mark.long) for n in range(5)],
)
def test_sigkill_at_random_moments(whole, study, tmp_path, seed):
    """Twice each, in line and with two processes: ten moments within the time that all samples take."""
    rng = np.random.default_rng(seed)
    check_killed(tmp_path, whole, study, rng.uniform(0.0, 0.8, 2), workers=2 * (seed % 2))


def test_a_file_of_another_study_is_refused(whole, study):
    with pytest.raises(StudyFileError, match="another seed"):
        study.run(whole, COUNT, seed=1)
    with pytest.raises(StudyFileError, match="another number of samples"):
        study.run(whole, COUNT + 1)
    other = ToleranceStudy(study.seal, study.tolerances, ("reaction",))
    with pytest.raises(StudyFileError, match="another measures"):
        other.run(whole, COUNT)
    other = ToleranceStudy(study.seal, study.tolerances, study.measures, 0.01 * np.ones(25))
    with pytest.raises(StudyFileError, match="another design"):
        other.run(whole, COUNT)


def test_a_file_that_is_no_study_is_refused(study, tmp_path):
    path = tmp_path / "text.sqlite"
    path.write_text("this is not a database, whatever its name says, and long enough to tell")
    with pytest.raises(StudyFileError, match="is not a file of a tolerance study"):
        study.run(path, COUNT)


def test_one_writer_at_a_time(study, whole):
    settings = study.settings("sobol", 0, COUNT)
    with (
        StudyRecord(whole, settings, study.inputs, study.outputs),
        pytest.raises(RecorderBusyError),
    ):
        study.run(whole, COUNT)


def test_failures_are_kept_with_their_message(seal, tolerances, tmp_path):
    """Boundaries that are off by millimetres fold."""
    from dataclasses import replace

    from seal_mdao.tolerances.boundary_errors import BoundaryTolerance

    wild = replace(tolerances, boundary=BoundaryTolerance(2.0, 1.0))
    sampled = ToleranceStudy(seal, wild, ("reaction",)).run(tmp_path / "samples.sqlite", 8)
    failed = ~sampled.completed
    assert failed.any()
    assert all(bool(message) == bad for message, bad in zip(sampled.messages, failed, strict=True))
    assert np.isnan(sampled.values[failed]).all()
    assert np.isfinite(sampled.values[~failed]).all()

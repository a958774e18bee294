"""Names in tolerance files are names in SQL, whatever they say."""

import sqlite3
from contextlib import closing

import numpy as np
import pytest

from seal_mdao.scenarios.task import Outcome
from seal_mdao.tolerances.record import StudyFileError, StudyRecord

NAMES = ('a" REAL, "b', "a'); DROP TABLE study; --", '"', "two words", "Länge", "select", "?")


@pytest.mark.parametrize("name", NAMES)
def test_name_is_that_of_one_column(tmp_path, name):
    path = tmp_path / "samples.sqlite"
    with StudyRecord(path, {"seed": "0"}, (name, "c"), (name, "d")) as record:
        made = record.samples(np.array([[1.0, 2.0], [3.0, 4.0]]))
        record.add(0, Outcome(np.array([5.0, 6.0]), None, "", 1.0))
        np.testing.assert_array_equal(record.results()[3], [[5.0, 6.0]])
    np.testing.assert_array_equal(made, [[1.0, 2.0], [3.0, 4.0]])
    with closing(sqlite3.connect(path)) as connection:
        tables = connection.execute("SELECT name FROM sqlite_master WHERE type='table'").fetchall()
        assert sorted(tables) == [("results",), ("samples",), ("study",)]
        for table, place in (("samples", 1), ("results", 5)):
            columns = [row[1] for row in connection.execute(f"PRAGMA table_info({table})")]
            assert (columns[place], len(columns)) == (name, place + 2)


def test_values_of_a_failed_sample_are_missing(tmp_path):
    path = tmp_path / "samples.sqlite"
    with StudyRecord(path, {}, ("a",), ("b", "c")) as record:
        record.add(0, Outcome(np.array([np.nan, np.inf]), None, "no equilibrium", 1.0))
        np.testing.assert_array_equal(record.results()[3], [[np.nan, np.inf]])
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("SELECT b, c FROM results").fetchall() == [(None, np.inf)]


@pytest.mark.parametrize(
    ("inputs", "measures"),
    [(("a", "A"), ()), (("Number",), ()), ((), ("status",)), ((), ("b", "c", "B"))],
)
def test_names_that_sql_takes_for_one_are_refused(tmp_path, inputs, measures):
    with pytest.raises(StudyFileError, match="rename one"):
        StudyRecord(tmp_path / "samples.sqlite", {}, inputs, measures)
    StudyRecord(tmp_path / "samples.sqlite", {}, ("a",), ("b",)).close()  # the lock is free


def test_a_file_that_is_none_of_samples_is_closed(tmp_path, monkeypatch):
    path, opened, connect = tmp_path / "samples.sqlite", [], sqlite3.connect
    path.write_text("no database " * 100)
    monkeypatch.setattr(sqlite3, "connect", lambda at: opened.append(connect(at)) or opened[0])
    with pytest.raises(StudyFileError, match="is not a file of a tolerance study"):
        StudyRecord(path, {}, ("a",), ("b",))
    with pytest.raises(sqlite3.ProgrammingError, match="closed"):
        opened[0].execute("SELECT 1")


@pytest.mark.parametrize(
    "program",
    [
        "CREATE TRIGGER once AFTER INSERT ON results BEGIN DELETE FROM samples; END",
        "CREATE TRIGGER once AFTER INSERT ON samples BEGIN DELETE FROM study; END",
    ],
)
def test_trigger_in_a_file_of_samples_does_nothing(tmp_path, program):
    path = tmp_path / "samples.sqlite"
    StudyRecord(path, {}, ("a",), ("b",)).close()
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute(program)
    with (
        StudyRecord(path, {}, ("a",), ("b",)) as record,
        pytest.raises(sqlite3.DatabaseError, match="not authorized"),
    ):
        insert_rows(record)


def insert_rows(record):
    record.samples(np.ones((3, 1)))
    record.add(1, Outcome(np.array([6.0]), None, "", 1.0))

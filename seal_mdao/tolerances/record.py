"""SQLite file of a tolerance study: samples, and a row of results as soon as it is known."""

import sqlite3
import time
from contextlib import ExitStack, closing
from pathlib import Path

import numpy as np

from seal_mdao.recording.claim import claim
from seal_mdao.recording.plain_reading import without_programs
from seal_mdao.scenarios.task import Outcome

COMPLETED, FAILED = "completed", "failed"
NUMBER = "INTEGER PRIMARY KEY"
OF_A_RUN = {"status": "TEXT", "message": "TEXT", "seconds": "REAL", "finished": "REAL"}
"""Columns of results before the measures."""


class StudyFileError(ValueError):
    """A file of samples with which a study cannot continue."""


class StudyRecord:
    """File of a tolerance study.

    Table ``study``: settings (key, value). Table ``samples``: number of a sample and its varying
    quantities. Table ``results``: status of every finished sample, message of a failure, duration (s),
    time of completion (Unix time), and measures; numbers are floats of 8 bytes, exactly as computed.
    Every row is committed at once and survives a kill.

    Parameters
    ----------
    path : str or Path
    settings : dict of str to str
        Settings of the study; a file with other settings is refused.
    inputs, measures : tuple of str
        Names of the columns.

    Raises
    ------
    StudyFileError
        For a file of another study, or another kind of file.
    RecorderBusyError
        If another process writes it.
    """

    def __init__(self, path, settings: dict, inputs: tuple, measures: tuple):
        self.path, self._inputs, self._measures = Path(path), tuple(inputs), tuple(measures)
        # one process writes the file at a time
        self._lock = claim(self.path)
        # after an error the file is closed and its lock released
        with ExitStack() as opened:
            opened.callback(self._lock.release)
            try:
                self._file = opened.enter_context(closing(sqlite3.connect(self.path)))
                without_programs(self._file)
                # write-ahead log: readers do not block the study
                self._file.execute("PRAGMA journal_mode = WAL")
                self._begin(settings)
            except sqlite3.DatabaseError as error:
                text = f"{path} is not a file of a tolerance study: {error}"
                raise StudyFileError(text) from None
            opened.pop_all()

    def _begin(self, settings) -> None:
        of_samples = dict.fromkeys(self._inputs, "REAL NOT NULL")
        of_results = dict.fromkeys(self._measures, "REAL")
        tables = {
            "samples": self._columns({"number": NUMBER}, of_samples),
            "results": self._columns({"number": NUMBER} | OF_A_RUN, of_results),
        }
        with self._file:
            self._file.execute(
                "CREATE TABLE IF NOT EXISTS study (key TEXT PRIMARY KEY, value TEXT)"
            )
            # a new file has no settings yet
            different = other_settings(self.path, settings)
            if different:
                raise StudyFileError(
                    f"{self.path} was written by a tolerance study with another {different[0]}; "
                    "continue with the same settings, choose another folder (--out), or replace "
                    "the study (--overwrite)"
                )
            for name, columns in tables.items():
                self._file.execute(f"CREATE TABLE IF NOT EXISTS {name} ({columns})")
            self._file.executemany(
                "INSERT OR IGNORE INTO study VALUES (?, ?)", list(settings.items())
            )

    def _columns(self, first: dict, further: dict) -> str:
        """Format names and types of the columns of a table in SQL."""
        # SQL does not distinguish capitals
        known = {name.lower(): name for name in first}
        for name in further:
            if name.lower() in known:
                raise StudyFileError(
                    f"{self.path}: the parameters or measures {known[name.lower()]!r} and {name!r} "
                    "differ only in upper and lower case, which the database does not distinguish; "
                    "rename one of them"
                )
            known[name.lower()] = name
        return ", ".join(f"{_quoted(name)} {kind}" for name, kind in (first | further).items())

    def samples(self, made: np.ndarray) -> np.ndarray:
        """Return the samples of the file, shape (S, len(inputs)); store ``made`` if it has none yet."""
        with self._file:
            # a resumed study has its samples already
            if not self._file.execute("SELECT COUNT(*) FROM samples").fetchone()[0]:
                marks = ", ".join("?" * (1 + len(self._inputs)))
                rows = [(number, *row) for number, row in enumerate(made.tolist())]
                self._file.executemany(f"INSERT INTO samples VALUES ({marks})", rows)
        return np.array([row[1:] for row in self._rows("samples")], float)

    def add(self, number: int, outcome: Outcome) -> None:
        """Store a sample that has finished."""
        # SQLite stores NaN as NULL
        values = outcome.values.tolist()
        marks = ", ".join("?" * (5 + len(values)))
        status = FAILED if outcome.failure else COMPLETED
        row = (number, status, outcome.failure, outcome.seconds, time.time(), *values)
        with self._file:
            self._file.execute(f"INSERT OR REPLACE INTO results VALUES ({marks})", row)

    @property
    def finished(self) -> set:
        """Numbers of the samples with results."""
        return {row[0] for row in self._file.execute("SELECT number FROM results")}

    def results(self):
        """Return numbers (n,), messages, seconds (n,), measures (n, M) of finished samples, in order."""
        rows = self._rows("results")
        numbers = np.array([row[0] for row in rows], int)
        values = np.array([row[5:] for row in rows], float).reshape(-1, len(self._measures))
        return numbers, [row[2] for row in rows], np.array([row[3] for row in rows]), values

    def _rows(self, table) -> list:
        return self._file.execute(f"SELECT * FROM {table} ORDER BY number").fetchall()

    def close(self) -> None:
        """Close the file and release its lock."""
        self._file.close()
        self._lock.release()

    def __enter__(self) -> "StudyRecord":
        return self

    def __exit__(self, *exception) -> None:
        self.close()


def other_settings(path, settings: dict) -> list[str]:
    """List the settings that differ from those in the file of a study; empty without such a file."""
    if not Path(path).is_file():
        return []
    try:
        with closing(sqlite3.connect(path)) as file:
            there = dict(file.execute("SELECT key, value FROM study"))
    except sqlite3.DatabaseError:  # ``StudyRecord`` says what is wrong with it
        return []
    return [key for key, value in settings.items() if there.get(key, value) != value]


def count_finished(path) -> int:
    """Count the samples with results in the file of a study; none where there is no such file."""
    if not Path(path).is_file():
        return 0
    try:
        with closing(sqlite3.connect(path)) as file:
            return file.execute("SELECT COUNT(*) FROM results").fetchone()[0]
    except sqlite3.DatabaseError:  # ``StudyRecord`` says what is wrong with it
        return 0


def _quoted(name: str) -> str:
    # an identifier of any characters in SQL
    return '"' + name.replace('"', '""') + '"'

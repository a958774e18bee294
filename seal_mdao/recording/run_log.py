"""Log of the runs that wrote a recorder file: when, with which software, and how they ended.

OpenMDAO's recorder file does not show whether a run was completed. A table of this package does: a row
is added when a run begins, and completed when the recorder is shut down. A killed run leaves its row
incomplete. OpenMDAO's own readers do not see the table.
"""

import json
import platform
import sqlite3
from dataclasses import dataclass
from datetime import datetime
from importlib import metadata

from seal_mdao.openmdao_access import counted_iterations
from seal_mdao.recording.plain_reading import PlainDatabase, reading

TABLE = "run_log"
BY_EXCEPTION = "Ended by an exception"
"""Message of a run that raised."""
COLUMNS = dict.fromkeys(("begun", "ended", "driver", "options", "versions"), str) | {
    "success": int, "message": str, "iterations": int | None, "analyses": int, "seconds": float,
}  # fmt: skip
"""Columns of the table with their types, in the order of ``LoggedRun``."""
SQL_TYPES = {str: "TEXT", int: "INT", int | None: "INT", float: "REAL"}
PACKAGES = ("seal_mdao", "openmdao", "numpy", "scipy", "numba", "unopy", "ipyopt")


@dataclass(frozen=True)
class LoggedRun:
    """One run that wrote to a recorder file.

    Attributes
    ----------
    begun, ended : str
        Local time with its offset, ISO 8601; ``ended`` is empty for a run that was cut off.
    driver, options : str, dict
        Class of the driver, and its options, as text if JSON cannot represent them.
    versions : dict of str to str
        Versions of Python and of ``PACKAGES``.
    success, message : bool, str
        Whether the driver reported success, and its exit message.
    iterations : int or None
        Iterations of the optimiser in this run; None if its driver does not count them.
    analyses : int
        Model runs of this run.
    seconds : float
    """

    begun: str
    ended: str
    driver: str
    options: dict
    versions: dict
    success: bool
    message: str
    iterations: int | None
    analyses: int
    seconds: float

    @property
    def cut_off(self) -> bool:
        """Whether the run was not completed."""
        return not self.ended


def begin(connection: sqlite3.Connection, driver) -> int:
    """Log the beginning of a run and return the number of its row."""
    columns = ", ".join(f"{name} {SQL_TYPES[kind]}" for name, kind in COLUMNS.items())
    # incomplete until ``end``: the column ``ended`` is empty
    options, used = json.dumps(options_of(driver)), json.dumps(versions())
    row = (_now(), "", type(driver).__name__, options, used, 0, "", 0, 0, 0.0)
    with connection:
        connection.execute(f"CREATE TABLE IF NOT EXISTS {TABLE}(id INTEGER PRIMARY KEY, {columns})")
        marks = ",".join("?" * len(row))
        insert = f"INSERT INTO {TABLE}({', '.join(COLUMNS)}) VALUES({marks})"
        return connection.execute(insert, row).lastrowid


def end(connection: sqlite3.Connection, row: int, driver) -> None:
    """Log how the last run of a driver ended."""
    result = driver.result
    found = {
        "ended": _now(), "success": int(bool(result.success)), "message": str(result.exit_status),
        "iterations": counted_iterations(driver), "analyses": int(result.model_evals),
        "seconds": float(result.runtime),
    }  # fmt: skip
    changes = ", ".join(f"{name}=?" for name in found)
    with connection:
        connection.execute(f"UPDATE {TABLE} SET {changes} WHERE id=?", (*found.values(), row))


def read(path) -> list[LoggedRun]:
    """Read the runs of a recorder file in order; empty for files of other recorders.

    Raises
    ------
    ValueError
        For a file that is no recorder file, or damaged.
    """
    with reading(path) as database:
        return read_runs(database)


def read_runs(database: PlainDatabase) -> list[LoggedRun]:
    """Read the runs of an open recorder file."""
    # files of other recorders lack the table
    if not database.has(TABLE):
        return []
    rows, found = database.numbered_rows(TABLE, COLUMNS), []
    for *first, options, used, success, message, iterations, analyses, seconds in rows:
        # JSON of another kind than an object has no items: the file is damaged
        texts = {name: str(version) for name, version in json.loads(used).items()}
        rest = bool(success), message, iterations, analyses, seconds
        found.append(LoggedRun(*first, dict(json.loads(options).items()), texts, *rest))
    return found


def versions() -> dict[str, str]:
    """Return the versions of Python and of the installed packages."""
    # packages that are not installed are omitted
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def options_of(driver) -> dict:
    """Return the options of a driver and of its optimiser, as text if JSON cannot represent them."""
    plain = (bool, int, float, str, type(None))
    # settings of the optimiser under a name of their own
    options = dict(driver.options.items())
    options |= {f"opt_settings[{k!r}]": v for k, v in getattr(driver, "opt_settings", {}).items()}
    return {k: v if isinstance(v, plain) else repr(v) for k, v in options.items()}


def _now() -> str:
    return datetime.now().astimezone().isoformat(timespec="seconds")

"""Which runs wrote a recorder file, when, with what, and how they ended.

OpenMDAO's recorder file does not say whether a run came to its end. A table of its own does: a row
when a run begins, completed when the recorder is shut down. A run that was killed leaves its row
open. OpenMDAO's own readers do not see the table.
"""

import json
import platform
import sqlite3
from dataclasses import dataclass
from datetime import datetime
from importlib import metadata

from seal_mdao.recording.plain_reading import PlainDatabase, reading

TABLE = "run_log"
BY_EXCEPTION = "Ended by an exception"
"""How a run ended that raised."""
COLUMNS = dict.fromkeys(("begun", "ended", "driver", "options", "versions"), str) | {
    "success": int, "message": str, "iterations": int, "analyses": int, "seconds": float,
}  # fmt: skip
"""Of the table, in the order of ``LoggedRun``."""
PACKAGES = ("seal_mdao", "openmdao", "numpy", "scipy", "numba", "unopy", "ipyopt")


@dataclass(frozen=True)
class LoggedRun:
    """One run that wrote to a recorder file.

    Attributes
    ----------
    begun, ended : str
        Local time with its offset, ISO 8601; ``ended`` is empty for a run that was cut off.
    driver : str
        Class of the driver.
    options : dict
        The driver's options, as text where JSON has no form for them.
    versions : dict of str to str
        Of Python and of the packages that matter.
    success : bool
        Whether the driver reported success.
    message : str
        The driver's last word.
    iterations, analyses : int
        Driver iterations, and model runs, of this run.
    seconds : float
    """

    begun: str
    ended: str
    driver: str
    options: dict
    versions: dict
    success: bool
    message: str
    iterations: int
    analyses: int
    seconds: float

    @property
    def cut_off(self) -> bool:
        """Whether the run never came to its end."""
        return not self.ended


def create(connection: sqlite3.Connection) -> None:
    """Add the table to a recorder file that has none."""
    connection.execute(
        f"CREATE TABLE IF NOT EXISTS {TABLE}(id INTEGER PRIMARY KEY, begun TEXT, ended TEXT, "
        "driver TEXT, options TEXT, versions TEXT, success INT, message TEXT, iterations INT, "
        "analyses INT, seconds REAL)"
    )


def begin(connection: sqlite3.Connection, driver) -> int:
    """Note the beginning of a run; returns the number of its row."""
    row = (_now(), type(driver).__name__, json.dumps(options_of(driver)), json.dumps(versions()))
    with connection:
        create(connection)
        return connection.execute(
            f"INSERT INTO {TABLE}(begun, ended, driver, options, versions, success, message, "
            "iterations, analyses, seconds) VALUES(?,'',?,?,?,0,'',0,0,0.0)",
            row,
        ).lastrowid


def end(connection: sqlite3.Connection, row: int, result) -> None:
    """Note how a run ended, from its ``DriverResult``."""
    with connection:
        connection.execute(
            f"UPDATE {TABLE} SET ended=?, success=?, message=?, iterations=?, analyses=?, "
            "seconds=? WHERE id=?",
            (
                _now(), int(bool(result.success)), str(result.exit_status), int(result.iter_count),
                int(result.model_evals), float(result.runtime), row,
            ),
        )  # fmt: skip


def read(path) -> list[LoggedRun]:
    """Runs of a recorder file in order; none for a file that another recorder wrote.

    Raises
    ------
    ValueError
        For a file that is no recorder file, or damaged.
    """
    with reading(path), PlainDatabase(path) as database:
        return read_runs(database)


def read_runs(database: PlainDatabase) -> list[LoggedRun]:
    """Runs of a recorder file that is open."""
    if not database.has(TABLE):
        return []
    found = []
    for begun, ended, driver, options, used, success, *rest in database.numbered_rows(
        TABLE, COLUMNS
    ):
        texts = {name: str(version) for name, version in json.loads(used).items()}
        options = dict(json.loads(options).items())
        found.append(LoggedRun(begun, ended, driver, options, texts, bool(success), *rest))
    return found


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that are installed."""
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def options_of(driver) -> dict:
    """Options of a driver and of its optimiser, as text where JSON has no form for them."""
    plain = (bool, int, float, str, type(None))
    options = dict(driver.options.items())
    options |= {f"opt_settings[{k!r}]": v for k, v in getattr(driver, "opt_settings", {}).items()}
    return {k: v if isinstance(v, plain) else repr(v) for k, v in options.items()}


def _now() -> str:
    return datetime.now().astimezone().isoformat(timespec="seconds")

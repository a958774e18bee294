"""RestartRecorder: a recorder file that is complete at any moment, and that can be continued."""

import os
import sqlite3
from pathlib import Path

import numpy as np
from openmdao.core.driver import Driver

from seal_mdao.openmdao_access import SqliteHooks, find_value, problem_of
from seal_mdao.recording import run_log
from seal_mdao.recording.claim import claim, require_free
from seal_mdao.recording.plain_reading import without_programs
from seal_mdao.recording.seal_inputs import inputs_of_seals, outputs_of_seals

LEFTOVERS = ("-journal", "-wal", "-shm")
"""What SQLite leaves beside a file when a process is killed; it belongs to that very file."""


class RestartRecorder(SqliteHooks):
    """SqliteRecorder whose file survives a kill at any moment and that can append to a file.

    Every case is a transaction of its own, as in ``SqliteRecorder``, so a killed run loses nothing
    but the evaluation in flight. Beyond that, a new file takes its name only when all that a reader
    needs is in it; before, a file of that name from an earlier run stays as it was. With ``append``
    the cases of an existing file are kept and new ones follow them; evaluations that the driver
    takes from the file (``hotstart_file``) are not recorded twice. The file also tells how every run
    ended; see ``seal_mdao.recording.run_log``.

    One run writes a file at a time; beside it a lock, ``.<name>.lock``, is held until the end.

    Parameters
    ----------
    filepath : str or Path
        The recorder file.
    append : bool
        Continue the file if it exists, instead of replacing it. Only for the problem that wrote it.
    **options
        Further options of ``SqliteRecorder``.
    """

    def __init__(self, filepath, append: bool = False, **options):
        if not isinstance(filepath, str | Path) or not Path(filepath).name:
            raise ValueError(
                f"filepath of {type(self).__name__} must name a file, got {filepath!r}"
            )
        super().__init__(filepath, **options)
        self._append = append
        self._unpublished = None
        self._driver = None
        self._log_row = None
        self._seals = None
        self._lock = None

    def startup(self, recording_requester, comm=None):
        """Prepare for a new run."""
        if self.is_started(recording_requester):
            return
        counter = self.counter
        super().startup(recording_requester, comm)
        self.counter = max(counter, self._last_counter())
        if isinstance(recording_requester, Driver):
            self._driver = recording_requester

    def record_metadata_system(self, system, run_number=None):
        """Record the options of a system once per run number; the root's make the file complete."""
        self._once(super().record_metadata_system, system, run_number)
        if not system.pathname and self.connection:
            if not self._append:
                self._note_begin()
            self._publish()

    def record_metadata_solver(self, solver, run_number=None):
        """Record the options of a solver once per run number."""
        self._once(super().record_metadata_solver, solver, run_number)

    def record_iteration_driver(self, driver, data, metadata):
        """Record a case, unless the driver took it from this very file; the inputs of seals always."""
        if self._repeated(driver) is None:
            metadata = self._look_at_seals(driver, data, metadata)
            self._note_begin()
            super().record_iteration_driver(driver, data, metadata)
        else:
            self.counter -= 1

    def record_derivatives_driver(self, driver, data, metadata):
        """Record derivatives with the number of the case to which they belong."""
        repeated = self._repeated(driver)
        if repeated is None:
            super().record_derivatives_driver(driver, data, metadata)
        elif self.connection and not self._has_derivatives(repeated):
            counter, self.counter = self.counter, repeated
            super().record_derivatives_driver(driver, data, metadata)
            self.counter = counter

    def _look_at_seals(self, driver, data, metadata) -> dict:
        """Add the inputs of seals, which a report needs whatever lies upstream of them; metadata that
        say so where an analysis has failed, which OpenMDAO's DOEDriver leaves out."""
        model = problem_of(driver).model
        if self._seals is None:
            self._seals = inputs_of_seals(model), outputs_of_seals(model)
        inputs, outputs = model.get_nonlinear_vectors()[:2]
        if data["input"] is not None:
            for name in set(self._seals[0]).difference(data["input"]):
                value = find_value(inputs, name)
                if value is not None:
                    data["input"][name] = value.copy()
        values = [find_value(outputs, name) for name in self._seals[1]]
        failed = any(value is not None and np.isnan(value).any() for value in values)
        if not (failed and metadata["success"]):
            return metadata
        return metadata | {"success": 0, "msg": "the analysis of a seal failed"}

    def _note_begin(self) -> None:
        """Note that a run writes; one that goes on is silent until then, for it may be refused."""
        if self.connection and self._log_row is None and self._driver is not None:
            self._log_row = run_log.begin(self.connection, self._driver)

    def note_end(self) -> None:
        """Note how the run of the driver ended, before the file is closed."""
        if self._driver is not None and self._driver.result.exit_status != run_log.BY_EXCEPTION:
            self._note_begin()
        if self.connection and self._log_row is not None:
            run_log.end(self.connection, self._log_row, self._driver.result)

    def shutdown(self):
        """Note how the run ended and close the file."""
        self.note_end()
        self._log_row = None
        if self.connection:
            self._publish()
        super().shutdown()
        self.connection = self.metadata_connection = None
        if self._lock is not None:
            self._lock.release()

    def open_database(self, comm):
        """Open the file to continue, or begin a new one under another name."""
        if comm is not None and comm.size > 1:
            if self._append:
                raise RuntimeError("RestartRecorder appends to a file on one process only")
            self.make_database(comm)
            return
        self._lock = claim(self.path)
        path = Path(self.path)
        if self._append and path.is_file():
            self.use_database(without_programs(sqlite3.connect(path)))
            return
        self._unpublished = path.with_name(path.name + ".new")
        _remove(self._unpublished)
        self.path = self._unpublished
        self.make_database(comm)
        self.path = path

    def _publish(self) -> None:
        """Give the new file its name."""
        if self._unpublished is None:
            return
        self.connection.close()
        _remove_leftovers(Path(self.path))
        os.replace(self._unpublished, self.path)
        self._unpublished = None
        self.use_database(sqlite3.connect(self.path))

    def _last_counter(self) -> int:
        if not (self._append and self.connection):
            return 0
        query = "SELECT MAX(counter) FROM driver_iterations"
        return self.connection.execute(query).fetchone()[0] or 0

    def _repeated(self, driver) -> int | None:
        """Number of the case in this file whose evaluation the driver repeats."""
        return getattr(driver, "repeated_case", None) if self._append else None

    def _has_derivatives(self, counter: int) -> bool:
        query = "SELECT 1 FROM driver_derivatives WHERE counter=? LIMIT 1"
        return self.connection.execute(query, (counter,)).fetchone() is not None

    def _once(self, record, requester, run_number) -> None:
        """Record metadata unless the file that is continued holds them already."""
        try:
            record(requester, run_number)
        except sqlite3.IntegrityError:
            if not self._append:
                raise


def record_all(driver, recorder) -> None:
    """Let a driver record all that a restart needs: every variable, and the derivatives."""
    driver.add_recorder(recorder)
    driver.recording_options["includes"] = ["*"]
    driver.recording_options["record_derivatives"] = True


def _remove_leftovers(path: Path) -> None:
    for ending in LEFTOVERS:
        path.with_name(path.name + ending).unlink(missing_ok=True)


def _remove(path: Path) -> None:
    path.unlink(missing_ok=True)
    _remove_leftovers(path)


def copy_record(source, target) -> None:
    """Copy a recorder file, also one that a killed process left behind; the copy appears at once.

    Raises
    ------
    ValueError
        When the source is not a SQLite file, or another run writes the target.
    """
    target = Path(target)
    require_free(target)
    if target.exists() and target.samefile(source):
        return
    fresh = target.with_name(target.name + ".new")
    _remove(fresh)
    here, there = sqlite3.connect(source), sqlite3.connect(fresh)
    try:
        here.backup(there)
    except sqlite3.DatabaseError as error:
        there.close()
        _remove(fresh)
        raise ValueError(f"{source} is not a recorder file ({error})") from error
    finally:
        here.close()
        there.close()
    _remove_leftovers(target)
    os.replace(fresh, target)

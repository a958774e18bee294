"""RestartRecorder: a recorder file that remains usable if the process is killed, and that can be
continued."""

import os
import sqlite3
from pathlib import Path

import numpy as np
from openmdao.core.driver import Driver

from seal_mdao.openmdao_access import (
    SqliteHooks,
    doe_failure,
    find_value,
    problem_of,
    run_afterwards,
)
from seal_mdao.recording import run_log
from seal_mdao.recording.claim import claim, require_free
from seal_mdao.recording.plain_reading import without_programs
from seal_mdao.recording.recorded_seals import inputs_of_seals, outputs_of_seals

LEFTOVERS = ("-journal", "-wal", "-shm")
"""Files that SQLite leaves beside a file when a process is killed; they belong to that file only."""


class RestartRecorder(SqliteHooks):
    """SqliteRecorder whose file remains usable if the process is killed, and that can append to a
    file.

    Every case is a transaction of its own, as in ``SqliteRecorder``, so a killed run loses only the
    evaluation in progress. In addition, a new file takes its name only when it contains all that a
    reader needs; until then a file of that name from an earlier run stays unchanged. With ``append`` the
    cases of an existing file are kept and new ones follow them; evaluations that the driver takes from
    the file (``hotstart_file``) are not recorded twice. The file also records how every run ended; see
    ``seal_mdao.recording.run_log``.

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
        self._unpublished = self._driver = self._log_row = self._seals = self._lock = None
        # whether the run has recorded a case; whether an earlier run is in the log
        self._has_cases = self._has_logged = False

    def startup(self, recording_requester, comm=None):
        """Prepare for a new run."""
        if self.is_started(recording_requester):
            return
        counter = self.counter
        super().startup(recording_requester, comm)
        if self._append and self.connection:
            # new cases are numbered after those of the file
            query = "SELECT MAX(counter) FROM driver_iterations"
            counter = max(counter, self.connection.execute(query).fetchone()[0] or 0)
        self.counter = counter
        if isinstance(recording_requester, Driver):
            self._driver = recording_requester

    def record_metadata_system(self, system, run_number=None):
        """Record the options of a system once per run number; the root's make the file complete."""
        self._once(super().record_metadata_system, system, run_number)
        # variables and tree have been recorded before: with these options the file is complete
        if not system.pathname and self.connection:
            if self._has_cases:
                # another run begins, so the one before has ended
                self.note_end()
                self._log_row, self._has_cases, self._has_logged = None, False, True
            elif not self._append and not self._has_logged:
                self._log_begin()
            self._publish()

    def record_metadata_solver(self, solver, run_number=None):
        """Record the options of a solver once per run number."""
        self._once(super().record_metadata_solver, solver, run_number)

    def record_iteration_driver(self, driver, data, metadata):
        """Record a case, unless the driver took it from this file; always with the inputs of seals,
        without variables that do not belong to its design."""
        if self._repeated(driver) is not None:
            # OpenMDAO has counted the case already
            self.counter -= 1
            return
        # variables of all seals, listed once
        if self._seals is None:
            model = problem_of(driver).model
            self._seals = inputs_of_seals(model), outputs_of_seals(model)
        self._add_inputs(driver, data)
        _remove_not_computed(driver, data)
        failure = doe_failure(driver)
        if not failure and self._has_failed(driver):
            failure = "the analysis of a seal failed"
        if metadata["success"] and failure:
            metadata = metadata | {"success": 0, "msg": failure}
        self._log_begin()
        self._has_cases = True
        super().record_iteration_driver(driver, data, metadata)

    def record_derivatives_driver(self, driver, data, metadata):
        """Record derivatives with the number of the case to which they belong."""
        repeated = self._repeated(driver)
        if repeated is None:
            super().record_derivatives_driver(driver, data, metadata)
        elif self.connection and not self._has_derivatives(repeated):
            # under the number of the repeated case, which lacks them
            counter, self.counter = self.counter, repeated
            super().record_derivatives_driver(driver, data, metadata)
            self.counter = counter

    def _add_inputs(self, driver, data) -> None:
        """Add the inputs of seals, which a report needs whatever lies upstream of them."""
        inputs = problem_of(driver).model.get_nonlinear_vectors()[0]
        for name in self._seals[0] if data["input"] is not None else ():
            value = find_value(inputs, name)
            if value is not None and name not in data["input"]:
                data["input"][name] = value.copy()

    def _has_failed(self, driver) -> bool:
        """Return whether an output of a seal is NaN: OpenMDAO's DOEDriver records failures as good.

        A single row of an output that is NaN is a scenario that was left out, not a failure.
        """
        outputs = problem_of(driver).model.get_nonlinear_vectors()[1]
        values = [find_value(outputs, name) for name in self._seals[1]]
        return any(value is not None and np.isnan(value).all() for value in values)

    def _log_begin(self) -> None:
        """Log that a run writes; for a continued one at its first new case, as it may be refused."""
        if self.connection and self._log_row is None and self._driver is not None:
            self._log_row = run_log.begin(self.connection, self._driver)

    def note_end(self) -> None:
        """Log how the run of the driver ended, before the file is closed."""
        driver = self._driver
        if self._has_logged and not self._has_cases:
            # no run since
            return
        if driver is not None and driver.result.exit_status != run_log.BY_EXCEPTION:
            self._log_begin()
        if self.connection and self._log_row is not None:
            run_log.end(self.connection, self._log_row, driver)

    def shutdown(self):
        """Log how the run ended and close the file."""
        self.note_end()
        self._log_row, self._has_cases, self._has_logged = None, False, False
        if self.connection:
            self._publish()
        super().shutdown()
        self.connection = self.metadata_connection = None
        if self._lock is not None:
            self._lock.release()

    def open_database(self, comm):
        """Open the file to continue, or begin a new one under another name."""
        # on several processes OpenMDAO writes one file per process
        if comm is not None and comm.size > 1:
            if self._append:
                raise RuntimeError(
                    "RestartRecorder can append to an existing recorder file on a single process "
                    "only, not under MPI"
                )
            self.make_database(comm)
            return
        self._lock = claim(self.path)
        path = Path(self.path)
        if self._append and path.is_file():
            self.use_database(without_programs(sqlite3.connect(path)))
            return
        # OpenMDAO creates the database at ``path``: point it to the temporary name meanwhile
        self._unpublished = path.with_name(path.name + ".new")
        _remove(self._unpublished)
        self.path = self._unpublished
        self.make_database(comm)
        self.path = path

    def _publish(self) -> None:
        """Give the new file its name."""
        if self._unpublished is None:
            return
        # SQLite would apply a journal of the old file to the new one
        self.connection.close()
        _remove(Path(self.path), LEFTOVERS)
        os.replace(self._unpublished, self.path)
        self._unpublished = None
        self.use_database(sqlite3.connect(self.path))

    def _repeated(self, driver) -> int | None:
        """Return the number of the case in this file whose evaluation the driver repeats."""
        return getattr(driver, "repeated_case", None) if self._append else None

    def _has_derivatives(self, counter: int) -> bool:
        query = "SELECT 1 FROM driver_derivatives WHERE counter=? LIMIT 1"
        return self.connection.execute(query, (counter,)).fetchone() is not None

    def _once(self, record, requester, run_number) -> None:
        try:
            record(requester, run_number)
        except sqlite3.IntegrityError:
            # the file that is continued contains them already
            if not self._append:
                raise


def _remove_not_computed(driver, data: dict) -> None:
    """Remove the variables of components that run only after the optimisation: their values are those
    of another design."""
    components = run_afterwards(driver)
    for kind in ("input", "output", "residual"):
        own = data[kind] or {}
        for name in [name for name in own if name.rpartition(".")[0] in components]:
            del own[name]


def record_all(driver, recorder) -> None:
    """Make a driver record all that a restart needs: every variable, and the derivatives."""
    driver.add_recorder(recorder)
    driver.recording_options["includes"] = ["*"]
    driver.recording_options["record_derivatives"] = True


def copy_record(source, target) -> None:
    """Copy a recorder file, even one of a killed process; the copy appears under its name at once.

    Raises
    ------
    ValueError
        If the source is not a SQLite file, or another run writes the target.
    """
    target = Path(target)
    require_free(target)
    if target.exists() and target.samefile(source):
        return
    fresh = target.with_name(target.name + ".new")
    _remove(fresh)
    here, there = sqlite3.connect(source), sqlite3.connect(fresh)
    try:
        # reads the journal of a killed process as well
        here.backup(there)
    except sqlite3.DatabaseError as error:
        there.close()
        _remove(fresh)
        raise ValueError(f"{source} is not a recorder file ({error})") from error
    finally:
        here.close()
        there.close()
    # replaced in one step, as in ``_publish``
    _remove(target, LEFTOVERS)
    os.replace(fresh, target)


def _remove(path: Path, endings: tuple = ("", *LEFTOVERS)) -> None:
    for ending in endings:
        path.with_name(path.name + ending).unlink(missing_ok=True)

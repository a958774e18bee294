"""Lock of a recorder file: one process writes it at a time."""

import os
from contextlib import suppress
from pathlib import Path

from filelock import FileLock, Timeout


class RecorderBusyError(ValueError):
    """Another run writes the recorder file."""


class Claim:
    """Lock of a recorder file, held until ``release``.

    The operating system releases it when its process ends, however that ends.
    """

    def __init__(self, lock: FileLock):
        self._lock = lock

    def release(self) -> None:
        """Release the lock and delete its file; a second call does nothing."""
        if self._lock.is_locked:
            # deleted while it is held: afterwards it may be that of another run
            with suppress(OSError):
                os.unlink(self._lock.lock_file)
            self._lock.release()


def claim(path) -> Claim:
    """Acquire the lock of a recorder file; call ``release`` of it at the end.

    Raises
    ------
    RecorderBusyError
        If another run holds it.
    """
    file = Path(path).absolute()
    name = file.with_name(f".{file.name}.lock")
    while True:
        lock = FileLock(name)
        try:
            lock.acquire(blocking=False)
        except Timeout:
            raise RecorderBusyError(
                f"another process is writing the recorder file {path}; wait until that process "
                "ends, or choose another file"
            ) from None
        # a run that ended in between has deleted the file that this lock is on: try again
        if name.exists():
            return Claim(lock)
        lock.release()


def require_free(path) -> None:
    """Raise RecorderBusyError if another run writes a recorder file."""
    claim(path).release()

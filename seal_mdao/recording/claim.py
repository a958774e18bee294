"""One writer of a recorder file at a time."""

from pathlib import Path

from filelock import FileLock, Timeout


class RecorderBusyError(ValueError):
    """Another run writes the recorder file."""


def lock_of(path) -> FileLock:
    """The lock beside a recorder file; the operating system lets go of it when its process ends."""
    path = Path(path).absolute()
    return FileLock(path.with_name(f".{path.name}.lock"))


def claim(path) -> FileLock:
    """Take the lock of a recorder file; ``release`` gives it back.

    Raises
    ------
    RecorderBusyError
        When another run has it.
    """
    lock = lock_of(path)
    try:
        lock.acquire(blocking=False)
    except Timeout:
        raise RecorderBusyError(
            f"another run is writing {path}; wait for its end, or give this run a file of its own"
        ) from None
    return lock


def require_free(path) -> None:
    """Check that no other run writes a recorder file.

    Raises
    ------
    RecorderBusyError
        When one does.
    """
    claim(path).release()

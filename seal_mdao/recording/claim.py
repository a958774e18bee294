"""Lock of a recorder file: one process writes it at a time."""

from pathlib import Path

from filelock import FileLock, Timeout


class RecorderBusyError(ValueError):
    """Another run writes the recorder file."""


def claim(path) -> FileLock:
    """Acquire the lock of a recorder file; call ``release`` of it at the end.

    Raises
    ------
    RecorderBusyError
        If another run holds it.
    """
    file = Path(path).absolute()
    # the operating system releases the lock when its process ends, however that ends
    lock = FileLock(file.with_name(f".{file.name}.lock"))
    try:
        lock.acquire(blocking=False)
    except Timeout:
        raise RecorderBusyError(
            f"another run is writing {path}; wait for its end, or give this run a file of its own"
        ) from None
    return lock


def require_free(path) -> None:
    """Raise RecorderBusyError if another run writes a recorder file."""
    claim(path).release()

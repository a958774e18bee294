"""What happens in a worker: tasks that are kept by their digest, and the end with the parent."""

import os
import pickle
import signal
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Thread

from seal_mdao.scenarios.task import Outcome

KEPT = 4
"""Tasks that a worker keeps: a problem has one or two."""
_tasks = {}


def perform(key: str, packed: bytes | Path | None, offsets, parameters) -> Outcome | None:
    """Run one scenario of the task whose digest is ``key``.

    Parameters
    ----------
    packed : bytes, Path or None
        The pickled task, or the file that it is in. Left out at first, so that a scenario sends no more
        than its numbers.

    Returns
    -------
    Outcome, or None
        None when this worker does not know the task yet: ask again with ``packed``.
    """
    task = _tasks.get(key)
    if task is None:
        if packed is None:
            return None
        task = _unpacked(key, packed)
    return task.run(offsets, parameters)


def _unpacked(key: str, packed: bytes | Path):
    while len(_tasks) >= KEPT:
        del _tasks[next(iter(_tasks))]
    content = packed.read_bytes() if isinstance(packed, Path) else packed
    return _tasks.setdefault(key, pickle.loads(content))


def begin(leash: Connection, begun) -> None:
    """Begin a worker process that ends with its parent, however that ends.

    ``begun``, shared with the parent, becomes 1: the script of this worker could be imported. Ctrl-C
    goes to all processes of a terminal; the parent alone decides what it means.
    """
    begun.value = 1
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with, args=(leash,), daemon=True).start()


def _end_with(leash: Connection) -> None:
    try:
        leash.recv()
    except (EOFError, OSError):
        os._exit(1)

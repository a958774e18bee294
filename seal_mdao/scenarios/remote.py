"""Code of a worker process: cached tasks, and termination with the parent process."""

import os
import pickle
import signal
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Thread

from seal_mdao.scenarios.task import Outcome

KEPT = 4
"""Number of tasks that a worker caches; a problem has one or two."""
_tasks = {}


def perform(key: str, packed: bytes | Path | None, offsets, parameters) -> Outcome | None:
    """Run one scenario of the task whose digest is ``key``.

    Parameters
    ----------
    packed : bytes, Path or None
        The pickled task, or its file. None at first, so that a scenario transfers its numbers only.

    Returns
    -------
    Outcome, or None
        None if this worker does not have the task yet: call again with ``packed``.
    """
    task = _tasks.get(key)
    if task is None:
        if packed is None:
            return None
        task = _unpacked(key, packed)
    return task.run(offsets, parameters)


def _unpacked(key: str, packed: bytes | Path):
    # first in, first out
    while len(_tasks) >= KEPT:
        del _tasks[next(iter(_tasks))]
    content = packed.read_bytes() if isinstance(packed, Path) else packed
    return _tasks.setdefault(key, pickle.loads(content))


def begin(leash: Connection, begun) -> None:
    """Initialise a worker process that ends with its parent, however that ends.

    ``begun``, shared with the parent, is set to 1: the script of this worker could be imported. Ctrl-C
    is sent to all processes of a terminal; only the parent handles it.
    """
    begun.value = 1
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with, args=(leash,), daemon=True).start()


def _end_with(leash: Connection) -> None:
    try:
        # nothing is ever sent: this returns with an error once the parent is gone
        leash.recv()
    except (EOFError, OSError):
        os._exit(1)

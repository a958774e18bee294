"""What happens in a worker: tasks that are kept by their digest, and the end with the parent."""

import os
import signal
from multiprocessing.connection import Connection
from threading import Thread

from seal_mdao.scenarios.task import Outcome

KEPT = 4
"""Tasks that a worker keeps: a problem has one or two."""
_tasks = {}


def perform(key: str, packed: bytes | None, offsets, parameters) -> Outcome | None:
    """Run one scenario of the task whose digest is ``key``.

    Parameters
    ----------
    packed : bytes, or None
        The pickled task. Left out at first, so that a scenario sends no more than its numbers.

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


def _unpacked(key: str, packed: bytes):
    import pickle

    while len(_tasks) >= KEPT:
        del _tasks[next(iter(_tasks))]
    return _tasks.setdefault(key, pickle.loads(packed))


def begin(leash: Connection) -> None:
    """Begin a worker process that ends with its parent, however that ends.

    Ctrl-C goes to all processes of a terminal; the parent alone decides what it means.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with, args=(leash,), daemon=True).start()


def _end_with(leash: Connection) -> None:
    try:
        leash.recv()
    except (EOFError, OSError):
        os._exit(1)

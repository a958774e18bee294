"""Worker processes on this machine that can be terminated and replaced."""

import multiprocessing
import os
import signal
import sys
from concurrent.futures import Future, ProcessPoolExecutor
from multiprocessing.connection import Connection
from threading import Thread

from seal_mdao import values


class Processes:
    """Process pool that is started on first use and stays until it is ended.

    Its processes are spawned, since the threads of numba and BLAS do not survive a fork. They end with
    this process, even if it is killed: each holds one end of a pipe whose other end exists here only.

    Parameters
    ----------
    count : int
        Number of processes.

    Attributes
    ----------
    begun : bool
        Whether any of them has ever been ready to work.
    """

    def __init__(self, count: int):
        self.count = values.integer("number of worker processes", count, 1)
        self._context = multiprocessing.get_context("spawn")
        # a value without a lock, which a killed worker could hold for ever
        self._begun = self._context.RawValue("b", 0)
        self._pool = self._leash = None

    @property
    def begun(self) -> bool:
        return bool(self._begun.value)

    def submit(self, function, *arguments) -> Future:
        """Submit a call, as ``Executor.submit``; start the processes on first use."""
        if self._pool is None:
            if getattr(multiprocessing.current_process(), "_inheriting", False):
                # a worker that imports a script without the guard __main__: the parent reports it once,
                # the traceback of every worker would hide its message
                sys.exit(1)
            # the workers wait for the end of this pipe, which closes with this process
            receiver, self._leash = self._context.Pipe(duplex=False)
            shared = receiver, self._begun
            self._pool = ProcessPoolExecutor(self.count, self._context, _begin, shared)
        try:
            return self._pool.submit(function, *arguments)
        except OSError:
            # a worker died while another one was starting, and the pool has closed the queues that this
            # one was to be given; asked again, it raises BrokenProcessPool
            return self._pool.submit(function, *arguments)

    def end(self) -> None:
        """Terminate all processes now; the next ``submit`` starts new ones."""
        if self._pool is not None:
            self._leash.close()
            self._pool.shutdown(cancel_futures=True)
            self._pool = self._leash = None

    def __enter__(self) -> "Processes":
        return self

    def __exit__(self, *exception) -> None:
        self.end()


def _begin(leash: Connection, begun) -> None:
    """Initialise a worker process that ends with its parent, however that ends."""
    # shared with the parent: the script of this worker could be imported
    begun.value = 1
    # Ctrl-C is sent to all processes of a terminal; only the parent handles it
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with, args=(leash,), daemon=True).start()


def _end_with(leash: Connection) -> None:
    try:
        # nothing is ever sent: this returns with an error once the parent is gone
        leash.recv()
    except (EOFError, OSError):
        os._exit(1)

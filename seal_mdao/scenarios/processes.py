"""Worker processes of this machine that can be ended at once, and replaced."""

import multiprocessing
from concurrent.futures import Future, ProcessPoolExecutor

from seal_mdao import values
from seal_mdao.scenarios.remote import begin


class Processes:
    """A ``ProcessPoolExecutor`` that is made when it is first needed and stays until it is ended.

    Its processes are spawned, since numba's and BLAS' threads do not survive a fork. They end with this
    process, even where that is killed: each holds one end of a pipe whose other end is here alone.

    Parameters
    ----------
    count : int
        Processes.

    Attributes
    ----------
    answered : bool
        Whether one of them has ever given a result.
    """

    def __init__(self, count: int):
        self.count = values.integer("number of worker processes", count, 1)
        self.answered = False
        self._pool = self._leash = None

    def submit(self, function, *arguments) -> Future:
        """As of an executor."""
        if self._pool is None:
            self._start()
        return self._pool.submit(function, *arguments)

    def _start(self):
        context = multiprocessing.get_context("spawn")
        held, self._leash = context.Pipe(duplex=False)
        self._pool = ProcessPoolExecutor(self.count, context, begin, (held,))

    def end(self) -> None:
        """End all processes now, whatever they do; the next ``submit`` starts others."""
        if self._pool is not None:
            self._leash.close()
            self._pool.shutdown(cancel_futures=True)
            self._pool = self._leash = None

    def __enter__(self) -> "Processes":
        return self

    def __exit__(self, *exception) -> None:
        self.end()

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
    begun : bool
        Whether one of them has ever been ready to work.
    """

    def __init__(self, count: int):
        self.count = values.integer("number of worker processes", count, 1)
        self._context = multiprocessing.get_context("spawn")
        self._begun = self._context.RawValue(
            "b", 0
        )  # without a lock that a killed worker would hold
        self._pool = self._leash = None

    @property
    def begun(self) -> bool:
        return bool(self._begun.value)

    def submit(self, function, *arguments) -> Future:
        """As of an executor."""
        if self._pool is None:
            self._start()
        return self._pool.submit(function, *arguments)

    def _start(self):
        held, self._leash = self._context.Pipe(duplex=False)
        self._pool = ProcessPoolExecutor(self.count, self._context, begin, (held, self._begun))

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

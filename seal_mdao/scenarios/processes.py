"""Worker processes on this machine that can be terminated and replaced."""

import multiprocessing
from concurrent.futures import Future, ProcessPoolExecutor

from seal_mdao import values
from seal_mdao.scenarios.remote import begin


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
            self._start()
        return self._pool.submit(function, *arguments)

    def _start(self):
        # the workers wait for the end of this pipe, which closes with this process
        receiver, self._leash = self._context.Pipe(duplex=False)
        self._pool = ProcessPoolExecutor(self.count, self._context, begin, (receiver, self._begun))

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

"""Scenarios on any executor, bitwise independent of the worker and of the order."""

import os
import pickle
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from hashlib import sha256
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.task import Outcome, SealTask, run_task

AHEAD = 2
"""Scenarios submitted per process: one in progress, one waiting."""
DIED = (
    "the process of a scenario was killed twice, probably because the memory was exhausted; use "
    "fewer parallel processes"
)

NONE_BEGAN = (
    "worker processes ended twice during start-up; put the code of the script that starts them "
    'under  if __name__ == "__main__":'
)


class Point(NamedTuple):
    """Point at which a task is run: index, boundary offsets (P,), mm, and parameters (N,)."""

    index: int
    offsets: np.ndarray
    parameters: np.ndarray


def usual_workers() -> int:
    """Return the default number of processes: one per core; 0, in this process, on a single core."""
    # cores that this process may use, which may be fewer than the machine has
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return cores if cores and cores > 1 else 0


def run_scenarios(
    task: SealTask, points: Iterable[Point], workers: int | Processes | Executor = 0
) -> Iterator[tuple[int, Outcome]]:
    """Run a task at many points; yield their indices and outcomes as they finish.

    Every point is run independently from its own numbers, so its outcome is bitwise the same wherever
    and whenever it is run.

    Parameters
    ----------
    task : SealTask
    points : iterable of Point
    workers : int, Processes or Executor
        0: in this process. A number of processes, started for this call. ``Processes`` that stay. Any
        ``concurrent.futures.Executor``, such as those of ``mpi4py.futures`` and Dask.
        ``Processes`` that die are replaced and their scenarios repeated once; they are terminated by any
        exception in this process.

    Raises
    ------
    RuntimeError
        If worker processes and their replacements end before they can work.
    ValueError
        For a task that cannot be pickled.
    """
    if isinstance(workers, int):
        if workers == 0:
            yield from ((point.index, task.run(*point[1:])) for point in points)
            return
        with Processes(workers) as own:
            yield from run_scenarios(task, points, own)
        return
    with TemporaryDirectory(prefix="seal_mdao-task-") as folder:
        run = _Run(task, workers, Path(folder))
        try:
            yield from run.outcomes(iter(points))
        except BaseException:
            run.stop()
            raise


class _Run:
    """One task on one executor.

    ``Processes`` read the task from a file, because a pipe holds 64 KB: if a worker dies during the
    transfer of more, Python before 3.12 hangs.
    """

    def __init__(self, task, workers, folder: Path):
        self._workers, self._nothing = workers, np.full(task.count, np.nan)
        self._running, self._dead = {}, []
        self._replaceable = isinstance(workers, Processes)
        self._ahead = AHEAD * workers.count if self._replaceable else None
        try:
            # pickled once; workers identify the task by its digest
            packed = pickle.dumps(task)
        except Exception as error:  # any error of any part of the task
            raise ValueError(
                "the scenarios cannot run in parallel, because the seal or a measure cannot be "
                f"sent to another process ({error}); run them one after the other with workers=0"
            ) from error
        self._key, self._packed = sha256(packed).hexdigest(), packed
        if self._replaceable:
            self._packed = folder / "task"
            self._packed.write_bytes(packed)

    def stop(self) -> None:
        """Cancel all running scenarios."""
        for future in self._running:
            future.cancel()
        if self._replaceable:
            self._workers.end()

    def outcomes(self, points) -> Iterator[tuple[int, Outcome]]:
        """Yield indices and outcomes, as ``run_scenarios``."""
        while True:
            # keep AHEAD scenarios per process submitted; other executors get all at once
            free = None if self._ahead is None else self._ahead - len(self._running)
            for point in islice(points, free):
                self._submit(point)
            if not (self._running or self._dead):  # all points are done
                return
            yield from self._finished()
            if self._dead:
                yield from self._repeated()

    def _submit(self, point: Point, packed=None) -> None:
        """Submit a point, at first without the task."""
        try:
            self._running[self._future(point, packed)] = point
        except BrokenExecutor:
            if not self._replaceable:
                raise
            self._dead.append(point)

    def _future(self, point: Point, packed) -> Future:
        return self._workers.submit(run_task, self._key, packed, *point[1:])

    def _finished(self) -> list:
        """Collect the finished outcomes, and the points whose worker may have died."""
        # at least one has finished
        done, _ = wait(self._running, return_when=FIRST_COMPLETED)
        finished = []
        for future in done:
            point = self._running.pop(future)
            if self._replaceable and isinstance(future.exception(), BrokenExecutor):
                self._dead.append(point)
                continue
            outcome = future.result()
            if outcome is None:  # the worker does not have the task yet
                self._submit(point, self._packed)
            else:
                finished.append((point.index, outcome))
        return finished

    def _repeated(self) -> Iterator[tuple[int, Outcome]]:
        """Replace the processes and repeat the lost points one by one, to identify the cause."""
        # the pool is broken: every running scenario ends with an exception
        while self._running:
            yield from self._finished()
        dead, self._dead = self._dead, []
        self._workers.end()
        for point in dead:
            try:
                yield point.index, self._future(point, self._packed).result()
            except BrokenExecutor:
                self._workers.end()
                if not self._workers.begun:
                    raise RuntimeError(NONE_BEGAN) from None
                yield point.index, Outcome(self._nothing, None, DIED, 0.0)

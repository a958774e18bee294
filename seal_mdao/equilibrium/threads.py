"""Limit BLAS to one thread during analyses and sensitivities.

Matrices of a few hundred unknowns gain nothing from threads, are slowed down when several runs share a
machine, and their rounding would depend on the number of threads.
"""

from concurrent.futures import ThreadPoolExecutor
from contextlib import ContextDecorator
from threading import Lock, local

from threadpoolctl import ThreadpoolController


class OneBlasThread(ContextDecorator):
    """Context manager and decorator that limits BLAS to one thread.

    Most BLAS libraries have one number of threads for the process: the first thread to enter sets it,
    the last to leave restores the number before. Where each calling thread has a number of its own,
    each sets and restores its own. Nested calls and exceptions are allowed for.
    """

    def __init__(self):
        # _inside: threads of the process within the context, guarded by the lock;
        # _of_process, _of_thread: limits to undo, of libraries with one number a process or a thread
        self._lock, self._inside = Lock(), 0
        self._libraries, self._of_process, self._of_thread = None, [], local()

    def __enter__(self):
        # nested entries of a thread count in ``depth``; only the outermost sets limits
        mine = self._of_thread
        mine.depth = getattr(mine, "depth", 0) + 1
        if mine.depth == 1:
            mine.limits = []
            with self._lock:
                self._inside += 1
                self._limit(of_process=self._inside == 1)
        return self

    def __exit__(self, *exception):
        mine = self._of_thread
        mine.depth -= 1
        if mine.depth > 0:
            return
        with self._lock:
            # limits of this thread first, then those of the process if it was the last one inside
            _restore(mine.limits)
            self._inside -= 1
            if self._inside == 0:
                _take_control(self._libraries)
                _restore(self._of_process)
                _take_control(self._libraries)

    def _limit(self, of_process: bool):
        if self._libraries is None:
            self._libraries = ThreadpoolController().select(user_api="blas")
            self._shared, self._own = _split(self._libraries)
        if of_process:
            _take_control(self._libraries)
            self._of_process.append(self._shared.limit(limits=1))
        self._of_thread.limits.append(self._own.limit(limits=1))


def _restore(limits: list) -> None:
    """Undo limits in reverse order and clear the list."""
    while limits:
        limits.pop().restore_original_limits()


def _take_control(libraries: ThreadpoolController) -> None:
    """Allow this thread to set the number of threads, which threadpoolctl may reserve for another."""
    for library in libraries.lib_controllers:
        if hasattr(library, "clear_controlling_thread"):
            library.clear_controlling_thread(force=True)


def _split(libraries: ThreadpoolController):
    """Split libraries into those with one number of threads a process and those with one a thread."""
    _take_control(libraries)
    # limit in this thread and look from another one: what it sees limited is shared by the process
    limit = libraries.limit(limits=1)
    with ThreadPoolExecutor(1) as another:
        seen = another.submit(libraries.info).result()
    limit.restore_original_limits()
    by_path = {True: [], False: []}
    for library in seen:
        by_path[library["num_threads"] == 1].append(library["filepath"])
    return (libraries.select(filepath=by_path[is_shared]) for is_shared in (True, False))


one_blas_thread = OneBlasThread()
"""The instance of this process, as a decorator or in a ``with`` statement."""

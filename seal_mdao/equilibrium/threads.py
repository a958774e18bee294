"""One BLAS thread while anything is analysed or differentiated.

Bands of a few hundred unknowns gain nothing from threads, lose a lot when several runs share a
machine, and their rounding would depend on the number of threads.
"""

from concurrent.futures import ThreadPoolExecutor
from contextlib import ContextDecorator
from threading import Lock, local

from threadpoolctl import ThreadpoolController


class OneBlasThread(ContextDecorator):
    """Limits BLAS to one thread while any thread of the process is inside.

    Most BLAS libraries have one number of threads for the whole process: the first to enter sets
    it, the last to leave restores what was there before. Where each calling thread has a number of
    its own, each sets and restores its own. Exceptions and nested calls change nothing of this.
    """

    def __init__(self):
        self._lock, self._inside = Lock(), 0
        self._libraries, self._of_process, self._of_thread = None, [], local()

    def __enter__(self):
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
            _restore(mine.limits)
            self._inside -= 1
            if self._inside == 0:
                _take_control(self._libraries)
                _restore(self._of_process)
                _take_control(self._libraries)

    def find_libraries_again(self) -> None:
        """Take in a BLAS library that has just been loaded; limited at once for who is inside."""
        with self._lock:
            self._libraries = None
            if self._inside:
                self._limit(of_process=True)

    def _limit(self, of_process: bool):
        if self._libraries is None:
            self._libraries = ThreadpoolController().select(user_api="blas")
            self._shared, self._own = _split(self._libraries)
        if of_process:
            _take_control(self._libraries)
            self._of_process.append(self._shared.limit(limits=1))
        if getattr(self._of_thread, "depth", 0):
            self._of_thread.limits.append(self._own.limit(limits=1))


def _restore(limits: list) -> None:
    """Undo limits, the last one first, and forget them."""
    while limits:
        limits.pop().restore_original_limits()


def _take_control(libraries: ThreadpoolController) -> None:
    """Let this thread set the number of threads; threadpoolctl may reserve that for another one."""
    for library in libraries.lib_controllers:
        if hasattr(library, "clear_controlling_thread"):
            library.clear_controlling_thread(force=True)


def _split(libraries: ThreadpoolController):
    """Libraries with one number of threads for the process, and those with one for each thread."""
    _take_control(libraries)
    limit = libraries.limit(limits=1)
    with ThreadPoolExecutor(1) as another:
        seen = another.submit(libraries.info).result()
    limit.restore_original_limits()
    by_path = {True: [], False: []}
    for library in seen:
        by_path[library["num_threads"] == 1].append(library["filepath"])
    return (libraries.select(filepath=by_path[is_shared]) for is_shared in (True, False))


one_blas_thread = OneBlasThread()
"""The one of this process, as a decorator or in a ``with`` statement."""

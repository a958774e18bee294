"""One BLAS thread for the many small factorisations of a load path.

Bands of a few hundred unknowns gain nothing from threads, lose a lot when several runs share a
machine, and their rounding would depend on the number of threads.
"""

from functools import cache, wraps

from threadpoolctl import ThreadpoolController


@cache
def _controller() -> ThreadpoolController:
    return ThreadpoolController()


def forget_libraries() -> None:
    """Look for BLAS libraries again: one has been loaded."""
    _controller.cache_clear()


def one_blas_thread(function):
    """Run ``function`` with BLAS limited to one thread; the setting is restored afterwards."""

    @wraps(function)
    def limited(*args, **kwargs):
        with _controller().limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited

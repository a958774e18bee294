"""Python's cyclic garbage collector in a command."""

import atexit
import gc


def collect_less() -> None:
    """Leave imported objects out of garbage collections, collect a tenth as often, and not at the end;
    once in a process.

    What is imported is no garbage, and its first collection alone takes 0.13 s; nor are most of the
    objects of a run. At its end Python would look at all objects several times, for 0.4 s, although the
    operating system frees the memory.
    """
    if gc.get_freeze_count() == 0:
        gc.freeze()
        gc.set_threshold(10 * gc.get_threshold()[0])
        atexit.register(gc.freeze)

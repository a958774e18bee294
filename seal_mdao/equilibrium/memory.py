"""Keep freed memory of the process for the next load step, with the allocator of glibc.

Every iteration allocates a tangent of some MB and frees it. glibc returns such blocks to the operating
system, which fills every new page with zeros: a fourth of the time of an analysis of the door seal.
"""

import ctypes
import os
import platform
from functools import cache

# <malloc.h>: parameters of mallopt
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
LARGEST = 32 * 2**20
"""Blocks up to this size are taken from memory that was freed, bytes; glibc allows no more."""
KEPT = 4 * LARGEST
"""Most freed memory at the end of the heap that the process keeps, bytes."""


@cache
def keep_freed_memory() -> None:
    """Set both thresholds of glibc's allocator for the process, at the first call.

    Nothing is changed with another C library, or where environment variables of glibc already set its
    allocator (``MALLOC_TRIM_THRESHOLD_``, ``GLIBC_TUNABLES``, ...).
    """
    chosen = any(name.startswith(("MALLOC_", "GLIBC_TUNABLES")) for name in os.environ)
    if chosen or platform.libc_ver()[0] != "glibc":
        return
    mallopt = ctypes.CDLL(None).mallopt
    mallopt(M_MMAP_THRESHOLD, LARGEST)
    mallopt(M_TRIM_THRESHOLD, KEPT)

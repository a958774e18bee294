"""Compile kernels with numba, cache them on disk, and announce compilation to the user.

Most of the compilation time goes to the wrappers of a kernel. So kernels that only other kernels call
get no wrapper for calls from Python (``internal``), none gets one for calls from C, and Python's cyclic
garbage collector is off meanwhile.

Numba caches a compiled kernel by its own source file. After an upgrade that is not enough: a kernel
whose file is unchanged would continue to use the old code of the kernels it calls, and types that have
moved cannot be unpickled. So there is a cache folder for every state of the sources. It lies in the
user's cache, not beside the modules: pip leaves files that it did not install when it removes a package,
and Python imports the remaining folder as a namespace package.
"""

import atexit
import gc
import hashlib
import os
import pickle
import shutil
import sys
import tempfile
import time
import warnings
from contextlib import suppress
from functools import cache
from pathlib import Path

import numba
from numba import config
from numba.core import caching, event
from numba.core.caching import CacheImpl, IndexDataCacheFile, _CacheLocator
from numba.extending import register_jitable
from platformdirs import user_cache_path

MESSAGE = (
    "seal_mdao: compiling numerical code (10 to 20 s, longer when busy), which later runs reuse ..."
)
ANNOUNCED = "SEAL_MDAO_COMPILATION_ANNOUNCED"
"""Environment variable set by the process that printed the message; its child processes print none."""

DAMAGED = "seal_mdao: {path} (compiled code) is damaged; it is compiled again ..."
DAMAGE_ANNOUNCED = "SEAL_MDAO_DAMAGE_ANNOUNCED"
"""Environment variable set by the process that printed ``DAMAGED``."""

PACKAGE = Path(__file__).parent
KERNEL_FOLDERS = (
    "contact", "equilibrium", "geometry", "loads", "materials", "rkpm", "structure", "terms",
)  # fmt: skip
"""Folders of the package with compiled functions and everything that these call."""
FOLDER_PREFIX = "seal_mdao-"
ABANDONED = 7 * 24 * 3600.0
"""Seconds after which cached kernels of other sources are deleted."""


@cache
def sources_key() -> str:
    """Compute a digest of the sources of all kernels, of this module, and of numba's version."""
    files = (path for name in KERNEL_FOLDERS for path in (PACKAGE / name).glob("*.py"))
    files = [Path(__file__), *sorted(files)]  # this module defines the format on disk
    text = numba.__version__.encode() + b"".join(path.read_bytes() for path in files)
    return hashlib.sha256(text).hexdigest()[:16]


@cache
def cache_base() -> Path:
    """Return the cache folder for kernels of all states of the sources.

    NUMBA_CACHE_DIR, else the user's cache; where that is not writable, a temporary folder that is
    deleted at the end of the process, with one warning.
    """
    base = Path(config.CACHE_DIR) if config.CACHE_DIR else user_cache_path("seal_mdao")
    try:
        base.mkdir(parents=True, exist_ok=True)
        # permissions alone do not show whether a folder is writable (read-only mounts, quotas)
        tempfile.TemporaryFile(dir=base).close()
    except OSError:
        return _temporary_base(base)
    return base


def _temporary_base(refused: Path) -> Path:
    """Create a cache folder for this process and its child processes."""
    folder = tempfile.mkdtemp(prefix="seal_mdao-kernels-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    # child processes inherit the folder by the environment
    os.environ["NUMBA_CACHE_DIR"] = config.CACHE_DIR = folder
    warnings.warn(
        f"the cache folder {refused} is not writable: the kernels of seal_mdao are recompiled in "
        "every run; set the environment variable NUMBA_CACHE_DIR to a writable folder",
        stacklevel=2,
    )
    return Path(folder)


class KernelLocator(_CacheLocator):
    """Location of numba's cache files of a kernel: the folder of this state of the sources."""

    def __init__(self, py_func, py_file: str):
        self._py_func, self._part = py_func, Path(py_file).parent.relative_to(PACKAGE)

    @classmethod
    def from_function(cls, py_func, py_file):
        """Return the locator of a function of this package, None for others (numba tries the next)."""
        return cls(py_func, py_file) if py_file.startswith(f"{PACKAGE}{os.sep}") else None

    def get_cache_path(self):
        return str(cache_base() / (FOLDER_PREFIX + sources_key()) / self._part)

    def get_source_stamp(self):
        return sources_key()

    def get_disambiguator(self):
        # two kernels of one name in a module differ by their first line
        return str(self._py_func.__code__.co_firstlineno)

    def ensure_cache_path(self):
        # a new state of the sources is the time to delete old ones
        if not os.path.isdir(self.get_cache_path()):
            _delete_abandoned()
        super().ensure_cache_path()


class KernelFiles(IndexDataCacheFile):
    """Numba's cache files of a kernel of this package, each preceded by a digest of its content.

    Numba loads files unchecked, and a damaged one raises in pickle or crashes in the machine code. Here
    such a file counts as missing, so that the kernel is compiled again and the file replaced.
    """

    def _load_index(self):
        found = _content(self._index_path)
        return {} if found is None else found

    def _save_index(self, overloads):
        self._write(self._index_path, overloads)

    def _load_data(self, name):
        return _content(self._data_path(name))

    def _save_data(self, name, data):
        self._write(self._data_path(name), data)

    def _write(self, path, content):
        packed = self._dump(content)
        with self._open_for_write(path) as file:
            file.write(_digest(packed) + packed)


def _content(path: str):
    """Read the content of a cache file; None where it is missing or damaged."""
    try:
        content = Path(path).read_bytes()
    except OSError:
        return None
    # layout: digest of fixed size, then the pickled content; compared before it is unpickled
    size = len(_digest(b""))
    if _digest(content[size:]) != content[:size]:
        _announce_damage(path)
        return None
    return pickle.loads(content[size:])


def _digest(packed: bytes) -> bytes:
    return hashlib.sha256(packed).digest()


def _announce_damage(path: str) -> None:
    """Print one line about the first damaged file, instead of the message on compilation."""
    if DAMAGE_ANNOUNCED not in os.environ:
        os.environ[DAMAGE_ANNOUNCED] = os.environ[ANNOUNCED] = "1"
        print(DAMAGED.format(path=path), file=sys.stderr, flush=True)


def _files(cache_path: str, filename_base: str, source_stamp) -> IndexDataCacheFile:
    """Return the cache files of a kernel: ``KernelFiles`` for this package, else those of numba."""
    kind = KernelFiles if source_stamp == sources_key() else IndexDataCacheFile
    return kind(cache_path, filename_base, source_stamp)


def _delete_abandoned() -> None:
    """Delete cache folders that have not changed for ``ABANDONED`` seconds."""
    for folder in cache_base().glob(FOLDER_PREFIX + "*"):
        with suppress(OSError):  # another process may be deleting it
            if time.time() - folder.stat().st_mtime > ABANDONED:
                shutil.rmtree(folder)


class _Compilation(event.Listener):
    """Listener of numba's compilations: print the message at the first kernel of this package, and
    switch off the garbage collector, which would traverse all of numba's objects repeatedly."""

    def __init__(self):
        # depth: a kernel compiles those it calls; collects: whether to switch the collector on again
        self.depth, self.collects = 0, False

    def on_start(self, event):
        module = event.data["dispatcher"].py_func.__module__
        if ANNOUNCED not in os.environ and module.startswith("seal_mdao."):
            os.environ[ANNOUNCED] = "1"
            print(MESSAGE, file=sys.stderr, flush=True)
        if self.depth == 0:
            self.collects = gc.isenabled()
            gc.disable()
        self.depth += 1

    def on_end(self, event):
        self.depth -= 1
        if self.depth == 0 and self.collects:
            if gc.get_freeze_count() == 0:
                # moves all new objects to the oldest generation at once, without traversing them
                gc.freeze()
                gc.unfreeze()
            gc.enable()


# Register the location and the files of the cache for kernels of this package; this must run before the
# first of them is defined.
CacheImpl._locator_classes.insert(0, KernelLocator)
caching.IndexDataCacheFile = _files
event.register("numba:compile", _Compilation())

# error_model numpy: division by zero gives inf or nan without a branch at every division
compiled = numba.njit(cache=True, error_model="numpy", no_cfunc_wrapper=True)
"""Decorator of a kernel."""

internal = register_jitable(cache=True, error_model="numpy", no_cfunc_wrapper=True)
"""Decorator of functions called by kernels only; called from Python they are not compiled."""

inlined = numba.njit(cache=True, error_model="numpy", inline="always", no_cfunc_wrapper=True)
"""Decorator of functions inlined into the kernels that call them."""

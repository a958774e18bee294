"""Where compiled kernels are kept, and what a user sees while they are compiled."""

import os
import pkgutil
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path

import numba as nb
import pytest
from numba.core.dispatcher import Dispatcher

import seal_mdao
from seal_mdao.compilation import (
    ABANDONED,
    ANNOUNCED,
    FOLDER_PREFIX,
    KERNEL_FOLDERS,
    MESSAGE,
    cache_base,
    sources_key,
)

KERNEL = "from seal_mdao.rkpm.kernel import cubic_b_spline; print(cubic_b_spline(0.5)[0])"
KERNEL_AND_TWO_CHILDREN = (
    KERNEL
    + """
import subprocess, sys
for name in ("kernel_derivatives(0.1, 0.2, 1.0)", "cubic_b_spline(1)"):
    code = f"import seal_mdao.rkpm.kernel as k; k.{name}"
    subprocess.run([sys.executable, "-c", code], check=True)
"""
)


def said(code, cache):
    """How often a fresh process, and those that it starts, wrote the message."""
    return written(code, cache).count(MESSAGE)


def written(code, cache):
    """What a fresh process, and those that it starts, wrote to stderr; the result is right."""
    # what the process of the tests has said counts for those that it starts
    env = {name: value for name, value in os.environ.items() if name != ANNOUNCED}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True,
        env={**env, "NUMBA_CACHE_DIR": str(cache)},
    )  # fmt: skip
    assert float(done.stdout) == 1 / 6
    return done.stderr


def compiled(cache):
    return sorted(path for path in cache.rglob("*.nbc"))


def test_the_first_run_says_once_that_it_compiles_and_a_later_one_does_not(tmp_path):
    assert [said(KERNEL, tmp_path) for _ in range(2)] == [1, 0]


def damage(path, kind):
    """A file of a kernel that was cut short, emptied, or has another byte in its middle."""
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 255
    path.write_bytes({"cut": content[: len(content) // 2], "empty": b"", "byte": content}[kind])


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("kind", ["cut", "empty", "byte"])
def test_damaged_kernel_is_compiled_again_with_one_line(tmp_path, ending, kind):
    written(KERNEL, tmp_path)
    for path in tmp_path.rglob(f"*.{ending}"):
        damage(path, kind)
    (line,) = written(KERNEL, tmp_path).splitlines()
    assert line.startswith(f"seal_mdao: {tmp_path}")
    assert line.endswith("(compiled code) is damaged; it is compiled again ...")
    assert written(KERNEL, tmp_path) == ""


def test_processes_that_a_command_starts_say_nothing_again(tmp_path):
    """Though they compile kernels of their own."""
    assert said(KERNEL_AND_TWO_CHILDREN, tmp_path) == 1
    assert len(compiled(tmp_path)) >= 3


def kernels():
    """Every compiled function of the package, by the module that defines it."""
    for found in pkgutil.walk_packages(seal_mdao.__path__, "seal_mdao."):
        for value in vars(import_module(found.name)).values():
            if isinstance(value, Dispatcher) and value.py_func.__module__ == found.name:
                yield found.name, value


def test_every_kernel_is_kept_in_the_folder_of_these_sources():
    found = list(kernels())
    assert {name.split(".")[1] for name, _ in found} == set(KERNEL_FOLDERS)
    for name, kernel in found:
        part = Path(*name.split(".")[1:-1])
        expected = cache_base() / (FOLDER_PREFIX + sources_key()) / part
        assert Path(kernel.stats.cache_path) == expected


def test_no_kernel_may_round_in_another_order():
    """What numba then chooses depends on the layouts and the kernels that a process has met before."""
    assert not [name for name, kernel in kernels() if kernel.targetoptions.get("fastmath")]


def test_kernels_of_others_are_kept_where_numba_says():
    @nb.njit(cache=True)
    def mine(x):
        return x + 1

    assert not Path(mine.stats.cache_path).name.startswith(FOLDER_PREFIX)


def test_kernels_of_other_sources_are_deleted_when_they_are_old(tmp_path):
    said(KERNEL, tmp_path)
    (now,) = tmp_path.iterdir()
    recent, old = (now.with_name(FOLDER_PREFIX + name) for name in ("recent", "old"))
    now.rename(old)
    recent.mkdir()
    past = time.time() - 1.1 * ABANDONED
    os.utime(old, (past, past))
    assert said(KERNEL, tmp_path) == 1
    assert sorted(now.parent.iterdir()) == sorted([now, recent])

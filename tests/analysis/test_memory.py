"""Memory that the iterations free is used again, without new pages from the operating system."""

import os
import platform
import subprocess
import sys

import pytest

SCRIPT = """
import resource
import seal_mdao as sm

def new_pages():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt

seal = sm.door_seal(depth=1.0, n_steps=8)
taken = []
for size in (0.0, 1e-6, 2e-6, 3e-6, 4e-6, 5e-6):
    before = new_pages()
    result = sm.analyze(seal, [size] * seal.n_offsets)
    taken.append(new_pages() - before)
tangent = 8 * result.path.discretization.layout.size / resource.getpagesize()
# the first analyses let the heap grow to its size; under load the system can move pages at any time
print(min(taken[3:]) / tangent)
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="the allocator of glibc")
@pytest.mark.parametrize(("variables", "reused"), [({}, True), ({"MALLOC_TOP_PAD_": "0"}, False)])
def test_a_later_analysis_takes_few_new_pages(variables, reused):
    """Fewer than one tangent has, where each of the 8 load steps would need at least one."""
    own = {n: v for n, v in os.environ.items() if not n.startswith(("MALLOC_", "GLIBC_TUNABLES"))}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], env=own | variables, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    tangents = float(done.stdout)
    assert tangents < 1.0 if reused else tangents > 8.0

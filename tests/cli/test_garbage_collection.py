"""Garbage collections of a command: none of what is imported, none at the end of the process."""

import subprocess
import sys

CODE = """
import atexit, contextlib, gc
from seal_mdao.cli.subcommands import main

counted = []
gc.callbacks.append(lambda phase, _: counted.append(len(gc.get_objects())))
# functions registered before run later
atexit.register(lambda: print(f"{max(counted, default=0)} {len(gc.get_objects())}"))
with contextlib.suppress(SystemExit):
    main(["keys", "--help"])
made_by_the_command = [[number] for number in range(20_000)]
"""


def test_imported_objects_are_left_out_of_collections():
    done = subprocess.run(
        [sys.executable, "-c", CODE], capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    # objects of the largest collection, and those that the end of the process would look at; the
    # command imports more than 100,000
    during, at_the_end = map(int, done.stdout.splitlines()[-1].split())
    assert during < 50_000
    assert at_the_end < 5_000

"""sweep_wrong_inputs.py: none of its wrong inputs ends in a surprise."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from wrong_files import LINES, SOUND
from wrong_inputs import cases

SWEEP = Path(__file__).with_name("sweep_wrong_inputs.py")


@pytest.mark.long
def test_sweep_of_wrong_inputs_has_no_surprise(tmp_path):
    """Each ends in a clear error, a failed path or a result that was checked, in time and memory.

    From a process of its own: the inputs' processes begin with all that the one before them holds.
    """
    command = [sys.executable, SWEEP, "--out", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    counts = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["counts"]
    assert sum(counts.values()) >= 200
    assert set(counts) <= {"clear error", "checked result", "failed path"}


def test_wrong_inputs_of_the_sweep_are_hundreds(tmp_path):
    """And no two have one name."""
    assert all(line in SOUND for line in LINES)
    names = [name for name, _ in cases(tmp_path)]
    assert len(names) >= 200
    assert len(set(names)) == len(names)

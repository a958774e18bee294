"""The package built as a wheel and unpacked where a test wants it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).resolve().parents[2]
TAKEN_OVER = ("PATH", "LD_LIBRARY_PATH", "SYSTEMROOT", "OPENBLAS_CORETYPE", "OPENBLAS_NUM_THREADS")


@pytest.fixture(scope="session")
def wheel(tmp_path_factory):
    """What ``pip wheel .`` makes of a copy of the sources."""
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "seal_mdao", source / "seal_mdao", ignore=ignored)
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", out, source],
        check=True,
    )
    (made,) = out.glob("seal_mdao-*.whl")
    return made


@pytest.fixture
def install(wheel):
    """Unpack the wheel into a folder, over what is there, as an upgrade does."""

    def unpack(folder):
        with ZipFile(wheel) as file:
            file.extractall(folder)

    return unpack


class Run:
    """Python in a process of its own that finds the package in ``folder`` only."""

    def __init__(self, folder, code, home, **variables):
        environment = {name: os.environ[name] for name in TAKEN_OVER if name in os.environ}
        environment |= {"PYTHONPATH": str(folder), "HOME": str(home), **variables}
        self.process = subprocess.Popen(
            [sys.executable, "-B", "-c", code], cwd=folder, env=environment, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip

    def lines(self):
        """What was printed, and what was written to standard error; the process must succeed."""
        out, errors = self.process.communicate(timeout=600)
        assert self.process.returncode == 0, errors
        return out.splitlines(), errors


@pytest.fixture
def start():
    return Run

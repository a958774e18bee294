"""Analyses that several folders look at, and random numbers that belong to a test."""

import gc
import importlib
import json
import os
import signal
from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.cli.arguments import run as run_command
from seal_mdao.cli.subcommands import COMMANDS
from seal_mdao.user_cache import FOLDER

# commands of the tests, also in other processes, choose load steps and penalties and fill sections
# themselves
os.environ[FOLDER] = ""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Tests of a folder stay together: one worker makes what they share and compiles what they run.

    The other worker begins in the middle, and finds most kernels in the cache when it needs them.
    """
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log) if config.getvalue("dist") == "load" else None


FIRST, PLAIN = "dsa", ("calibration", "drivers", "materials", "outline", "restart")
"""The folder whose tests compile most, and those whose tests compile next to nothing."""


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    """The first of two workers compiles; the second meanwhile runs what needs few kernels."""
    plain = [item for item in items if item.path.parent.name in PLAIN]
    others = [item for item in items if item.path.parent.name not in PLAIN]
    others.sort(key=lambda item: item.path.parent.name != FIRST)
    half = len(items) // 2
    items[:] = others[:half] + plain + others[half:]


@pytest.fixture(scope="module", autouse=True)
def _leave_what_is_imported_out_of_garbage_collection():
    """Imported modules and collected tests stay to the end, and every collection goes through them.

    OpenMDAO's recorders ask for a complete one at the end of each run. Without them 114 tests of drivers
    take 13 % less processor time (13.3 s, not 15.3 s).
    """
    gc.collect()
    gc.freeze()


TIGHT = sm.NewtonOptions(tolerance=1e-11)


def design(seed, size):
    """A reproducible random design: boundary offsets within +-``size`` mm."""
    return np.random.default_rng(seed).uniform(-size, size, sm.door_seal().n_offsets)


@pytest.fixture(scope="session")
def tight():
    """Newton tolerance of the gradient checks."""
    return TIGHT


@pytest.fixture(scope="session")
def drawn_model():
    """The door seal with the Newton tolerance of the gradient checks."""
    return sm.door_seal(newton=TIGHT)


@pytest.fixture(scope="session")
def nominal(drawn_model):
    """The nominal seal under the corner door, factors kept."""
    return sm.analyze(drawn_model, keep_factors=True)


@pytest.fixture(scope="session")
def flat():
    """The nominal seal under the wholly flat door, factors kept."""
    return sm.analyze(sm.door_seal(door="flat", newton=TIGHT), keep_factors=True)


@pytest.fixture(scope="session")
def cut():
    """A path with halved steps that cannot be solved as one: too few iterations are allowed."""
    few = sm.NewtonOptions(tolerance=1e-11, max_iterations=3, damped_iterations=0)
    return sm.analyze(sm.door_seal(newton=few, n_steps=20), keep_factors=True)


@pytest.fixture(scope="session")
def frictionless():
    """Nominal seal without friction, pressed 3 mm."""
    model = sm.door_seal(friction=0.0, depth=3.0, n_steps=35, newton=TIGHT)
    return sm.analyze(model, keep_factors=True)


@pytest.fixture(scope="session")
def buckled():
    """Nominal seal without friction pressed 10 mm: it buckles sideways, and too little damped motion is
    allowed for the path to be completed."""
    return sm.analyze(sm.door_seal(friction=0.0, newton=sm.NewtonOptions(damped_iterations=80)))


@pytest.fixture(scope="session")
def random_offsets():
    """One design within +-0.2 mm."""
    return design(7, 0.2)


@pytest.fixture(scope="session")
def random_design(drawn_model, random_offsets):
    """That design with a corner radius of its own, factors kept."""
    return sm.analyze(drawn_model, random_offsets, {"door_radius": 4.1}, keep_factors=True)


@pytest.fixture
def rng(request):
    """Random numbers that depend on the name of the test only."""
    return np.random.default_rng(list(request.node.name.encode()))


@pytest.fixture(scope="session")
def run_script():
    """Run a script in this process; returns its exit code and summary.json (None without)."""

    def run(name, out, *arguments):
        script = importlib.import_module(f"seal_mdao.cli.{name}" if name in COMMANDS else name)
        argv = ["--out", str(out), *map(str, arguments)]
        code = run_command(script.arguments_parser(), script.main, argv)
        summary = Path(out) / "summary.json"
        return code, json.loads(summary.read_text()) if summary.exists() else None

    return run


@pytest.fixture(scope="session")
def refusing_script(run_script):
    """What ``seal-mdao analyze`` says of a seal file, in one line with exit status 2."""

    def said(path, capsys):
        assert run_script("analyze", path.parent / "out", path) == (2, None)
        captured = capsys.readouterr()
        # the first look at a profile may have to compile
        (line,) = (line for line in captured.err.splitlines() if "compiling" not in line)
        return line

    return said


@pytest.fixture
def hear_ctrl_c():
    """Preparation of a new process: jobs that a shell has put into the background ignore Ctrl-C."""
    return lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)

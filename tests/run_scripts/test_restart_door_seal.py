"""optimize_door_seal.py killed and continued: the same optimum, and nothing analysed twice."""

import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import openmdao.api as om
import pytest
from script_runs import CHEAP, SCRIPTS

from seal_mdao.optimization import OPTIMIZERS
from seal_mdao.recording import run_log

USED, OTHER, *_ = OPTIMIZERS
"""The optimiser of a run without options, and another one."""

NEW_NUMBERS = ("wall_s", "model_evaluations", "reused_evaluations")
"""What a continued run says of itself, not of the optimisation."""


def designs(path):
    """All recorded designs in order, shape (n, 26)."""
    reader = om.CaseReader(str(path))
    cases = [reader.get_case(n) for n in reader.list_cases("driver", out_stream=None)]
    both = [case.get_design_vars(scaled=False) for case in cases]
    rows = [np.append(case["boundary_offsets"], case["door_radius"]) for case in both]
    return np.reshape(rows, (-1, 26))


def killed_run(out, after_cases, delay):
    """Start the script; kill -9 it ``delay`` seconds after it has recorded ``after_cases`` cases."""
    command = [sys.executable, str(SCRIPTS / "optimize_door_seal.py"), "--out", str(out), *CHEAP]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        while recorded(out / "cases.sql") < after_cases:
            assert process.poll() is None, process.stderr.read()
            time.sleep(2e-3)
        time.sleep(delay)
        os.kill(process.pid, signal.SIGKILL)
        assert process.wait() == -signal.SIGKILL


def recorded(path):
    """Number of cases in a recorder file that is being written, -1 while there is none."""
    if not path.exists():
        return -1
    connection = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
    try:
        return connection.execute("SELECT COUNT(*) FROM driver_iterations").fetchone()[0]
    except sqlite3.OperationalError:
        return -1
    finally:
        connection.close()


@pytest.mark.parametrize(
    "after_cases",
    [4, pytest.param(0, marks=pytest.mark.long), pytest.param(1, marks=pytest.mark.long)],
)
def test_killed_run_goes_on_where_it_was(after_cases, tmp_path, run_script, optimised, rng):
    whole, _, expected = optimised
    killed_run(tmp_path, after_cases, rng.uniform(0.0, 0.1))
    already = designs(tmp_path / "cases.sql")
    every = designs(whole / "cases.sql")
    assert after_cases <= len(already) <= len(every)
    assert np.array_equal(already, every[: len(already)])
    code, s = run_script("optimize_door_seal", tmp_path, "--restart", tmp_path / "cases.sql")
    assert code == 0
    assert s["reused_evaluations"] == max(len(already) - 1, 0)
    assert s["recorded_evaluations"] == len(every)
    assert np.array_equal(designs(tmp_path / "cases.sql"), every)
    for key in expected.keys() - set(NEW_NUMBERS):
        assert s[key] == expected[key], key
    assert [run.cut_off for run in run_log.read(tmp_path / "cases.sql")] == [True, False]


@pytest.mark.long
def test_run_at_its_iteration_limit_goes_on_elsewhere(tmp_path, run_script, optimised):
    """The first file stays as it is when the continued run has a folder of its own."""
    first, second = tmp_path / "first", tmp_path / "second"
    code, _ = run_script("optimize_door_seal", first, "--max-iterations", 2, *CHEAP)
    assert code == 1
    before = (first / "cases.sql").read_bytes()
    code, s = run_script("optimize_door_seal", second, "--restart", first / "cases.sql")
    assert code == 0
    assert s["objective_ratio"] == pytest.approx(optimised[2]["objective_ratio"], rel=1e-12)
    assert (first / "cases.sql").read_bytes() == before


def test_folder_is_that_of_the_file_and_its_settings_may_be_repeated(
    tmp_path, run_script, optimised, monkeypatch, capsys
):
    shutil.copy(optimised[0] / "cases.sql", tmp_path)
    monkeypatch.chdir(tmp_path)
    script = sys.modules["optimize_door_seal"]
    arguments = ["--restart", "cases.sql", "--friction", "0.25", "--optimizer", USED, *CHEAP]
    arguments += ["--accuracy", "paper"]
    code = script.run(script.arguments_parser(), script.main, arguments)
    assert code == 0
    assert (tmp_path / "summary.json").exists()
    assert "recorded evaluations used again" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--friction", "0.4"), "recorded with friction = 0.25"),
        (("--n-steps", "105"), "recorded with n_steps = 21"),
        (("--optimizer", OTHER), f"recorded with optimizer = {USED}"),
        (("--accuracy", "engineering"), "--accuracy engineering: "),
        (("--accuracy", "engineering"), "recorded with basis_order = 1"),
        (("--keep-force",), "recorded with keep_force = False"),
    ],
)
def test_another_problem_is_refused(
    arguments, message, tmp_path, run_script, optimised, capsys, monkeypatch
):
    """In one line, and before anything is analysed."""
    monkeypatch.setattr("seal_mdao.analysis_cache.analyze_particles", None)
    cases = shutil.copy(optimised[0] / "cases.sql", tmp_path)
    before = Path(cases).read_bytes()
    with pytest.raises(SystemExit) as ended:
        run_script("optimize_door_seal", tmp_path, "--restart", cases, *arguments)
    assert ended.value.code == 2
    (error,) = capsys.readouterr().err.splitlines()
    assert message in error
    assert Path(cases).read_bytes() == before


def test_files_that_cannot_be_continued(tmp_path, run_script, optimised, capsys):
    sources = {"text.sql": b"no database", "empty.sql": b""}
    for name, content in sources.items():
        (tmp_path / name).write_bytes(content)
    plain = om.Problem(reports=None, work_dir=str(tmp_path))
    plain.model.add_subsystem("c", om.ExecComp("y = x**2"), promotes=["*"])
    plain.add_recorder(om.SqliteRecorder(tmp_path / "other.sql"))
    plain.setup()
    plain.run_model()
    plain.cleanup()
    other = shutil.copy(optimised[0] / "cases.sql", tmp_path / "version.sql")
    forget_an_attribute(other)
    messages = {
        "text.sql": "not a file of an OpenMDAO recorder",
        "empty.sql": "not a file of an OpenMDAO recorder",
        "other.sql": "does not contain the settings of the built-in door seal",
        "version.sql": "the recorded settings of a door seal are not valid",
        "nowhere.sql": "is not a file",
    }
    for name, message in messages.items():
        with pytest.raises(SystemExit) as ended:
            run_script("optimize_door_seal", tmp_path, "--restart", tmp_path / name)
        assert ended.value.code == 2
        assert message in capsys.readouterr().err


def forget_an_attribute(path):
    """Rename an attribute of the seal in the recorded settings."""
    connection = sqlite3.connect(path)
    (text,) = connection.execute("SELECT model_viewer_data FROM driver_metadata").fetchone()
    text = text.replace(r"\"friction\":", r"\"rubbing\":")
    with connection:
        connection.execute("UPDATE driver_metadata SET model_viewer_data=?", (text,))
    connection.close()

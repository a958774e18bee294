"""What goes wrong beside the mechanics: one line, exit status 1 or 2, nothing lost."""

import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from script_runs import CHEAP, SCRIPTS

from seal_mdao.recording.claim import claim


def refused(run_script, capsys, name, out, *arguments):
    """The error line of a script that ends with status 2."""
    with pytest.raises(SystemExit) as ended:
        run_script(name, out, *arguments)
    assert ended.value.code == 2
    (error,) = capsys.readouterr().err.splitlines()
    return error


def test_rerun_into_a_folder_with_results_is_refused(tmp_path, run_script, optimised, capsys):
    cases = shutil.copy(optimised[0] / "cases.sql", tmp_path)
    before = Path(cases).read_bytes()
    error = refused(run_script, capsys, "optimize_door_seal", tmp_path, *CHEAP)
    assert "--overwrite" in error
    assert str(cases) in error
    assert Path(cases).read_bytes() == before


def test_restart_does_not_replace_the_file_of_another_run(tmp_path, run_script, optimised, capsys):
    cases = tmp_path / "cases.sql"
    cases.write_bytes(b"results of another run")
    source = optimised[0] / "cases.sql"
    error = refused(run_script, capsys, "optimize_door_seal", tmp_path, "--restart", source)
    assert "--overwrite" in error
    assert cases.read_bytes() == b"results of another run"


def test_overwrite_replaces_it(tmp_path, run_script):
    (tmp_path / "cases.sql").write_bytes(b"results of another run")
    code, s = run_script(
        "optimize_door_seal", tmp_path, "--overwrite", "--max-iterations", 1, *CHEAP
    )
    assert code == 1
    assert s["iterations"] == 1


def test_run_into_the_folder_of_a_run_at_work_is_refused(tmp_path, run_script, capsys):
    lock = claim(tmp_path / "cases.sql")
    try:
        error = refused(run_script, capsys, "optimize_door_seal", tmp_path, *CHEAP)
    finally:
        lock.release()
    assert "another process is writing the recorder file" in error


@pytest.mark.parametrize(
    ("arguments", "name"),
    [(("--depths", "nan"), "--depths"), (("--depths", "-5"), "--depths"),
     (("--depth", "1e-9"), "depth"), (("--corner-x", "1e300"), "corner_x"),
     (("--door-radius", "1e-9"), "door_radius"), (("--layers", "2"), "layers"),
     (("--normal-penalty", "1e-9"), "normal_penalty"), (("--segments", "100000000"), "segments")],
)  # fmt: skip
def test_wrong_argument_is_named(arguments, name, tmp_path, run_script, capsys):
    assert name in refused(run_script, capsys, "analyze_door_seal", tmp_path, *arguments)


def test_folder_that_cannot_be_written(run_script, capsys):
    """Not even by the superuser."""
    error = refused(run_script, capsys, "analyze_door_seal", "/proc/self", *CHEAP)
    assert "--out" in error
    assert "/proc/self" in error


def test_disk_that_is_full(tmp_path, run_script, capsys, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device", str(tmp_path / "reaction.png"))

    monkeypatch.setattr("seal_mdao.plotting.save", full)
    code, s = run_script("analyze_door_seal", tmp_path, *CHEAP)
    assert code == 1
    assert s["converged"]
    error = capsys.readouterr().err.splitlines()[-1]
    assert "reaction.png: No space left on device" in error
    assert "summary.json" in error


def test_ctrl_c_ends_a_long_analysis_at_once(tmp_path, hear_ctrl_c):
    """A real one, after it has said how long it is going to take."""
    command = [sys.executable, SCRIPTS / "analyze_door_seal.py", "--out", tmp_path]
    size = ["--rays", "1160", "--layers", "9", "--n-steps", "1000"]
    with subprocess.Popen(
        [*command, *size], stderr=subprocess.PIPE, text=True, preexec_fn=hear_ctrl_c
    ) as process:
        for line in process.stderr:
            if "will take about" in line:
                break
        process.send_signal(signal.SIGINT)
        said = process.stderr.read().splitlines()
        assert process.wait(60) == 130
    assert "10440 particles in 1000 load steps" in line
    assert said[-1] == f"analyze_door_seal.py: interrupted; nothing was saved in {tmp_path}"
    assert not any("Traceback" in text for text in said)


def test_ctrl_c_ends_an_analysis_in_one_line(tmp_path, run_script, capsys, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("seal_mdao.seals.result.solve_path", interrupted)
    code, _ = run_script("analyze_door_seal", tmp_path, *CHEAP)
    assert code == 130
    assert "interrupted" in capsys.readouterr().err.splitlines()[-1]


def test_warnings_are_printed_and_in_the_summary(tmp_path, run_script, capsys):
    code, s = run_script("analyze_door_seal", tmp_path, "--depth", 15, "--n-steps", 100)
    assert code == 0
    assert any("crosses itself" in text for text in s["warnings"])
    assert "WARNING: the boundary crosses itself" in capsys.readouterr().out


@pytest.mark.parametrize("content", [b"", b"no database", b"SQLite format 3\x00" + bytes(400)])
def test_damaged_recorder_file_is_named(tmp_path, run_script, capsys, content):
    cases = tmp_path / "damaged.sql"
    cases.write_bytes(content)
    error = refused(run_script, capsys, "history", tmp_path / "out", cases)
    assert str(cases) in error

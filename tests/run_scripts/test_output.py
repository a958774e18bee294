"""Scripts end as they should whatever their output leads to, and results come before pictures."""

import os
import subprocess
import sys
from importlib import import_module

import pytest
from coarse_seal import written

CODE = """
import os, sys
from seal_mdao.standard_streams import make_writable
make_writable()
print("area 3 mm², force ≥ 15 N/m, turned by 3°, für")
print("told", file=sys.stderr)
with open("file", "w") as file:
    print(file.fileno() > 2)
    os.write(2, b"of a library")
print(open("file").read() == "", os.get_inheritable(2))
"""


def ended(command, folder, **environment):
    return subprocess.run(
        ["sh", "-c", command], cwd=folder, env=os.environ | environment, capture_output=True,
        check=False, timeout=100, encoding="utf-8",
    )  # fmt: skip


@pytest.mark.parametrize("closed", ["", "2>&-", "2>&- <&-"])
@pytest.mark.parametrize(
    ("encoding", "line"),
    [
        ({"PYTHONIOENCODING": "utf-8"}, "area 3 mm², force ≥ 15 N/m, turned by 3°, für"),
        ({"PYTHONIOENCODING": "ascii"}, "area 3 mm^2, force >= 15 N/m, turned by 3 deg, f\\xfcr"),
        (
            {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0", "PYTHONIOENCODING": ""},
            "area 3 mm^2, force >= 15 N/m, turned by 3 deg, f\\xfcr",
        ),
    ],
)
def test_everything_can_be_printed(tmp_path, closed, encoding, line):
    (tmp_path / "code.py").write_text(CODE, encoding="utf-8")
    found = ended(f"{sys.executable} code.py {closed}", tmp_path, **encoding)
    assert found.stdout.splitlines() == [line, "True", "True True"], found.stderr
    assert found.stderr == ("" if closed else "told\nof a library")
    assert found.returncode == 0


@pytest.mark.parametrize("closed", ["2>&-", ">&- 2>&- <&-"])
def test_a_script_without_standard_error(tmp_path, closed):
    pytest.importorskip("netgen")
    file = written(tmp_path)
    script = "-m seal_mdao analyze"
    found = ended(f"{sys.executable} {script} {file} --out out --no-vtu {closed}", tmp_path)
    assert found.returncode == 0, found.stdout
    assert (tmp_path / "out" / "summary.json").is_file()
    assert found.stdout.endswith("figures, CSV and summary.json in out\n") == (closed == "2>&-")
    wrong = ended(f"{sys.executable} {script} none.toml --out out {closed}", tmp_path)
    assert wrong.returncode == 2


def test_names_that_the_encoding_does_not_have(tmp_path):
    found = ended(
        f"{sys.executable} -m seal_mdao analyze 'Türdichtung ≥ 3.toml' --out out", tmp_path,
        PYTHONIOENCODING="ascii",
    )  # fmt: skip
    assert found.returncode == 2
    assert found.stderr.endswith("T\\xfcrdichtung >= 3.toml: there is no such file\n")


class PictureError(Exception):
    """Whatever may go wrong in a picture."""


def fail(*_, **__):
    raise PictureError


def test_curves_are_written_before_pictures(run_script, tmp_path, monkeypatch):
    pytest.importorskip("netgen")
    monkeypatch.setattr(import_module("seal_mdao.cli.analyze"), "draw", fail)
    with pytest.raises(PictureError):
        run_script("analyze", tmp_path / "out", written(tmp_path), "--no-vtu")
    there = {path.name for path in (tmp_path / "out").iterdir()}
    assert there >= {"summary.json", "curve_door.csv", "contact_door.csv"}


def test_the_optimum_is_written_before_its_drawing(run_script, tmp_path, monkeypatch):
    pytest.importorskip("netgen")
    monkeypatch.setattr(import_module("seal_mdao.cli.optimize"), "write_design", fail)
    with pytest.raises(PictureError):
        run_script("optimize", tmp_path / "out", written(tmp_path), "--max-iterations", 1)
    there = {path.name for path in (tmp_path / "out").iterdir()}
    assert there >= {"summary.json", "optimum.csv"}

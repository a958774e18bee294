"""Names of parameters in sweeps and tolerances, default folders, headings of options."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import seal_mdao as sm
from seal_mdao.cli.subcommands import main

pytest.importorskip("netgen")
BULB = (Path(__file__).parents[1] / "seal_file" / "bulb.toml").read_text(encoding="utf-8")
QUICK = BULB.replace("spacing = 0.9", "spacing = 1.4").replace("steps = 40", "steps = 4")
SHIFTED = '[tolerance.vary.{}]\ndistribution = "uniform"\nkind = "shift"\nlow = -0.1\nhigh = 0.1\n'


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(QUICK, encoding="utf-8")
    return tmp_path / "mine.toml"


def test_every_command_checks_the_parameters_of_tolerances(file, capsys):
    file.write_text(QUICK + SHIFTED.format("door_travel"), encoding="utf-8")
    assert main(["check", str(file)]) == 2
    said = capsys.readouterr().err
    assert (
        "[tolerance.vary.door_travel]: the parameter door_travel cannot have a manufacturing tolerance"
        in said
    )
    assert "door_y" in said
    file.write_text(QUICK + SHIFTED.format("dor_y"), encoding="utf-8")
    assert main(["check", str(file)]) == 2
    assert "did you mean 'door_y'?" in capsys.readouterr().err
    file.write_text(QUICK + SHIFTED.format("door_y"), encoding="utf-8")
    assert main(["check", str(file)]) == 0


def test_a_sweep_varies_the_placement_of_a_profile(file):
    """A plate that lies 0.2 mm lower presses as one that travels 0.2 mm more."""
    main(["sweep", str(file), "--vary", "door_y=-0.2,0.0".replace("=", " ").split()[0], "-0.2,0.0"])
    rows = json.loads(Path("out/mine_sweep/summary.json").read_text())["values"]
    low, nominal = (row["door_Fy_N_per_m"] for row in rows)
    seal = sm.build_seal(file)
    assert nominal == pytest.approx(sm.analyze(seal).path.reaction("door")[-1, 1], rel=1e-12)
    shifted = sm.analyze(seal.with_placements(), parameters={"door_y": -0.2})
    assert low == pytest.approx(shifted.path.reaction("door")[-1, 1], rel=1e-12)
    assert low > 1.01 * nominal


def test_an_analysis_writes_to_a_folder_of_its_file(file):
    assert main(["analyze", str(file), "--no-vtu", "--quiet"]) in (0, 1)
    assert Path("out/mine/summary.json").is_file()
    assert not Path("out/seal").exists()


@pytest.mark.parametrize(
    ("given", "folder"),
    [
        (["optimize", "mine.toml"], "mine_optimization"),
        (["study", "mine.toml"], "mine_tolerances"),
        (["study"], "tolerances"),
        (["robust", "mine.toml"], "mine_robust"),
        (["robust"], "robust"),
        (["refine", "mine.toml", "--to", "5"], "mine_refined"),
        (["sweep", "mine.toml", "--vary", "friction", "0.1,0.2"], "mine_sweep"),
        (["check", "mine.toml"], "mine_check"),
        (["calibrate", "mine.toml", "force.csv", "--find", "c10"], "mine_calibration"),
        (["optimize", "mine.toml", "--out", "best"], None),
    ],
)
def test_every_command_has_a_folder_for_each_file(file, monkeypatch, given, folder):
    """So that a second seal neither is refused nor overwrites the results of the first one."""
    monkeypatch.setattr("seal_mdao.cli.arguments._printed_as_asked", lambda *_: 0)
    assert main(given) == 0
    assert [own.name for own in Path("out").glob("*")] == ([folder] if folder else [])


@pytest.mark.parametrize("name", ["x.html", "best/pic.PNG", "x.csv", "x.toml", "x.json"])
def test_a_file_is_no_output_folder(file, monkeypatch, capsys, name):
    """A folder x.html was made without a word."""
    monkeypatch.setattr("seal_mdao.cli.arguments._printed_as_asked", lambda *_: 0)
    with pytest.raises(SystemExit) as ended:
        main(["analyze", "mine.toml", "--out", name])
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert f"--out: {name} is the name of a file, but --out names the folder of all results" in said
    assert f"give a folder, such as {name.rpartition('.')[0]}" in said
    assert [own.name for own in Path().iterdir()] == ["mine.toml"]
    # names with other dots, and a folder that is there
    assert main(["analyze", "mine.toml", "--out", "seal_0.5"]) == 0
    Path("x.html").mkdir()
    assert main(["analyze", "mine.toml", "--out", "x.html"]) == 0


def test_a_restart_writes_beside_its_recorder_file(file, monkeypatch):
    monkeypatch.setattr("seal_mdao.cli.arguments._printed_as_asked", lambda *_: 0)
    Path("before").mkdir()
    Path("before/cases.sql").touch()
    assert main(["optimize", "mine.toml", "--restart", "before/cases.sql"]) == 0
    assert not Path("out").exists()


@pytest.mark.parametrize("command", ["study", "robust"])
def test_options_of_the_built_in_seal_have_a_heading(command, capsys):
    with pytest.raises(SystemExit):
        main([command, "--help"])
    text = capsys.readouterr().out
    own, built_in = text.split("door seal of the paper (without a seal file):")
    assert "--rays" not in own.partition("options:")[2]
    assert "--rays" in built_in


def test_a_reader_of_the_output_that_has_ended(tmp_path):
    """As ``head`` does after its last line; the disk is not at fault."""
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "seal_mdao", "examples", "--out", str(tmp_path)]
    ended = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, check=False)
    os.close(write)
    assert ended.returncode == 1
    assert ended.stderr == (
        f"seal-mdao examples: the output is no longer read; nothing was saved in {tmp_path}\n"
    )

"""``seal-mdao``: every subcommand runs, says what is wrong in one line, and leaves its files."""

import csv
import json
import os
import re
import subprocess
import sys
import warnings
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image
from round_tip import PRESSED_TIP
from seal_file.coarse_bulb import BULB, COARSE, changed

import seal_mdao as sm
from seal_mdao.analysis.cost import duration
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli import arguments, examples
from seal_mdao.cli.analyze import stress_line
from seal_mdao.cli.arguments import WrongArgumentError, parser, run
from seal_mdao.cli.compare import KEYS, names_of, print_table
from seal_mdao.cli.subcommands import COMMANDS, main
from seal_mdao.cli.sweep import warnings_of, write_table
from seal_mdao.plotting.animation import check_format
from seal_mdao.plotting.captions import caption
from seal_mdao.seals.result import SealResult
from seal_mdao.seals.result_units import PLANE


@pytest.fixture
def bulb(tmp_path):
    """A seal file that is analysed quickly."""
    pytest.importorskip("netgen")
    path = tmp_path / "bulb.toml"
    path.write_text(changed(BULB.read_text(encoding="utf-8"), COARSE), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_an_example_and_exits_with_zero(name, capsys):
    with pytest.raises(SystemExit) as ended:
        main([name, "--help"])
    said = capsys.readouterr().out
    assert ended.value.code == 0
    assert f"usage: seal-mdao {name}" in said
    assert f"example: seal-mdao {name} " in said


def test_general_help_lists_every_command(capsys):
    assert main([]) == 2
    said = capsys.readouterr().out
    assert all(f"  {name} " in said for name in COMMANDS)


def test_the_module_is_the_command():
    done = subprocess.run(
        [sys.executable, "-m", "seal_mdao", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == f"seal_mdao {sm.__version__}"


@pytest.mark.parametrize(
    "wrong",
    [
        ["analyse"], ["check"], ["check", "nowhere.toml"], ["sweep", "x.toml"], ["examples", "none"],
        ["sweep", "x.toml", "--vary", "friction", "0.1:0.5"],
        ["sweep", "x.toml", "--vary", "friction", "0.1:inf:3"],
        ["sweep", "x.toml", "--vary", "friction", "0.1:0.5:0"],
        ["animate", "x.toml", "-o", "close.avi"], ["report", "none.sql"],
        ["new", "a", "--from", "none.dxf"], ["optimize", "x.toml", "--optimizer", "guess"],
    ],
)  # fmt: skip
def test_wrong_use_is_one_line_with_status_two(wrong, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    try:
        code = main(wrong)
    except SystemExit as ended:
        code = ended.code
    assert code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "seal-mdao" in line


@pytest.mark.parametrize("name", COMMANDS)
def test_an_unknown_option_of_any_command_is_one_line_with_status_two(
    name, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main([name, "--nonsense"])
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"seal-mdao {name}: error: ")
    assert not list(tmp_path.iterdir())


def test_a_sweep_of_two_quantities_is_refused(bulb, tmp_path, capsys):
    two = ["--vary", "c10", "60,80", "--vary", "friction", "0.1,0.2"]
    with pytest.raises(SystemExit) as ended:
        main(["sweep", str(bulb), *two, "--out", str(tmp_path / "out")])
    assert ended.value.code == 2
    assert "a sweep varies one quantity" in capsys.readouterr().err


@pytest.mark.parametrize("folder", [".", "/", ""])
@pytest.mark.parametrize("command", ["analyze", "check"])
def test_a_folder_instead_of_a_seal_file_is_refused(folder, command, capsys):
    try:
        code = main([command, folder])
    except SystemExit as ended:
        code = ended.code
    assert code == 2
    text = capsys.readouterr().err
    assert "folder" in text or "directory" in text


def test_studio_refuses_a_drawing_and_says_what_to_do(tmp_path, capsys):
    drawing = tmp_path / "strip.dxf"
    drawing.write_text("0\nEOF\n")
    with pytest.raises(SystemExit) as ended:
        main(["studio", str(drawing), "--no-browser"])
    assert ended.value.code == 2
    assert "seal-mdao new NAME --from DRAWING.dxf" in capsys.readouterr().err


@pytest.mark.parametrize("name", [".", "..", "", ".toml"])
def test_a_new_file_needs_a_name(name, tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["new", name, "--out", str(tmp_path)])
    assert ended.value.code == 2
    assert "is no name of a file" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_misspelt_command_is_named(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["anlyze", "bulb.toml"])
    assert ended.value.code == 2
    assert "did you mean 'analyze'?" in capsys.readouterr().err


def test_ctrl_c_while_modules_are_imported(monkeypatch, capsys):
    def interrupted(name):
        raise KeyboardInterrupt

    monkeypatch.setattr("seal_mdao.cli.subcommands.import_module", interrupted)
    assert main(["check", "bulb.toml"]) == 130
    assert capsys.readouterr().err == "seal-mdao check: interrupted\n"


ENOUGH = {
    "examples": (), "materials": (), "new": ("mine",), "fit": ("tests.csv", "--law", "yeoh"),
    "calibrate": ("bulb.toml", "force.csv", "--find", "c10"),
    "compare": ("bulb.toml", "bulb.toml"), "sweep": ("bulb.toml", "--vary", "friction", "0.1:0.2:2"),
}  # fmt: skip
"""Arguments with which a subcommand starts, where they are not one file."""


@pytest.mark.parametrize("name", COMMANDS)
def test_ctrl_c_in_any_command_is_one_line_with_status_130(name, tmp_path, monkeypatch, capsys):
    """What an earlier stage wrote is there, and named."""
    monkeypatch.chdir(tmp_path)
    Path("bulb.toml").touch()

    def interrupted(arguments):
        (arguments.out / "summary.json").write_text("{}", encoding="utf-8")
        raise KeyboardInterrupt

    monkeypatch.setattr(import_module(f"seal_mdao.cli.{name}"), "main", interrupted)
    assert main([name, *ENOUGH.get(name, ("bulb.toml",)), "--out", "out"]) == 130
    assert capsys.readouterr().err == (
        f"seal-mdao {name}: interrupted; saved in out: summary.json\n"
    )
    assert Path("out", "summary.json").read_text(encoding="utf-8") == "{}"


def test_a_wrong_parameter_is_refused_before_any_analysis(bulb, tmp_path, monkeypatch):
    monkeypatch.setattr("seal_mdao.cli.varied.seal_of", None)
    with pytest.raises(SystemExit):
        main(["sweep", str(bulb), "--vary", "frixion", "0.1:0.2:2", "--out", str(tmp_path / "out")])


def test_new_check_and_analyze(tmp_path, monkeypatch, capsys):
    """What `new` writes can be checked as it is; a second file of the name is refused."""
    pytest.importorskip("netgen")
    monkeypatch.chdir(tmp_path)
    assert main(["new", "mine"]) == 0
    assert main(["check", "mine.toml", "--out", "look"]) == 0
    summary = json.loads((tmp_path / "look" / "summary.json").read_text())
    seal = sm.read_seal_file("mine.toml")
    assert summary["profiles"] == ["plate"]
    assert summary["to_be_chosen"][0] == "load steps"
    assert summary["design_parameters"] == 6 == seal.designs[0].parameters
    analysis, choice = (summary[f"estimated_seconds{own}"] for own in ("", "_of_choice"))
    assert 0.3 * analysis < choice < 3.0 * analysis
    output = summary["estimated_seconds_of_output"]
    assert 2.0 < output < 8.0
    assert (
        f"with 40 load steps takes about {duration(analysis + choice + output)}, of which "
        f"{duration(choice)} for the choice of load steps and penalties and "
        f"{duration(output)} for start-up"
    ) in capsys.readouterr().out
    assert (tmp_path / "look" / "section.png").stat().st_size > 20_000
    with pytest.raises(SystemExit):
        main(["new", "mine"])
    assert "mine.toml already exists" in capsys.readouterr().err


def test_check_of_a_file_that_leaves_nothing_open(bulb, tmp_path, capsys):
    assert main(["check", str(bulb), "--out", str(tmp_path / "look")]) == 0
    summary = json.loads((tmp_path / "look" / "summary.json").read_text())
    assert summary["estimated_seconds_of_choice"] == 0.0
    assert "choosing" not in capsys.readouterr().out


def test_check_says_which_particles_a_file_without_spacing_has(bulb, tmp_path, capsys):
    lines = bulb.read_text().splitlines()
    path = tmp_path / "short.toml"
    path.write_text("\n".join(line for line in lines if not line.startswith(("spacing", "layers"))))
    assert main(["check", str(path), "--out", str(tmp_path / "look")]) == 0
    said = capsys.readouterr().out
    assert said.startswith("particles by default: spacing = ")
    assert ", layers = 5 in [section]" in said
    assert main(["check", str(bulb), "--out", str(tmp_path / "look")]) == 0
    assert "by default" not in capsys.readouterr().out


def test_new_from_a_drawing(tmp_path, monkeypatch):
    """The lowest edge is fixed, the plate is above the others; the drawing lies beside the file."""
    pytest.importorskip("netgen")
    pytest.importorskip("ezdxf")
    monkeypatch.chdir(tmp_path)
    drawing = examples.examples_folder() / "weatherstrip.dxf"
    assert main(["new", "strip", "--from", str(drawing)]) == 0
    assert (tmp_path / "weatherstrip.dxf").read_bytes() == drawing.read_bytes()
    seal = sm.read_seal_file("strip.toml")
    assert seal.profiles[0].contact == ("bulb",)
    assert main(["check", "strip.toml"]) == 0


DOOR_LAYERS = (
    "ignored in the drawing: 10 entities on layers 'centre' (2), 'dimensions' (4), 'hatch' (1), "
    "'notes' (3)"
)


def test_new_from_a_drawing_of_two_rubbers(tmp_path, monkeypatch, capsys):
    """The parting layer is found, materials have the names of the texts in their parts, the comment
    says what was left out; the file is checked as it is."""
    pytest.importorskip("netgen")
    pytest.importorskip("ezdxf")
    monkeypatch.chdir(tmp_path)
    drawing = examples.examples_folder() / "car_door_seal.dxf"
    assert main(["new", "door", "--from", str(drawing)]) == 0
    text = (tmp_path / "door.toml").read_text(encoding="utf-8")
    assert (
        "# Layers of the drawing: edges base, foot_right, seal_surface, foot_left, cavity;" in text
    )
    assert (
        "# lines between rubbers on the layers parting; left out centre (2 entities), dimensions (4"
        in text
    )
    seal = sm.read_seal_file("door.toml")
    assert list(seal.materials) == ["bulb", "foot"]
    assert seal.section.material == "bulb"
    assert seal.section.regions[0].at == pytest.approx((0.0, 1.25))
    assert seal.fixed_edges == ("base",)
    capsys.readouterr()
    assert main(["check", "door.toml", "--out", "look"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == DOOR_LAYERS
    assert "materials: bulb, foot" in said
    summary = json.loads((tmp_path / "look" / "summary.json").read_text())
    assert summary["materials"] == ["bulb", "foot"]
    assert summary["warnings"] == []


def test_layers_and_units_of_new_are_those_of_the_file(tmp_path, monkeypatch, capsys):
    """A drawing without units, with a frame; the names of the layers need quotes."""
    ezdxf = pytest.importorskip("ezdxf")
    monkeypatch.chdir(tmp_path)
    document = ezdxf.new("R2010", units=0)
    model = document.modelspace()
    corners = [(0, 0), (2, 0), (2, 1), (0, 1)]
    for name, i in (("base", 0), ("right", 1), ("top", 2), ("left", 3)):
        model.add_line(corners[i], corners[(i + 1) % 4], {"layer": name})
    model.add_lwpolyline([(-9, -9), (9, -9), (9, 9), (-9, 9)], close=True,
                         dxfattribs={"layer": "frame 1"})  # fmt: skip
    document.saveas("box.dxf")
    with pytest.raises(SystemExit):
        main(["new", "box", "--from", "box.dxf"])
    assert "the drawing has no unit of length ($INSUNITS in its" in capsys.readouterr().err
    with_units = ["new", "box", "--from", "box.dxf", "--units", "cm", "--ignore", "frame 1"]
    assert main(with_units) == 0
    section = sm.read_seal_file("box.toml").section
    assert section.outline.area == pytest.approx(200.0)
    assert 'units = "cm"\nignore = ["frame 1"]\n' in Path("box.toml").read_text()


def test_materials_are_listed(capsys):
    assert main(["materials"]) == 0
    said = capsys.readouterr().out
    assert "       60     3605            600.8" in said
    assert "    2A3                               62 to 90       130.0" in said
    assert "law = neo_hookean, mooney_rivlin" in said


def test_examples_are_copied_with_their_files(tmp_path, capsys):
    assert main(["examples"]) == 0
    listed = {line.split()[0] for line in capsys.readouterr().out.splitlines()}
    assert listed == {path.stem for path in examples.examples_folder().glob("*.toml")}
    assert main(["examples", "weatherstrip", "--out", str(tmp_path)]) == 0
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"weatherstrip.toml", "weatherstrip.dxf", "rubber_tests.csv"}
    with pytest.raises(SystemExit):
        main(["examples", "weatherstrip", "--out", str(tmp_path)])


def test_examples_of_an_incomplete_installation(tmp_path, monkeypatch):
    monkeypatch.setattr(examples, "INSTALLED", tmp_path)
    monkeypatch.setattr(examples, "__file__", str(tmp_path / "a" / "b" / "c.py"))
    with pytest.raises(WrongArgumentError, match="reinstall seal_mdao"):
        examples.examples_folder()


def test_sweep_is_the_analyses_one_by_one(bulb, tmp_path):
    out = tmp_path / "sweep"
    assert main(["sweep", str(bulb), "--vary", "c10", "60:100:3", "--out", str(out)]) == 0
    with (out / "sweep.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    seal = sm.build_seal(sm.read_seal_file(bulb))
    assert [float(row["c10"]) for row in rows] == pytest.approx([60.0, 80.0, 100.0])
    for row in rows[::2]:
        result = sm.analyze(seal, parameters={"c10": float(row["c10"])})
        assert float(row["door_Fy_N_per_m"]) == pytest.approx(
            result.path.reaction("door")[-1, 1], rel=1e-9
        )
        assert float(row["contact_width"]) == pytest.approx(result.contact_width, rel=1e-9)
    assert (out / "sweep.png").is_file()


def test_a_sweep_has_every_value_of_a_measure_and_units(bulb, tmp_path, capsys):
    path = bulb.with_name("forces.toml")
    more = '[[measure]]\ntype = "reaction"\nname = "forces"\ncomponent = "y"\ntravel = [0.5, 1.0]\n'
    path.write_text(bulb.read_text(encoding="utf-8") + more, encoding="utf-8")
    out = tmp_path / "sweep"
    assert main(["sweep", str(path), "--vary", "c10", "80,90", "--out", str(out)]) == 0
    summary = json.loads((out / "summary.json").read_text())
    measure = next(m for m in sm.build_seal(path).standard if m.name == "forces")
    forces = sm.analyze(sm.build_seal(path)).value(measure)
    (first, _), units = summary["values"], summary["units"]
    assert [first["forces_1"], first["forces_2"]] == pytest.approx(list(forces), rel=1e-9)
    assert first["trustworthy"] is True
    assert (units["forces_1"], units["forces_2"], units["contact_width"]) == ("N/m", "N/m", "mm")
    assert "forces_2 = " in capsys.readouterr().out


def test_a_sweep_refuses_wrong_values_before_load_steps_are_chosen(
    bulb, tmp_path, capsys, monkeypatch
):
    def chosen(*arguments, **options):
        raise AssertionError("load steps are chosen for a sweep that cannot be completed")

    monkeypatch.setattr("seal_mdao.cli.varied.seal_of", chosen)
    arguments = ["--vary", "c10", "80,-5", "--out", str(tmp_path / "out")]
    assert main(["sweep", str(bulb), *arguments]) == 2
    assert "c10 of MooneyRivlin must be a number of at least 0" in capsys.readouterr().err


@pytest.mark.parametrize("vary", [("c10", "80,90"), ("section.spacing", "1.7,1.8")])
def test_a_sweep_has_measures_whose_points_the_nominal_seal_determines(bulb, tmp_path, vary):
    path = bulb.with_name("pressures.toml")
    more = '[[measure]]\ntype = "contact_pressure"\n[[measure]]\ntype = "von_mises"\ncount = 2\n'
    path.write_text(bulb.read_text(encoding="utf-8") + more, encoding="utf-8")
    out = tmp_path / "sweep"
    assert main(["sweep", str(path), "--vary", *vary, "--out", str(out)]) == 0
    summary = json.loads((out / "summary.json").read_text())
    result = sm.analyze(sm.build_seal(path))
    (own,) = (row for row in summary["values"] if row["value"] in (80.0, 1.8))
    assert own["contact_pressure"] == pytest.approx(result.value("contact_pressure")[0], rel=1e-9)
    stresses, units = [own["von_mises_1"], own["von_mises_2"]], summary["units"]
    assert stresses == pytest.approx(list(result.value("von_mises")), rel=1e-9)
    assert units["contact_pressure"] == units["von_mises_2"] == "kPa"
    assert (out / "measures.png").is_file()


def test_values_of_one_and_of_two_contact_regions_are_in_one_table(tmp_path):
    state = {"converged": True, "trustworthy": True}
    rows = [
        {"value": 1.0, "converged": False, "trustworthy": False},
        {"value": 2.0} | state | {"contact_pressure": 30.0},
        {"value": 3.0} | state | {"contact_pressure_1": 40.0, "contact_pressure_2": 50.0},
    ]
    path = tmp_path / "sweep.csv"
    write_table(path, "travel", rows)
    with path.open(newline="") as file:
        found = list(csv.DictReader(file))
    assert [row["contact_pressure"] for row in found] == ["", "30", ""]
    assert [row["contact_pressure_2"] for row in found] == ["", "", "50"]
    assert list(found[0])[:2] == ["travel", "converged"]


def test_a_sweep_prints_each_warning_once(bulb, tmp_path, capsys, monkeypatch):
    """With the values that have it; an analysis that cannot be used or fails is status 1."""
    out, own = tmp_path / "sweep", lambda result: f"{result.seal.scalars['c10'].value:g} kPa"
    arguments = ["sweep", str(bulb), "--vary", "c10", "60,80", "--out", str(out)]
    monkeypatch.setattr(SealResult, "warnings", property(lambda result: ("soft", own(result))))
    assert main(arguments) == 0
    warned = [line for line in capsys.readouterr().out.splitlines() if line.startswith("WARNING")]
    lines = ["(c10 = 60, 80): soft", "(c10 = 60): 60 kPa", "(c10 = 80): 80 kPa"]
    assert warned == [f"WARNING {line}" for line in lines]
    found = json.loads((out / "summary.json").read_text())["warnings"]
    assert found[0] == {"text": "soft", "at": [60.0, 80.0]}
    monkeypatch.setattr(SealResult, "trustworthy", property(lambda result: own(result) == "60 kPa"))
    assert main(arguments) == 1


def test_a_sweep_says_why_an_analysis_failed():
    failed = SimpleNamespace(converged=False, failure="the path ends at 2 mm", warnings=("soft",))
    assert warnings_of({0.3: failed}) == [{"text": "the path ends at 2 mm", "at": [0.3]}]


def test_analyses_and_captions_say_at_which_temperature_they_are(
    bulb, tmp_path, capsys, monkeypatch
):
    """On the console, in summary.json and below figures; a sweep names what it varies, too."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    text = bulb.read_text(encoding="utf-8")
    table = "expansion = 1e-4\nswelling = 1.02\n"
    hot = changed(text, {'law = "mooney_rivlin"\n': f'law = "mooney_rivlin"\n{table}'})
    bulb.write_text(f"[model]\ntemperature = [23, 60]\n{hot}", encoding="utf-8")
    drawn = []
    monkeypatch.setattr("seal_mdao.plotting.save", lambda figure, path: drawn.append(caption()))
    out = tmp_path / "out"
    assert main(["analyze", str(bulb), "--no-vtu", "--out", str(out)]) == 0
    conditions = json.loads((out / "summary.json").read_text())["conditions"]
    assert conditions == {"temperature_degC": 60.0, "swelling": 1.02}
    assert (
        "\nprescribed conditions at the end of the analysis: 60 °C, swelling 1.02\n"
        in capsys.readouterr().out
    )
    named = "bulb: rubber (Mooney-Rivlin), 60 °C, swelling 1.02"
    assert set(drawn) == {f"{named} | 2023-11-14"}
    drawn.clear()
    assert main(["sweep", str(bulb), "--vary", "temperature", "60:80:2", "--out", str(out)]) == 0
    # not the temperature of the file, which is that of none of the analyses
    named = named.replace(" 60 °C,", "")
    varied = {f"{named}, varied: temperature | 2023-11-14"}
    assert set(drawn) == varied
    drawn.clear()
    scatter = 'distribution = "uniform"\nlow = 50\nhigh = 70\n'
    with bulb.open("a", encoding="utf-8") as file:
        file.write(f"[tolerance.vary.temperature]\n{scatter}")
    study = ["study", str(bulb), "--samples", "2", "--workers", "0"]
    assert main([*study, "--out", str(tmp_path / "study")]) == 0
    assert set(drawn) == varied


def test_without_an_environment_nothing_is_said_about_it(bulb, tmp_path, capsys):
    assert main(["analyze", str(bulb), "--no-vtu", "--out", str(tmp_path / "out")]) == 0
    assert "conditions at the end" not in capsys.readouterr().out
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["conditions"] == {}


@pytest.mark.parametrize("given", ["-3:6", "-.5:6", "-1e-3:6", "-a:6:4", "-3,a"])
def test_a_wrong_negative_range_is_named(given, capsys):
    with pytest.raises(SystemExit):
        main(["sweep", "x.toml", "--vary", "travel", given])
    said = capsys.readouterr().err
    # letters behind a minus are an option
    wanted = (
        "expected 2 arguments" if given[1] == "a" else f"{given!r} is neither FROM:TO:COUNT nor"
    )
    assert f"argument --vary: {wanted}" in said


def test_a_sweep_of_the_travel_from_away_through_zero(bulb, tmp_path):
    """Without travel, and away from the seal, the only measure of the file, at 0.6 mm, is left empty."""
    text = bulb.read_text(encoding="utf-8")
    text = text[: text.index("[[measure]]")] + '[[measure]]\ntype = "reaction"\ntravel = 0.6\n'
    bulb.write_text(text, encoding="utf-8")
    out = tmp_path / "sweep"
    assert main(["sweep", str(bulb), "--vary", "travel", "-0.6:0.6:3", "--out", str(out)]) == 0
    away, still, closed = swept(out)
    assert [float(row["door_travel"]) for row in (away, still, closed)] == [-0.6, 0.0, 0.6]
    assert float(away["door_Fy_N_per_m"]) == float(still["door_Fy_N_per_m"]) == 0.0
    assert still["reaction"] == ""
    assert float(closed["reaction"]) > 0.0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("0.1,0.2,0.1", "contains a value twice"), ("0.1,,0.2", "is neither FROM:TO:COUNT nor"),
        ("0.1,nan", "contains a number that is not finite"),
        ("0.1:0.2:0", "must have a COUNT (number of values) from 1 to 200"),
        (",".join(map(str, range(201))), "must have a COUNT (number of values) from 1 to 200"),
    ],
)  # fmt: skip
def test_wrong_values_of_a_sweep_are_named(given, message, capsys):
    with pytest.raises(SystemExit):
        main(["sweep", "x.toml", "--vary", "friction", given])
    assert f"{given!r} {message}" in capsys.readouterr().err


def test_a_measure_with_the_name_of_what_is_varied(bulb, tmp_path, capsys):
    """The table would have two columns of one name."""
    named = '[[measure]]\ntype = "section_area"\nname = "door_y"\n'
    bulb.write_text(bulb.read_text() + named)
    with pytest.raises(SystemExit) as ended:
        main(["sweep", str(bulb), "--vary", "door_y", "0:0.1:2", "--out", str(tmp_path / "out")])
    assert ended.value.code == 2
    assert "door_y is also the name of a [[measure]]" in capsys.readouterr().err


def test_a_sweep_of_listed_values(bulb, tmp_path):
    """Any order and distances; -1 is a travel away from the seal."""
    out = tmp_path / "sweep"
    assert main(["sweep", str(bulb), "--vary", "travel", "-1,1.3,0.9", "--out", str(out)]) == 0
    away, short, long = swept(out)
    assert [float(row["door_travel"]) for row in (away, short, long)] == [-1.0, 0.9, 1.3]
    assert float(long["reaction"]) > float(short["reaction"]) > 0.0


def swept(out):
    """Rows of the table of a sweep."""
    with (out / "sweep.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_sweep_of_the_travel_leaves_measures_beyond_it_empty(bulb, tmp_path, capsys):
    """The path is 4/3 of the first travel; two measures reach beyond it, one of them the objective."""
    text = bulb.read_text(encoding="utf-8")
    targets = "travel_mm,force\n0.7,20.0\n1.3,40.0\n"
    (bulb.parent / "target.csv").write_text(targets, encoding="utf-8")
    rows = "".join(
        f'[[measure]]\ntype = "{kind}"\nname = "{name}"\n{keys}\n'
        for kind, name, keys in (
            ("reaction", "far", "travel = 1.5"), ("reaction", "near", "travel = 0.6"),
            ("load_deflection_error", "curve", 'data = "target.csv"'),
        )
    )  # fmt: skip
    before, after = text.split("[optimize]")
    after = "".join(
        'minimize = "curve"\n' if line.startswith("minimize") else line
        for line in after.splitlines(keepends=True)
    )
    bulb.write_text(f"{before}{rows}[optimize]{after}", encoding="utf-8")
    out = tmp_path / "sweep"
    assert main(["sweep", str(bulb), "--vary", "travel", "0.6:1.2:3", "--out", str(out)]) == 0
    short, middle, long = swept(out)
    # paths of 0.8, 1.2 and 1.6 mm
    assert [row["far"] == "" for row in (short, middle, long)] == [True, True, False]
    assert [row["curve"] == "" for row in (short, middle, long)] == [True, True, False]
    assert all(float(row["near"]) > 0.0 for row in (short, middle, long))
    # what [optimize] names by its type is there in every row
    assert all(float(row["reaction"]) >= 0.0 for row in (short, middle, long))
    result = sm.analyze(sm.build_seal(bulb))
    assert float(long["far"]) == pytest.approx(result.far, rel=1e-9)
    said = capsys.readouterr().out
    assert "far needs the force at 1.5 mm of travel" in said
    assert said.count("shorter: door_travel = 0.6, 0.9") == 2


def test_a_sweep_of_the_travel_is_that_of_files_with_other_travels(bulb, tmp_path):
    """The first stage goes down, the second back up in proportion."""
    out = tmp_path / "sweep"
    assert main(["sweep", str(bulb), "--vary", "travel", "0.9:1.5:2", "--out", str(out)]) == 0
    text = bulb.read_text(encoding="utf-8")
    for row, (down, up) in zip(swept(out), ((0.9, 0.3), (1.5, 0.5)), strict=True):
        bulb.write_text(
            text.replace("[0.0, -1.2]", f"[0.0, -{down}]").replace("[0.0, 0.4]", f"[0.0, {up}]")
        )
        result = sm.analyze(sm.build_seal(sm.read_seal_file(bulb)))
        assert float(row["door_travel"]) == pytest.approx(down)
        assert float(row["door_Fy_N_per_m"]) == pytest.approx(
            result.path.reaction("door")[-1, 1], rel=1e-9
        )
    with (out / "curves.csv").open(newline="") as file:
        curves = list(csv.DictReader(file))
    # six steps of two seals
    assert len(curves) == 12
    assert float(curves[3]["travel_mm"]) == pytest.approx(0.9)
    assert json.loads((out / "summary.json").read_text())["unit"] == "mm"
    assert (out / "measures.png").is_file()


@pytest.mark.parametrize(
    ("path", "values", "old", "new", "unit"),
    [
        ("material.rubber.c10", "90:90:1", "c10 = 80.0", "c10 = 90.0", "kPa"),
        ("section.spacing", "1.5:1.5:1", "spacing = 1.8", "spacing = 1.5", "mm"),
        ("profile.door.stage.1.translate.2", "-1.1:-1.1:1", "[0.0, -1.2]", "[0.0, -1.1]", "mm"),
        ("section.hole.1.circle.radius", "4.6:4.6:1", "radius = 4.5", "radius = 4.6", "mm"),
        ("section.layers", "5:5:1", "spacing = 1.8", "spacing = 1.8\nlayers = 5", ""),
    ],
)
def test_a_sweep_of_a_number_of_the_file_is_that_of_a_changed_file(
    bulb, tmp_path, path, values, old, new, unit
):
    out = tmp_path / "sweep"
    assert main(["sweep", str(bulb), "--vary", path, values, "--out", str(out)]) == 0
    (row,) = swept(out)
    text = bulb.read_text(encoding="utf-8")
    assert old in text
    bulb.write_text(text.replace(old, new))
    result = sm.analyze(sm.build_seal(sm.read_seal_file(bulb)))
    # the table has 12 digits
    assert float(row["door_Fy_N_per_m"]) == pytest.approx(
        result.path.reaction("door")[-1, 1], rel=1e-11
    )
    assert float(row["contact_width"]) == pytest.approx(result.contact_width, rel=1e-11)
    assert json.loads((out / "summary.json").read_text())["unit"] == unit


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("frixion", "(did you mean 'friction'?); the parameters are "),
        (
            "frixion",
            "door_travel; numbers of the file are material.rubber.c10, material.rubber.c01",
        ),
        ("material.rubber.c1", "[material.rubber]: unknown key 'c1' (did you mean 'c10'?)"),
        ("material.rubber.law", "the seal file has no number 'material.rubber.law'"),
        ("profile.lid.friction", "(did you mean 'profile.door.friction'?)"),
        ("profile.door.start.3", "the seal file has no number 'profile.door.start.3'"),
        ("section.spacings", "unknown key 'spacings' (did you mean 'spacing'?)"),
    ],
)
def test_what_cannot_vary_is_told_before_any_analysis(bulb, tmp_path, capsys, name, message):
    try:
        code = main(["sweep", str(bulb), "--vary", name, "1:2:2", "--out", str(tmp_path / "out")])
    except SystemExit as ended:
        code = ended.code
    assert code == 2
    assert message in capsys.readouterr().err


def test_keys_are_those_of_the_page(capsys):
    """Tables, laws and measures by their names; keys with forms, units, defaults and meanings."""
    assert main(["keys"]) == 0
    said = capsys.readouterr().out
    assert all(f"  {name} " in said for name in ("design", "gent", "load_deflection_error"))
    assert re.search(r"  cavity +\[\[cavity\]\] ", said)
    assert re.search(r"  fixed +\[fixed\] ", said)
    assert main(["keys", "cavity"]) == 0
    said = capsys.readouterr().out
    assert "written as [[cavity]]" in said
    assert "  pressure [101.325]: a number above 0 (kPa)" in said
    assert "absolute pressure outside, and inside at the start" in said
    assert main(["keys", "hyperfoam"]) == 0
    assert "law hyperfoam, fitted to tests" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["keys", "profil"])
    assert "did you mean 'profile'?" in capsys.readouterr().err


def test_a_parameter_that_may_be_two_is_refused(bulb, tmp_path, capsys):
    with pytest.raises(SystemExit):
        main(["sweep", str(bulb), "--vary", "penalty", "1:2:2", "--out", str(tmp_path / "out")])
    said = capsys.readouterr().err
    assert "door_normal_penalty" in said
    assert "door_tangent_penalty" in said


def test_compare_draws_both_and_writes_their_curves(bulb, tmp_path, capsys):
    other = bulb.with_name("stiffer.toml")
    other.write_text(bulb.read_text().replace("steps = 4", "steps = 5"), encoding="utf-8")
    out = tmp_path / "out"
    assert main(["compare", str(bulb), str(other), "--out", str(out)]) == 0
    summary = json.loads((out / "summary.json").read_text())
    assert list(summary) == ["bulb", "stiffer"]
    assert [own["n_steps"] for own in summary.values()] == [6, 7]
    for name in summary:
        assert (out / name / "curve_door.csv").is_file()
    with Image.open(out / "comparison.png") as picture:
        assert min(picture.size) > 600
    assert "stiffer  force on door" in capsys.readouterr().out


def test_compare_prints_the_force_on_profiles_that_move(capsys):
    """Not on the ground, which comes first in the file."""
    ends = {"ground": {"force_N_per_m": [0.0, -5.0]}, "door": {"force_N_per_m": [1.0, 5.0]}}
    own = {"profiles": ends, "converged": True, "warnings": (), **dict.fromkeys(KEYS)}
    print_table({"seal": own}, {"seal": ["door"]}, {"seal": PLANE})
    assert capsys.readouterr().out == "seal  force on door 1.00, 5.00 N/m\n"


def test_compare_prints_the_width_in_contact_with_every_profile(capsys):
    ends = {
        "ground": {"force_N_per_m": [0.0, -5.0], "deformed_contact_width_mm": 2.0},
        "door": {"force_N_per_m": [1.0, 5.0], "deformed_contact_width_mm": 3.25},
    }
    own = {"profiles": ends, "converged": True, "warnings": (), **dict.fromkeys(KEYS)}
    own |= {"area_mm2": 90.0, "deformed_contact_width_mm": 5.25}
    print_table({"seal": own}, {"seal": ["door"]}, {"seal": PLANE})
    widths = "2 mm in contact with ground, 3.25 mm in contact with door"
    force = "force on door 1.00, 5.00 N/m"
    assert capsys.readouterr().out == f"seal  {force}, {widths}, area_mm2 90\n"


def test_names_of_files_of_one_stem():
    paths = [Path("a/seal.toml"), Path("b/seal.toml"), Path("c/other.toml")]
    assert names_of(paths) == ["a_seal", "b_seal", "other"]
    with pytest.raises(WrongArgumentError, match=r"a/seal.toml is given twice"):
        names_of([Path("a/seal.toml"), Path("a/seal.toml")])
    with pytest.raises(WrongArgumentError, match="a_seal"):
        names_of([Path("a/seal.toml"), Path("b/a/seal.toml")])


@pytest.mark.parametrize("name", ["close.gif", "new/close.html"])
def test_animation_has_a_frame_for_every_step(bulb, tmp_path, name):
    assert main(["animate", str(bulb), "-o", name, "--out", str(tmp_path)]) == 0
    path = tmp_path / name
    if path.suffix == ".gif":
        shown = []
        with Image.open(path) as frames:
            for number in range(frames.n_frames):
                frames.seek(number)
                shown.append(np.asarray(frames.convert("L")).tobytes())
        assert len(set(shown)) >= 6  # six load steps; equal frames at the end are merged
    else:
        assert path.read_text(encoding="utf-8").count("data:image/png;base64") >= 6


def test_formats_of_animations(tmp_path, monkeypatch):
    with pytest.raises(ValueError, match="unknown file format of an animation; the name must"):
        check_format(tmp_path / "close.avi")
    monkeypatch.setattr("seal_mdao.plotting.animation.FFMpegWriter.isAvailable", lambda: False)
    with pytest.raises(ValueError, match="needs the program ffmpeg"):
        check_format(tmp_path / "close.mp4")


def test_json_and_quiet(bulb, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["check", str(bulb), "--out", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads((out / "summary.json").read_text())
    assert main(["check", str(bulb), "--out", str(out), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_json_of_a_command_without_a_summary_lists_its_files(bulb, tmp_path, capsys):
    """Not the summary that another command has left in the folder."""
    out = tmp_path / "out"
    assert main(["check", str(bulb), "--out", str(out)]) == 0
    capsys.readouterr()
    assert main(["animate", str(bulb), "-o", "close.gif", "--out", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"files": ["close.gif"]}


def test_ctrl_c_ends_with_130_and_leaves_what_was_done(bulb, tmp_path, monkeypatch, capsys):
    """The second of three analyses is interrupted; the table has the first."""
    analyses, real = [], sm.analyze

    def analyze(*given, **more):
        if analyses:
            raise KeyboardInterrupt
        analyses.append(1)
        return real(*given, **more)

    monkeypatch.setattr("seal_mdao.cli.sweep.sm.analyze", analyze)
    out = tmp_path / "out"
    code = main(["sweep", str(bulb), "--vary", "friction", "0.1:0.3:3", "--out", str(out)])
    assert code == 130
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.endswith(f"interrupted; saved in {out}: curves.csv and sweep.csv")
    assert len((out / "sweep.csv").read_text().splitlines()) == 2


def test_ctrl_c_in_an_optimisation_writes_the_best_design_and_ends_with_130(
    bulb, tmp_path, monkeypatch, capsys
):
    """The fourth analysis is interrupted, once."""
    pytest.importorskip("tomli_w")
    analyses, real = [], AnalysisCache.analyze_particles

    def analyze(*given, **more):
        analyses.append(1)
        if len(analyses) == 4:
            raise KeyboardInterrupt
        return real(*given, **more)

    monkeypatch.setattr(AnalysisCache, "analyze_particles", analyze)
    out = tmp_path / "out"
    assert main(["optimize", str(bulb), "--out", str(out)]) == 130
    assert len(analyses) > 4
    assert "Stopped by the user (Ctrl-C)" in capsys.readouterr().out
    assert {"cases.sql", "optimum.toml", "summary.json"} <= {own.name for own in out.iterdir()}


def test_files_of_an_earlier_run_are_not_those_of_an_interrupted_one(tmp_path):
    """But for recorder file, samples and summary, with which a second start continues."""
    for name in ("notes.txt", "cases.sql", "curves.csv"):
        (tmp_path / name).touch()
    before = arguments._files(tmp_path)
    assert arguments._saved(tmp_path, before) == f"saved in {tmp_path}: cases.sql"
    os.utime(tmp_path / "curves.csv", (0, 0))
    (tmp_path / "nominal.sql").touch()
    assert arguments._saved(tmp_path, before) == (
        f"saved in {tmp_path}: cases.sql, curves.csv and nominal.sql"
    )


def test_progress_is_printed_where_there_is_no_terminal(bulb, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("seal_mdao.progress.INTERVAL", 0.0)
    assert main(["analyze", str(bulb), "--out", str(tmp_path / "out"), "--no-vtu"]) == 0
    lines = capsys.readouterr().err.splitlines()
    steps = [line for line in lines if "load step" in line]
    # the time left is known from the end of the first one on
    assert steps[0] == "analysis 1: load step 1 of 6"
    for number, line in enumerate(steps[1:], 2):
        assert re.fullmatch(rf"analysis 1: load step {number} of 6, about [\d.]+ s left", line)
    assert len(steps) == 6
    assert main(["analyze", str(bulb), "--out", str(tmp_path / "out"), "--no-vtu", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_a_state_that_means_nothing_is_said_first_and_by_the_exit_status(
    bulb, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr("seal_mdao.seals.local_states.LARGEST_STRETCH", 1.0)
    out = tmp_path / "out"
    assert main(["analyze", str(bulb), "--out", str(out), "--no-vtu"]) == 1
    said = capsys.readouterr().out
    assert 0 <= said.index("WARNING: a principal stretch") < said.index("particles,")
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["converged"], summary["trustworthy"]) == (True, False)
    assert list(summary).index("warnings") < list(summary).index("reaction_N_per_m")


def test_largest_stress_names_a_singular_point():
    summary = {
        "largest_von_mises_kPa": 9.0, "largest_von_mises_at_mm": [1.0, 2.0],
        "largest_von_mises_singular_at": None, "largest_von_mises_elsewhere_kPa": 5.0,
        "largest_von_mises_elsewhere_at_mm": [3.0, 4.0],
    }  # fmt: skip
    plain = "largest von Mises stress 9.0 kPa, at x = 1, y = 2 (undeformed coordinates)"
    assert stress_line(summary) == plain
    # what rounding leaves of a zero
    noisy = summary | {"largest_von_mises_at_mm": [-7e-15, 2.0]}
    assert stress_line(noisy) == plain.replace("x = 1", "x = 0")
    assert stress_line(summary | {"largest_von_mises_singular_at": "a re-entrant corner"}) == (
        f"{plain}: a re-entrant corner, where the exact stress is infinite and the computed stress "
        "grows with refinement (away_from_singular of von_mises excludes this point); elsewhere "
        "5.0 kPa, at x = 3, y = 4"
    )


def test_what_an_optimisation_lacks_is_said_before_load_steps_are_chosen(
    bulb, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr("seal_mdao.cli.optimize.seal_of", None)
    text = bulb.read_text(encoding="utf-8")
    (tmp_path / "cases.sql").write_bytes(b"")
    with pytest.raises(SystemExit) as ended:
        main(["optimize", str(bulb), "--out", str(tmp_path)])
    assert ended.value.code == 2
    assert "contains an earlier optimisation" in capsys.readouterr().err
    bulb.write_text(text[: text.index("[optimize]")], encoding="utf-8")
    assert main(["optimize", str(bulb), "--out", str(tmp_path / "out")]) == 2
    assert "[optimize] is missing" in capsys.readouterr().err


@pytest.mark.filterwarnings("default")
def test_warnings_of_python_are_lines_of_the_command(tmp_path, capsys):
    """Without file, line number and source, which the user of a command does not know."""

    def command(arguments):
        warnings.warn("contact is at a kink", sm.KinkWarning, stacklevel=1)
        return 0

    made = parser("a command for this test", str(tmp_path))
    assert run(made, command, []) == 0
    assert capsys.readouterr().err == "WARNING: contact is at a kink\n"


@pytest.mark.parametrize(
    ("finer", "points"),
    [
        ("", "1 adjacent contact point:"),
        ("edge_spacing = { tip = 0.04 }", "3 adjacent contact points:"),
    ],
)
def test_a_printed_peak_of_few_points_says_so_without_a_measure(tmp_path, capsys, finer, points):
    pytest.importorskip("netgen")
    path = tmp_path / "lip.toml"
    path.write_text(PRESSED_TIP.format(section=f"spacing = 0.3\n{finer}"), encoding="utf-8")
    main(["analyze", str(path), "--out", str(tmp_path / "out")])
    assert f", of only {points} reduce edge_spacing there)" in capsys.readouterr().out

"""The spacing of particles is chosen so that errors are below a tolerance."""

import json
import tomllib

import numpy as np
import pytest
from cord_files import cord

import seal_mdao as sm
from seal_mdao.accuracy import chosen_spacing
from seal_mdao.accuracy.chosen_spacing import Cloud, refine, with_factor
from seal_mdao.accuracy.error_estimate import ErrorEstimate
from seal_mdao.cli.subcommands import main
from seal_mdao.seals.result import analyze


def estimate(relative):
    return ErrorEstimate(np.array([2.0]), np.array([2.0 * relative]), np.zeros(1), np.zeros(1), 2.0)


@pytest.fixture
def second_order(monkeypatch):
    """Errors of 4 % at a spacing of 0.8 mm that fall with its square; nothing is analysed."""

    def estimated(file, result, callback):
        return {"reaction": estimate(0.04 * (file.section.spacing / 0.8) ** 2)}

    monkeypatch.setattr(chosen_spacing, "estimate_errors", estimated)
    monkeypatch.setattr(chosen_spacing, "build_seal", lambda file: None)
    monkeypatch.setattr(chosen_spacing, "analyze", lambda seal, keep_factors: None)


def test_second_order(second_order, tmp_path):
    """Two clouds are enough; the second is no finer than needed."""
    tried = []
    found = refine(sm.read_seal_file(cord(tmp_path, spacing=0.8)), 0.01, ["reaction"], tried.append)
    assert tried[-1] is found
    # 0.9 * 0.8 mm * sqrt(1/4)
    assert [cloud.file.section.spacing for cloud in tried] == [0.8, 0.36]
    assert found.worst(["reaction"]) == ("reaction", pytest.approx(0.0081))


def test_tolerances_of_steps_and_penalties(second_order, tmp_path):
    """Those that the file leaves open; given steps stay."""
    path = cord(tmp_path, spacing=0.8)
    found = refine(sm.read_seal_file(path), 0.01, ["reaction"])
    assert found.file.penalty_tolerance == pytest.approx(5e-4)
    assert found.file.step_tolerance is None
    path.write_text(path.read_text().replace(", steps = 16", ""))
    assert refine(sm.read_seal_file(path), 0.01, ["reaction"]).file.step_tolerance == 0.0025
    assert refine(sm.read_seal_file(path), 0.1, ["reaction"]).file.step_tolerance == 0.005


def test_slower_convergence_ends(monkeypatch, second_order, tmp_path):
    monkeypatch.setattr(
        chosen_spacing, "estimate_errors", lambda *given: {"reaction": estimate(0.04)}
    )
    monkeypatch.setattr(chosen_spacing, "analyze", lambda seal, keep_factors: Particles)
    with pytest.raises(ValueError, match=r"error of reaction is still 4 % .* 12 particles"):
        refine(sm.read_seal_file(cord(tmp_path, spacing=0.8)), 0.01, ["reaction"])


class Particles:
    particles = np.zeros((12, 2))


def test_all_distances_are_multiplied(tmp_path):
    path = cord(tmp_path, spacing=0.8)
    path.write_text(
        path.read_text().replace("spacing = 0.8", "spacing = 0.8\nedge_spacing = { side = 0.4 }")
    )
    section = with_factor(sm.read_seal_file(path), 0.51).section
    # 2 cells across a wall become 4
    assert (section.spacing, section.layers, section.edge_spacing) == (0.408, 5, {"side": 0.204})


@pytest.mark.parametrize(
    ("names", "text"),
    [
        (["force"], "unknown measure 'force'; known are reaction"),
        ([], "the seal file has no measure whose"),
    ],
)
def test_wrong_names(names, text, tmp_path):
    with pytest.raises(ValueError, match=text):
        refine(sm.read_seal_file(cord(tmp_path)), 0.01, names)


def test_nothing_to_estimate():
    none = ErrorEstimate(np.ones(1), None, None, np.zeros(1), 1.0, "the path ends early")
    with pytest.raises(
        ValueError, match="error of the results cannot be estimated: the path ends early"
    ):
        Cloud(None, None, {"reaction": none}).worst(["reaction"])


def test_command(tmp_path, capsys):
    """A force within 0.5 %, and a file with the spacing that has it."""
    path, out = cord(tmp_path, spacing=0.6), tmp_path / "out"
    given = ["refine", str(path), "--to", "0.5 %", "--measures", "reaction", "--out", str(out)]
    assert main(given) == 0
    text = capsys.readouterr().out
    clouds = json.loads((out / "summary.json").read_text())["clouds"]
    assert len(clouds) >= 2
    last = clouds[-1]["errors"]["reaction"]
    assert last["bar"] <= 0.005 * last["value"] < clouds[0]["errors"]["reaction"]["bar"]
    assert f"{clouds[-1]['n_particles']} particles" in text
    # other lines are unchanged, and the new file gives the new cloud
    written = (out / path.name).read_text()
    assert tomllib.loads(written)["profile"] == tomllib.loads(path.read_text())["profile"]
    again = analyze(sm.build_seal(sm.read_seal_file(out / path.name)))
    assert len(again.particles) == clouds[-1]["n_particles"]
    # within the tolerance of a cloud of half its spacing
    finer = with_factor(sm.read_seal_file(out / path.name), 0.5)
    best = float(analyze(sm.build_seal(finer)).value("reaction")[0])
    assert abs(last["value"] - best) <= 0.005 * best
    assert (out / "errors.png").stat().st_size
    assert (out / "section.png").stat().st_size


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--to", "0"], "'0' is not a percentage above 0"),
        (["--to", "much"], "'much' is not a percentage"),
        (["--out", "."], "would be overwritten"),
    ],
)
def test_wrong_arguments(arguments, text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main(["refine", str(cord(tmp_path)), *arguments])
    assert ended.value.code == 2
    assert text in capsys.readouterr().err

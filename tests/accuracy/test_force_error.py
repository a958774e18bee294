"""Estimated error of the forces at the default spacing, against finer particles and finite elements."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from verification.loaded_sections import REFERENCES, loaded_errors, loaded_result

import seal_mdao as sm
from seal_mdao.accuracy import error_estimate
from seal_mdao.accuracy import force_error as module
from seal_mdao.accuracy.force_error import LARGEST, WANTED, ForceError, force_error
from seal_mdao.cli.subcommands import main
from seal_mdao.file_optimization import FILLING

pytest.importorskip("netgen")

BULB = """
[material.foam]
law = "hyperfoam"
mu = [120.0, 40.0]
alpha = [4.0, -2.0]
nu = [0.2, 0.3]
[section]
outer = [
  { edge = "base", line = [[-5.0, 0.0], [5.0, 0.0]] },
  { edge = "side", line = [[5.0, 0.0], [5.0, 2.0]] },
  { edge = "bulb", arc = { start = [5.0, 2.0], through = [0.5, 8.0], end = [-5.0, 2.0] } },
  { edge = "other", line = [[-5.0, 2.0], [-5.0, 0.0]] },
]
hole = [{ edge = "inside", circle = { centre = [0.2, 4.7], radius = 1.8 } }]
[fixed]
edges = ["base"]
[[profile]]
name = "door"
friction = 0.3
contact = ["bulb"]
circle = { centre = [0.0, 0.0], radius = 10.0 }
start = [1.5, 18.0]
stage = [{ translate = [0.0, -1.0] }, { translate = [0.0, -1.2] }]
"""
"""Foam bulb with a thick wall around a small hole, which is nearly closed: too stiff by default."""


@pytest.fixture(scope="module")
def bulb(tmp_path_factory):
    """The bulb: its file, the result, and the estimated error."""
    path = tmp_path_factory.mktemp("bulb") / "bulb.toml"
    path.write_text(BULB, encoding="utf-8")
    file = sm.read_seal_file(path)
    result = sm.analyze(sm.build_seal(file))
    return file, result, force_error(file, result)


def test_estimate_is_that_of_other_particles_with_the_recommended_spacing(bulb):
    file, result, found = bulb
    spacing, layers = found.filling
    finer = replace(file, section=replace(file.section, spacing=spacing, layers=layers))
    fine = sm.analyze(sm.build_seal(finer))
    # e = C h^2:  (F_h - F_fine) / F = C (h^2 - h_fine^2)
    force, other = (own.reaction[-1, 1] for own in (result, fine))
    ratio = (spacing / file.section.spacing) ** 2
    error = (force / other - 1.0) / (1.0 - ratio)
    assert error > 0.05
    assert 0.8 * error <= found.relative <= 1.2 * error
    assert ratio * error <= WANTED
    assert f"{100.0 * found.relative:.2g} %" in found.warning
    assert f"spacing = {spacing:g} and layers = {layers} in [section]" in found.warning


HOOD = """
[material.sponge]
sponge = "2A2"
[section]
spacing = 1.0
layers = 5
outer = [
  { edge = "base", line = [[-8.0, 0.0], [8.0, 0.0]] },
  { edge = "crown", line = [[8.0, 0.0], [8.0, 4.0]] },
  { edge = "crown", arc = { start = [8.0, 4.0], through = [0.0, 12.0], end = [-8.0, 4.0] } },
  { edge = "crown", line = [[-8.0, 4.0], [-8.0, 0.0]] },
]
hole = [
  { edge = "cavity", line = [[-6.0, 4.0], [-6.0, 2.0], [6.0, 2.0], [6.0, 4.0]] },
  { edge = "cavity", arc = { start = [6.0, 4.0], through = [0.0, 10.0], end = [-6.0, 4.0] } },
]
[fixed]
edges = ["base"]
[[profile]]
name = "hood"
friction = 0.3
normal_penalty = 1.5e5
tangent_penalty = 5e3
arc = { start = [-12.0, 8.0], through = [0.0, 0.0], end = [12.0, 8.0] }
start = [1.0, 12.5]
stage = [{ translate = [0.0, -5.0], steps = 16 }]
"""
"""D-shaped profile of foam under a round hood; with half of the spacing iterations diverge in the fourth
of eight load steps."""


@pytest.fixture(scope="module")
def hood(tmp_path_factory):
    path = tmp_path_factory.mktemp("hood") / "hood.toml"
    path.write_text(HOOD, encoding="utf-8")
    file = sm.read_seal_file(path)
    return file, sm.analyze(sm.build_seal(file))


def test_a_load_step_that_is_too_long_is_halved(hood):
    found = force_error(*hood)
    assert not found.unknown
    # 0.37 % in 16 load steps with both spacings
    assert found.relative == pytest.approx(0.0038, rel=0.05)


def test_another_path_in_few_load_steps_is_computed_in_more(hood, monkeypatch):
    """As that of a ring that rolls; here every difference counts as another path."""
    monkeypatch.setattr(module, "APART", 1e-9)
    found = force_error(*hood)
    assert not found.unknown
    assert found.relative == pytest.approx(0.0037, rel=0.05)


def test_estimate_is_the_difference_from_finite_elements():
    """A bulb whose force is 1.8 % too large, which is no reason for a warning."""
    name = "stretched_bulb"
    result = loaded_result(name)
    found = force_error(sm.read_seal_file(REFERENCES / f"{name}.toml"), result)
    assert abs(found.relative / loaded_errors(name, result).force - 1.0) <= 0.15
    assert not found.warning
    assert not found.unknown


def test_paths_that_leave_that_of_the_result_give_no_estimate(bulb, monkeypatch):
    """As where a profile passes a lip in one load step: both clouds have no force."""
    file, result, _ = bulb
    original = error_estimate.force_difference

    def apart(coarse, fine, at):
        return 0.3 if fine is result else original(coarse, fine, at)

    monkeypatch.setattr(error_estimate, "force_difference", apart)
    found = force_error(file, result)
    assert found.relative is None
    assert "another path" in found.unknown
    assert not found.warning


def test_warning_only_above_the_largest_error():
    assert not ForceError(LARGEST).warning
    assert not ForceError(None, "a reason").warning


def test_remedy_is_that_of_an_error_of_second_order():
    """Of 8 % a quarter is admitted: 0.9 times half of the spacing, and 7 cells for 3 across a wall."""
    file = SimpleNamespace(section=SimpleNamespace(spacing=1.0, layers=4))
    assert module._with_remedy(file, 0.08).filling == (0.45, 8)
    assert module._with_remedy(file, LARGEST).filling is None


def test_analyze_prints_the_error_of_a_file_without_spacing(bulb, tmp_path, capsys):
    file, _, found = bulb
    assert main(["analyze", str(file.path), "--out", str(tmp_path / "out"), "--no-vtu"]) == 0
    assert f"WARNING: {found.warning}" in capsys.readouterr().out
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["force_error_by_spacing"] == pytest.approx(found.relative, rel=1e-9)
    assert found.warning in summary["warnings"]


OPTIMIZED = """
[[design]]
edges = ["bulb"]
parameters = 2
bound = 0.05
[optimize]
minimize = "section_area"
[[optimize.constraint]]
measure = "reaction"
lower = 1.0
"""


def test_optimize_prints_the_error_of_the_optimum_without_spacing(tmp_path, capsys):
    (tmp_path / "bulb.toml").write_text(BULB + OPTIMIZED, encoding="utf-8")
    out = tmp_path / "out"
    main(["optimize", str(tmp_path / "bulb.toml"), "--out", str(out), "--max-iterations", "1"])
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    # that of the written optimum with the spacing and the layers of the default
    optimum = sm.read_seal_file(out / "optimum.toml")
    filling = {
        name: getattr(sm.read_seal_file(out.parent / "bulb.toml").section, name) for name in FILLING
    }
    file = replace(optimum, section=replace(optimum.section, **filling))
    found = force_error(file, sm.analyze(sm.build_seal(file)))
    assert summary["force_error_by_spacing"] == pytest.approx(found.relative, rel=1e-9)
    assert found.warning in summary["warnings"]
    said = capsys.readouterr().out
    assert said.count(f"WARNING (last design): {found.warning}") == 1
    assert "numerical error of the forces due to the particle spacing" in said


def test_analyze_with_a_spacing_estimates_nothing(tmp_path, capsys):
    path = tmp_path / "bulb.toml"
    path.write_text(BULB.replace("[section]", "[section]\nspacing = 1.0\nlayers = 3"))
    assert main(["analyze", str(path), "--out", str(tmp_path / "out"), "--no-vtu"]) == 0
    assert "due to the particle spacing" not in capsys.readouterr().out
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert "force_error_by_spacing" not in summary


def test_largest_force_is_compared_although_it_is_within_a_stage(tmp_path):
    """A roller passes over the bulb in one stage, and leaves it."""
    text = BULB.replace("start = [1.5, 18.0]", "start = [-7.0, 17.4]").replace(
        "friction = 0.3", "friction = 0.0"
    )
    begin = text.index("stage = [")
    path = tmp_path / "bulb.toml"
    path.write_text(text[:begin] + "stage = [{ translate = [14.0, 0.0], steps = 14 }]\n")
    result = sm.analyze(sm.build_seal(path))
    largest = 1 + int(np.linalg.norm(result.reaction, axis=1).argmax())
    assert 4 <= largest <= 10
    assert module._compared_ends(result).tolist() == [largest, 14.0]

"""Estimated errors of measures by particles, load steps and penalties, against errors that are known."""

import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from cord_files import cord
from seal_file.block_files import BLOCK, FIXED, MOVED

import seal_mdao as sm
from seal_mdao.accuracy.error_estimate import (
    ErrorEstimate,
    _by_particles,
    estimate_errors,
    some_ends,
)
from seal_mdao.accuracy.refined_file import refined_file
from seal_mdao.analysis.increment import Solution
from seal_mdao.analysis.path_result import Status
from seal_mdao.cli.error_table import error_lines
from seal_mdao.cli.subcommands import main
from seal_mdao.measures.contact_pressure import ContactWidth
from seal_mdao.measures.fluid import BlowOffPressure
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.retention import CompressionSet, RetainedForce, TimeToForceFraction
from seal_mdao.measures.work import ProfileWork
from seal_mdao.plotting import error_parts
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.result import analyze, analyze_particles

MEASURED = '[[measure]]\ntype = "reaction"\nname = "force"\nprofile = "top"\n'


def analyzed(path):
    file = sm.read_seal_file(path)
    return file, analyze(sm.build_seal(file))


def force(result) -> float:
    return float(result.value("reaction")[0])


@pytest.fixture(scope="module")
def estimated(tmp_path_factory):
    file, result = analyzed(cord(tmp_path_factory.mktemp("cord")))
    return result, estimate_errors(file, result)


def test_formulas(tmp_path):
    """Both differences, of ordinary paths: 4/3 between the clouds, 1/3 of what 8 for 32 steps change."""
    file, result = analyzed(cord(tmp_path, steps=32))
    seal = result.seal
    fine = unchosen_seal(refined_file(file, seal).file)
    ends = some_ends(seal, 8)
    paths = [analyze(own.with_ends(ends)) for own in (seal, fine)]
    few, on_fine = (force(path) for path in paths)
    along = 4 / 3 * np.subtract(*([force(own) for own in path.up_to_each_step()] for path in paths))
    found = estimate_errors(file, result)["reaction"]
    # iterations end at a residual of 1e-5 of the forces
    assert found.particles[0] == pytest.approx(4 / 3 * (few - on_fine), abs=4e-5 * few)
    rms = np.sqrt(np.mean(along[4:] ** 2))
    assert found.fluctuation[0] == pytest.approx(rms, abs=4e-5 * few)
    # that over the complete path is another one
    assert abs(rms - np.sqrt(np.mean(along**2))) > 8e-5 * few
    assert found.load_steps[0] == pytest.approx((few - force(result)) / 3, abs=1e-5 * few)


def test_particles(estimated, tmp_path):
    """A cloud of half the spacing, filled anew, has a quarter of the error."""
    result, estimates = estimated
    actual = force(result) - force(analyzed(cord(tmp_path, spacing=0.2))[1])
    ratio = estimates["reaction"].particles[0] / actual
    assert 0.5 < ratio < 2.0, ratio


def test_particles_of_a_block(tmp_path):
    """A square grid under a bonded plate, with a singular corner, against an eighth of the spacing."""
    path = tmp_path / "block.toml"
    path.write_text(BLOCK.format(bulk=1e3, spacing=1.0) + FIXED + MOVED + MEASURED)
    file, result = analyzed(path)
    path.write_text(BLOCK.format(bulk=1e3, spacing=0.25) + FIXED + MOVED + MEASURED)
    actual = result.value("force") - analyzed(path)[1].value("force")
    ratio = estimate_errors(file, result)["force"].particles / actual
    assert ((ratio > 0.5) & (ratio < 2.0)).all(), ratio


def test_load_steps(estimated, tmp_path):
    """Eight times as many load steps have an eighth of the error; of the force by friction."""
    file, result = analyzed(cord(tmp_path, steps=32))
    across = Reaction("lid", name="force_on_lid")
    many = analyzed(cord(tmp_path, steps=256))[1]
    actual = result.value(across)[0] - many.value(across)[0]
    ratio = estimate_errors(file, result)["force_on_lid"].load_steps[0] / actual
    assert 0.5 < ratio < 2.0, ratio


def test_penalties(tmp_path):
    """A thousand times the penalties have a thousandth of the error."""
    file, soft = analyzed(cord(tmp_path, penalty=1e5))
    stiff = analyzed(cord(tmp_path, penalty=1e8))[1]
    ratio = estimate_errors(file, soft)["reaction"].penalties[0] / (force(soft) - force(stiff))
    assert 0.8 < ratio < 1.25, ratio


def test_same_points(estimated):
    """A norm over all particles is compared over the same places; a sum over particles is not."""
    _, estimates = estimated
    norm, total = estimates["stress_norm"], estimates["gap_square_sum"]
    # four times as many places alone would make the norm larger by 4^(1/p)
    assert abs(norm.particles[0]) < 0.05 * norm.value[0]
    assert total.particles is None
    assert total.bar is None
    assert "number of particles" in total.unknown
    assert total.load_steps is not None


def test_bar_and_error():
    found = ErrorEstimate(np.array([2.0]), np.array([0.3]), np.array([-0.1]), np.array([0.05]), 2.0)
    assert found.error == pytest.approx(0.25)
    assert found.bar == pytest.approx(0.45)
    assert replace(found, penalties=None).error is None
    # a fluctuation makes the bar longer, and no error larger
    wide = replace(found, fluctuation=np.array([0.5]))
    assert wide.error == pytest.approx(0.25)
    assert wide.bar == pytest.approx(0.65)
    assert replace(found, fluctuation=np.array([0.2])).bar == pytest.approx(0.45)
    assert replace(wide, particles=None).bar is None


STRIP = """
[material.rubber]
law = "mooney_rivlin"
c10 = 500.0
c01 = 125.0
bulk_modulus = 400000.0
[section]
spacing = {spacing}
outer = [
  {{ edge = "base", line = [[-6, 0], [6, 0]] }},
  {{ edge = "dome", arc = {{ start = [6, 0], through = [0, 6], end = [-6, 0] }} }},
]
[fixed]
edges = ["base"]
[[profile]]
name = "door"
contact = ["dome"]
contact_points = "particles"
friction = 0.3
line = [[-40, 0], [40, 0]]
start = [0, 6]
stage = [{{ translate = [0, -1.8] }}]
[[measure]]
type = "contact_width"
"""
"""A half-round strip, glued at its base and squeezed by 30 %."""


def test_agreement_by_chance(tmp_path):
    """At the end of the path two coarse clouds have nearly the same width, which is wrong by several
    percent: before the end their widths differ."""

    def width(spacing):
        path = tmp_path / "strip.toml"
        path.write_text(STRIP.format(spacing=spacing))
        file, result = analyzed(path)
        return file, result, result.value("contact_width")

    file, result, coarse = width(2.2)
    found = estimate_errors(file, result)["contact_width"]
    actual = abs(coarse - width(0.6)[2])
    assert abs(found.particles) < 0.25 * actual
    assert 0.5 * actual < found.bar < 2.0 * actual
    (line,) = [own for own in error_lines({"contact_width": found}, result) if "+- of" in own]
    assert "oscillates along the path; +- of contact_width contains" in line


def test_decreasing_values():
    """A tenth of a value that is five times that at the end, as of a strip that is released, is no half
    of that at the end; and a value before the end that is not finite is left out."""

    def compared(measure, earlier=(10.0, 9.0), end=(2.0, 1.94)):
        def path(value):
            return SimpleNamespace(value=lambda own: np.array([value]))

        paths = SimpleNamespace(
            coarse=path(end[0]), fine=path(end[1]), kept=None,
            before_end=[(path(earlier[0]), path(earlier[1]))],
        )  # fmt: skip
        return _by_particles(measure, paths, 2.0).ravel()

    measure = SimpleNamespace(name="own", at_end=True, on_refined=lambda fine, kept: "own")
    assert compared(measure) == pytest.approx([4 / 3 * 0.2, 4 / 3 * 0.06])
    assert compared(measure, (1.0, 0.9)) == pytest.approx([4 / 3 * 0.1, 4 / 3 * 0.06])
    assert compared(measure, (10.0, np.nan)) == pytest.approx([4 / 3 * 0.06])
    # no error of a force that has been released
    assert compared(measure, end=(0.0, 0.0)) == pytest.approx([0.0, 0.0])
    assert compared(measure, end=(0.0, 0.03)) == pytest.approx([4 / 3 * 0.2, 4 / 3 * -0.03])
    measure.at_end = False
    assert compared(measure) == pytest.approx([4 / 3 * 0.06])


@pytest.mark.parametrize(
    ("measure", "at_end"),
    [
        (Reaction("lid"), True),
        (Reaction("lid", travels=(1.0,)), False),
        (Reaction("lid", stages=(1,)), False),
        (Reaction("lid", times=(1.0,)), False),
        (RetainedForce(Reaction("lid", stages=(1, 2))), False),
        (TimeToForceFraction(Reaction("lid"), 0.5), False),
        (CompressionSet(0), False),
        (ProfileWork("lid"), True),
        (ProfileWork("lid", stages=(0, 1)), False),
        (BlowOffPressure("water"), False),
        (ContactWidth("lid"), True),
    ],
)
def test_measures_at_the_end(measure, at_end):
    """Those at given stages or travels have other values on a shorter path, or none."""
    assert measure.at_end is at_end


def test_few_ends(tmp_path):
    """Of 16 load steps every second one, the last one always."""
    seal = sm.build_seal(cord(tmp_path))
    assert some_ends(seal, 8).tolist() == list(np.arange(2.0, 17.0, 2.0))
    assert some_ends(seal, 5).tolist() == [4.0, 8.0, 12.0, 16.0]


def test_paths_that_fail_are_said(tmp_path, monkeypatch):
    """The finer cloud does not come to an end: what else is known stays, with the reason."""
    file, result = analyzed(cord(tmp_path))
    monkeypatch.setattr("seal_mdao.analysis.load_path.iterate", _never)
    monkeypatch.setattr("seal_mdao.analysis.load_path.newton", _never_newton)
    monkeypatch.setattr("seal_mdao.analysis.load_path.mixed_newton", _never_newton)
    found = estimate_errors(file, result)["reaction"]
    assert found.particles is None
    assert "could not be completed" in found.unknown
    assert found.penalties is not None


def test_error_of_the_forces_before_the_finer_path_fails(tmp_path, monkeypatch):
    """With half of the spacing the path ends after five of eight load steps."""
    file, result = analyzed(cord(tmp_path))
    seal = result.seal
    fine = unchosen_seal(refined_file(file, seal).file)
    both = [analyze(own.with_ends(some_ends(seal, 8))) for own in (seal, fine)]
    forces = [np.array([force(own) for own in path.up_to_each_step()]) for path in both]
    error = 4 / 3 * np.abs(np.subtract(*forces))[:5].max() / forces[0].max()
    solve = analyze_particles

    def ended(seal, *others, **options):
        found = solve(seal, *others, **options)
        if len(seal.nominal_particles) == len(fine.nominal_particles):
            path = replace(found.path, steps=found.path.steps[:5], status=Status.SINGULAR)
            found = replace(found, path=path)
        return found

    monkeypatch.setattr("seal_mdao.accuracy.error_estimate.analyze_particles", ended)
    monkeypatch.setattr("seal_mdao.accuracy.error_estimate.MORE", 1)
    text = estimate_errors(file, result)["reaction"].unknown
    stated = re.search(r"due to the particles is at most ([\d.]+) % of the largest force", text)
    assert float(stated[1]) == pytest.approx(100.0 * error, rel=0.05)
    assert 0.1 < float(stated[1]) < 10.0


def _never(increment, d, *others, **options):
    return Solution(Status.NOT_CONVERGED, d, (1.0,), increment.evaluate(d))


def _never_newton(increment, guess):
    return _never(increment, guess)


def test_design_is_refused(tmp_path):
    path = cord(tmp_path)
    path.write_text(
        path.read_text() + '[[design]]\nedges = ["side"]\nparameters = 4\nbound = 0.2\n'
    )
    file = sm.read_seal_file(path)
    result = analyze(sm.build_seal(file), np.array([0.0, 0.1, 0.0, 0.0]))
    with pytest.raises(ValueError, match="for the nominal section only"):
        estimate_errors(file, result)


def test_command(tmp_path, capsys):
    """The table, the summary and the figure have the same numbers."""
    out = tmp_path / "out"
    assert main(["analyze", str(cord(tmp_path)), "--errors", "--no-vtu", "--out", str(out)]) == 0
    text = capsys.readouterr().out
    written = json.loads((out / "summary.json").read_text())
    summary = written["errors"]
    force = summary["reaction"]
    assert written["measures"]["reaction"]["error_bar"] == force["bar"]
    parts = [force[part] for part in ("particles", "load_steps", "penalties")]
    assert force["bar"] == pytest.approx(sum(map(abs, parts)))
    row = next(line.split() for line in text.splitlines() if line.startswith("reaction  "))
    assert float(row[2]) == pytest.approx(force["bar"], rel=0.05)
    assert [float(part) for part in row[-3:]] == pytest.approx(parts, rel=0.05)
    assert summary["gap_square_sum"]["bar"] is None
    assert "not estimated (?) for gap_square_sum" in text
    assert (out / "errors.png").stat().st_size > 0


def test_figure(estimated):
    """A group of three bars for every measure with a known part."""
    _, estimates = estimated
    axes = error_parts(estimates).axes[0]
    labels = [text.get_text() for text in axes.get_yticklabels()]
    assert "reaction" in labels
    assert len(axes.patches) == 3 * len(labels)
    at = labels.index("reaction")
    own = estimates["reaction"]
    assert axes.patches[at].get_width() == pytest.approx(100 * own.particles[0] / own.scale)


def test_parts_that_are_not_estimated_are_marked_and_their_reason_is_given_once():
    none = np.array([1.0])
    estimates = {
        name: ErrorEstimate(np.array([50.0]), None, steps, none, 50.0, "walls touch each other")
        for name, steps in (("force", none), ("stress", None))
    }
    axes = error_parts(estimates).axes[0]
    assert [own.get_text() for own in axes.texts] == ["not estimated"] * 3
    legend = [own.get_text() for own in axes.get_legend().get_texts()]
    assert legend == ["particles (not estimated)", "load steps", "penalties"]
    seal = SimpleNamespace(standard=(), units=SimpleNamespace(force="N/m"))
    lines = error_lines(estimates, SimpleNamespace(seal=seal))
    assert lines[-1] == "not estimated (?) for force, stress: walls touch each other"
    assert sum("walls touch" in line for line in lines) == 1


def test_percentages_of_a_component_name_what_they_are_relative_to():
    """A component of 10 N/m of a force of 200 N/m; those of the other one are relative to the value."""
    none = np.array([1.0])
    estimates = {
        name: ErrorEstimate(np.array([10.0]), none, none, none, scale)
        for name, scale in (("drag", 200.0), ("width", 10.5))
    }
    seal = SimpleNamespace(standard=(), units=SimpleNamespace(force="N/m"))
    lines = error_lines(estimates, SimpleNamespace(seal=seal))
    (line,) = [own for own in lines if own.startswith("in %")]
    assert "of drag to 200 N/m (" in line
    assert "width" not in line


def test_stored_figures_of_the_page():
    """The page shows what is estimated today, to the three digits that are stored."""
    root = Path(__file__).parents[2]
    stored = json.loads((root / "docs" / "benchmarks" / "error_estimates.json").read_text())
    file, result = analyzed(root / "examples" / "paper_seal.toml")
    estimates = estimate_errors(file, result)
    for name, own in stored["paper_seal"]["errors"].items():
        found = estimates[name].particles / estimates[name].scale
        # iterations end at a residual of 1e-5 of the forces
        np.testing.assert_allclose(found, own["estimated"], rtol=6e-3, atol=2e-4)


def test_relative_error_bars_are_known_or_none():
    part = np.array([0.3, -0.1])
    known = ErrorEstimate(np.ones(2), part, -part, part, 2.0)
    assert known.relative == pytest.approx([0.45, 0.15])
    assert replace(known, scale=0.0).relative is None
    assert replace(known, load_steps=None).relative is None
    empty = np.zeros(0)
    assert ErrorEstimate(empty, empty, empty, empty, 2.0).relative is None

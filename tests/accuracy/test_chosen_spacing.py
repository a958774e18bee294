"""Particles are chosen for admissible errors: by the key ``accuracy`` and the command ``refine``."""

import json
import re
import tomllib
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from cord_files import cord
from round_tip import PRESSED_TIP

import seal_mdao as sm
from seal_mdao import registry, user_cache
from seal_mdao.accuracy import chosen_spacing
from seal_mdao.accuracy.chosen_spacing import Cloud, _finer_edges, refine, with_factor
from seal_mdao.accuracy.error_estimate import ErrorEstimate
from seal_mdao.cli.refine import refined_text
from seal_mdao.cli.seal_files import cloud_line
from seal_mdao.cli.subcommands import main
from seal_mdao.file_seal import file_and_seal
from seal_mdao.plotting import section_cloud
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.result import analyze
from seal_mdao.seals.settings import seal_of

REACTION = '{ reaction = "1 %" }'


def estimate(relative, steps=0.0, fluctuation=0.0):
    return ErrorEstimate(
        np.array([2.0]), np.array([2.0 * relative]), np.array([2.0 * steps]), np.zeros(1), 2.0,
        fluctuation=np.array([2.0 * fluctuation]),
    )  # fmt: skip


def accurate(folder, accuracy=REACTION, spacing="spacing = 0.8", **given):
    """Cord with ``accuracy`` and a line for the spacing, which may be empty."""
    path = cord(folder, spacing=0.8, **given)
    text = path.read_text().replace("spacing = 0.8", f"{spacing}\naccuracy = {accuracy}")
    path.write_text(text)
    return path


class NoResult:
    """Stands for a completed analysis of 12 particles."""

    particles, seal, path = np.zeros((12, 2)), None, None

    def require_converged(self):
        pass

    def measures(self, names):
        return ()


def errors_by(monkeypatch, estimated):
    """Replace the estimate by a function of the spacing; nothing is analysed."""
    monkeypatch.setattr(
        chosen_spacing, "estimate_errors", lambda file, *others: estimated(file.section.spacing)
    )
    monkeypatch.setattr(chosen_spacing, "built", lambda file, callback: None)
    monkeypatch.setattr(chosen_spacing, "analyze", lambda seal, keep_factors, callback: NoResult())
    monkeypatch.setattr(chosen_spacing, "_require_limit", lambda result: None)
    monkeypatch.setattr(chosen_spacing, "store_path", lambda seal, path: None)


@pytest.fixture
def second_order(monkeypatch):
    """Errors of 4 % at a spacing of 0.8 mm that fall with its square, of the width of 16 %."""

    def estimated(spacing):
        relative = 0.04 * (spacing / 0.8) ** 2
        return {"reaction": estimate(relative), "contact_width": estimate(4.0 * relative)}

    errors_by(monkeypatch, estimated)


def tried_spacings(path):
    tried = []
    found = refine(sm.read_seal_file(path), tried.append)
    assert tried[-1] is found
    return [cloud.file.section.spacing for cloud in tried], found


def test_measures_without_points_have_no_error(second_order, tmp_path):
    """The gap of a seal that has none: of all measures it is left out, by its name it is an error."""
    gap = '[[measure]]\ntype = "gap"\nprofile = "lid"\n'
    path = accurate(tmp_path, accuracy='"3 %"')
    path.write_text(path.read_text() + gap)
    found = refine(sm.read_seal_file(path))
    assert found.worst.name == "contact_width"
    assert found.not_estimated["gap"] == "the nominal seal has no point at which gap is evaluated"
    path.write_text(path.read_text().replace('"3 %"', '{ gap = "3 %" }'))
    with pytest.raises(
        ValueError, match="of gap cannot be estimated: the nominal seal has no point"
    ):
        refine(sm.read_seal_file(path))


def test_second_order(second_order, tmp_path):
    """Two clouds are enough; the second is no finer than needed."""
    spacings, found = tried_spacings(accurate(tmp_path))
    # 0.9 * 0.8 mm * sqrt(1/4)
    assert spacings == [0.8, 0.36]
    assert found.worst.name == "reaction"
    assert found.worst.error == pytest.approx(0.0081)
    assert found.file.section.chosen


def test_every_measure_has_its_own_admissible_error(second_order, tmp_path):
    """The measure farthest beyond its own error decides, not that with the largest error."""
    spacings, found = tried_spacings(
        accurate(tmp_path, '{ reaction = "1 %", contact_width = "10 %" }')
    )
    assert spacings == [0.8, 0.36]
    assert found.worst.name == "reaction"
    # 16 % and 4 % for 8 %: 0.9 * 0.8 mm * sqrt(1/2), the width now decides
    spacings, found = tried_spacings(
        accurate(tmp_path, '{ reaction = "4 %", contact_width = "8 %" }')
    )
    assert spacings == [0.8, 0.509]
    assert found.worst.name == "contact_width"


def test_the_particles_get_what_steps_and_penalties_leave(monkeypatch, tmp_path):
    """Of 1 % the steps take 0.5 %, so the particles have to be below that."""
    errors_by(
        monkeypatch, lambda spacing: {"reaction": estimate(0.04 * (spacing / 0.8) ** 2, 0.005)}
    )
    spacings, found = tried_spacings(accurate(tmp_path))
    # 0.9 * 0.8 mm * sqrt(0.5 / 4)
    assert spacings == [0.8, 0.255]
    assert found.worst.error <= 0.01


def test_steps_with_too_large_errors_are_refused(monkeypatch, tmp_path):
    errors_by(monkeypatch, lambda spacing: {"reaction": estimate(1e-4, 0.02)})
    path = accurate(tmp_path)
    with pytest.raises(
        ValueError, match=r"alone .* 1\.00%; leave steps, .*penalty out of the file"
    ):
        refine(sm.read_seal_file(path))
    # chosen steps cannot be left out
    text = re.sub(r"\w+_penalty = .*\n", "", path.read_text()).replace(", steps = 16", "")
    path.write_text(text)
    monkeypatch.setattr(chosen_spacing, "built", lambda file, callback: None)
    with pytest.raises(
        ValueError, match=r"admit a larger error of reaction in accuracy of \[section"
    ):
        refine(sm.read_seal_file(path))


def test_tolerances_of_steps_and_penalties(tmp_path):
    """Those that the file leaves open; given steps stay, and so do smaller tolerances."""
    path = accurate(tmp_path)
    file = sm.read_seal_file(path)
    assert file.penalty_tolerance == pytest.approx(5e-4)
    assert file.step_tolerance is None
    text = path.read_text().replace(", steps = 16", "")
    path.write_text(text)
    assert sm.read_seal_file(path).step_tolerance == pytest.approx(0.0025)
    path.write_text(text + "[steps]\ntolerance = 0.001\n")
    assert sm.read_seal_file(path).step_tolerance == 0.001
    path.write_text(text.replace("1 %", "10 %"))
    assert sm.read_seal_file(path).step_tolerance == 0.005


def test_a_measure_that_does_not_converge_ends_the_choice(monkeypatch, tmp_path):
    """As a stress at a sharp corner: after the third cloud, which is little finer, not after five."""
    errors_by(monkeypatch, lambda spacing: {"reaction": estimate(0.04 * (spacing / 0.8) ** 0.4)})
    tried = []
    with pytest.raises(ValueError, match=r"does not .*: 2\.91% with 0\.36 mm, 2\.37% with 0\.216"):
        refine(sm.read_seal_file(accurate(tmp_path)), tried.append)
    assert len(tried) == 3


def test_fluctuations_decide(monkeypatch, tmp_path):
    """The error at the end of the path is 0.1 %, its fluctuation 4 %: as an error of 4 %."""
    falling = lambda spacing: 0.04 * (spacing / 0.8) ** 2  # noqa: E731
    errors_by(
        monkeypatch, lambda spacing: {"reaction": estimate(1e-3, fluctuation=falling(spacing))}
    )
    assert tried_spacings(accurate(tmp_path))[0] == [0.8, 0.36]
    errors_by(monkeypatch, lambda spacing: {"reaction": estimate(1e-3, fluctuation=0.04)})
    with pytest.raises(ValueError, match=r"decrease .*: 4\.00% with 0\.36 mm, 4\.00% with 0\.216"):
        refine(sm.read_seal_file(accurate(tmp_path)))


def test_a_coarse_error_that_is_small_by_chance(monkeypatch, tmp_path):
    """The second error is larger than the first, the third falls with the square of the spacing."""

    def estimated(spacing):
        error = 0.034 if spacing == 0.8 else 0.2 * (spacing / 0.8) ** 2
        return {"reaction": estimate(error)}

    errors_by(monkeypatch, estimated)
    spacings, found = tried_spacings(accurate(tmp_path))
    # 0.9 * 0.8 mm * sqrt(1 / 3.4), then with 4.76 % by the smallest factor 0.6, then with 1.71 %
    # by 0.9 sqrt(1 / 1.71)
    assert spacings == [0.8, 0.39, 0.234, 0.161]
    assert found.worst.error <= 0.01


def spacings_of_two_measures(monkeypatch, tmp_path, errors) -> list:
    """Spacings tried with the estimated errors of a force and a contact width, by the spacing."""

    def estimated(spacing):
        force, width = errors[spacing]
        return {"reaction": estimate(force), "contact_width": estimate(width)}

    errors_by(monkeypatch, estimated)
    path = accurate(tmp_path, '{ reaction = "1 %", contact_width = "1 %" }')
    return tried_spacings(path)[0]


def test_an_error_that_is_zero_on_a_coarse_cloud_has_no_order(monkeypatch, tmp_path):
    """As the width of a contact that only smaller particles find; other errors need a second cloud."""
    errors = {0.8: (0.03, 0.0), 0.416: (0.005, 0.02), 0.265: (0.005, 0.005)}
    assert spacings_of_two_measures(monkeypatch, tmp_path, errors) == list(errors)


def test_slow_convergence_of_two_measures(monkeypatch, tmp_path):
    """Each of two measures has a larger error than before once: that says nothing about either."""
    errors = {0.8: (0.03, 0.02), 0.416: (0.04, 0.03), 0.25: (0.03, 0.04), 0.15: (0.005, 0.005)}
    assert spacings_of_two_measures(monkeypatch, tmp_path, errors) == list(errors)


def test_slower_convergence_ends(monkeypatch, tmp_path):
    errors_by(monkeypatch, lambda spacing: {"reaction": estimate(0.2 * (spacing / 0.8) ** 0.6)})
    with pytest.raises(ValueError, match=r"numerical error of reaction is still .* 12 particles"):
        refine(sm.read_seal_file(accurate(tmp_path)))


def test_all_distances_are_multiplied():
    filling = {"spacing": 0.8, "layers": 3, "edge_spacing": {"side": 0.4}}
    # 2 cells across a wall become 4
    assert with_factor(filling, 0.51) == {
        "spacing": 0.408, "layers": 5, "edge_spacing": {"side": 0.204}
    }  # fmt: skip
    # a factor that is 0.5 but for rounding
    assert with_factor(filling, 0.5 * (1.0 - 1e-12))["layers"] == 5


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("reaction =", "force =", "accuracy = 'force', but there is no such measure"),
        ('"1 %"', "1.0", "a percentage above 0 and at most 50"),
        ('"1 %"', '"60 %"', "a percentage above 0 and at most 50"),
        ('"1 %"', '"1"', "a percentage above 0 and at most 50"),
        ("spacing = 0.8", 'cloud = "a.vtu"', "accuracy can only be combined with spacing"),
        ("spacing = 0.8", "rays = { rays = 8, layers = 4 }", "accuracy can only be combined with"),
        (r"\[\[measure\]\][^[]*", "", "the file has no \\[\\[measure\\]\\]; add one"),
    ],
)
def test_wrong_keys(old, new, text, tmp_path):
    path = accurate(tmp_path)
    path.write_text(re.sub(old, new, path.read_text()))
    with pytest.raises(sm.SealFileError, match=text):
        sm.read_seal_file(path)


def test_start_without_spacing(tmp_path):
    """A twelfth of the smaller extent, 3 mm; of the layers and edges that are given."""
    path = accurate(tmp_path, spacing="layers = 5")
    assert sm.read_seal_file(path).section.filling == {
        "spacing": 0.25, "layers": 5, "edge_spacing": {}
    }  # fmt: skip


def test_measures_without_estimate(tmp_path):
    """One that the file names ends the choice, of all together it is left out."""
    none = ErrorEstimate(np.ones(1), None, np.zeros(1), np.zeros(1), 1.0, "the path ends early")
    estimates = {"reaction": estimate(0.001), "contact_width": none}
    estimates |= dict.fromkeys(("stress_norm", "gap_square_sum"), none)
    named = sm.read_seal_file(accurate(tmp_path, '{ reaction = "1 %", contact_width = "1 %" }'))
    with pytest.raises(ValueError, match="error of contact_width cannot be estimated: the path"):
        Cloud(named, None, estimates).worst  # noqa: B018
    every = Cloud(sm.read_seal_file(accurate(tmp_path, '"1 %"')), None, estimates)
    assert every.worst.name == "reaction"
    assert list(every.not_estimated) == ["contact_width", "stress_norm", "gap_square_sum"]


def test_creases_are_refused_before_the_estimate(monkeypatch, tmp_path):
    monkeypatch.setattr(chosen_spacing, "built", lambda file, callback: None)
    monkeypatch.setattr(chosen_spacing, "analyze", lambda seal, keep_factors, callback: NoResult())
    monkeypatch.setattr(chosen_spacing, "EvaluationPoints", lambda path: SimpleNamespace())
    monkeypatch.setattr(chosen_spacing, "creases", lambda samples: "the free surface is compressed")
    with pytest.raises(ValueError, match="because the free surface is compressed, or give spacing"):
        refine(sm.read_seal_file(accurate(tmp_path)))


MEASURES = """[[measure]]
type = "contact_width"
[[measure]]
type = "peak_pressure"
[[measure]]
type = "pressure_integral"
exponent = 2
reference_pressure = 100.0
"""


def lip(folder, accuracy, tip=0.04):
    path = folder / "lip.toml"
    section = f"spacing = 0.4\nedge_spacing = {{ tip = {tip} }}\naccuracy = {{ {accuracy} }}"
    path.write_text(PRESSED_TIP.format(section=section) + MEASURES)
    return path


def test_too_few_points_in_contact(tmp_path):
    """Two clouds agree about a width between three points to 2 %, which is wrong by 10 %: the edge in
    contact, and nothing else, is refined until five points touch."""
    path, tried = lip(tmp_path, 'contact_width = "8 %"'), []
    file, seal = file_and_seal(sm.read_seal_file(path), report=tried.append)

    def wrong(result):
        # Hertz: a = sqrt(4 F R / (pi E*)) with E* = 6 C10 / 0.75 and the force on the plate
        stiffness = 6.0 * result.seal.materials["rubber"].c10 / 0.75
        half = np.sqrt(4.0 * result.reaction[-1, 1] * 0.5 / (np.pi * stiffness))
        return abs(result.value("contact_width")[0] / (2.0 * half) - 1.0)

    assert tried[0].worst.error <= 0.02
    assert wrong(tried[0].result) > 0.08
    assert wrong(analyze(seal)) <= 0.08
    points = [int((cloud.result.response("plate").gap < 0.0).sum()) for cloud in tried]
    assert points[0] < 5 <= points[-1]
    assert [cloud.few_points is None for cloud in tried] == [own >= 5 for own in points]
    for before, after in pairwise(tried):
        sections = before.file.section, after.file.section
        assert sections[0].spacing == sections[1].spacing
        assert set(sections[1].edge_spacing) == {"tip"}
        # 0.9 h n / 5
        most = sections[0].edge_spacing["tip"] * max(0.3, 0.9 * before.few_points.count / 5)
        assert 0.9 * most <= sections[1].edge_spacing["tip"] <= most
    assert cloud_line(tried[0]).endswith(
        "(at most 8 %); contact_width has only 3 points in contact with plate (at least 5)"
    )
    assert cloud_line(tried[-1]).endswith("(at most 8 %)")
    # the choice is fixed
    assert chosen_for(file, seal)["filling"]["edge_spacing"] == file.section.edge_spacing


def test_points_that_are_not_reached(tmp_path, monkeypatch):
    monkeypatch.setattr(chosen_spacing, "ROUNDS", 1)
    with pytest.raises(
        ValueError, match=r"contact_width has only 3 points .* mm along tip, at least 5 are needed"
    ):
        refine(sm.read_seal_file(lip(tmp_path, 'contact_width = "8 %"')))


@pytest.mark.parametrize(
    ("accuracy", "few"),
    [
        ('reaction = "8 %"', None),
        ('pressure_integral = "8 %"', None),
        ('reaction = "8 %", peak_pressure = "9 %"', "peak_pressure has only 1 point in"),
    ],
)
def test_integrals_need_no_points(tmp_path, accuracy, few):
    """A force is the sum over the points; a peak is between two of them."""
    file = sm.read_seal_file(lip(tmp_path, accuracy, tip=0.1))
    found = Cloud(file, analyze(unchosen_seal(file)), {}).few_points
    assert (None if found is None else str(found)[: len(few)]) == few


def test_no_contact_needs_no_points(tmp_path):
    """The plate stays 1 mm above the tip."""
    path = lip(tmp_path, 'contact_width = "8 %"')
    path.write_text(path.read_text().replace("start = [0.0, 3.5]", "start = [0.0, 4.5]"))
    file = sm.read_seal_file(path)
    assert Cloud(file, analyze(unchosen_seal(file)), {}).few_points is None


@pytest.fixture(scope="module")
def chosen(tmp_path_factory):
    """Seal that is built for a reaction within 1.8 %, with its file and its clouds."""
    folder, tried = tmp_path_factory.mktemp("chosen"), []
    path = accurate(folder, '{ reaction = "1.8 %" }', "spacing = 0.6")
    file, seal = file_and_seal(sm.read_seal_file(path), report=tried.append)
    return file, seal, tried, analyze(seal)


def test_the_choice_is_fixed(chosen):
    """The analysis of the last cloud is that of the seal, and what was chosen gives the same bits
    without another choice, in recorder files, too."""
    file, seal, tried, result = chosen
    assert len(tried) >= 2
    # the path itself, without the factors of its tangents
    assert result.path.discretization is tried[-1].result.path.discretization
    found = chosen_for(file, seal)
    assert found["filling"] == tried[-1].file.section.filling
    for other in (sm.build_seal(file.path, **found), seal_of(seal.settings())):
        assert analyze(other).value("reaction")[0] == result.value("reaction")[0]


def test_within_the_admissible_error(chosen):
    """Of a cloud of half the spacing, whose own error is a quarter."""
    file, seal, _, result = chosen
    half = {"filling": with_factor(file.section.filling, 0.5)}
    finer = analyze(sm.build_seal(file.path, **(chosen_for(file, seal) | half)))
    force, best = (own.value("reaction")[0] for own in (result, finer))
    assert abs(force - best) <= 0.018 * best


@pytest.mark.parametrize(("count", "factor"), [(1, 0.3), (2, 0.36), (4, 0.72)])
def test_finer_edges_of_few_points(chosen, count, factor):
    """0.9 n / 5 of the distance of the points, at least 0.3 of it."""
    result = chosen[3]
    contact = contacts(result.seal)[0]
    points = np.argsort(result.response(contact.label).gap)[:count]
    apart = result.term(contact.label).where.lengths(result.particles)[points].max()
    found = _finer_edges(result, contact.label, points)
    assert found
    assert [*found.values()] == pytest.approx([factor * apart] * len(found), rel=1e-2)


def test_wrong_filling(chosen, tmp_path):
    file, seal, _, _ = chosen
    found = chosen_for(file, seal)
    with pytest.raises(sm.SealFileError, match=r"\[section\] has no accuracy; leave out filling"):
        sm.build_seal(cord(tmp_path), filling=found["filling"])
    with pytest.raises(sm.SealFileError, match="with spacing, layers and edge_spacing"):
        sm.build_seal(file.path, filling={"spacing": 0.3})
    with pytest.raises(sm.SealFileError, match="which the given load steps"):
        sm.build_seal(file.path, step_ends=[1.0])


def test_command(tmp_path, capsys):
    """A force within 1.8 %, and a file with the spacing that has it."""
    path, out = cord(tmp_path, spacing=0.6), tmp_path / "out"
    given = ["refine", str(path), "--to", "1.8 %", "--measures", "reaction", "--out", str(out)]
    assert main(given) == 0
    text = capsys.readouterr().out
    clouds = json.loads((out / "summary.json").read_text())["clouds"]
    assert len(clouds) >= 2
    last = clouds[-1]["errors"]["reaction"]
    assert last["bar"] <= 0.018 * last["value"] < clouds[0]["errors"]["reaction"]["bar"]
    assert f"{clouds[-1]['n_particles']} particles" in text
    # other lines are unchanged, and the new file gives the new cloud
    written = (out / path.name).read_text()
    assert tomllib.loads(written)["profile"] == tomllib.loads(path.read_text())["profile"]
    again = analyze(sm.build_seal(sm.read_seal_file(out / path.name)))
    assert len(again.particles) == clouds[-1]["n_particles"]
    assert again.value("reaction")[0] == last["value"]
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


def test_particles_of_rays_are_not_chosen(capsys):
    """The message names the key to replace, not the key accuracy, which the file does not have."""
    path = Path(__file__).parents[2] / "examples/paper_seal.toml"
    assert main(["refine", str(path), "--to", "2"]) == 2
    said = capsys.readouterr().err
    assert "but this one has rays; replace rays by a spacing" in said
    assert "accuracy" not in said


def test_analyze_shows_the_errors_of_the_choice(tmp_path, capsys, monkeypatch):
    """They are known without ``--errors``, and the choice is in the summary. A second command on the
    same file has the same, without trying clouds; ``refine`` tries them again."""
    monkeypatch.setenv(user_cache.FOLDER, str(tmp_path / "choices"))
    monkeypatch.setattr(registry, "_registered", {})
    path, out = accurate(tmp_path, '{ reaction = "3 %" }', "spacing = 0.6"), tmp_path / "out"
    assert main(["analyze", str(path), "--no-vtu", "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert "particles chosen for accuracy: spacing = 0.6, layers = 3" in text
    assert "estimated errors (computed minus exact value)" in text
    summary = json.loads((out / "summary.json").read_text())
    assert summary["filling"] == {"spacing": 0.6, "layers": 3, "edge_spacing": {}}
    assert (
        summary["measures"]["reaction"]["error_bar"]
        <= 0.03 * summary["errors"]["reaction"]["value"]
    )
    assert main(["analyze", str(path), "--no-vtu", "--out", str(out)]) == 0
    again = capsys.readouterr().out
    assert "layers = 3 (by an earlier command)" in again
    assert "at most 3 %" in text
    assert "at most 3 %" not in again
    other = json.loads((out / "summary.json").read_text())
    assert other | {"wall_s": 0.0} == summary | {"wall_s": 0.0}
    assert main(["refine", str(path), "--out", str(tmp_path / "refined")]) == 0
    assert "at most 3 %" in capsys.readouterr().out


def test_written_tolerances(tmp_path):
    """Those of the choice are in the new file, in place of larger ones."""
    path = accurate(tmp_path, spacing='edge_spacing = { "side" = 0.2 }')
    text = path.read_text().replace(", steps = 16", "").replace("tangent_penalty = 1000000.0\n", "")
    path.write_text(text + "[steps]\n# fewer\ntolerance = 0.02\n")
    file = sm.read_seal_file(path)
    written = tomllib.loads(refined_text(file, tmp_path / "out"))
    assert written["steps"] == {"tolerance": 0.0025}
    assert written["penalties"] == {"tolerance": 0.0005}
    given = tomllib.loads(text)
    section = {"spacing": 0.25, "layers": 3, "edge_spacing": {"side": 0.2}}
    del given["section"]["accuracy"]
    assert written["section"] == given["section"] | section
    path.write_text(path.read_text().replace("accuracy = {", "'accuracy' = {"))
    with pytest.raises(ValueError, match="must be on lines of their own"):
        refined_text(sm.read_seal_file(path), tmp_path / "out")


def test_particles_are_written_into_a_file_without_any(tmp_path):
    path = cord(tmp_path)
    text, count = re.subn(r"(?m)^(spacing|layers) = .*\n", "", path.read_text())
    assert count
    path.write_text(text)
    file = sm.read_seal_file(path)
    assert file.section.default_spacing
    written = tomllib.loads(refined_text(file, tmp_path / "out"))
    chosen = {"spacing": file.section.spacing, "layers": 5}
    assert written["section"] == tomllib.loads(text)["section"] | chosen


def test_sweeps_choose_once(tmp_path, monkeypatch, capsys):
    """A number of the file varies with the particles of the file; its spacing cannot vary."""
    path, clouds = accurate(tmp_path, '{ reaction = "30 %" }', "spacing = 0.6"), []
    real = chosen_spacing.estimate_errors

    def counted(file, *others):
        clouds.append(file.section.spacing)
        return real(file, *others)

    monkeypatch.setattr(chosen_spacing, "estimate_errors", counted)
    given = ["sweep", str(path), "--out", str(tmp_path / "out"), "--vary"]
    assert main([*given, "material.rubber.c10", "500,600"]) == 0
    assert clouds == [0.6]
    with pytest.raises(SystemExit):
        main([*given, "section.spacing", "0.5,0.6"])
    assert "section.spacing cannot be varied" in capsys.readouterr().err


def test_the_picture_of_the_particles_has_their_errors(chosen):
    """Of every measure with an estimate; without estimates there is the number of particles alone."""
    _, _, tried, result = chosen
    count = len(result.particles)
    lines = section_cloud(result, tried[-1].estimates).axes[0].get_title(loc="left").splitlines()
    assert lines[0].startswith(f"{count} particles, ")
    worst = tried[-1].worst
    assert f"reaction ± {100.0 * worst.error:.2g} % (estimated)" in lines
    assert not any("gap square sum" in line for line in lines)
    assert "%" not in section_cloud(result).axes[0].get_title(loc="left")
